//! What a pair of nodes exchanges: bounds and spreads before it is computed, the open exchange, and what gets through.

mod bent;
mod exchange;
mod side;
mod sight;
mod spread;

pub(crate) use bent::{End, Meeting, bound, meet, touch};
pub(crate) use exchange::exchanges;
pub(crate) use side::Side;
pub(crate) use sight::{Sight, View, Viewer};
pub(crate) use spread::{NEAR, spread};
