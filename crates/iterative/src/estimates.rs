//! What a matrix that is too large for dense methods tells of its spectrum: eigenvalues by the
//! Lanczos process, and the radius of Gauss–Seidel by its own sweeps.

use crate::GaussSeidel;
use crate::core::{Metric, lanczos};
use fredholm_linop::{
    Context, Halt, LinearOperator, MultiVector, Scalar, Scheme, SecondKind, SolveError, Watch, Work,
};

/// Estimated eigenvalues of A per right-hand side, ascending: those of the Lanczos process in the
/// inner product of H = D⁻¹ after `steps` steps with whole orthogonalisation. The extreme ones are
/// the best. Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., § 10.1.
///
/// Memory: `steps` + 2 vectors. Cost: `steps` applications.
///
/// ```
/// use fredholm_iterative::ritz_values;
/// use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind};
///
/// let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
/// let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
/// let values = ritz_values(&a, 2, &Quiet)?;
/// assert!((values[0][0] - 0.5).abs() < 1e-15 && (values[0][1] - 1.5).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SolveError::Unsuitable`] where A is not known to be self-adjoint in that product. Where
/// `watch` breaks, what was found by then is lost and the lists are empty.
pub fn ritz_values<T: Scalar>(
    a: &SecondKind<'_, T>,
    steps: usize,
    watch: &dyn Watch,
) -> Result<Vec<Vec<f64>>, SolveError> {
    let metric = Metric::new("the Lanczos process", a)?;
    let mut work = Work::default();
    match lanczos(a, &metric, steps, true, &mut Context::new(&mut work, &mut || watch.go_on())) {
        Ok(found) => {
            Ok(found.iter().map(|t| (0..t.diagonal.len()).map(|k| t.eigenvalue(k)).collect()).collect())
        }
        Err(Halt::Interrupted) => Ok(vec![Vec::new(); a.factor().rhs_count()]),
        Err(Halt::Refused(error)) => Err(error),
    }
}

/// Estimated spectral radius of Gauss–Seidel's iteration matrix per right-hand side: the growth of
/// an error in the last of `sweeps` sweeps.
///
/// ```
/// use fredholm_iterative::gauss_seidel_radius;
/// use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind};
///
/// let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
/// let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
/// let radius = gauss_seidel_radius(&a, 5, &Quiet)?;
/// assert!((radius[0] - 0.25).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SolveError::Unsuitable`] where a diagonal entry is 0. Where `watch` breaks, the estimates are
/// those found by then.
pub fn gauss_seidel_radius<T: Scalar>(
    a: &SecondKind<'_, T>,
    sweeps: usize,
    watch: &dyn Watch,
) -> Result<Vec<f64>, SolveError> {
    // With b = 0 the iterate is its own error.
    let b = MultiVector::zeros(a.dim(), a.factor().rhs_count());
    let mut x = MultiVector::from_fn(b.dim(), b.rhs_count(), |_, _| T::one());
    let mut work = Work::default();
    let mut poll = || watch.go_on();
    let mut context = Context::new(&mut work, &mut poll);
    let mut growth = vec![0.0; b.rhs_count()];
    let mut sweep = || -> Result<(), Halt> {
        let mut iteration = GaussSeidel.begin(a, &b, &mut context)?;
        iteration.restart(&mut x, &mut context)?;
        for _ in 0..sweeps {
            let before = x.norms();
            iteration.advance(&mut x, &mut context)?;
            let after = x.norms().into_iter().zip(before);
            growth = after.map(|(after, before)| if before > 0.0 { after / before } else { 0.0 }).collect();
        }
        Ok(())
    };
    match sweep() {
        Ok(()) | Err(Halt::Interrupted) => Ok(growth),
        Err(Halt::Refused(error)) => Err(error),
    }
}
