//! How much memory a run may take, how much it will take, and how much it took.

mod groups;
mod limit;
mod machine;
mod plan;

use std::fs;

pub use limit::{Limit, addresses_are_limited, less_than_asked};
pub(crate) use limit::{allowance, limit, room_to_begin};
pub use plan::Plan;

use crate::size::Bytes;

/// Largest memory this process has held so far, where the system tells.
#[must_use]
pub fn peak() -> Option<Bytes> {
    machine::field(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

/// The same as a record has it.
pub(crate) fn peak_bytes() -> Option<u64> {
    peak().and_then(|Bytes(peak)| u64::try_from(peak).ok())
}
