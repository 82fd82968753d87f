//! From differences to probabilities.
//!
//! A difference over a standard error that was estimated from n batches follows Student's t with n
//! − 1 degrees of freedom; the normal score is the z of the same probability. Probabilities are
//! dimensionless, two-sided where nothing else is said.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};
use statrs::function::erf::{erfc, erfc_inv};
use std::f64::consts::SQRT_2;

/// Degrees of freedom from which on Student's t is taken as normal: the scores then differ by less
/// than 1e-5 at |z| = 3.
const NORMAL_DEGREES: f64 = 1e6;

/// Probability that a normal score is as far from 0 as this one.
#[must_use]
pub fn two_sided_p(z: f64) -> f64 {
    erfc(z.abs() / SQRT_2)
}

/// The normal score of a value of Student's t with these degrees of freedom.
#[must_use]
pub fn normal_score(t: f64, freedom: f64) -> f64 {
    if freedom >= NORMAL_DEGREES || t == 0.0 || t.is_nan() {
        return t;
    }
    let tail = StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |law| law.cdf(-t.abs()));
    // Beyond what a number can hold, the score stays finite.
    t.signum() * SQRT_2 * erfc_inv((2.0 * tail).max(1e-300))
}

/// The value of Student's t that is exceeded with this two-sided probability.
#[must_use]
pub(crate) fn critical_t(p: f64, freedom: f64) -> f64 {
    if freedom >= NORMAL_DEGREES {
        return SQRT_2 * erfc_inv(p);
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |law| -law.inverse_cdf(0.5 * p))
}

/// Probability that χ² with these degrees of freedom is at least this large.
#[must_use]
pub fn chi_square_p(chi: f64, freedom: f64) -> f64 {
    ChiSquared::new(freedom).map_or(f64::NAN, |law| law.sf(chi))
}

/// What many scores say of mean 0 and variance 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suite {
    /// Number of scores.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Their variance about 0.
    pub variance: f64,
    /// Probability of a mean as far from 0.
    pub mean_p: f64,
    /// Two-sided probability of Σ z², χ² with as many degrees of freedom as there are scores.
    pub variance_p: f64,
}

impl Suite {
    /// Of independent scores.
    #[must_use]
    pub fn new(scores: &[f64]) -> Self {
        let n = scores.len() as f64;
        let mean = scores.iter().sum::<f64>() / n;
        let chi: f64 = scores.iter().map(|z| z * z).sum();
        let above = chi_square_p(chi, n);
        Self {
            count: scores.len(),
            mean,
            variance: chi / n,
            mean_p: two_sided_p(mean * n.sqrt()),
            variance_p: (2.0 * above.min(1.0 - above)).min(1.0),
        }
    }

    /// χ² of the counts of ten equally likely intervals: whether the scores are normal.
    #[must_use]
    pub fn shape_p(scores: &[f64]) -> f64 {
        let law = Normal::standard();
        let mut counts = [0.0; 10];
        for &z in scores {
            counts[((law.cdf(z) * 10.0) as usize).min(9)] += 1.0;
        }
        let expected = scores.len() as f64 / 10.0;
        let chi: f64 = counts.iter().map(|n: &f64| (n - expected).powi(2) / expected).sum();
        chi_square_p(chi, 9.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, tables 26.1, 26.8
    /// and 26.10.
    #[test]
    fn probabilities_are_those_of_the_tables() {
        for (z, p) in [(1.959_964, 0.05), (2.575_829, 0.01), (3.890_592, 1e-4)] {
            assert!((two_sided_p(z) / p - 1.0).abs() < 1e-5);
            assert!((normal_score(z, 1e9) - z).abs() < 1e-12);
        }
        for (t, freedom, z) in
            [(2.262_157, 9.0, 1.959_964), (2.744_042, 31.0, 2.575_829), (12.706_205, 1.0, 1.959_964)]
        {
            assert!((normal_score(t, freedom) - z).abs() < 1e-5, "{}", normal_score(t, freedom));
            assert!((normal_score(-t, freedom) + z).abs() < 1e-5);
        }
        assert!((chi_square_p(18.307_038, 10.0) - 0.05).abs() < 1e-8);
        assert!(normal_score(1e300, 31.0).is_finite() && normal_score(f64::NAN, 3.0).is_nan());
    }

    #[test]
    fn bounds_are_where_the_probabilities_are() {
        for (p, freedom) in [(0.01, 31.0), (1e-6, 31.0), (0.05, 1.0), (1e-4, 1e9)] {
            let bound = critical_t(p, freedom);
            assert!(
                (two_sided_p(normal_score(bound, freedom)) / p - 1.0).abs() < 1e-6,
                "{p} {freedom}: {bound}"
            );
        }
    }

    #[test]
    fn a_shift_and_a_spread_are_seen() {
        let law = Normal::standard();
        let even: Vec<f64> = (0..1000).map(|i| law.inverse_cdf((f64::from(i) + 0.5) / 1000.0)).collect();
        let sound = Suite::new(&even);
        assert!(sound.mean_p > 0.5 && sound.variance_p > 0.5 && Suite::shape_p(&even) > 0.5, "{sound:?}");
        let shifted: Vec<f64> = even.iter().map(|z| z + 0.15).collect();
        let spread: Vec<f64> = even.iter().map(|z| z * 1.15).collect();
        assert!(Suite::new(&shifted).mean_p < 1e-4);
        assert!(Suite::new(&spread).variance_p < 1e-4 && Suite::new(&spread).mean_p > 0.5);
    }
}
