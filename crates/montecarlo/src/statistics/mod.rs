//! Means, standard errors and decisions.

mod correction;
mod crosscheck;
mod moments;
mod significance;

pub use correction::Correction;
pub use crosscheck::{Comparison, Crosscheck, Place, crosscheck};
pub use moments::Moments;
pub(crate) use moments::bits;
pub use significance::{Suite, chi_square_p, normal_score, two_sided_p};
