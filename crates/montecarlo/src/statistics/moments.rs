//! Mean and variance of vectors in one pass, and their merging.
//!
//! δ = x − m, m ← m + δ/n, S ← S + δ (x − m); two parts merge by S = S_a + S_b + δ² n_a n_b/n (B.
//! P. Welford, Technometrics 4 (1962) 419, doi:10.1080/00401706.1962.10490022; T. F. Chan, G. H.
//! Golub, R. J. LeVeque, Am. Stat. 37 (1983) 242, doi:10.1080/00031305.1983.10483115). The standard
//! error of the mean is √(S/(n (n − 1))). In the unit of the values.

use serde::{Deserialize, Serialize};

/// Running means and sums of squares of vectors.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    count: u64,
    #[serde(with = "bits")]
    mean: Vec<f64>,
    #[serde(with = "bits")]
    squares: Vec<f64>,
}

impl Moments {
    /// No vectors of `len` values yet.
    #[must_use]
    pub fn new(len: usize) -> Self {
        Self { count: 0, mean: vec![0.0; len], squares: vec![0.0; len] }
    }

    /// Takes a vector; what is longer than the others is cut.
    pub fn push(&mut self, values: &[f64]) {
        self.count += 1;
        let n = self.count as f64;
        for ((mean, squares), value) in self.mean.iter_mut().zip(&mut self.squares).zip(values) {
            let delta = value - *mean;
            *mean += delta / n;
            *squares += delta * (value - *mean);
        }
    }

    /// Takes what another one has taken.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (a, b) = (self.count as f64, other.count as f64);
        self.count += other.count;
        let theirs = other.mean.iter().zip(&other.squares);
        for ((mean, squares), (m, s)) in self.mean.iter_mut().zip(&mut self.squares).zip(theirs) {
            let delta = m - *mean;
            *mean += delta * b / (a + b);
            *squares += s + delta * delta * a * b / (a + b);
        }
    }

    /// Number of vectors.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Length of the vectors.
    #[must_use]
    pub fn len(&self) -> usize {
        self.mean.len()
    }

    /// Whether the vectors are empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mean.is_empty()
    }

    /// The means.
    #[must_use]
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Variances of single vectors; infinite below two.
    #[must_use]
    pub fn variances(&self) -> Vec<f64> {
        let freedom = self.count.saturating_sub(1) as f64;
        let variance = |s: &f64| if freedom > 0.0 { s / freedom } else { f64::INFINITY };
        self.squares.iter().map(variance).collect()
    }

    /// Standard errors of the means; infinite below two vectors.
    #[must_use]
    pub fn standard_errors(&self) -> Vec<f64> {
        let n = self.count.max(1) as f64;
        self.variances().into_iter().map(|variance| (variance / n).sqrt()).collect()
    }
}

/// Numbers as their bits, so that a state reads back as it was.
pub(crate) mod bits {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(crate) fn serialize<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
        out.collect_seq(values.iter().map(|value| value.to_bits()))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<f64>, D::Error> {
        Ok(Vec::<u64>::deserialize(source)?.into_iter().map(f64::from_bits).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pass_agrees_with_two() {
        // Integers about a large offset: the two-pass sums are exact.
        let values: Vec<[f64; 2]> = (0..100).map(|i| [1e8 + f64::from(i * 37 % 11), f64::from(i)]).collect();
        let (mut all, mut parts) = (Moments::new(2), [Moments::new(2), Moments::new(2)]);
        for (i, value) in values.iter().enumerate() {
            all.push(value);
            parts[usize::from(i >= 30)].push(value);
        }
        let [mut first, second] = parts;
        first.merge(&second);
        for moments in [&all, &first] {
            for axis in 0..2 {
                let mean = values.iter().map(|v| v[axis]).sum::<f64>() / 100.0;
                let variance = values.iter().map(|v| (v[axis] - mean).powi(2)).sum::<f64>() / 99.0;
                assert!((moments.mean()[axis] / mean - 1.0).abs() < 1e-14);
                assert!((moments.standard_errors()[axis] / (variance / 100.0).sqrt() - 1.0).abs() < 1e-9);
            }
        }
        assert_eq!(Moments::new(1).standard_errors(), [f64::INFINITY]);
    }
}
