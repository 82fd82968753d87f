//! The terminal as whoever watches a run: the console is told of progress, a signal cancels.

use std::ops::ControlFlow;
use std::sync::Arc;

use fredholm_study::{Error, Watch};

use crate::args::LogArgs;
use crate::console::{self, Console};
use crate::interrupt::Interrupt;

/// A console and the signals.
pub(crate) struct Terminal {
    pub(crate) console: Box<dyn Console>,
    pub(crate) interrupt: Arc<Interrupt>,
}

impl Terminal {
    /// Listens to the signals from now on.
    pub(crate) fn new(log: LogArgs) -> Result<Self, Error> {
        let interrupt = Interrupt::install(log)?;
        Ok(Self { console: console::choose(log), interrupt })
    }
}

impl Watch for Terminal {
    fn begin(&self, stage: &str) {
        self.console.begin(stage);
    }

    fn advance(&self, share: f64, note: &dyn Fn() -> String) {
        self.console.advance(share, note);
    }

    fn end(&self, stage: &str, seconds: f64) {
        self.console.end(stage, seconds);
    }

    fn warn(&self, text: &str) {
        self.console.warn(text);
    }

    fn memory(&self, predicted: u128, limit: u128) {
        self.console.memory(predicted, limit);
    }

    fn go_on(&self) -> ControlFlow<()> {
        if self.interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn begin_saving(&self) -> ControlFlow<()> {
        self.interrupt.begin_saving()
    }
}
