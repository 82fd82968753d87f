//! The threads of a run. Their number changes the time, not a bit of the results.

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Error, ErrorKind};
use crate::memory;

/// Threads of this machine: one a core.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, Into::into)
}

/// Threads of a run: as many as are asked for, or else one a core, but no more than a limited
/// address space has room for.
pub(crate) fn count(asked: Option<u16>) -> usize {
    asked.map_or_else(cores, usize::from).min(memory::allowance())
}

/// A pool of so many threads, or else of one a core, to run a study on: `pool.install(|| …)`. A
/// limited address space has room for fewer.
///
/// # Errors
/// [`ErrorKind::Resources`] where the threads cannot be started.
pub fn thread_pool(asked: Option<u16>) -> Result<ThreadPool, Error> {
    memory::room_to_begin()?;
    let count = count(asked);
    let built = ThreadPoolBuilder::new().num_threads(count).build();
    built.map_err(|error| {
        let text = format!("cannot start {count} threads: {error}; ask for fewer");
        Error::new(ErrorKind::Resources, text)
    })
}
