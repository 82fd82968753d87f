//! The diagonal that relaxation divides by.

use fredholm_linop::{LinearOperator, MultiVector, Scalar, SecondKind, SolveError};

/// a_ii per unknown and lane.
///
/// # Errors
/// [`SolveError::Unsuitable`] if one of them cannot be divided by.
pub(crate) fn divisors<T: Scalar>(
    solver: &'static str,
    a: &SecondKind<'_, T>,
) -> Result<MultiVector<T>, SolveError> {
    let lanes = a.factor().lanes();
    let mut divisors = MultiVector::zeros(a.dim(), lanes);
    let mut diagonal = vec![T::zero(); a.dim()];
    for lane in 0..lanes {
        a.diagonal(lane, &mut diagonal);
        if let Some(i) = diagonal.iter().position(|entry| *entry == T::zero() || !entry.is_finite()) {
            let reason = format!(
                "it divides by the diagonal, but entry ({i}, {i}) of lane {lane} is {:?}; use a direct solver",
                diagonal[i]
            );
            return Err(SolveError::Unsuitable { solver, reason });
        }
        divisors.set_lane(lane, &diagonal);
    }
    Ok(divisors)
}
