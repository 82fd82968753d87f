//! Progress as a bar on a terminal.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

use super::Console;
use crate::output::tell;

/// Steps of the bar.
const STEPS: u64 = 1000;
/// Time between two frames.
const FRAME_INTERVAL: Duration = Duration::from_millis(100);

/// A clock for the current stage, a bar once it tells of progress; a line stays for each that has
/// ended.
#[derive(Debug, Default)]
pub(super) struct Bar {
    current: Mutex<Option<ProgressBar>>,
}

impl Bar {
    fn with(&self, act: impl FnOnce(&ProgressBar)) {
        if let Some(bar) = self.current.lock().unwrap_or_else(PoisonError::into_inner).as_ref() {
            act(bar);
        }
    }
}

impl Console for Bar {
    fn begin(&self, stage: &str) {
        let bar = ProgressBar::new(STEPS)
            .with_style(style("{prefix:>16}  {elapsed}"))
            .with_prefix(stage.to_owned());
        let bar = bar.with_finish(ProgressFinish::AndClear);
        bar.enable_steady_tick(FRAME_INTERVAL);
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar);
    }

    fn advance(&self, share: f64, note: &dyn Fn() -> String) {
        self.with(|bar| {
            let step = (share * STEPS as f64) as u64;
            if step > bar.position() {
                bar.set_style(style("{prefix:>16}  [{bar:24}] {percent:>3} %  {elapsed}  {wide_msg}"));
                bar.set_position(step);
                bar.set_message(note());
            }
        });
    }

    fn end(&self, stage: &str, seconds: f64) {
        self.with(ProgressBar::finish_and_clear);
        tell(format_args!("{stage:>16}  {seconds:8.2} s"));
    }

    fn warn(&self, text: &str) {
        let print = || tell(format_args!("warning: {text}"));
        match self.current.lock().unwrap_or_else(PoisonError::into_inner).as_ref() {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}
