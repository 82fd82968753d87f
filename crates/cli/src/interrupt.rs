//! Ctrl-C and the termination signal.
//!
//! The first signal asks the run to stop at its next look; the second ends the process at once. Where a run cannot look
//! up in time, a watchman ends the process, unless there is an iterate or a result worth the wait.

use std::io::{self, IsTerminal};
use std::ops::ControlFlow;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use fredholm_study::{Error, ErrorKind};

use crate::args::LogFormat;
use crate::ending::{Ending, present};
use crate::output::tell;

/// Time from the signal to the end where nothing can be saved.
const PATIENCE: Duration = Duration::from_millis(800);

/// What would be lost if the process ended now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Nothing that could be written.
    Preparing,
    /// An iterate, or results half written: the run ends by itself.
    Saving,
}

/// Whether the user asked to stop.
#[derive(Debug)]
pub(crate) struct Interrupt {
    requested: AtomicBool,
    phase: Mutex<Phase>,
    log: LogFormat,
}

impl Interrupt {
    /// Listens to the signals from now on.
    pub(crate) fn install(log: LogFormat) -> Result<Arc<Self>, Error> {
        let interrupt =
            Arc::new(Self { requested: AtomicBool::new(false), phase: Mutex::new(Phase::Preparing), log });
        let listener = Arc::clone(&interrupt);
        ctrlc::set_handler(move || listener.signal()).map_err(|e| Error::new(ErrorKind::Resources, e))?;
        Ok(interrupt)
    }

    /// Whether a signal has come.
    pub(crate) fn requested(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
    }

    /// From now on there is something to save. Breaks where a signal has come before.
    pub(crate) fn begin_saving(&self) -> ControlFlow<()> {
        if self.requested() && *self.phase() == Phase::Preparing {
            return ControlFlow::Break(());
        }
        *self.phase() = Phase::Saving;
        ControlFlow::Continue(())
    }

    fn phase(&self) -> MutexGuard<'_, Phase> {
        self.phase.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn signal(self: &Arc<Self>) {
        if self.requested.swap(true, Ordering::Relaxed) {
            process::exit(i32::from(Ending::Interrupted.code()));
        }
        let watchman = Arc::clone(self);
        thread::spawn(move || watchman.wait());
    }

    /// Ends the process after a while; the lock keeps the run from beginning to write meanwhile.
    fn wait(&self) {
        thread::sleep(PATIENCE);
        let phase = self.phase();
        if *phase == Phase::Preparing {
            if self.log == LogFormat::Plain && io::stderr().is_terminal() {
                // Below the progress bar.
                tell("");
            }
            present(&Error::cancelled(), self.log);
            process::exit(i32::from(Ending::Interrupted.code()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_after_the_signal_is_not_saved() {
        for (signalled, saving) in [(false, false), (true, false), (false, true), (true, true)] {
            let phase = if saving { Phase::Saving } else { Phase::Preparing };
            let (requested, phase) = (AtomicBool::new(signalled), Mutex::new(phase));
            let interrupt = Interrupt { requested, phase, log: LogFormat::Plain };
            let refused = interrupt.begin_saving().is_break();
            assert_eq!(refused, signalled && !saving);
            assert_eq!(*interrupt.phase() == Phase::Saving, !refused);
        }
    }
}
