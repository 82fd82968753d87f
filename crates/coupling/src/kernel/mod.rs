//! Point-to-point kernels k(p, q).

mod lambert;

pub use lambert::lambert;
