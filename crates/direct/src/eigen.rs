//! Eigenvalues and singular values of dense real matrices, by faer.
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, chapters 7 and 8. Cost: about 10n³ operations for eigenvalues of a general matrix,
//! 4n³/3 for a symmetric one, 8n³/3 for singular values. Memory: n² entries more.

use crate::factorisation::{par, scratch};
use crate::spectrum::SpectrumError;
use faer::diag::Diag;
use faer::dyn_stack::MemStack;
use faer::linalg::evd::{
    ComputeEigenvectors, evd_real, evd_scratch, self_adjoint_evd, self_adjoint_evd_scratch,
};
use faer::linalg::svd::{ComputeSvdVectors, svd, svd_scratch};
use faer::{MatRef, Spec};
use fredholm_linop::Dense;
use num_complex::Complex64;

/// Eigenvalues of a matrix, in no particular order.
pub(crate) fn eigenvalues(matrix: &Dense<f64>) -> Result<Vec<Complex64>, SpectrumError> {
    let n = matrix.dim();
    let none = ComputeEigenvectors::No;
    let mut memory = scratch(evd_scratch::<f64>(n, none, none, par(), Spec::default()))?;
    let (mut real, mut imaginary) = (Diag::<f64>::zeros(n), Diag::<f64>::zeros(n));
    let (re, im, stack) = (real.as_mut(), imaginary.as_mut(), MemStack::new(&mut memory));
    evd_real(view(matrix), re, im, None, None, par(), stack, Spec::default())
        .map_err(|_| SpectrumError::NotConverged { what: "eigenvalues" })?;
    let parts = real.column_vector().iter().zip(imaginary.column_vector().iter());
    Ok(parts.map(|(&re, &im)| Complex64::new(re, im)).collect())
}

/// Eigenvalues of a symmetric matrix, ascending. Only what is on one side of the diagonal is read.
pub(crate) fn symmetric_eigenvalues(matrix: &Dense<f64>) -> Result<Vec<f64>, SpectrumError> {
    let n = matrix.dim();
    let none = ComputeEigenvectors::No;
    let mut memory = scratch(self_adjoint_evd_scratch::<f64>(n, none, par(), Spec::default()))?;
    let mut values = Diag::<f64>::zeros(n);
    let stack = MemStack::new(&mut memory);
    self_adjoint_evd(view(matrix), values.as_mut(), None, par(), stack, Spec::default())
        .map_err(|_| SpectrumError::NotConverged { what: "eigenvalues" })?;
    Ok(values.column_vector().iter().copied().collect())
}

/// Singular values, descending.
pub(crate) fn singular_values(matrix: &Dense<f64>) -> Result<Vec<f64>, SpectrumError> {
    let n = matrix.dim();
    let none = ComputeSvdVectors::No;
    let mut memory = scratch(svd_scratch::<f64>(n, n, none, none, par(), Spec::default()))?;
    let mut values = Diag::<f64>::zeros(n);
    let stack = MemStack::new(&mut memory);
    svd(view(matrix), values.as_mut(), None, None, par(), stack, Spec::default())
        .map_err(|_| SpectrumError::NotConverged { what: "singular values" })?;
    Ok(values.column_vector().iter().copied().collect())
}

/// The transposed matrix: that has the same values, and columns where rows are stored.
fn view(matrix: &Dense<f64>) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(matrix.as_slice(), matrix.dim(), matrix.dim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_a_rotation_and_of_a_second_difference_are_known() {
        let rotation = Dense::new(2, vec![0.0, -2.0, 2.0, 0.0]).unwrap();
        let mut found = eigenvalues(&rotation).unwrap();
        found.sort_by(|a, b| a.im.total_cmp(&b.im));
        assert!(
            (found[0] - Complex64::new(0.0, -2.0)).norm() < 1e-15
                && (found[1] - found[0].conj()).norm() < 1e-15
        );
        assert!(singular_values(&rotation).unwrap().iter().all(|value| (value - 2.0).abs() < 1e-15));
        let n = 12;
        let entry = |at: usize| match (at / n).abs_diff(at % n) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        };
        let difference = Dense::new(n, (0..n * n).map(entry).collect()).unwrap();
        for (k, value) in symmetric_eigenvalues(&difference).unwrap().into_iter().enumerate() {
            let exact = 2.0 - 2.0 * (std::f64::consts::PI * (k + 1) as f64 / (n + 1) as f64).cos();
            assert!((value - exact).abs() < 1e-14);
        }
    }
}
