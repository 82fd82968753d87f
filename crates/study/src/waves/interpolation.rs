//! Fields over frequency from those at some frequencies.
//!
//! ```text
//! F(f) = Σ w_i F_i/(f − f_i) / Σ w_i/(f − f_i)
//! ```
//!
//! with the weights of M. S. Floater, K. Hormann, Numer. Math. 107 (2007) 315
//! (doi:10.1007/s00211-007-0093-y): a blend of polynomials of degree d that has no poles between
//! the frequencies. The next frequency to compute is the one where degrees d and d − 2 differ most;
//! what is computed there tells how good the interpolation was. Before that the delay on the way
//! from the source to the middle of the surfaces and on to the receiver is taken out of the phase:
//! what is left changes with the size of the body only.

use std::collections::BTreeMap;
use std::ops::Range;

use fredholm_mesh::Vec3;
use fredholm_report::{FarRow, MonostaticRow, WaveRow};
use fredholm_scene::waves::direction;
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{Complex64, ComplexVector, FarField, Origin, incident, polar_frame};
use serde_json::{Value, json};

use super::compute::{far_row, pair};
use super::model::Band;
use super::{Model, Outcome};
use crate::error::Error;

/// Frequencies that are computed first.
const FIRST_FREQUENCIES: usize = 7;
/// Highest degree of the polynomials.
const DEGREE: usize = 9;
/// What is stated over the largest difference that was seen.
const SAFETY: f64 = 2.0;
/// What the fields themselves jump by from one frequency to the next, since the rules of integrals
/// to 1e-3 and the iterations of a solver change: no interpolation is more exact.
const ROUGHNESS: f64 = 2e-3;
/// Frequencies in turn that have to be as exact as asked for.
const IN_TURN: usize = 2;

/// How a sweep was interpolated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolated {
    /// Frequencies that were computed.
    pub computed: usize,
    /// All frequencies.
    pub frequencies: usize,
    /// Stated error of the interpolation at any frequency, over the root mean square of the field
    /// of a receiver over the sweep.
    pub relative: f64,
}

impl Interpolated {
    pub(super) fn record(&self) -> Value {
        json!({ "computed": self.computed, "frequencies": self.frequencies, "relative": self.relative })
    }
}

/// What one frequency is computed by.
pub(super) type Compute<'a> = &'a mut dyn FnMut(&Band, &mut Outcome) -> Result<(), Error>;

/// Whether the frequencies of a model are interpolated, and how exactly.
pub(super) fn accuracy(model: &Model) -> Option<f64> {
    let mut bits: Vec<u64> = model.bands.iter().map(|band| band.wave.frequency().to_bits()).collect();
    bits.sort_unstable();
    bits.dedup();
    let distinct = bits.len() == model.bands.len();
    model.scene.settings().sweep_accuracy.filter(|_| distinct && bits.len() > FIRST_FREQUENCIES)
}

/// All frequencies to an accuracy.
pub(super) fn swept(model: &Model, accuracy: f64, compute: Compute<'_>) -> Result<Outcome, Error> {
    let mut bands: Vec<&Band> = model.bands.iter().collect();
    bands.sort_by(|a, b| a.wave.frequency().total_cmp(&b.wave.frequency()));
    let (count, places) = (bands.len(), Places::of(model));
    let mut samples = Samples::default();
    let mut outcomes = BTreeMap::new();
    let mut add = |at: usize, samples: &mut Samples| -> Result<(), Error> {
        let mut outcome = Outcome::default();
        compute(bands[at], &mut outcome)?;
        samples.add(at, bands[at].wave.frequency(), places.values(bands[at], &outcome));
        outcomes.insert(at, outcome);
        Ok(())
    };
    for i in 0..FIRST_FREQUENCIES {
        add(i * (count - 1) / (FIRST_FREQUENCIES - 1), &mut samples)?;
    }
    let frequency = |at: usize| bands[at].wave.frequency();
    let mut seen = vec![f64::INFINITY; IN_TURN];
    let relative = loop {
        let doubts = (0..count).filter(|at| !samples.at.contains(at)).map(|at| {
            let [high, low] = [DEGREE, DEGREE - 2].map(|degree| samples.value(frequency(at), degree));
            (samples.gap(&high, &low, &places.groups), at)
        });
        let Some((doubt, at)) = doubts.max_by(|a, b| a.0.total_cmp(&b.0)) else { break 0.0 };
        let largest = seen.iter().rev().take(IN_TURN).fold(doubt, |most, gap| most.max(*gap));
        let stated = SAFETY * largest + ROUGHNESS;
        if stated <= accuracy {
            break stated;
        }
        let expected = samples.value(frequency(at), DEGREE);
        add(at, &mut samples)?;
        let found = samples.known(at);
        seen.push(samples.gap(&expected, found, &places.groups));
    };
    let computed = outcomes.len();
    let mut all = Outcome {
        interpolated: Some(Interpolated { computed, frequencies: count, relative }),
        ..Outcome::default()
    };
    let Some(pattern) = outcomes.values().next().cloned() else { return Ok(all) };
    for (at, band) in bands.iter().enumerate() {
        if let Some(outcome) = outcomes.remove(&at) {
            all.append(outcome);
        } else {
            places.rows(band, &samples.value(frequency(at), DEGREE), &pattern, &mut all);
        }
    }
    Ok(all)
}

