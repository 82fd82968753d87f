//! The one protocol between a long computation and whoever waits for it: progress one way,
//! cancellation the other.
//!
//! Every method has a default that does nothing, so that a caller implements what it wants to know.
//! All of them may be called from any thread.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::Quiet;

/// Is told of the progress of a computation, and says whether it is still wanted.
pub trait Watch: Sync {
    /// A stage of the computation begins.
    fn begin(&self, _stage: &str) {}

    /// The stage has come to `share`, 0 to 1, of its way; `note` says more, and is only called for
    /// by whoever shows it.
    fn advance(&self, _share: f64, _note: &dyn Fn() -> String) {}

    /// The stage has ended after so many seconds.
    fn end(&self, _stage: &str, _seconds: f64) {}

    /// Something that the user should know, but that does not end the computation.
    fn warn(&self, _text: &str) {}

    /// The computation will hold `predicted` bytes at most, where `limit` bytes are allowed. It is
    /// told before any of them is taken, and again where more becomes known.
    fn memory(&self, _predicted: u128, _limit: u128) {}

    /// Whether the computation is still wanted; asked often.
    fn go_on(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// From now on there is a result that would be lost if the process ended. The answer says
    /// whether it is still wanted.
    fn begin_saving(&self) -> ControlFlow<()> {
        self.go_on()
    }
}

impl Watch for Quiet {}

/// Counts the steps of a computation over all its threads, and tells a watch of them.
pub struct Steps<'a> {
    watch: &'a dyn Watch,
    done: AtomicU64,
    total: u64,
    things: &'static str,
}

impl fmt::Debug for Steps<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Steps({} of {} {})", self.done(), self.total, self.things)
    }
}

impl<'a> Steps<'a> {
    /// Counts so many things, such as `pairs`.
    pub fn new(watch: &'a dyn Watch, total: u64, things: &'static str) -> Self {
        Self { watch, done: AtomicU64::new(0), total, things }
    }

    /// Says that `count` more are done, and asks whether to go on.
    pub fn add(&self, count: u64) -> ControlFlow<()> {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        self.tell(done);
        self.watch.go_on()
    }

    /// Says that the next one begins, and asks whether to go on.
    pub fn begin(&self) -> ControlFlow<()> {
        self.tell(self.done.fetch_add(1, Ordering::Relaxed));
        self.watch.go_on()
    }

    /// How many are done.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// How many there are in all.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.total
    }

    fn tell(&self, done: u64) {
        let Self { total, things, .. } = self;
        self.watch.advance(done as f64 / (*total).max(1) as f64, &|| format!("{done} of {total} {things}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// Keeps what it is told, and breaks after so much.
    struct Listener(Mutex<Vec<(f64, String)>>, usize);

    impl Watch for Listener {
        fn advance(&self, share: f64, note: &dyn Fn() -> String) {
            self.0.lock().unwrap().push((share, note()));
        }

        fn go_on(&self) -> ControlFlow<()> {
            if self.0.lock().unwrap().len() < self.1 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        }
    }

    #[test]
    fn steps_are_counted_told_and_stopped() {
        let listener = Listener(Mutex::default(), 2);
        let steps = Steps::new(&listener, 4, "rows");
        assert!(steps.begin().is_continue() && steps.add(2).is_break());
        assert_eq!((steps.done(), steps.total()), (3, 4));
        let told = listener.0.into_inner().unwrap();
        assert_eq!(told, [(0.0, "0 of 4 rows".to_owned()), (0.75, "3 of 4 rows".to_owned())]);
        assert!(Quiet.go_on().is_continue() && Quiet.begin_saving().is_continue());
    }
}
