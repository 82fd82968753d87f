//! Memory that a matrix will take, known before any is taken.

use std::fmt;

use fredholm_coupling::waiting_bytes;
use fredholm_linop::PackedSymmetric;

use super::options::Options;
use crate::failure::{Ending, Failure};
use crate::size::Bytes;

/// Bytes an element takes besides its row of the matrix: geometry, quadrature points, error sums of the assembly.
const PER_ELEMENT: u128 = 4096;
/// Bytes of the program itself.
const PROGRAM: u128 = 8 << 20;
/// Bytes of a factor.
const FACTOR: u128 = 8;
/// Bytes of a factor with its stated error, and of one in sparse storage.
const DENSE: u128 = FACTOR + 4;
const SPARSE: u128 = DENSE + 4;

/// Memory by use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction {
    elements: usize,
    exchange: Bytes,
    factors: Bytes,
    rest: Bytes,
}

impl Prediction {
    pub(super) fn new(elements: usize, rows: usize, options: &Options) -> Self {
        let packed = |n: usize| u128::from(PackedSymmetric::<f64>::bytes(n));
        // Exchanges and their errors; what is merged or given a sky is copied, of what is closed the exchanges are.
        let copied = rows != elements || options.sky;
        let exchange = u128::from(waiting_bytes::<f64>(elements, true))
            + 2 * packed(elements)
            + packed(rows) * (2 * u128::from(copied) + u128::from(options.close));
        let n = rows as u128;
        // A row sums to about 1, so that it has at most 1/X entries of at least X.
        let kept = options.threshold.map(|threshold| n.min((1.1 / threshold) as u128 + 1));
        let factors = kept.map_or(n * n * DENSE, |kept| n * kept * SPARSE);
        let points = options.points as u128 * n * FACTOR;
        let rest = PROGRAM + elements as u128 * PER_ELEMENT + points;
        Self { elements, exchange: Bytes(exchange), factors: Bytes(factors), rest: Bytes(rest) }
    }

    pub(super) fn total(&self) -> Bytes {
        Bytes(self.exchange.0 + self.factors.0 + self.rest.0)
    }

    /// Refuses what is above the limit, and says what to change.
    pub(super) fn admit(&self, options: &Options) -> Result<(), Failure> {
        let limit = options.memory_limit();
        if self.total() <= limit {
            return Ok(());
        }
        let sparse = if options.threshold.is_none() { ", a --threshold" } else { "" };
        let text = format!(
            "these view factors need {}, but {limit} are allowed: {self}\n  help: use fewer elements{sparse}, --rows surface, \
             or allow more with --memory",
            self.total()
        );
        Err(Failure::new(Ending::Resources, text))
    }
}

impl fmt::Display for Prediction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { elements, exchange, factors, rest } = self;
        write!(
            f,
            "{exchange} for the exchanges of {elements} elements and their errors, {factors} for the matrix and {rest} for all the rest"
        )
    }
}
