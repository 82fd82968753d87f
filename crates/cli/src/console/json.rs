//! Progress and errors as JSON: an object a line, with `event` and `time`, seconds since the first
//! line.

use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Instant;

use fredholm_study::Bytes;
use serde_json::{Value, json};

use super::{Console, Tenths};
use crate::output::tell;

/// Time of the first line.
static STARTED: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Lines of JSON.
#[derive(Debug, Default)]
pub(super) struct Json {
    current: Mutex<(String, Tenths)>,
}

/// Writes an object and its time as a line.
pub(crate) fn line(mut object: Value) {
    object["time"] = json!(STARTED.elapsed().as_secs_f64());
    tell(object);
}

impl Console for Json {
    fn begin(&self, stage: &str) {
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = (stage.to_owned(), Tenths::default());
        line(json!({ "event": "begin", "stage": stage }));
    }

    fn advance(&self, share: f64, note: &dyn Fn() -> String) {
        let mut current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        if current.1.completed(share).is_some() {
            line(json!({ "event": "progress", "stage": current.0, "share": share, "note": note() }));
        }
    }

    fn end(&self, stage: &str, seconds: f64) {
        line(json!({ "event": "end", "stage": stage, "seconds": seconds }));
    }

    fn memory(&self, predicted: u128, limit: u128) {
        let (predicted, limit) = (Bytes(predicted).as_u64(), Bytes(limit).as_u64());
        line(json!({ "event": "memory", "predicted_bytes": predicted, "limit_bytes": limit }));
    }

    fn held(&self, peak: Bytes) {
        line(json!({ "event": "memory", "peak_bytes": peak.as_u64() }));
    }

    fn warn(&self, text: &str) {
        line(json!({ "event": "warning", "message": text }));
    }
}
