//! How much memory a run may take, how much it will take, and how much it took.

mod groups;
mod heap;
mod limit;
mod machine;
mod plan;

use std::fs;

pub(crate) use heap::share as share_one_heap;
pub(crate) use limit::{Limit, allowance, limit, room_to_begin, tell};
pub(crate) use plan::Plan;

use crate::console::Console;
use crate::size::Bytes;

/// Largest memory this process has held so far, where the system tells.
pub(crate) fn peak() -> Option<Bytes> {
    machine::field(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

/// Says at the end of a run what it has held.
pub(crate) fn conclude(console: &dyn Console) {
    if let Some(peak) = peak() {
        console.held(peak);
    }
}

/// The same as a record has it.
pub(crate) fn peak_bytes() -> Option<u64> {
    peak().and_then(|Bytes(peak)| u64::try_from(peak).ok())
}
