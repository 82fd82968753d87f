//! The stages of a run: each is announced, timed and preceded by a look for Ctrl-C.

use std::time::Instant;

use fredholm_report::Timing;

use crate::console::Console;
use crate::failure::Failure;
use crate::interrupt::Interrupt;

/// Runs stages and keeps their times.
pub(crate) struct Stages<'a> {
    pub(crate) console: &'a dyn Console,
    pub(crate) interrupt: &'a Interrupt,
    timings: Vec<Timing>,
}

impl<'a> Stages<'a> {
    pub(crate) fn new(console: &'a dyn Console, interrupt: &'a Interrupt) -> Self {
        Self { console, interrupt, timings: Vec::new() }
    }

    /// Runs one stage.
    pub(crate) fn run<R>(
        &mut self,
        stage: &str,
        work: impl FnOnce() -> Result<R, Failure>,
    ) -> Result<R, Failure> {
        self.interrupt.check()?;
        self.console.begin(stage);
        let started = Instant::now();
        let result = work()?;
        let seconds = started.elapsed().as_secs_f64();
        self.console.end(stage, seconds);
        self.timings.push(Timing { stage: stage.to_owned(), seconds });
        Ok(result)
    }

    /// The stages so far.
    pub(crate) fn timings(&self) -> &[Timing] {
        &self.timings
    }
}
