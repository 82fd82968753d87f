//! The diagonal that relaxation divides by.

use fredholm_linop::{LinearOperator, MultiVector, Scalar, SecondKind, SolveError};

/// a_ii per unknown and right-hand side.
///
/// # Errors
/// [`SolveError::Unsuitable`] if one of them cannot be divided by.
pub(crate) fn divisors<T: Scalar>(
    solver: &'static str,
    a: &SecondKind<'_, T>,
) -> Result<MultiVector<T>, SolveError> {
    let rhs_count = a.factor().rhs_count();
    let mut divisors = MultiVector::zeros(a.dim(), rhs_count);
    let mut diagonal = vec![T::zero(); a.dim()];
    for rhs in 0..rhs_count {
        a.diagonal(rhs, &mut diagonal);
        if let Some(i) = diagonal.iter().position(|entry| *entry == T::zero() || !entry.is_finite()) {
            let reason = format!(
                "it divides by the diagonal, but entry ({i}, {i}) of right-hand side {rhs} is {:?}; use a direct solver",
                diagonal[i]
            );
            return Err(SolveError::Unsuitable { solver, reason });
        }
        divisors.set_vector(rhs, &diagonal);
    }
    Ok(divisors)
}
