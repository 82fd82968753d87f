//! The threads of a run. Their number changes the time, not a bit of the results.

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure::{Ending, Failure};
use crate::memory;

/// Threads of this machine: one a core.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, Into::into)
}

/// Threads of a run: as many as are asked for, or else one a core, but no more than a limited address space has room for.
pub(crate) fn count(asked: Option<u16>) -> usize {
    asked.map_or_else(cores, usize::from).min(memory::allowance())
}

/// A pool of as many threads.
pub(crate) fn pool(asked: Option<u16>) -> Result<ThreadPool, Failure> {
    memory::room_to_begin()?;
    let count = count(asked);
    let built = ThreadPoolBuilder::new().num_threads(count).build();
    built.map_err(|e| {
        Failure::new(Ending::Resources, format!("cannot start {count} threads: {e}; ask for fewer"))
    })
}
