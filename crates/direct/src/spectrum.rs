//! What decides how iterative schemes fare on A = I − D K: spectra, conditions, and the properties
//! that the theory asks for.
//!
//! With Φ = A, C = diag(A), A = C + L + U and H = D⁻¹: J = I − C⁻¹ A is Jacobi's iteration matrix,
//! L₁ = −(C + L)⁻¹ U that of Gauss–Seidel, Ψ = H Φ and Θ = H^½ Φ H^(−½) are symmetric for light.
//! Source: M. Leblond, Numerical Linear Algebra with Applications 9, 2002; A. Berman, R. J.
//! Plemmons, Nonnegative Matrices in the Mathematical Sciences, SIAM 1994, chapter 6, DOI
//! 10.1137/1.9781611971262.
//!
//! Φ is an M-matrix if no entry beside the diagonal is positive and the inverse has no negative
//! one; a symmetric M-matrix is a Stieltjes matrix. Ψ is that of the unknowns with d_i > 0; black
//! ones have no row in it.
//!
//! ```
//! use fredholm_direct::spectrum;
//! use fredholm_linop::{MultiVector, PackedSymmetric, SecondKind};
//!
//! // Two facing plates: ρF has the eigenvalues ±½.
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let found = spectrum(&a, 0)?;
//! assert!((found.jacobi_radius() - 0.5).abs() < 1e-15 && (found.gauss_seidel_radius() - 0.25).abs() < 1e-15);
//! assert!(found.m_matrix && found.irreducible);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::eigen::{eigenvalues, singular_values, symmetric_eigenvalues};
use crate::factorisation::Factorisation;
use fredholm_linop::{Dense, LinearOperator, LinopError, SecondKind};
use num_complex::Complex64;
use thiserror::Error;

/// Rounding of an entry of the inverse, relative to the largest.
const ROUNDING: f64 = 1e-12;

/// Spectra, conditions and properties of the system of one right-hand side.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Eigenvalues of D K (R F for light), by falling modulus.
    pub reflection: Vec<Complex64>,
    /// Eigenvalues of J, by falling modulus.
    pub jacobi: Vec<Complex64>,
    /// Eigenvalues of L₁, by falling modulus.
    pub gauss_seidel: Vec<Complex64>,
    /// cond₂ of Φ.
    pub condition_phi: f64,
    /// Eigenvalues of Ψ, ascending; empty where D has a negative entry.
    pub psi: Vec<f64>,
    /// Eigenvalues of Θ, ascending; empty where D has a negative entry.
    pub theta: Vec<f64>,
    /// Largest |ψ_ij − ψ_ji| over the largest |ψ_ij|.
    pub symmetry_defect: f64,
    /// Whether Φ is an M-matrix.
    pub m_matrix: bool,
    /// Whether every unknown acts on every other, maybe over others.
    pub irreducible: bool,
    /// The field of values {xᴴ Φ x : ‖x‖ = 1} fits these bounds: real from, real to, and imaginary
    /// on either side of 0.
    pub field_of_values: [f64; 3],
}

/// A spectrum that cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SpectrumError {
    /// The iteration of the eigenvalue method did not end.
    #[error("the {what} were not found; the matrix may hold very large or very small entries")]
    NotConverged {
        /// What was looked for.
        what: &'static str,
    },
    /// There is no memory.
    #[error(transparent)]
    Linop(#[from] LinopError),
    /// The diagonal cannot be divided by.
    #[error("entry ({index}, {index}) of the system is 0: there is no Jacobi iteration")]
    Diagonal {
        /// Index of the unknown.
        index: usize,
    },
}

impl Spectrum {
    /// ρ(J).
    #[must_use]
    pub fn jacobi_radius(&self) -> f64 {
        radius(&self.jacobi)
    }

    /// ρ(L₁).
    #[must_use]
    pub fn gauss_seidel_radius(&self) -> f64 {
        radius(&self.gauss_seidel)
    }

    /// ρ(D K).
    #[must_use]
    pub fn reflection_radius(&self) -> f64 {
        radius(&self.reflection)
    }

    /// cond₂(Ψ), where Ψ is positive definite.
    #[must_use]
    pub fn condition_psi(&self) -> Option<f64> {
        condition(&self.psi)
    }

    /// cond₂(Θ), where Θ is positive definite.
    #[must_use]
    pub fn condition_theta(&self) -> Option<f64> {
        condition(&self.theta)
    }

