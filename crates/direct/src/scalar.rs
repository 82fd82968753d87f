//! The numbers that dense systems are made of.

use crate::bunch_kaufman::Ldlt;
use crate::cholesky::Llt;
use crate::factorisation::Lu;
use fredholm_linop::Scalar;
use num_complex::{Complex32, Complex64};

/// A number whose dense matrices are factorised, also in single precision. Implemented for f64 and
/// Complex64.
pub trait DenseScalar: Scalar + Lu + Llt + Ldlt {
    /// The counterpart in single precision.
    type Low: Lu;
    /// The nearest number in single precision.
    fn lower(self) -> Self::Low;
    /// The same number in double precision.
    fn raise(low: Self::Low) -> Self;
}

impl DenseScalar for f64 {
    type Low = f32;

    fn lower(self) -> f32 {
        self as f32
    }

    fn raise(low: f32) -> Self {
        f64::from(low)
    }
}

impl DenseScalar for Complex64 {
    type Low = Complex32;

    fn lower(self) -> Complex32 {
        Complex32::new(self.re as f32, self.im as f32)
    }

    fn raise(low: Complex32) -> Self {
        Self::new(low.re.into(), low.im.into())
    }
}
