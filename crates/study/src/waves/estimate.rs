//! Estimates of the error of the scattered E at the receivers and of their far fields, relative in
//! the L² norm over the points or directions of each.
//!
//! | estimate | from |
//! |---|---|
//! | stated | the share of the edge currents, or the field inside closed bodies, times a measured factor ([`Indicator`]), and what is left of the bounces |
//! | mesh | Richardson: a third of the difference to edges twice as long, for the second order of the rules; more than the error where functions are of the first full order |
//! | form | half the difference between the currents 2 n × H and 2 n × E, which a true conductor does not tell apart |
//!
//! Of a monostatic sweep the error is stated from some of its waves. Where the indicator is one of
//! the whole scattered field, the error is spread evenly over all directions: what goes back may be
//! far less than what goes on.
//!
//! What is left of the bounces is the residual of the solver, in the run record too.

use std::collections::BTreeMap;

use fredholm_mesh::Vec3;
use fredholm_waves::material::Material;
use fredholm_waves::{ComplexVector, EdgeCurrents, Indicator, Shadow};
use serde_json::{Value, json};

use super::{Model, Outcome};

/// The estimated error at one receiver and frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimated {
    /// Number of the receiver.
    pub receiver: usize,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Error relative to the scattered field, L² over the points or directions.
    pub relative: f64,
}

impl Estimated {
    pub(super) fn record(&self, model: &Model) -> Value {
        let name = model.receivers.get(self.receiver).map(|receiver| &receiver.name);
        json!({ "receiver": name, "frequency_hz": self.frequency, "relative": self.relative })
    }
}

/// Most points or directions of a receiver that the share of edge currents is taken from.
const MOST_PLACES_OF_A_RECEIVER: usize = 60;

/// Directions of a sweep that its error is stated from, at most some more.
const SWEEP_DIRECTIONS: usize = 8;

/// The error of a monostatic sweep, from that of some of its waves: root mean square over that of
/// what they send back.
#[derive(Default)]
pub(super) struct SweepError {
    /// Sums of the squares of the errors and of the fields, V².
    sums: [f64; 2],
    /// Whether the error of some wave is not known.
    unknown: bool,
}

impl SweepError {
    /// Whether a direction of so many is one of the sample.
    pub(super) fn samples(index: usize, count: usize) -> bool {
        index.is_multiple_of(count.div_ceil(SWEEP_DIRECTIONS).max(1))
    }

    /// Squares of the error, where it is known, and of the field, V².
    pub(super) fn add(&mut self, error: Option<f64>, field: f64) {
        self.unknown |= error.is_none();
        self.sums[0] += error.unwrap_or(0.0);
        self.sums[1] += field;
    }

    /// What is stated.
    pub(super) fn estimated(&self, receiver: usize, frequency: f64) -> Option<Estimated> {
        let known = !self.unknown && self.sums[1] > 0.0;
        known.then(|| Estimated { receiver, frequency, relative: (self.sums[0] / self.sums[1]).sqrt() })
    }
}

/// What the error of a receiver is stated from.
pub(super) enum Stating {
    /// The field inside closed bodies, and whether the currents solve an equation.
    Inside { inside: f64, equation: bool },
    /// The edge currents, and whether they are part of the field.
    Edges { edges: EdgeCurrents, added: bool },
}

impl Stating {
    /// The indicator of a receiver with these points or directions and fields.
    pub(super) fn indicator(
        &self,
        places: &[Vec3],
        fields: &[ComplexVector],
        edge: &(dyn Fn(&EdgeCurrents, Vec3) -> ComplexVector + Sync),
    ) -> Indicator {
        match self {
            Self::Inside { inside, equation: true } => Indicator::InsideEquation(*inside),
            Self::Inside { inside, equation: false } => Indicator::InsideOptics(*inside),
            Self::Edges { edges, added } => {
                let step = places.len().div_ceil(MOST_PLACES_OF_A_RECEIVER).max(1);
                let (mut share, mut size) = (0.0, 0.0);
                for (&place, field) in places.iter().zip(fields).step_by(step) {
                    share += edge(edges, place).norm_squared();
                    size += field.norm_squared();
                }
                let share = if size > 0.0 { (share / size).sqrt() } else { 0.0 };
                if *added { Indicator::EdgesAdded(share) } else { Indicator::EdgesLeft(share) }
            }
        }
    }
}

/// Whether the magnetic form is a second opinion: not on itself, nor on what it does not know.
pub(super) fn has_magnetic_form(model: &Model) -> bool {
    let conductors = model.bands.iter().flat_map(|band| &band.materials).all(|m| *m == Material::Conductor);
    let optics = matches!(model.shadow, Shadow::Geometric | Shadow::Radiated);
    conductors && optics && model.galerkin.is_none()
}

/// A third of the difference.
pub(super) fn mesh(fine: &Outcome, coarse: &Outcome) -> Vec<Estimated> {
    differences(fine, coarse, 1.0 / 3.0)
}

/// Half the difference.
pub(super) fn form(electric: &Outcome, magnetic: &Outcome) -> Vec<Estimated> {
    differences(electric, magnetic, 0.5)
}

fn differences(ours: &Outcome, others: &Outcome, factor: f64) -> Vec<Estimated> {
    // Positive frequencies are in the order of their bits.
    let mut sums: BTreeMap<(u64, usize), [f64; 2]> = BTreeMap::new();
    let mut add = |(frequency, receiver): (f64, usize), a: &[f64], b: &[f64]| {
        let sum = sums.entry((frequency.to_bits(), receiver)).or_default();
        for (a, b) in a.iter().zip(b) {
            sum[0] += (a - b) * (a - b);
            sum[1] += a * a;
        }
    };
    for (row, other) in ours.near.iter().zip(&others.near) {
        add((row.frequency, row.receiver), &row.scattered[..6], &other.scattered[..6]);
    }
    for (row, other) in ours.far.iter().zip(&others.far) {
        add((row.frequency, row.receiver), &row.amplitude, &other.amplitude);
    }
    let estimated = |((bits, receiver), [gap, size]): ((u64, usize), [f64; 2])| Estimated {
        receiver,
        frequency: f64::from_bits(bits),
        relative: if size > 0.0 { factor * (gap / size).sqrt() } else { 0.0 },
    };
    sums.into_iter().map(estimated).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_report::WaveRow;

    fn row(receiver: usize, ez: f64) -> WaveRow {
        let mut scattered = [0.0; 12];
        scattered[4] = ez;
        WaveRow { receiver, index: 0, position: [0.0; 3], frequency: 1e9, incident: [9.0; 12], scattered }
    }

    #[test]
    fn errors_are_those_of_each_receiver() {
        let outcome = |near: &[WaveRow]| Outcome { near: near.to_vec(), ..Outcome::default() };
        let fine = outcome(&[row(0, 3.0), row(0, 4.0), row(1, 2.0)]);
        let coarse = outcome(&[row(0, 3.0), row(0, 4.0 + 1.5), row(1, 2.0)]);
        let found = mesh(&fine, &coarse);
        assert_eq!(found.len(), 2);
        assert!((found[0].relative - 0.1).abs() < 1e-15 && found[1].relative.abs() < 1e-300);
        assert!((form(&fine, &coarse)[0].relative - 0.15).abs() < 1e-15);
    }
}
