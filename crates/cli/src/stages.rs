//! The stages of a run: each is announced, timed and preceded by a look for Ctrl-C.

use std::time::Instant;

use fredholm_report::Timing;

use crate::console::Console;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::memory::{Limit, Plan};

/// Runs stages and keeps their times.
pub(crate) struct Stages<'a> {
    pub(crate) console: &'a dyn Console,
    pub(crate) interrupt: &'a Interrupt,
    timings: Vec<Timing>,
    /// What stands before the names of stages that are shown.
    prefix: String,
    /// Whether an interrupted run leaves what it has by then.
    partial: bool,
}

impl<'a> Stages<'a> {
    pub(crate) fn new(console: &'a dyn Console, interrupt: &'a Interrupt) -> Self {
        Self { console, interrupt, timings: Vec::new(), prefix: String::new(), partial: true }
    }

    /// Stages of one of several parts, which are of no use without the others: an interrupted run leaves nothing.
    pub(crate) fn part(console: &'a dyn Console, interrupt: &'a Interrupt, name: &str) -> Self {
        Self { prefix: format!("{name}, "), partial: false, ..Self::new(console, interrupt) }
    }

    /// From now on there is something to save, where the run leaves partial results. Fails where a signal has come before.
    pub(crate) fn begin_saving(&self) -> Result<(), Failure> {
        if self.partial { self.interrupt.begin_saving() } else { self.interrupt.check() }
    }

    /// Runs one stage.
    pub(crate) fn run<R>(
        &mut self,
        stage: &str,
        work: impl FnOnce() -> Result<R, Failure>,
    ) -> Result<R, Failure> {
        self.interrupt.check()?;
        let shown = format!("{}{stage}", self.prefix);
        self.console.begin(&shown);
        let started = Instant::now();
        let result = work()?;
        let seconds = started.elapsed().as_secs_f64();
        self.console.end(&shown, seconds);
        self.timings.push(Timing { stage: stage.to_owned(), seconds });
        Ok(result)
    }

    /// Refuses what a limit does not allow, before any of it is taken; `help` says how to need less.
    pub(crate) fn admit(&self, plan: &Plan, limit: Limit, help: &str) -> Result<(), Failure> {
        // Programs are told what was predicted of what is refused, too.
        self.console.admit(plan, limit);
        plan.admit(limit, help)
    }

    /// The stages so far.
    pub(crate) fn timings(&self) -> &[Timing] {
        &self.timings
    }
}
