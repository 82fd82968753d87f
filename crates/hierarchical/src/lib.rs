//! Hierarchical radiosity: B = M + R F B on elements that are as small as the accuracy asked for
//! needs, with links between elements of any size.
//!
//! Input elements are grouped to clusters above and split into quarters below ([`Tree`]). A
//! [`Link`] stands for all pairs of leaves of two nodes; an oracle splits those that leave too
//! large an error, and the [`HierarchicalOperator`] of all links is solved like any other.
//! [`solve`] goes on until the irradiance of the faces has the accuracy asked for, and states an
//! estimate of its error.
//!
//! Source: P. Hanrahan, D. Salzman, L. Aupperle, *A rapid hierarchical radiosity algorithm*,
//! SIGGRAPH 1991, doi:10.1145/122718.122740. Units: metres, W/m².

mod checkpoint;
mod closure;
mod driver;
mod error;
mod exposure;
mod gather;
mod goal;
mod light;
mod link;
mod opening;
mod operator;
mod oracle;
mod refine;
mod senders;
mod shadow_edges;
mod state;
mod transport;
mod tree;

pub use driver::{
    Options, Problem, RESIDUAL_OVER_ACCURACY, Round, RoundWatch, Solution, Solvers, Stated, conclude,
    expected_bytes, solve,
};
pub use error::HierarchyError;
pub use gather::{Gather, Gatherer, Lamps, Leaves, Lighter};
pub use goal::{Goal, Reached};
pub use light::Surfaces;
pub use link::Link;
pub use operator::HierarchicalOperator;
pub use senders::{Sender, senders};
pub use shadow_edges::shadow_edges;
pub use state::State;
pub use tree::{Node, Tree};
