//! Several bounces: the current x = b + K x with the dyadic kernel between facets.
//!
//! Unknowns are the tangential parts of the current, 2i along t₁ and 2i + 1 along t₂ of facet i.
//! With the integral G = −∫_q (jk + 1/R) g u dA over the source facet, H of a constant tangent t is
//! G × t, so that the blocks are
//!
//! ```text
//! J form, x = J = 2 n × H:  K_ab = +2 s [(t_a·G) (n_p·t_b) − (t_a·t_b) (n_p·G)]
//! M form, x = M = 2 n × E:  K_ab = −2 s [ the same ]                             (E of M is −H of J = M)
//! ```
//!
//! with the sides s(p, q) of the treatment of shadows ([`Shadow`]):
//!
//! | treatment | source behind its facet | observer turned away | blocked |
//! |---|---|---|---|
//! | geometric | closed 0, sheet 1 | closed 0, sheet −1 | 0 |
//! | radiated | 1 | closed 0, sheet −1 | 1 |
//! | exact, exact-dual | 1 | 1 | 1 |
//! | thesis | −1 | closed 0, sheet 1 | 1 |
//!
//! Flat facets do not couple with themselves. J in A/m, M in V/m, lengths in metres.

mod bounces;
mod dense;
mod galerkin;
mod inner;
mod material;
mod nystrom;
mod pair;
mod sides;
mod system;
mod view;

pub use bounces::{Bounces, spectral_radius};
pub use galerkin::galerkin;
pub use material::MaterialCoupling;
pub use nystrom::NystromCoupling;
pub use system::{Bounced, Discretisation, System};

pub(crate) use inner::depth as inner_depth;
pub(crate) use pair::{Block, block};
pub(crate) use sides::Sides;
pub(crate) use view::View;
