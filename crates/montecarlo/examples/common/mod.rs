//! What the examples have in common.

use std::fs;
use std::time::Instant;

/// CPU seconds of this thread where the system tells, else seconds.
pub struct Clock {
    started: Instant,
    before: Option<f64>,
}

impl Clock {
    /// Starts now.
    pub fn start() -> Self {
        Self { started: Instant::now(), before: used() }
    }

    /// Seconds since then.
    pub fn seconds(&self) -> f64 {
        let used = self.before.zip(used()).map(|(before, now)| now - before);
        used.unwrap_or_else(|| self.started.elapsed().as_secs_f64())
    }
}

/// The first number of schedstat: nanoseconds on a processor.
fn used() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| nanoseconds * 1e-9)
}
