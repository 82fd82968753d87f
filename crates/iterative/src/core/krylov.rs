//! Factors of several right-hand sides at once.

use fredholm_linop::Scalar;

/// u/v per right-hand side; 0 where there is nothing to divide by, as in a right-hand side that is
/// solved exactly.
pub(crate) fn quotients<T: Scalar>(u: &[T], v: &[T]) -> Vec<T> {
    let quotient = |(&u, &v): (&T, &T)| if v == T::zero() { T::zero() } else { u / v };
    u.iter().zip(v).map(quotient).map(|q| if q.is_finite() { q } else { T::zero() }).collect()
}

/// −u per right-hand side.
pub(crate) fn minus<T: Scalar>(u: &[T]) -> Vec<T> {
    u.iter().map(|&u| -u).collect()
}

/// Real numbers as scalars.
pub(crate) fn reals<T: Scalar>(u: &[f64]) -> Vec<T> {
    u.iter().map(|&u| T::from_real(u)).collect()
}
