//! The numbers that unknowns are made of: f64 for light, Complex64 for waves.

use faer::linalg::matmul::matmul;
use faer::traits::ComplexField;
use faer::traits::math_utils::one;
use faer::{Accum, MatMut, MatRef, Par};
use num_complex::{Complex32, Complex64};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for num_complex::Complex64 {}
}

/// What there is one of for each kind of number, such as a list of solvers.
pub trait OfScalar {
    /// That of T.
    type Of<T: Scalar>;
}

/// A real or complex number in double precision. Implemented for f64 and Complex64 only.
pub trait Scalar:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + bytemuck::Zeroable
    + 'static
{
    /// The same number in single precision, for storage in half the memory.
    type Single: Copy + Debug + PartialEq + Send + Sync + bytemuck::Zeroable + 'static;
    /// Whether these are the real numbers.
    const IS_REAL: bool;
    /// The nearest number in single precision; what is above 3.4e38 becomes infinite.
    fn to_single(self) -> Self::Single;
    /// The number that is stored in single precision.
    fn from_single(single: Self::Single) -> Self;
    /// 0.
    fn zero() -> Self;
    /// 1.
    fn one() -> Self;
    /// The real number `value`.
    fn from_real(value: f64) -> Self;
    /// Real part.
    fn re(self) -> f64;
    /// Complex conjugate; the number itself where it is real.
    #[must_use]
    fn conj(self) -> Self;
    /// The number times a real one.
    #[must_use]
    fn scale(self, factor: f64) -> Self;
    /// Absolute value.
    fn abs(self) -> f64;
    /// Square of the absolute value.
    fn abs2(self) -> f64;
    /// Neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// y = A x for matrices stored row by row: `count` numbers of x for each of `len` numbers of a
    /// row of A. The bits depend on the sizes alone.
    fn multiply(a: &[Self], x: &[Self], y: &mut [Self], len: usize, count: usize);
    /// What `real` or `complex` makes, whichever is of this kind. These are no generic functions,
    /// so that what they name is compiled in their crate, once, and not wherever a generic function
    /// calls this.
    fn choose<F: OfScalar>(real: fn() -> F::Of<f64>, complex: fn() -> F::Of<Complex64>) -> F::Of<Self>;
}

impl Scalar for f64 {
    type Single = f32;
    const IS_REAL: bool = true;

    #[inline]
    fn to_single(self) -> f32 {
        self as f32
    }

    #[inline]
    fn from_single(single: f32) -> Self {
        single.into()
    }

    #[inline]
    fn zero() -> Self {
        0.0
    }

    #[inline]
    fn one() -> Self {
        1.0
    }

    #[inline]
    fn from_real(value: f64) -> Self {
        value
    }

    #[inline]
    fn re(self) -> f64 {
        self
    }

    #[inline]
    fn conj(self) -> Self {
        self
    }

    #[inline]
    fn scale(self, factor: f64) -> Self {
        self * factor
    }

    #[inline]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline]
    fn abs2(self) -> f64 {
        self * self
    }

    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    fn multiply(a: &[Self], x: &[Self], y: &mut [Self], len: usize, count: usize) {
        multiply(a, x, y, len, count);
    }

    fn choose<F: OfScalar>(real: fn() -> F::Of<f64>, _: fn() -> F::Of<Complex64>) -> F::Of<f64> {
        real()
    }
}

impl Scalar for Complex64 {
    type Single = Complex32;
    const IS_REAL: bool = false;

    #[inline]
    fn to_single(self) -> Complex32 {
        Complex32::new(self.re as f32, self.im as f32)
    }

    #[inline]
    fn from_single(single: Complex32) -> Self {
        Self::new(single.re.into(), single.im.into())
    }

    #[inline]
    fn zero() -> Self {
        Self::new(0.0, 0.0)
    }

    #[inline]
    fn one() -> Self {
        Self::new(1.0, 0.0)
    }

    #[inline]
    fn from_real(value: f64) -> Self {
        Self::new(value, 0.0)
    }

    #[inline]
    fn re(self) -> f64 {
        self.re
    }

    #[inline]
    fn conj(self) -> Self {
        Complex64::conj(&self)
    }

    #[inline]
    fn scale(self, factor: f64) -> Self {
        Complex64::scale(&self, factor)
    }

    #[inline]
    fn abs(self) -> f64 {
        self.norm()
    }

    #[inline]
    fn abs2(self) -> f64 {
        self.norm_sqr()
    }

    #[inline]
    fn is_finite(self) -> bool {
        Complex64::is_finite(self)
    }

    fn multiply(a: &[Self], x: &[Self], y: &mut [Self], len: usize, count: usize) {
        multiply(a, x, y, len, count);
    }

    fn choose<F: OfScalar>(_: fn() -> F::Of<f64>, complex: fn() -> F::Of<Complex64>) -> F::Of<Self> {
        complex()
    }
}

fn multiply<T: ComplexField>(a: &[T], x: &[T], y: &mut [T], len: usize, count: usize) {
    let rows = a.len() / len.max(1);
    let (a, x) = (MatRef::from_row_major_slice(a, rows, len), MatRef::from_row_major_slice(x, len, count));
    matmul(MatMut::from_row_major_slice_mut(y, rows, count), Accum::Replace, a, x, one(), Par::Seq);
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "these results are exact")]
mod tests {
    use super::*;

    #[test]
    fn complex_arithmetic_is_that_of_the_plane() {
        let z = Complex64::new(3.0, -4.0);
        assert_eq!((Scalar::abs(z), Scalar::abs2(z)), (5.0, 25.0));
        assert_eq!(Scalar::conj(z), Complex64::new(3.0, 4.0));
        assert_eq!(
            (Scalar::re(z), <Complex64 as Scalar>::IS_REAL, <f64 as Scalar>::IS_REAL),
            (3.0, false, true)
        );
        assert_eq!(z * Scalar::conj(z), Complex64::from_real(25.0));
        assert_eq!(Scalar::scale(z, 2.0), z + z);
        assert!(!Scalar::is_finite(Complex64::new(0.0, f64::NAN)));
        assert_eq!(Complex64::from_single(z.to_single()), z);
        let rounded = f64::from_single(0.1.to_single());
        assert!(rounded != 0.1 && (rounded - 0.1).abs() < 1e-8);
    }

    #[test]
    fn real_numbers_are_their_own_conjugates() {
        assert_eq!((Scalar::abs(-2.0), Scalar::abs2(-2.0), Scalar::conj(-2.0)), (2.0, 4.0, -2.0));
        assert!(!Scalar::is_finite(f64::INFINITY));
    }
}
