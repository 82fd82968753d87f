//! What a solver or an assembly tells whoever watches a run.

use std::ops::ControlFlow;

use fredholm_linop::{Observer, Progress, Stop, Watch};

use crate::options::SolveSettings;
use crate::stages::Stages;

/// Watches an assembly or a solution.
#[derive(Clone, Copy)]
pub(crate) struct Watcher<'a> {
    pub(crate) watch: &'a dyn Watch,
    stop: Stop,
}

impl<'a> Watcher<'a> {
    pub(crate) fn new(stages: &Stages<'a>, options: &SolveSettings) -> Self {
        let max_iterations = usize::try_from(options.max_iterations).unwrap_or(usize::MAX);
        Self::to(stages, Stop { tolerance: options.tolerance, max_iterations })
    }

    /// Watches what ends by itself at `stop`.
    pub(crate) fn to(stages: &Stages<'a>, stop: Stop) -> Self {
        Self { watch: stages.watch, stop }
    }

    /// The same with another end.
    pub(crate) fn until(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// When the solution ends by itself.
    pub(crate) fn stop(&self) -> Stop {
        self.stop
    }

    /// Whether the computation is still wanted.
    pub(crate) fn go_on(&self) -> ControlFlow<()> {
        self.watch.go_on()
    }
}

impl<T> Observer<T> for Watcher<'_> {
    fn observe(&mut self, progress: &Progress<'_, T>) -> ControlFlow<()> {
        let record = progress.record;
        let residual = record.residuals.iter().copied().fold(0.0, f64::max);
        // The digits gained of those asked for.
        let share = (residual.ln() / self.stop.tolerance.ln()).clamp(0.0, 1.0);
        self.watch.advance(share, &|| format!("iteration {}, residual {residual:.1e}", record.iteration));
        self.go_on()
    }

    fn poll(&mut self) -> ControlFlow<()> {
        self.go_on()
    }
}
