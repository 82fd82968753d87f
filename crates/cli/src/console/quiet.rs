//! No progress at all.

use super::Console;

/// Shows nothing.
#[derive(Debug)]
pub(super) struct Quiet;

impl Console for Quiet {
    fn begin(&self, _: &str) {}

    fn advance(&self, _: f64, _: &dyn Fn() -> String) {}

    fn end(&self, _: &str, _: f64) {}

    fn warn(&self, _: &str) {}
}
