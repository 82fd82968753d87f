//! Links: exchanges between two nodes of any levels, and what is known of their errors.
//!
//! A link stands for all pairs of leaves of its two nodes. Its errors are what the nodes lose by one value each, relative to the open exchange: the *spread* of a side is the standard
//! deviation over that side of the point form factor, with what stands between; the *doubt* is the uncertainty of the share that gets through.

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
    /// Spread over a and over b.
    pub spread: [f32; 2],
    /// Doubt.
    pub doubt: f32,
    /// Whether anything may stand between.
    pub partly: bool,
}

impl Link {
    /// Bytes of a link with both of its entries in the operator.
    pub const BYTES: u64 = (size_of::<Self>() + 2 * (size_of::<u32>() + size_of::<f64>())) as u64;

    /// Exchange A_a F_ab with what stands between, m².
    #[must_use]
    pub fn exchange(&self) -> f64 {
        self.open * f64::from(self.share)
    }
}
