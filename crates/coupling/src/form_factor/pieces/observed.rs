//! What refinement changed, and what it says about the errors of the parts that remain.
//!
//! Each refinement of a part shows what its error was, and so how far those of the others can be
//! believed: see [`error_model`](crate::form_factor::error_model) for the formula.

use super::piece::Piece;
use crate::form_factor::ErrorModel;

/// The refinements of one integral.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observed {
    model: ErrorModel,
    /// w.
    unknown: f64,
    /// Σ 1.
    count: f64,
    /// Σ ρ².
    surprise: f64,
}

impl Observed {
    /// None yet, of an integral of which it is known or not which lines are active.
    pub(super) fn new(model: ErrorModel, sure: bool) -> Self {
        Self { model, unknown: model.unknown[usize::from(sure)], count: 0.0, surprise: 0.0 }
    }

    /// Takes the change of a part's integral against the error that it had.
    pub(super) fn add(&mut self, change: f64, error: f64) {
        let ratio = if error > 0.0 { (change.abs() / error).min(self.model.largest_surprise) } else { 0.0 };
        self.surprise = self.model.memory * self.surprise + ratio * ratio;
        self.count = self.model.memory * self.count + 1.0;
    }

    /// What the error of a part counts for, at least.
    pub(super) fn scale(&self) -> f64 {
        self.model.safety * (1.0 + self.model.surprise * self.surprise).sqrt()
    }

    /// The error of the sum of some parts.
    pub(super) fn error(&self, parts: &[Piece]) -> f64 {
        let squares: f64 = parts.iter().map(|part| part.error.powi(2)).sum();
        let unknown = 1.0 + self.unknown / (1.0 + self.count);
        self.scale() * unknown * (1.0 + self.model.many * (parts.len() as f64).ln()) * squares.sqrt()
    }
}
