//! What refinement changed, and what it says about the errors of the parts that remain.
//!
//! Errors of parts are of either sign; of many, some are underestimated, and those are the ones that are not improved. Each time a part is refined, the change of its integral shows
//! what its error was. Let ρ be the change over the error, and Σ a sum in which each earlier refinement weighs less by a factor. With n parts of errors eₖ
//!
//! error = c √(1 + u Σ ρ²) (1 + w/(1 + Σ 1)) (1 + l ln n) √(Σ eₖ²).
//!
//! A part that was off by about its error or more raises that of all; before the first refinement nothing is known and w is largest; where it is known which lines are active, w is less.

use super::piece::Piece;

/// c,
const SAFETY: f64 = 0.495;
/// u,
const SURPRISE: f64 = 0.62;
/// w,
const UNKNOWN: f64 = 5.0;
/// and where all events are sure, and
const SURE: f64 = 1.2;
/// l of the formula.
const MANY: f64 = 0.17;
/// What a refinement weighs after the next one.
const KEEP: f64 = 0.95;
/// Largest ρ that counts.
const LARGEST: f64 = 6.2;

/// The refinements of one integral.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observed {
    /// w.
    unknown: f64,
    /// Σ 1.
    count: f64,
    /// Σ ρ².
    surprise: f64,
}

impl Observed {
    /// None yet, of an integral of which it is known or not which lines are active.
    pub(super) fn new(sure: bool) -> Self {
        Self { unknown: if sure { SURE } else { UNKNOWN }, count: 0.0, surprise: 0.0 }
    }

    /// Takes the change of a part's integral against the error that it had.
    pub(super) fn add(&mut self, change: f64, error: f64) {
        let ratio = if error > 0.0 { (change.abs() / error).min(LARGEST) } else { 0.0 };
        self.surprise = KEEP * self.surprise + ratio * ratio;
        self.count = KEEP * self.count + 1.0;
    }

    /// What the error of a part counts for, at least.
    pub(super) fn scale(&self) -> f64 {
        SAFETY * (1.0 + SURPRISE * self.surprise).sqrt()
    }

    /// The error of the sum of some parts.
    pub(super) fn error(&self, parts: &[Piece]) -> f64 {
        let squares: f64 = parts.iter().map(|part| part.error.powi(2)).sum();
        let unknown = 1.0 + self.unknown / (1.0 + self.count);
        self.scale() * unknown * (1.0 + MANY * (parts.len() as f64).ln()) * squares.sqrt()
    }
}