/// Values at some frequencies, in their order.
#[derive(Default)]
struct Samples {
    at: Vec<usize>,
    frequencies: Vec<f64>,
    values: Vec<Vec<Complex64>>,
}

impl Samples {
    fn add(&mut self, at: usize, frequency: f64, values: Vec<Complex64>) {
        let place = self.at.partition_point(|&other| other < at);
        self.at.insert(place, at);
        self.frequencies.insert(place, frequency);
        self.values.insert(place, values);
    }

    fn known(&self, at: usize) -> &[Complex64] {
        self.at.iter().position(|&other| other == at).map_or(&[], |i| &self.values[i])
    }

    /// The values at a frequency by polynomials of this degree at most.
    fn value(&self, frequency: f64, degree: usize) -> Vec<Complex64> {
        let weights = weights(&self.frequencies, degree.min(self.frequencies.len() - 1));
        let mut sum = vec![Complex64::ZERO; self.values.first().map_or(0, Vec::len)];
        let mut whole = 0.0;
        for ((weight, &node), values) in weights.iter().zip(&self.frequencies).zip(&self.values) {
            if frequency.total_cmp(&node).is_eq() {
                return values.clone();
            }
            let share = weight / (frequency - node);
            whole += share;
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
        }
        for sum in &mut sum {
            *sum /= whole;
        }
        sum
    }

    /// The largest difference of a group of values, over the root mean square of that group over
    /// the samples.
    fn gap(&self, a: &[Complex64], b: &[Complex64], groups: &[Range<usize>]) -> f64 {
        let relative = |group: &Range<usize>| {
            let gap: f64 = group.clone().map(|i| (a[i] - b[i]).norm_sqr()).sum();
            let size: f64 = self.values.iter().flat_map(|v| &v[group.clone()]).map(Complex64::norm_sqr).sum();
            if size > 0.0 { (gap * self.values.len() as f64 / size).sqrt() } else { 0.0 }
        };
        groups.iter().map(relative).fold(0.0, f64::max)
    }
}

/// The weights for nodes in rising order, each over the largest.
fn weights(nodes: &[f64], degree: usize) -> Vec<f64> {
    let last = nodes.len() - 1;
    let span = (nodes[last] - nodes[0]).max(f64::MIN_POSITIVE);
    let weight = |k: usize| {
        let blends = k.saturating_sub(degree)..=k.min(last - degree);
        let product = |i: usize| {
            let others = (i..=i + degree).filter(|&j| j != k);
            others.map(|j| span / (nodes[k] - nodes[j]).abs()).product::<f64>()
        };
        let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * blends.map(product).sum::<f64>()
    };
    (0..=last).map(weight).collect()
}

/// Where the numbers of an outcome stand, and how long the waves are on their way.
struct Places<'a> {
    model: &'a Model,
    /// Middle of the surfaces, m.
    centre: Vec3,
    /// From the first source to the middle, m.
    source: f64,
    /// The numbers of each receiver.
    groups: Vec<Range<usize>>,
}

impl<'a> Places<'a> {
    fn of(model: &'a Model) -> Self {
        let centre =
            model.geometry.mesh.bounds().map_or(Vec3::ZERO, |bounds| 0.5 * (bounds.min + bounds.max));
        let source = model.sources().first().map_or(0.0, |source| match source.origin() {
            Origin::Point(p) => p.distance(centre),
            Origin::Direction(travel) => travel.dot(centre),
        });
        Self { model, centre, source, groups: Vec::new() }.grouped()
    }

    /// Near receivers first, then far ones, then sweeps, as the rows of an outcome.
    fn grouped(mut self) -> Self {
        use fredholm_scene::waves::Places as Receiving;
        let mut end = 0;
        for kind in 0..3 {
            for receiver in &self.model.receivers {
                let numbers = match (&receiver.places, kind) {
                    (Receiving::Near { points, .. }, 0) => 6 * points.len(),
                    (Receiving::Far(angles), 1) => 2 * angles.len(),
                    (Receiving::Monostatic(angles), 2) => 4 * angles.len(),
                    _ => continue,
                };
                self.groups.push(end..end + numbers);
                end += numbers;
            }
        }
        self
    }

