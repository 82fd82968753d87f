//! What a pair of nodes exchanges: bounds and spreads before it is computed, the open exchange, and
//! what gets through.

mod bent;
mod draw;
mod encounter;
mod exchange;
mod sample;
mod scattered;
mod segments;
mod side;
mod sight;
mod spread;

pub(crate) use bent::Meeting;
pub(crate) use encounter::encounter;
pub(crate) use exchange::exchanges;
pub(crate) use scattered::{Chance, apart};
pub(crate) use side::Side;
pub(crate) use sight::{Sight, View, Viewer};
pub(crate) use spread::spread;
