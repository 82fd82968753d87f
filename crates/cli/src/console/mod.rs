//! How a run shows what it is doing, on standard error.

mod bar;
pub(crate) mod json;
mod plain;
mod quiet;

use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use fredholm_study::Bytes;

use crate::args::{LogArgs, LogFormat};

/// Follows the stages of a run; can be told of progress from any thread.
pub(crate) trait Console: Send + Sync {
    /// A stage begins.
    fn begin(&self, stage: &str);

    /// The stage has come to `share`, 0 to 1, of its way; `note` says more.
    fn advance(&self, share: f64, note: &dyn Fn() -> String);

    /// The stage has ended.
    fn end(&self, stage: &str, seconds: f64);

    /// Something the user should know.
    fn warn(&self, text: &str);

    /// So many bytes will be held of those that are allowed; `check` tells people, the others only
    /// programs.
    fn memory(&self, _predicted: u128, _limit: u128) {}

    /// So much memory was held at most, which records tell people.
    fn held(&self, _peak: Bytes) {}
}

/// The console that was asked for: bars on a terminal, lines elsewhere.
pub(crate) fn choose(log: LogArgs) -> Box<dyn Console> {
    match log.log {
        _ if log.quiet => Box::new(quiet::Quiet),
        LogFormat::Json => Box::<json::Json>::default(),
        LogFormat::Plain if stderr().is_terminal() => Box::<bar::Bar>::default(),
        LogFormat::Plain => Box::<plain::Plain>::default(),
    }
}

/// Time between two lines of a stage.
const LINE_INTERVAL: Duration = Duration::from_millis(500);

/// Decides which progress is worth a line: full tenths, ten at most, and not in a hurry.
#[derive(Debug)]
struct Tenths {
    told: u32,
    last: Instant,
}

impl Default for Tenths {
    fn default() -> Self {
        Self { told: 0, last: Instant::now() }
    }
}

impl Tenths {
    /// The tenth that `share` completes, where it is a new one; the end of the stage has its own
    /// line.
    fn completed(&mut self, share: f64) -> Option<u32> {
        if self.last.elapsed() < LINE_INTERVAL {
            return None;
        }
        let tenth = (share * 10.0).clamp(0.0, 9.0) as u32;
        let new = tenth > self.told;
        if new {
            (self.told, self.last) = (tenth, Instant::now());
        }
        new.then_some(tenth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tenth_is_told_once() {
        let long_ago = Instant::now().checked_sub(LINE_INTERVAL).unwrap();
        let mut tenths = Tenths::default();
        let told: Vec<_> = [0.0, 0.05, 0.11, 0.12, 0.35, 0.3, 0.99, 1.0, 2.0, f64::NAN]
            .into_iter()
            .filter_map(|share| {
                tenths.last = long_ago;
                tenths.completed(share)
            })
            .collect();
        assert_eq!(told, [1, 3, 9]);
    }
    #[test]
    fn a_stage_that_hurries_is_not_told_of() {
        let mut tenths = Tenths::default();
        assert_eq!(tenths.completed(0.5), None);
    }
}
