//! Do a deterministic and a stochastic solution agree?
//!
//! Of each place t = (x_mc − x_det)/√(s² + δ²), s the standard error of n batches and δ what the deterministic side says of its own error, with the degrees of freedom n − 1 of s alone;
//! z is the normal score. A place is at fault where its probability is significant after the correction for all places. All values in one unit.

use super::{Correction, Suite, normal_score, two_sided_p};
use crate::MonteCarloError;

/// Two solutions at the same places.
#[derive(Clone, Copy, Debug)]
pub struct Comparison<'a> {
    /// x_det.
    pub deterministic: &'a [f64],
    /// δ.
    pub deterministic_error: &'a [f64],
    /// x_mc.
    pub stochastic: &'a [f64],
    /// s.
    pub standard_error: &'a [f64],
    /// Batches behind s.
    pub batches: u64,
}

/// One place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its number.
    pub index: usize,
    /// Normal score of the difference.
    pub z: f64,
    /// Two-sided probability of it.
    pub p: f64,
    /// Whether it is significant.
    pub significant: bool,
}

/// The verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Crosscheck {
    /// Every place, in order.
    pub places: Vec<Place>,
    /// What the scores say together. Places that share paths are not independent: for looking at.
    pub suite: Suite,
    /// Number of significant places.
    pub significant: usize,
}

impl Crosscheck {
    /// Whether nothing speaks against agreement.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.significant == 0
    }

    /// The places farthest apart, the worst first.
    #[must_use]
    pub fn worst(&self, count: usize) -> Vec<Place> {
        let mut places = self.places.clone();
        places.sort_by(|a, b| b.z.abs().total_cmp(&a.z.abs()).then(a.index.cmp(&b.index)));
        places.truncate(count);
        places
    }
}

/// Rounding that is no difference, over the larger value.
const ROUNDING: f64 = 1e-12;

/// Compares two solutions at the level of significance `alpha`.
///
/// # Errors
/// [`MonteCarloError::Length`] for vectors of different lengths.
pub fn crosscheck(
    comparison: &Comparison<'_>,
    correction: Correction,
    alpha: f64,
) -> Result<Crosscheck, MonteCarloError> {
    let expected = comparison.deterministic.len();
    let lengths = [
        ("the deterministic error", comparison.deterministic_error.len()),
        ("the stochastic solution", comparison.stochastic.len()),
        ("the standard error", comparison.standard_error.len()),
    ];
    if let Some(&(what, found)) = lengths.iter().find(|(_, found)| *found != expected) {
        return Err(MonteCarloError::Length { what, expected, found });
    }
    let scores: Vec<f64> = (0..expected).map(|i| score(comparison, i)).collect();
    let probabilities: Vec<f64> = scores.iter().map(|&z| two_sided_p(z)).collect();
    let significant = correction.significant(&probabilities, alpha);
    let place = |i: usize| Place { index: i, z: scores[i], p: probabilities[i], significant: significant[i] };
    Ok(Crosscheck {
        places: (0..expected).map(place).collect(),
        suite: Suite::new(&scores),
        significant: significant.iter().filter(|s| **s).count(),
    })
}

fn score(comparison: &Comparison<'_>, i: usize) -> f64 {
    let (x, y) = (comparison.deterministic[i], comparison.stochastic[i]);
    let deviation = comparison.standard_error[i].hypot(comparison.deterministic_error[i]);
    if (x - y).abs() <= ROUNDING * x.abs().max(y.abs()) {
        return 0.0;
    }
    normal_score((y - x) / deviation, comparison.batches.saturating_sub(1).max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compare(stochastic: &[f64], errors: &[f64], delta: f64) -> Crosscheck {
        let n = stochastic.len();
        let (deterministic, deterministic_error) = (vec![1.0; n], vec![delta; n]);
        let comparison = Comparison {
            deterministic: &deterministic,
            deterministic_error: &deterministic_error,
            stochastic,
            standard_error: errors,
            batches: 1 << 40,
        };
        crosscheck(&comparison, Correction::Holm, 0.01).unwrap()
    }

    #[test]
    fn one_of_a_hundred_places_far_off_is_found_and_noise_is_not() {
        let mut values: Vec<f64> = (0..100).map(|i| 1.0 + 0.001 * f64::from(i % 5 - 2)).collect();
        assert!(compare(&values, &[0.001; 100], 0.0).agrees());
        values[42] = 1.006;
        let found = compare(&values, &[0.001; 100], 0.0);
        assert_eq!((found.significant, found.worst(1)[0].index), (1, 42));
        assert!((found.worst(1)[0].z - 6.0).abs() < 1e-9);
        // The deterministic side owns to as much.
        assert!(compare(&values, &[0.001; 100], 0.003).agrees());
    }

    #[test]
    fn exact_agreement_without_error_is_no_fault_and_a_difference_without_error_is() {
        assert!(compare(&[1.0, 1.0], &[0.0; 2], 0.0).agrees());
        assert_eq!(compare(&[1.0, 1.1], &[0.0; 2], 0.0).worst(1)[0].index, 1);
        assert!(!compare(&[1.0, 1.1], &[0.0; 2], 0.0).agrees());
    }
}
