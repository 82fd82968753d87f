//! The coupling operator: stored against lazy, rows and columns, Nyström against Galerkin.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, wave};
use fredholm_linop::{Dense, LinearOperator, MultiVector};
use fredholm_waves::surface::{cube, dihedral, facing_plates, trihedral};
use fredholm_waves::{Complex64, NystromCoupling, Scatterer, Shadow, WaveError, galerkin};
use std::f64::consts::FRAC_PI_2;

fn arbitrary(dim: usize, rhs_count: usize) -> MultiVector<Complex64> {
    MultiVector::from_fn(dim, rhs_count, |i, l| {
        let t = (i * 7 + l * 3 + 1) as f64;
        Complex64::new((t * 0.37).sin(), (t * 0.91).cos())
    })
}

fn product(a: &dyn LinearOperator<Complex64>, x: &MultiVector<Complex64>) -> MultiVector<Complex64> {
    let mut y = MultiVector::zeros(x.dim(), x.rhs_count());
    a.apply(x, &mut y);
    y
}

fn distance(a: &MultiVector<Complex64>, b: &MultiVector<Complex64>) -> f64 {
    let difference: f64 = a.as_slice().iter().zip(b.as_slice()).map(|(a, b)| (a - b).norm_sqr()).sum();
    (difference / b.as_slice().iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt()
}

/// Everything an operator is asked for agrees with the stored matrix.
fn check(scatterer: &Scatterer, shadow: Shadow) {
    let lazy = NystromCoupling::new(scatterer, wave(), shadow).unwrap();
    let dense = lazy.dense_matrix().unwrap();
    let x = arbitrary(dense.dim(), 2);
    let y = product(&lazy, &x);
    assert!(y.norms().iter().all(|&norm| norm > 1e-3), "{shadow:?}");
    assert!(distance(&y, &product(&dense, &x)) < 1e-12, "{shadow:?}");
    let mut line = vec![Complex64::ZERO; dense.dim()];
    for i in [0, 1, dense.dim() / 2, dense.dim() - 1] {
        lazy.row(i, 0, &mut line);
        assert_eq!(line, dense.row_slice(i));
        lazy.column(i, 0, &mut line);
        assert!(line.iter().enumerate().all(|(k, &entry)| entry == dense.get(k, i)));
    }
    lazy.diagonal(0, &mut line);
    assert!(line.iter().enumerate().all(|(k, &entry)| entry == dense.get(k, k)));
}

#[test]
fn the_lazy_operator_is_the_stored_one() {
    let open = [
        dihedral(0.9 * WAVELENGTH, 0.7 * WAVELENGTH, FRAC_PI_2, WAVELENGTH / 8.0).unwrap(),
        facing_plates(WAVELENGTH, 0.4, WAVELENGTH / 8.0).unwrap(),
        trihedral(WAVELENGTH, WAVELENGTH / 7.0).unwrap(),
    ];
    for scatterer in &open {
        for shadow in [Shadow::Geometric, Shadow::Radiated, Shadow::Thesis] {
            check(scatterer, shadow);
        }
        let refused = NystromCoupling::new(scatterer, wave(), Shadow::Exact);
        assert!(matches!(refused.err(), Some(WaveError::NotClosed { facet: 0 })));
    }
    for shadow in [Shadow::Exact, Shadow::ExactDual] {
        check(&cube(0.8 * WAVELENGTH, WAVELENGTH / 6.0).unwrap(), shadow);
    }
}

#[test]
fn a_convex_body_does_not_couple_with_itself_in_the_geometric_treatment() {
    let cube = cube(0.8 * WAVELENGTH, WAVELENGTH / 6.0).unwrap();
    for shadow in [Shadow::Geometric, Shadow::Radiated] {
        let lazy = NystromCoupling::new(&cube, wave(), shadow).unwrap();
        let y = product(&lazy, &arbitrary(lazy.dim(), 1));
        assert!(y.norms()[0] < 1e-12, "{shadow:?} {}", y.norms()[0]);
    }
}

/// Acting on a smooth current, both discretisations tend to the same as the mesh is refined.
#[test]
fn galerkin_and_nystrom_approach_each_other() {
    let gap = |per_wavelength: f64| {
        let scatterer = dihedral(WAVELENGTH, WAVELENGTH, FRAC_PI_2, WAVELENGTH / per_wavelength).unwrap();
        let k = wave().wavenumber();
        let current = |i: usize| Complex64::cis(k * 0.7 * scatterer.facets()[i / 2].centre.x);
        let x = MultiVector::from_fn(2 * scatterer.facets().len(), 1, |i, _| current(i));
        let nystrom = NystromCoupling::new(&scatterer, wave(), Shadow::Geometric).unwrap();
        let dense: Dense<Complex64> = galerkin(&scatterer, &wave(), Shadow::Geometric, 1e-3).unwrap();
        distance(&product(&dense, &x), &product(&nystrom, &x))
    };
    let (coarse, fine) = (gap(8.0), gap(16.0));
    assert!(coarse < 0.1 && fine < 0.6 * coarse, "{coarse} {fine}");
}

#[test]
fn the_same_bits_for_any_threads() {
    let scatterer = trihedral(WAVELENGTH, WAVELENGTH / 8.0).unwrap();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let lazy = NystromCoupling::new(&scatterer, wave(), Shadow::Geometric).unwrap();
            (product(&lazy, &arbitrary(lazy.dim(), 2)), lazy.dense_matrix().unwrap())
        })
    };
    let one = run(1);
    for threads in [2, 4] {
        assert_eq!(run(threads), one);
    }
}
