//! Trials of a part of a run, from which the time of the whole is told: what they took, by stages,
//! in seconds of one thread that has a core to itself.

use std::fs;
use std::ops::ControlFlow;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use fredholm_linop::Watch;

use crate::threads::thread_pool;

/// Seconds that this thread has worked, where the system tells, else that have passed.
pub(crate) fn spent() -> f64 {
    static STARTED: OnceLock<Instant> = OnceLock::new();
    // Nanoseconds on a processor, waiting for one, and turns.
    let text = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let worked = text.split_ascii_whitespace().next().and_then(|first| first.parse::<f64>().ok());
    let passed = STARTED.get_or_init(Instant::now).elapsed().as_secs_f64();
    worked.filter(|&nanoseconds| nanoseconds > 0.0).map_or(passed, |nanoseconds| 1e-9 * nanoseconds)
}

/// Does some work on one thread, whose time tells that of all of it; none where no thread can be
/// started.
pub(crate) fn alone<R: Send>(work: impl FnOnce() -> R + Send) -> Option<R> {
    if rayon::current_num_threads() == 1 {
        // A thread of the pool is asked, which the caller may not be.
        return Some(rayon::scope(|_| work()));
    }
    Some(thread_pool(Some(1)).ok()?.install(work))
}

/// Where a trial on one thread stands.
#[derive(Clone, Debug, Default)]
pub(crate) struct Readings {
    /// The stages that have ended, and their seconds.
    pub(crate) stages: Vec<(String, f64)>,
    /// Seconds since the start of the trial, and the share of its way that a stage had come to.
    pub(crate) shares: Vec<[f64; 2]>,
    begun: f64,
}

/// Measures a trial, and ends it where it takes more than so many seconds.
pub(crate) struct Meter<'a> {
    /// Whoever waits for the forecast.
    watch: &'a dyn Watch,
    started: (Instant, f64),
    most: f64,
    readings: Mutex<Readings>,
}

impl<'a> Meter<'a> {
    /// For a trial that begins now, on this thread.
    pub(crate) fn new(watch: &'a dyn Watch, most: f64) -> Self {
        let readings = Mutex::new(Readings { begun: spent(), ..Readings::default() });
        Self { watch, started: (Instant::now(), spent()), most, readings }
    }

    /// Seconds of the trial so far.
    pub(crate) fn seconds(&self) -> f64 {
        spent() - self.started.1
    }

    /// What was measured.
    pub(crate) fn readings(self) -> Readings {
        self.readings.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn note(&self, note: impl FnOnce(&mut Readings)) {
        note(&mut self.readings.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Watch for Meter<'_> {
    fn begin(&self, _stage: &str) {
        self.note(|readings| readings.begun = spent());
    }

    fn advance(&self, share: f64, _note: &dyn Fn() -> String) {
        let seconds = self.seconds();
        self.note(|readings| readings.shares.push([seconds, share]));
    }

    fn end(&self, stage: &str, _seconds: f64) {
        self.note(|readings| readings.stages.push((stage.to_owned(), spent() - readings.begun)));
    }

    fn go_on(&self) -> ControlFlow<()> {
        // The system is asked for the time of the thread where that may be too long only.
        let over =
            self.started.0.elapsed() > Duration::from_secs_f64(self.most) && self.seconds() > self.most;
        if over { ControlFlow::Break(()) } else { self.watch.go_on() }
    }
}
