//! What several schemes have in common.

mod blend;
mod blocks;
mod conjugate;
mod diagonal;
mod jacobi_radius;
mod krylov;
mod lanczos;
mod metric;
mod precondition;
mod shooting;
mod small_lu;
mod stationary;
mod sweeping;
mod unsent;

pub(crate) use blend::{Blend, blend};
pub(crate) use blocks::Blocks;
pub(crate) use conjugate::Conjugate;
pub(crate) use diagonal::divisors;
pub(crate) use jacobi_radius::jacobi_radius;
pub(crate) use krylov::{minus, quotients, reals};
pub(crate) use lanczos::lanczos;
pub(crate) use metric::Metric;
pub(crate) use precondition::{Diagonal, Identity, Precondition, Weights};
pub(crate) use shooting::{Shooting, Step};
pub(crate) use small_lu::SmallLu;
pub(crate) use stationary::Stationary;
pub(crate) use sweeping::{Sweeping, relax_by, relax_fully, visit_all};
pub(crate) use unsent::sent_shares;

/// Makes a [`fredholm_linop::Solver`] of a scheme.
macro_rules! solve_by_steps {
    ($scheme:ty) => {
        impl<T: ::fredholm_linop::Scalar> ::fredholm_linop::Solver<T> for $scheme {
            fn name(&self) -> &'static str {
                ::fredholm_linop::Scheme::<T>::name(self)
            }

            fn description(&self) -> &'static str {
                ::fredholm_linop::Scheme::<T>::description(self)
            }

            fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
                ::fredholm_linop::Scheme::<T>::bytes(self, dim, rhs_count)
            }

            fn solve(
                &self,
                a: &::fredholm_linop::SecondKind<'_, T>,
                b: &::fredholm_linop::MultiVector<T>,
                x: &mut ::fredholm_linop::MultiVector<T>,
                stop: &::fredholm_linop::Stop,
                observer: &mut dyn ::fredholm_linop::Observer<T>,
            ) -> Result<::fredholm_linop::Report, ::fredholm_linop::SolveError> {
                ::fredholm_linop::solve_by_steps(self, a, b, x, stop, observer)
            }
        }
    };
}
pub(crate) use solve_by_steps;
