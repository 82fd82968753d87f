//! The one protocol between a long computation and whoever waits for it: progress one way,
//! cancellation the other.
//!
//! Every method has a default that does nothing, so that a caller implements what it wants to know.
//! All of them may be called from any thread.

use std::ops::ControlFlow;

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
