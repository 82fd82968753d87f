//! Memory that a matrix will take, known before any is taken.

use fredholm_linop::PackedSymmetric;

use super::options::Settings;
use crate::memory::Plan;
use crate::prediction::{BYTES_OF_AN_ASSEMBLED_ELEMENT, BYTES_OF_AN_ELEMENT, waiting};

/// Bytes of a factor.
const BYTES_OF_A_FACTOR: u128 = 8;
/// Bytes of a factor with its stated error, and of one in sparse storage.
const BYTES_OF_A_DENSE_FACTOR: u128 = BYTES_OF_A_FACTOR + 4;
const BYTES_OF_A_SPARSE_FACTOR: u128 = BYTES_OF_A_DENSE_FACTOR + 4;
/// Bytes of a point, as it is given and as it is written.
const BYTES_OF_A_POINT: u128 = 96;

/// Of the entries on their way, which bring their errors with them, one in so many is still there
/// when they have arrived.
const RETAINED_ONE_IN: u128 = 3;

/// How to need less.
pub(super) fn help(options: &Settings) -> String {
    let sparse = if options.threshold.is_none() { ", a --threshold" } else { "" };
    format!("use fewer elements{sparse}, or --rows surface")
}

/// What is held when. The exchanges and the errors stated for them are held from the assembly on,
/// of the rows once they are merged.
pub(super) fn plan(elements: usize, rows: usize, options: &Settings) -> Plan {
    let packed = |n: usize| u128::from(PackedSymmetric::<f64>::bytes(n));
    let (n, m) = (elements as u128, rows as u128);
    let waiting = u128::from(waiting::<f64>(elements, true));
    let retained = waiting / RETAINED_ONE_IN;
    // One after the other, exchanges and errors are merged, or given a row for the sky.
    let copied = if rows != elements || options.sky { packed(rows) * 2 } else { 0 };
    let closed = if options.close { packed(rows) } else { 0 };
    // A row sums to about 1, so that it has at most 1/X entries of at least X.
    let kept = options.threshold.map(|threshold| m.min((1.1 / threshold) as u128 + 1));
    let factors = kept.map_or(m * m * BYTES_OF_A_DENSE_FACTOR, |kept| m * kept * BYTES_OF_A_SPARSE_FACTOR);
    let points = options.points as u128;
    Plan::default()
        .hold(format!("{elements} elements"), n * BYTES_OF_AN_ELEMENT)
        .hold("points", points * (BYTES_OF_A_POINT + m * BYTES_OF_A_FACTOR))
        .stage(
            format!("the exchanges of {elements} elements and their errors"),
            2 * packed(elements) + waiting + n * BYTES_OF_AN_ASSEMBLED_ELEMENT,
        )
        .stage(
            format!("the exchanges of {elements} elements and of {rows} rows"),
            2 * packed(elements) + copied,
        )
        .stage(
            format!("the exchanges of {rows} rows and their closure"),
            2 * packed(rows) + closed + retained,
        )
        .stage(format!("the exchanges of {rows} rows and the matrix"), 2 * packed(rows) + factors + retained)
}
