//! The numbers that blocks are made of, and those that they are multiplied with.

use faer::linalg::matmul::matmul;
use faer::traits::ComplexField;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use fredholm_linop::Scalar;
use num_complex::{Complex32, Complex64};
use std::ops::{Mul, Neg};

/// A real or complex number in single precision. Implemented for f32 and Complex32.
pub trait Number: Times<Self> + Send + Sync {
    /// The number in double precision.
    type Double: Scalar<Single = Self> + Times<Self>;
    /// |x|².
    fn square(self) -> f64;
}

/// A number that matrices of others are multiplied with: in single precision while they are
/// factorised, in double precision when they solve, so that a solver meets the same operator at
/// every step.
pub trait Times<N>: ComplexField + Copy + Mul<Output = Self> + Neg<Output = Self> {
    /// Gives a matrix in this precision to `run`.
    fn with<R>(a: MatRef<'_, N>, run: impl FnOnce(MatRef<'_, Self>) -> R) -> R;
}

macro_rules! numbers {
    ($($single:ty, $double:ty);*) => {$(
        impl Number for $single {
            type Double = $double;

            fn square(self) -> f64 {
                <$double>::from_single(self).abs2()
            }
        }

        impl Times<$single> for $single {
            fn with<R>(a: MatRef<'_, $single>, run: impl FnOnce(MatRef<'_, Self>) -> R) -> R {
                run(a)
            }
        }

        impl Times<$single> for $double {
            fn with<R>(a: MatRef<'_, $single>, run: impl FnOnce(MatRef<'_, Self>) -> R) -> R {
                // Along the lines that are stored one after the other.
                let by_rows = a.col_stride() == 1 && a.row_stride() != 1;
                let a = if by_rows { a.transpose() } else { a };
                let mut wide = Mat::zeros(a.nrows(), a.ncols());
                for (wide, narrow) in wide.as_mut().col_iter_mut().zip(a.col_iter()) {
                    wide.iter_mut().zip(narrow.iter()).for_each(|(x, &y)| *x = Self::from_single(y));
                }
                run(if by_rows { wide.transpose() } else { wide.as_ref() })
            }
        }
    )*};
}

numbers!(f32, f64; Complex32, Complex64);

/// y += factor · A x.
pub(crate) fn add_product<N, X: Times<N>>(a: MatRef<'_, N>, x: MatRef<'_, X>, y: MatMut<'_, X>, factor: X) {
    X::with(a, |a| matmul(y, Accum::Add, a, x, factor, Par::Seq));
}
