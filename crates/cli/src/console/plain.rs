//! Progress as lines of text: one at the end of a stage, and one every tenth of it.

use std::sync::{Mutex, PoisonError};

use super::{Console, Tenths};
use crate::output::tell;

/// Lines of text.
#[derive(Debug, Default)]
pub(super) struct Plain {
    current: Mutex<(String, Tenths)>,
}

impl Console for Plain {
    fn begin(&self, stage: &str) {
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = (stage.to_owned(), Tenths::default());
    }

    fn advance(&self, share: f64, note: &dyn Fn() -> String) {
        let mut current = self.current.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(tenth) = current.1.completed(share) {
            tell(format_args!("{}: {} %, {}", current.0, 10 * tenth, note()));
        }
    }

    fn end(&self, stage: &str, seconds: f64) {
        tell(format_args!("{stage}: done in {seconds:.2} s"));
    }

    fn warn(&self, text: &str) {
        tell(format_args!("warning: {text}"));
    }
}
