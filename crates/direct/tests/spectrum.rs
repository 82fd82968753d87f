//! Spectra against closed forms, and the checks on matrices that have and have not what they look
//! for.

#![allow(clippy::unwrap_used)] // a test that cannot run should panic

use fredholm_direct::{SpectrumError, spectrum};
use fredholm_linop::{Dense, MultiVector, PackedSymmetric, SecondKind};

/// An integrating sphere of n equal patches: F = 1/n everywhere, so that R F has the eigenvalue ρ
/// once, else 0.
fn sphere(n: usize, rho: f64) -> (PackedSymmetric<f64>, MultiVector<f64>) {
    let coupling = PackedSymmetric::new(n, vec![1.0 / n as f64; n * (n + 1) / 2]).unwrap();
    (coupling, MultiVector::from_fn(n, 1, |_, _| rho))
}

#[test]
fn an_integrating_sphere_has_one_eigenvalue_that_is_not_zero() {
    let (n, rho) = (20, 0.75);
    let (coupling, factor) = sphere(n, rho);
    let found = spectrum(&SecondKind::new(&coupling, factor).unwrap(), 0).unwrap();
    assert!((found.reflection_radius() - rho).abs() < 1e-14);
    assert!(found.reflection[1..].iter().all(|value| value.norm() < 1e-13));
    // Θ = I − ρ 1 1ᵀ/n: eigenvalues 1 − ρ and 1.
    assert!((found.condition_theta().unwrap() - 1.0 / (1.0 - rho)).abs() < 1e-12);
    assert!((found.condition_psi().unwrap() - 1.0 / (1.0 - rho)).abs() < 1e-12);
    assert!((found.condition_phi - 1.0 / (1.0 - rho)).abs() < 1e-12);
    // J = (q/p)(1 1ᵀ − I) with q = ρ/n, p = 1 − q: eigenvalues (n − 1) q/p and −q/p.
    let q = rho / n as f64;
    assert!((found.jacobi_radius() - (n - 1) as f64 * q / (1.0 - q)).abs() < 1e-13);
    assert!(found.m_matrix && found.stieltjes() && found.irreducible);
    let [low, high, skew] = found.field_of_values;
    assert!((low - (1.0 - rho)).abs() < 1e-13 && (high - 1.0).abs() < 1e-13 && skew < 1e-14);
}

#[test]
fn gauss_seidel_of_a_tridiagonal_matrix_squares_the_radius_of_jacobi() {
    let n = 9;
    let entry = |at: usize| f64::from(u8::from((at / n).abs_diff(at % n) == 1));
    let coupling = Dense::new(n, (0..n * n).map(entry).collect()).unwrap();
    let a = SecondKind::new(&coupling, MultiVector::from_fn(n, 1, |_, _| 0.5)).unwrap();
    let found = spectrum(&a, 0).unwrap();
    let cosine = (std::f64::consts::PI / 10.0).cos();
    assert!((found.jacobi_radius() - cosine).abs() < 1e-14);
    assert!((found.gauss_seidel_radius() - cosine * cosine).abs() < 1e-12);
}

#[test]
fn what_is_missing_is_told() {
    // K = [0 −1; 2 0]: a positive entry beside the diagonal of Φ, eigenvalues ±i√2 of K, not
    // symmetric.
    let coupling = Dense::new(2, vec![0.0, -1.0, 2.0, 0.0]).unwrap();
    let a =
        |d: [f64; 2]| SecondKind::new(&coupling, MultiVector::from_vec(2, 1, d.to_vec()).unwrap()).unwrap();
    let found = spectrum(&a([1.0, 1.0]), 0).unwrap();
    assert!(!found.m_matrix && !found.stieltjes() && found.irreducible);
    assert!((found.reflection_radius() - 2f64.sqrt()).abs() < 1e-15);
    assert!((found.reflection[0].im.abs() - 2f64.sqrt()).abs() < 1e-15);
    assert!((found.symmetry_defect - 1.5).abs() < 1e-15);
    // The skew part of Φ is [0 1.5; −1.5 0].
    assert!((found.field_of_values[2] - 1.5).abs() < 1e-15);
    // With a black unknown nothing comes back from it.
    assert!(!spectrum(&a([1.0, 0.0]), 0).unwrap().irreducible);
    // A closed scene that reflects too much has no positive inverse.
    let (coupling, factor) = sphere(5, 1.5);
    let found = spectrum(&SecondKind::new(&coupling, factor).unwrap(), 0).unwrap();
    assert!(!found.m_matrix && found.condition_theta().is_none());
    let unit = Dense::new(1, vec![1.0]).unwrap();
    let a = SecondKind::new(&unit, MultiVector::from_fn(1, 1, |_, _| 1.0)).unwrap();
    assert_eq!(spectrum(&a, 0), Err(SpectrumError::Diagonal { index: 0 }));
}
