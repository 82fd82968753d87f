//! Links: exchanges between two nodes of any levels, and what is known of their errors.
//!
//! A link stands for all pairs of leaves of its two nodes. The form factor is not the same all over
//! a node: to first order it is 1 + g·(x − c) times its mean, with a gradient g for each side. What
//! that leaves, and all of the variation where a node is not divided, are errors: relative to the
//! open exchange, the *deviation* of a side is the standard deviation of the form factor over it,
//! the *rest* that from the linear function, and the *doubt* the uncertainty of the share that gets
//! through.

use glam::Vec3;

/// An exchange between two flat nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// One node.
    pub a: u32,
    /// The other one, of a higher number.
    pub b: u32,
    /// Exchange A_a F_ab if nothing stood between, m².
    pub open: f64,
    /// Share of it that gets through.
    pub share: f32,
    /// Doubt.
    pub doubt: f32,
    /// Deviation over a and over b.
    pub deviation: [f32; 2],
    /// Rest over a and over b.
    pub rest: [f32; 2],
    /// Gradients over a and over b, 1/m; 0 for links of constants.
    pub gradient: [Vec3; 2],
    /// Whether anything may stand between.
    pub partly: bool,
}

impl Link {
    /// Bytes of a link and of its two ends in the operator.
    pub const BYTES: u64 = size_of::<Self>() as u64 + crate::HierarchicalOperator::BYTES_OF_LINK;

    /// Exchange A_a F_ab with what stands between, m².
    #[must_use]
    pub fn exchange(&self) -> f64 {
        self.open * f64::from(self.share)
    }
}
