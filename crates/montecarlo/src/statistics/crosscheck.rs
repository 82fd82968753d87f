//! Do a deterministic and a stochastic solution agree?
//!
//! Of each place t = (x_mc − x_det)/√(s² + δ²), s the standard error of n batches and δ what the
//! deterministic side says of its own error, with the degrees of freedom n − 1 of s alone; z is the
//! normal score. A place is at fault where its probability is significant after the correction for
//! all places. All values in one unit.
//!
//! What such a comparison can find is stated with it: a place that deviates by t_c √(s² + δ²) +
//! 1.28 s √(1 + t_c² s²/(2 (n − 1) (s² + δ²))) from what the deterministic side has, t_c the bound
//! of significance for one of all places, is found nine times out of ten. Where no sample has
//! arrived, s is not 0 but what a single one would have brought.

use super::significance::critical_t;
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
    /// What a single sample would have brought: s is no less; 0 where that is not known.
    pub single: &'a [f64],
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
    /// The deviation that would have been found with a probability of 0.9.
    pub found: f64,
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

/// Normal deviation that nine of ten exceed.
const NINE_OF_TEN: f64 = 1.281_551_565_544_6;
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
        ("the worth of a sample", comparison.single.len()),
    ];
    if let Some(&(what, found)) = lengths.iter().find(|(_, found)| *found != expected) {
        return Err(MonteCarloError::Length { what, expected, found });
    }
    let scores: Vec<f64> = (0..expected).map(|i| score(comparison, i)).collect();
    let probabilities: Vec<f64> = scores.iter().map(|&z| two_sided_p(z)).collect();
    let significant = correction.significant(&probabilities, alpha);
    let bound = critical_t(alpha / expected.max(1) as f64, comparison.freedom());
    let place = |i: usize| Place {
        index: i,
        z: scores[i],
        p: probabilities[i],
        significant: significant[i],
        found: comparison.found(i, bound),
    };
    Ok(Crosscheck {
        places: (0..expected).map(place).collect(),
        suite: Suite::new(&scores),
        significant: significant.iter().filter(|s| **s).count(),
    })
}

impl Comparison<'_> {
    fn stochastic_error(&self, i: usize) -> f64 {
        self.standard_error[i].max(self.single[i])
    }

    /// √(s² + δ²).
    fn deviation(&self, i: usize) -> f64 {
        self.stochastic_error(i).hypot(self.deterministic_error[i])
    }

    /// The deviation that is beyond the bound nine times out of ten: both the value and the bound,
    /// which follows s, vary by chance.
    fn found(&self, i: usize, bound: f64) -> f64 {
        let (s, deviation) = (self.stochastic_error(i), self.deviation(i));
        let spread = if deviation > 0.0 { bound * s / deviation } else { 0.0 };
        bound * deviation + NINE_OF_TEN * s * (1.0 + 0.5 * spread * spread / self.freedom()).sqrt()
    }

    /// Degrees of freedom of s.
    fn freedom(&self) -> f64 {
        self.batches.saturating_sub(1).max(1) as f64
    }
}

fn score(comparison: &Comparison<'_>, i: usize) -> f64 {
    let (x, y) = (comparison.deterministic[i], comparison.stochastic[i]);
    if (x - y).abs() <= ROUNDING * x.abs().max(y.abs()) {
        return 0.0;
    }
    normal_score((y - x) / comparison.deviation(i), comparison.freedom())
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
            single: &vec![0.0; n],
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

    #[test]
    fn where_nothing_has_arrived_one_sample_might_have() {
        let comparison = |deterministic: f64| {
            Comparison {
                deterministic: &[deterministic],
                deterministic_error: &[0.0],
                stochastic: &[0.0],
                standard_error: &[0.0],
                single: &[0.1],
                batches: 1 << 40,
            }
            .verdict()
        };
        // 2.576 is the bound of 1 % of one place, and 1.282 what nine of ten exceed.
        assert!(comparison(0.25).agrees() && !comparison(0.26).agrees());
        assert!((comparison(0.25).places[0].found - 0.385_738).abs() < 1e-6);
    }

    impl Comparison<'_> {
        fn verdict(&self) -> Crosscheck {
            crosscheck(self, Correction::Holm, 0.01).unwrap()
        }
    }
}
