//! The stages of a run: each is announced, timed and preceded by a look for a cancellation.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use fredholm_linop::{Observer, Progress, Quiet, Watch};
use fredholm_report::Timing;

use crate::error::Error;
use crate::memory::{Limit, Plan};

/// Whoever watches a run, and whether the run has something to save: until then a cancellation ends
/// it at its next look, and afterwards with what there is.
#[derive(Clone)]
pub(crate) struct Signals<'a> {
    pub(crate) watch: &'a dyn Watch,
    saving: Arc<AtomicBool>,
}

impl Signals<'_> {
    /// Whether the run was cancelled.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.watch.go_on().is_break()
    }

    /// Fails where the run was cancelled and there is nothing to save.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let saving = self.saving.load(Ordering::Relaxed);
        if !saving && self.is_cancelled() { Err(Error::cancelled()) } else { Ok(()) }
    }

    /// From now on there is something to save. Fails where the run was cancelled before.
    pub(crate) fn begin_saving(&self) -> Result<(), Error> {
        if !self.saving.load(Ordering::Relaxed) {
            if self.watch.begin_saving() == ControlFlow::Break(()) {
                return Err(Error::cancelled());
            }
            self.saving.store(true, Ordering::Relaxed);
        }
        Ok(())
    }

    /// Tells the memory that a plan predicts, and refuses what a limit does not allow, before any
    /// of it is taken; `help` says how to need less.
    pub(crate) fn admit(&self, plan: &Plan, limit: Limit, help: &str) -> Result<(), Error> {
        // Programs are told what was predicted of what is refused, too.
        plan.tell(limit, self.watch);
        plan.admit(limit, help)
    }
}

/// A solver that tells nothing of its iterations, but ends where the run is cancelled.
impl<T> Observer<T> for Signals<'_> {
    fn observe(&mut self, _: &Progress<'_, T>) -> ControlFlow<()> {
        self.watch.go_on()
    }

    fn poll(&mut self) -> ControlFlow<()> {
        self.watch.go_on()
    }
}

/// A watch that hears of no stages: those of the parts of one stage are too many to be told.
pub(crate) struct Unstaged<'a>(pub(crate) &'a dyn Watch);

impl Watch for Unstaged<'_> {
    fn warn(&self, text: &str) {
        self.0.warn(text);
    }

    fn memory(&self, predicted: u128, limit: u128) {
        self.0.memory(predicted, limit);
    }

    fn go_on(&self) -> ControlFlow<()> {
        self.0.go_on()
    }
}

/// Runs stages and keeps their times.
pub(crate) struct Stages<'a> {
    pub(crate) watch: &'a dyn Watch,
    signals: Signals<'a>,
    timings: Vec<Timing>,
    /// What stands before the names of stages that are shown.
    prefix: String,
    /// Whether a cancelled run leaves what it has by then.
    partial: bool,
    /// Whether the run was cancelled by a watch that it has no more.
    cancelled: bool,
}

impl<'a> Stages<'a> {
    pub(crate) fn new(watch: &'a dyn Watch) -> Self {
        let signals = Signals { watch, saving: Arc::default() };
        Self { watch, signals, timings: Vec::new(), prefix: String::new(), partial: true, cancelled: false }
    }

    /// The same without its watch, for results that outlive it: nobody is told of anything, and
    /// nobody cancels. What was cancelled stays so.
    pub(crate) fn unwatched(self) -> Stages<'static> {
        let (watch, cancelled): (&'static dyn Watch, _) = (&Quiet, self.is_cancelled());
        let signals = Signals { watch, saving: self.signals.saving };
        let Self { timings, prefix, partial, .. } = self;
        Stages { watch, signals, timings, prefix, partial, cancelled }
    }

    /// Stages of one of several parts, which are of no use without the others: a cancelled run
    /// leaves nothing.
    pub(crate) fn part(&self, name: &str) -> Self {
        Self {
            watch: self.watch,
            signals: self.signals.clone(),
            timings: Vec::new(),
            prefix: format!("{name}, "),
            partial: false,
            cancelled: self.cancelled,
        }
    }

    /// A handle for what runs within a stage.
    pub(crate) fn signals(&self) -> Signals<'a> {
        self.signals.clone()
    }

    /// Whether the run was cancelled.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled || self.signals.is_cancelled()
    }

    /// Fails where the run was cancelled and there is nothing to save.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.signals.check()
    }

    /// From now on there is something to save, where the run leaves partial results. Fails where it
    /// was cancelled before.
    pub(crate) fn begin_saving(&self) -> Result<(), Error> {
        if self.partial { self.signals.begin_saving() } else { self.check() }
    }

    /// Runs one stage.
    pub(crate) fn run<R>(
        &mut self,
        stage: &str,
        work: impl FnOnce() -> Result<R, Error>,
    ) -> Result<R, Error> {
        self.check()?;
        let shown = format!("{}{stage}", self.prefix);
        self.watch.begin(&shown);
        let started = Instant::now();
        let result = work()?;
        let seconds = started.elapsed().as_secs_f64();
        self.watch.end(&shown, seconds);
        self.timings.push(Timing { stage: stage.to_owned(), seconds });
        Ok(result)
    }

    /// Tells the memory that a plan predicts.
    pub(crate) fn tell(&self, plan: &Plan, limit: Limit) {
        plan.tell(limit, self.watch);
    }

    /// See [`Signals::admit`].
    pub(crate) fn admit(&self, plan: &Plan, limit: Limit, help: &str) -> Result<(), Error> {
        self.signals.admit(plan, limit, help)
    }

    /// The stages so far.
    pub(crate) fn timings(&self) -> &[Timing] {
        &self.timings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whoever cancels from the beginning.
    struct Cancelled;

    impl Watch for Cancelled {
        fn go_on(&self) -> ControlFlow<()> {
            ControlFlow::Break(())
        }

        fn begin_saving(&self) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
    }

    #[test]
    fn a_cancelled_run_stays_so_without_its_watch() {
        assert!(Stages::new(&Cancelled).unwatched().is_cancelled());
        let mut stages = Stages::new(&Quiet).unwatched();
        assert!(!stages.is_cancelled() && stages.run("results", || Ok(())).is_ok());
    }

    #[test]
    fn a_cancelled_run_goes_on_only_where_it_has_something_to_save() {
        let mut stages = Stages::new(&Cancelled);
        assert!(stages.run("first", || Ok(())).is_err() && stages.part("part").begin_saving().is_err());
        stages.begin_saving().unwrap();
        assert!(stages.run("second", || Ok(())).is_ok() && stages.part("part").check().is_ok());
        assert_eq!(stages.timings().len(), 1);
    }
}
