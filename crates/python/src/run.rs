//! A study on threads of its own, while the thread that asked for it looks after signals and
//! progress.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use fredholm_study::{Error, Watch, thread_pool};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::failure::{failure, internal, interrupted};
use crate::locks::locked;

/// Time between two looks for signals and progress.
const LOOK_INTERVAL: Duration = Duration::from_millis(40);
/// Time from Ctrl-C to the end where there is nothing to save: the run is then left to end by
/// itself at its next look.
const GRACE_PERIOD: Duration = Duration::from_millis(700);
/// Time between two notes of progress.
const NOTE_INTERVAL: Duration = Duration::from_millis(100);

/// How a run is carried out.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct How {
    /// Threads; one a core.
    threads: Option<u16>,
    /// What is called with (event, stage, share, text); none: nobody is told.
    progress: Option<Py<PyAny>>,
}

/// What a run has come to when it is cancelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// Nothing that is worth keeping.
    #[default]
    Preparing,
    /// A result, or a part of one: it is waited for.
    Saving,
    /// Nobody waits for it any more.
    Left,
}

/// Something that Python is told.
enum Event {
    Begin(String),
    Advance(f64, String),
    End(String, f64),
    Warn(String),
}

/// Between the threads of a run and the one that waits.
#[derive(Default)]
struct Relay {
    cancelled: AtomicBool,
    phase: Mutex<Phase>,
    events: Mutex<Vec<Event>>,
    noted: Mutex<Option<Instant>>,
}

impl Relay {
    fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Leaves a run that has nothing to save. Whether it had nothing.
    fn leave(&self) -> bool {
        let mut phase = locked(&self.phase);
        let left = *phase == Phase::Preparing;
        if left {
            *phase = Phase::Left;
        }
        left
    }

    fn tell(&self, event: Event) {
        locked(&self.events).push(event);
    }

    /// Whether a note of progress is due.
    fn is_due(&self) -> bool {
        let Ok(mut noted) = self.noted.try_lock() else { return false };
        let due = noted.is_none_or(|last| last.elapsed() >= NOTE_INTERVAL);
        if due {
            *noted = Some(Instant::now());
        }
        due
    }
}

impl Watch for Relay {
    fn begin(&self, stage: &str) {
        self.tell(Event::Begin(stage.to_owned()));
    }

    fn advance(&self, share: f64, note: &dyn Fn() -> String) {
        if self.is_due() {
            self.tell(Event::Advance(share, note()));
        }
    }

    fn end(&self, stage: &str, seconds: f64) {
        self.tell(Event::End(stage.to_owned(), seconds));
    }

    fn warn(&self, text: &str) {
        self.tell(Event::Warn(text.to_owned()));
    }

    fn go_on(&self) -> ControlFlow<()> {
        if self.cancelled.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn begin_saving(&self) -> ControlFlow<()> {
        let mut phase = locked(&self.phase);
        if *phase == Phase::Preparing && self.go_on().is_break() || *phase == Phase::Left {
            return ControlFlow::Break(());
        }
        *phase = Phase::Saving;
        ControlFlow::Continue(())
    }
}

/// Runs `work` on threads of its own and hands its result to Python with `wrap`. Ctrl-C cancels it:
/// the exception then has what there is.
pub(crate) fn run<R: Send + 'static>(
    py: Python<'_>,
    how: How,
    work: impl FnOnce(&dyn Watch) -> Result<R, Error> + Send + 'static,
    wrap: impl FnOnce(R) -> PyResult<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let relay = Arc::new(Relay::default());
    let (sender, receiver) = channel();
    let (watch, threads) = (Arc::clone(&relay), how.threads);
    let worker = move || {
        let result = thread_pool(threads).and_then(|pool| pool.install(|| work(&*watch)));
        // Nobody may wait any more.
        let _ = sender.send(result);
    };
    thread::Builder::new().name("fredholm".to_owned()).spawn(worker).map_err(internal)?;
    let mut wait = Wait {
        relay: &relay,
        receiver: Mutex::new(receiver),
        progress: how.progress,
        stopped: None,
        again: false,
    };
    match (wait.outcome(py)?, wait.stopped) {
        (Some(Ok(result)), None) => wrap(result),
        (Some(Err(error)), None) => Err(failure(py, &error)),
        (result, Some((_, stop))) if stop.is_instance_of::<PyKeyboardInterrupt>(py) => {
            let partial = result.and_then(Result::ok).map(wrap).transpose()?;
            Err(interrupted(py, partial))
        }
        (_, Some((_, stop))) => Err(stop),
        (None, None) => Err(internal("the run ended without a result")),
    }
}

/// The thread that waits for a run.
struct Wait<'a, R> {
    relay: &'a Relay,
    receiver: Mutex<Receiver<R>>,
    progress: Option<Py<PyAny>>,
    /// When the run was cancelled, and by what.
    stopped: Option<(Instant, PyErr)>,
    /// Whether Ctrl-C was pressed again: nothing is waited for then.
    again: bool,
}

impl<R: Send> Wait<'_, R> {
    /// The result, or none of a run that was left.
    fn outcome(&mut self, py: Python<'_>) -> PyResult<Option<R>> {
        loop {
            let received = py.detach(|| locked(&self.receiver).recv_timeout(LOOK_INTERVAL));
            self.look(py);
            match received {
                Ok(result) => return Ok(Some(result)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(internal("the run broke off: this is a fault of fredholm, please report it"));
                }
            }
            if self.again {
                return Ok(None);
            }
            let waited = self.stopped.as_ref().is_some_and(|(since, _)| since.elapsed() >= GRACE_PERIOD);
            if waited && self.relay.leave() {
                return Ok(None);
            }
        }
    }

    /// Looks for signals, and tells of progress.
    fn look(&mut self, py: Python<'_>) {
        let events = std::mem::take(&mut *locked(&self.relay.events));
        let told = events.into_iter().try_for_each(|event| self.tell(py, event));
        match (told.and_then(|()| py.check_signals()), &self.stopped) {
            (Err(stop), None) => {
                self.relay.cancel();
                self.stopped = Some((Instant::now(), stop));
            }
            (Err(stop), Some(_)) => self.again = stop.is_instance_of::<PyKeyboardInterrupt>(py),
            (Ok(()), _) => {}
        }
    }

    fn tell(&self, py: Python<'_>, event: Event) -> PyResult<()> {
        let Some(progress) = &self.progress else { return Ok(()) };
        let (kind, stage, share, text) = match event {
            Event::Begin(stage) => ("begin", stage, 0.0, String::new()),
            Event::Advance(share, text) => ("advance", String::new(), share, text),
            Event::End(stage, seconds) => ("end", stage, seconds, String::new()),
            Event::Warn(text) => ("warn", String::new(), 0.0, text),
        };
        progress.call1(py, (kind, stage, share, text)).map(drop)
    }
}