    /// Whether Ψ is a Stieltjes matrix: a symmetric M-matrix.
    #[must_use]
    pub fn stieltjes(&self) -> bool {
        self.m_matrix && self.symmetry_defect == 0.0 && self.condition_psi().is_some()
    }
}

fn radius(values: &[Complex64]) -> f64 {
    values.first().map_or(0.0, |value| value.norm())
}

fn condition(ascending: &[f64]) -> Option<f64> {
    let (low, high) = (ascending.first()?, ascending.last()?);
    (*low > 0.0).then_some(high / low)
}

/// Bytes that [`spectrum`] takes besides the operator: some dense matrices.
#[must_use]
pub fn spectrum_bytes(dim: usize) -> u64 {
    Dense::<f64>::bytes(dim).saturating_mul(9)
}

/// Computes it all for one right-hand side, by dense methods: n³ operations, some n² entries of
/// memory.
///
/// # Errors
/// No memory, an eigenvalue method that does not end, or a diagonal entry of 0.
pub fn spectrum(a: &SecondKind<'_, f64>, rhs: usize) -> Result<Spectrum, SpectrumError> {
    let phi = a.dense(rhs)?;
    let factors: Vec<f64> = (0..a.dim()).map(|i| a.factor().row(i)[rhs]).collect();
    let (psi, theta, symmetry_defect) = symmetric_forms(a, &factors, rhs)?;
    let singular = singular_values(&phi)?;
    Ok(Spectrum {
        reflection: sorted(eigenvalues(&map(&phi, |i, j, entry| diagonal(i, j) - entry)?)?),
        jacobi: sorted(eigenvalues(&jacobi(&phi)?)?),
        gauss_seidel: sorted(eigenvalues(&gauss_seidel(&phi)?)?),
        condition_phi: singular.first().zip(singular.last()).map_or(1.0, |(high, low)| high / low),
        psi,
        theta,
        symmetry_defect,
        m_matrix: is_m_matrix(&phi)?,
        irreducible: is_irreducible(&phi),
        field_of_values: field_of_values(&phi)?,
    })
}

fn diagonal(i: usize, j: usize) -> f64 {
    f64::from(u8::from(i == j))
}

fn sorted(mut values: Vec<Complex64>) -> Vec<Complex64> {
    values.sort_by(|u, v| {
        v.norm().total_cmp(&u.norm()).then(v.re.total_cmp(&u.re)).then(v.im.total_cmp(&u.im))
    });
    values
}

/// A matrix of which every entry is made of that of another.
fn map(of: &Dense<f64>, entry: impl Fn(usize, usize, f64) -> f64) -> Result<Dense<f64>, LinopError> {
    let mut made = Dense::zeros(of.dim())?;
    for i in 0..of.dim() {
        let rows = made.row_slice_mut(i).iter_mut().zip(of.row_slice(i)).enumerate();
        rows.for_each(|(j, (made, &known))| *made = entry(i, j, known));
    }
    Ok(made)
}

/// J = I − C⁻¹ A.
fn jacobi(phi: &Dense<f64>) -> Result<Dense<f64>, SpectrumError> {
    if let Some(index) = (0..phi.dim()).find(|&i| phi.get(i, i) == 0.0) {
        return Err(SpectrumError::Diagonal { index });
    }
    Ok(map(phi, |i, j, entry| if i == j { 0.0 } else { -entry / phi.get(i, i) })?)
}

/// L₁ = −(C + L)⁻¹ U, row by row by forward substitution.
fn gauss_seidel(phi: &Dense<f64>) -> Result<Dense<f64>, LinopError> {
    let n = phi.dim();
    let mut made = map(phi, |i, j, entry| if j > i { -entry } else { 0.0 })?;
    let mut row = vec![0.0; n];
    for i in 0..n {
        row.copy_from_slice(made.row_slice(i));
        for (k, &below) in phi.row_slice(i)[..i].iter().enumerate() {
            row.iter_mut().zip(made.row_slice(k)).for_each(|(sum, known)| *sum -= below * known);
        }
        let pivot = phi.get(i, i);
        made.row_slice_mut(i).iter_mut().zip(&row).for_each(|(entry, sum)| *entry = sum / pivot);
    }
    Ok(made)
}

