//! The threads of a run. Their number changes the time, not a bit of the results.

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure::{Ending, Failure};

/// Threads where none are asked for: one a core.
pub(crate) fn default_count() -> usize {
    std::thread::available_parallelism().map_or(1, Into::into)
}

/// A pool of `count` threads.
pub(crate) fn pool(count: usize) -> Result<ThreadPool, Failure> {
    let built = ThreadPoolBuilder::new().num_threads(count).build();
    built.map_err(|e| {
        Failure::new(Ending::Resources, format!("cannot start {count} threads: {e}; ask for fewer"))
    })
}
