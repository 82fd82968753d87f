//! Progress as JSON: an object a line, with `event` and `time`, seconds since the start.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use serde_json::{Value, json};

use super::{Console, Tenths};

/// Lines of JSON.
#[derive(Debug)]
pub(super) struct Json {
    started: Instant,
    current: Mutex<(String, Tenths)>,
}

impl Default for Json {
    fn default() -> Self {
        Self { started: Instant::now(), current: Mutex::default() }
    }
}

impl Json {
    fn line(&self, mut object: Value) {
        object["time"] = json!(self.started.elapsed().as_secs_f64());
        eprintln!("{object}");
    }
}

impl Console for Json {
    fn begin(&self, stage: &str) {
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = (stage.to_owned(), Tenths::default());
        self.line(json!({ "event": "begin", "stage": stage }));
    }

    fn advance(&self, share: f64, note: &dyn Fn() -> String) {
        let mut current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        if current.1.completed(share).is_some() {
            self.line(json!({ "event": "progress", "stage": current.0, "share": share, "note": note() }));
        }
    }

    fn end(&self, stage: &str, seconds: f64) {
        self.line(json!({ "event": "end", "stage": stage, "seconds": seconds }));
    }

    fn warn(&self, text: &str) {
        self.line(json!({ "event": "warning", "message": text }));
    }
}