/// Eigenvalues of Ψ and Θ, and how far Ψ is from symmetric.
fn symmetric_forms(
    a: &SecondKind<'_, f64>,
    factors: &[f64],
    rhs: usize,
) -> Result<(Vec<f64>, Vec<f64>, f64), SpectrumError> {
    let coupling = a.coupling().dense(rhs)?;
    let defect = symmetry_defect(&coupling, factors);
    if factors.iter().any(|&d| d < 0.0) {
        return Ok((Vec::new(), Vec::new(), defect));
    }
    let theta = map(&coupling, |i, j, entry| diagonal(i, j) - (factors[i] * factors[j]).sqrt() * entry)?;
    let lit: Vec<usize> = (0..factors.len()).filter(|&i| factors[i] > 0.0).collect();
    let psi = |i: usize, j: usize| diagonal(i, j) / factors[i] - coupling.get(i, j);
    let entries =
        lit.iter().flat_map(|&i| lit.iter().map(move |&j| (i, j))).map(|(i, j)| psi(i, j)).collect();
    let psi = Dense::new(lit.len(), entries)?;
    Ok((symmetric_eigenvalues(&psi)?, symmetric_eigenvalues(&theta)?, defect))
}

/// ψ_ij = −k_ij beside the diagonal, whatever D is.
fn symmetry_defect(coupling: &Dense<f64>, factors: &[f64]) -> f64 {
    let n = coupling.dim();
    let on_diagonal = |i: usize| if factors[i] == 0.0 { 0.0 } else { 1.0 / factors[i] - coupling.get(i, i) };
    let (mut defect, mut largest) = (0.0_f64, 0.0_f64);
    for i in 0..n {
        largest = largest.max(on_diagonal(i).abs());
        for j in 0..i {
            let (lower, upper) = (coupling.get(i, j), coupling.get(j, i));
            defect = defect.max((lower - upper).abs());
            largest = largest.max(lower.abs()).max(upper.abs());
        }
    }
    if largest > 0.0 { defect / largest } else { 0.0 }
}

fn is_m_matrix(phi: &Dense<f64>) -> Result<bool, SpectrumError> {
    let n = phi.dim();
    let positive = |i: usize| phi.row_slice(i).iter().enumerate().any(|(j, &entry)| j != i && entry > 0.0);
    if (0..n).any(positive) {
        return Ok(false);
    }
    let factorisation = Factorisation::new(n, map(phi, |_, _, entry| entry)?.into_vec())?;
    if factorisation.is_singular(f64::EPSILON, f64::abs) {
        return Ok(false);
    }
    let mut inverse = map(phi, |i, j, _| diagonal(i, j))?.into_vec();
    factorisation.solve(&mut inverse)?;
    let largest = inverse.iter().copied().fold(0.0, f64::max);
    Ok(inverse.iter().all(|&entry| entry >= -ROUNDING * largest))
}

/// Whether everything is reached from unknown 0, and it from everything.
fn is_irreducible(phi: &Dense<f64>) -> bool {
    let n = phi.dim();
    let reaches_all = |linked: &dyn Fn(usize, usize) -> bool| {
        let (mut seen, mut open) = (vec![false; n], vec![0]);
        seen.iter_mut().take(1).for_each(|first| *first = true);
        while let Some(i) = open.pop().filter(|_| n > 0) {
            for j in (0..n).filter(|&j| linked(i, j)) {
                if !seen[j] {
                    seen[j] = true;
                    open.push(j);
                }
            }
        }
        seen.iter().all(|&seen| seen)
    };
    reaches_all(&|i, j| phi.get(i, j) != 0.0) && reaches_all(&|i, j| phi.get(j, i) != 0.0)
}

/// Eigenvalues of the symmetric part bound it along the real axis, those of the skew part along the
/// imaginary one.
fn field_of_values(phi: &Dense<f64>) -> Result<[f64; 3], SpectrumError> {
    let symmetric = symmetric_eigenvalues(&map(phi, |i, j, entry| 0.5 * (entry + phi.get(j, i)))?)?;
    let skew = singular_values(&map(phi, |i, j, entry| 0.5 * (entry - phi.get(j, i)))?)?;
    let first = |values: &[f64]| values.first().copied().unwrap_or(0.0);
    Ok([first(&symmetric), symmetric.last().copied().unwrap_or(0.0), first(&skew)])
}
