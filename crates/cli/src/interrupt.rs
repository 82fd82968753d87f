//! Ctrl-C, the termination signal, and the limit of time.
//!
//! The first signal asks the run to stop at its next look; the second ends the process at once.
//! Where a run cannot look up in time, a watchman ends the process, unless there is an iterate or a
//! result worth the wait. The limit of time does what a first signal does, with another exit code.

use std::io::{self, IsTerminal};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use fredholm_report::exit;
use fredholm_study::{Error, ErrorKind};

use crate::args::{LogArgs, LogFormat};
use crate::console::Console;
use crate::ending::{Ending, present};
use crate::output::tell;

/// Time from the signal to the end where nothing can be saved.
const GRACE_PERIOD: Duration = Duration::from_millis(800);

/// What would be lost if the process ended now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Nothing that could be written.
    Preparing,
    /// An iterate, or results half written: the run ends by itself.
    Saving,
}

/// Whether the user asked to stop, now or beforehand by a limit of time.
#[derive(Debug)]
pub(crate) struct Interrupt {
    requested: AtomicBool,
    /// Whether it was the limit of time that asked.
    out_of_time: AtomicBool,
    time_limit: Option<Duration>,
    phase: Mutex<Phase>,
    log: LogFormat,
}

impl Interrupt {
    /// Listens to the signals, and counts the time, from now on.
    pub(crate) fn install(log: LogArgs) -> Result<Arc<Self>, Error> {
        let interrupt = Arc::new(Self::new(log));
        let listener = Arc::clone(&interrupt);
        ctrlc::set_handler(move || listener.signal()).map_err(|e| Error::new(ErrorKind::Resources, e))?;
        if let Some(limit) = log.time_limit {
            let clock = Arc::clone(&interrupt);
            thread::spawn(move || clock.count(limit));
        }
        Ok(interrupt)
    }

    fn new(LogArgs { log, time_limit, .. }: LogArgs) -> Self {
        let (requested, out_of_time) = (AtomicBool::new(false), AtomicBool::new(false));
        Self { requested, out_of_time, time_limit, phase: Mutex::new(Phase::Preparing), log }
    }

    /// The end of a run: where the limit of time has interrupted it, that is said, and the run
    /// counts as not converged.
    pub(crate) fn ended(&self, ended: Result<Ending, Error>, console: &dyn Console) -> Result<Ending, Error> {
        match ended {
            Ok(Ending::Interrupted) if self.out_of_time() => {
                console.warn(&format!("{}: the results are those until then", self.time_is_over()));
                Ok(Ending::NotConverged)
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => Err(self.explained(error)),
            ended => ended,
        }
    }

    fn out_of_time(&self) -> bool {
        self.out_of_time.load(Ordering::Relaxed)
    }

    fn time_is_over(&self) -> String {
        let seconds = self.time_limit.unwrap_or_default().as_secs_f64();
        format!("the time limit of {seconds} s has passed")
    }

    /// The error of an interrupted run, with the limit of time where that was the reason.
    fn explained(&self, error: Error) -> Error {
        if !self.out_of_time() {
            return error;
        }
        let text = format!("{}: {error}", self.time_is_over());
        Error::new(ErrorKind::NotConverged, text)
            .with_help("give more time (fredholm check tells about how long a run takes), or ask for less")
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
            exit(i32::from(Ending::Interrupted.code()));
        }
        let watchman = Arc::clone(self);
        thread::spawn(move || watchman.wait());
    }

    /// Interrupts the run after a time, unless a signal has done so before.
    fn count(&self, limit: Duration) {
        thread::sleep(limit);
        if !self.requested() {
            // In this order, so that whoever sees the request sees its reason.
            self.out_of_time.store(true, Ordering::SeqCst);
            self.requested.store(true, Ordering::SeqCst);
            self.wait();
        }
    }

    /// Ends the process after a while; the lock keeps the run from beginning to write meanwhile.
    fn wait(&self) {
        thread::sleep(GRACE_PERIOD);
        let phase = self.phase();
        if *phase == Phase::Preparing {
            if self.log == LogFormat::Plain && io::stderr().is_terminal() {
                // Below the progress bar.
                tell("");
            }
            let error = self.explained(Error::cancelled());
            present(&error, self.log);
            exit(i32::from(Ending::from(error.kind()).code()));
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
            let log = LogArgs { log: LogFormat::Plain, quiet: false, time_limit: None };
            let interrupt = Interrupt {
                requested: AtomicBool::new(signalled),
                phase: Mutex::new(phase),
                ..Interrupt::new(log)
            };
            let refused = interrupt.begin_saving().is_break();
            assert_eq!(refused, signalled && !saving);
            assert_eq!(*interrupt.phase() == Phase::Saving, !refused);
        }
    }
}