    /// e^{jkd}: what takes a delay d, m, out.
    fn advance(band: &Band, delay: f64) -> Complex64 {
        Complex64::cis(band.wave.wavenumber() * delay)
    }

    fn near(&self, band: &Band, row: &WaveRow) -> Complex64 {
        Self::advance(band, self.source + Vec3::from_array(row.position).distance(self.centre))
    }

    fn far(&self, band: &Band, row: &FarRow) -> Complex64 {
        Self::advance(band, self.source - direction(row.theta_degrees, row.phi_degrees).dot(self.centre))
    }

    fn back(&self, band: &Band, row: &MonostaticRow) -> Complex64 {
        Self::advance(band, -2.0 * direction(row.theta_degrees, row.phi_degrees).dot(self.centre))
    }

    /// All complex numbers of an outcome of one frequency without their delays, and in the end the
    /// power of located sources.
    fn values(&self, band: &Band, outcome: &Outcome) -> Vec<Complex64> {
        let mut values = Vec::new();
        let mut add = |numbers: &[f64], turn: Complex64| {
            values.extend(numbers.chunks_exact(2).map(|c| Complex64::new(c[0], c[1]) * turn));
        };
        outcome.near.iter().for_each(|row| add(&row.scattered, self.near(band, row)));
        outcome.far.iter().for_each(|row| add(&row.amplitude, self.far(band, row)));
        outcome.monostatic.iter().for_each(|row| add(row.scattering.as_flattened(), self.back(band, row)));
        let power = outcome.far.iter().find_map(|row| row.total).map_or(0.0, |total| {
            let square: f64 = total.amplitude.iter().map(|x| x * x).sum();
            2.0 * std::f64::consts::PI * square / (IMPEDANCE * total.gain)
        });
        values.push(power.into());
        values
    }

    /// The rows of a frequency from its numbers, with the receivers of another.
    fn rows(&self, band: &Band, values: &[Complex64], pattern: &Outcome, all: &mut Outcome) {
        let (frequency, sources) = (band.wave.frequency(), self.model.sources());
        let power = values.last().map(|power| power.re);
        let mut next = values.iter();
        let mut take = |numbers: &mut [f64], turn: Complex64| {
            for (number, value) in numbers.chunks_exact_mut(2).zip(&mut next) {
                let value = value * turn.conj();
                (number[0], number[1]) = (value.re, value.im);
            }
        };
        for row in &pattern.near {
            let mut row = WaveRow { frequency, ..row.clone() };
            let turn = self.near(band, &row);
            take(&mut row.scattered, turn);
            let there = incident(&sources, &band.wave, Vec3::from_array(row.position));
            row.incident = pair(there.e, there.h);
            all.near.push(row);
        }
        for row in &pattern.far {
            let mut amplitude = [0.0; 4];
            take(&mut amplitude, self.far(band, row));
            let u = direction(row.theta_degrees, row.phi_degrees);
            let [theta, phi] = polar_frame(u);
            let [a, b, c, d] = amplitude;
            let amplitude = ComplexVector::along(theta, Complex64::new(a, b))
                + ComplexVector::along(phi, Complex64::new(c, d));
            let (at, angles) = ([row.receiver, row.index], [row.theta_degrees, row.phi_degrees]);
            let far = FarField { direction: u, amplitude };
            all.far.push(far_row((self.model, band, power), at, angles, &far));
        }
        for row in &pattern.monostatic {
            let mut row = MonostaticRow { frequency, ..row.clone() };
            let turn = self.back(band, &row);
            take(row.scattering.as_flattened_mut(), turn);
            all.monostatic.push(row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials up to the degree are met exactly, and known values; a lower degree does not do.
    #[test]
    fn polynomials_are_exact() {
        let at = [0.0, 0.4, 0.7, 1.3, 1.9, 2.0];
        let cubic = |x: f64| Complex64::new(1.0 - x + 2.0 * x * x * x, x * x);
        let mut samples = Samples::default();
        for (i, &x) in at.iter().enumerate().rev() {
            samples.add(i, x, vec![cubic(x), Complex64::ONE]);
        }
        assert_eq!(samples.value(0.4, 1)[0], cubic(0.4));
        for x in [0.1, 1.0, 1.95] {
            let found = samples.value(x, 3);
            assert!(
                (found[0] - cubic(x)).norm() < 1e-12 && (found[1] - 1.0).norm() < 1e-12,
                "{x}: {found:?}"
            );
            assert!((samples.value(x, 1)[0] - cubic(x)).norm() > 1e-4);
        }
    }
}
