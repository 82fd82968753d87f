//! Many tests at once: which of them are significant.
//!
//! Holm: the k-th smallest of n probabilities is compared with α/(n − k + 1), from the smallest on
//! until one fails; the probability of any false alarm is at most α whatever depends on what (S.
//! Holm, Scand. J. Stat. 6 (1979) 65). Benjamini and Hochberg: up to the last k with p_k ≤ α k/n;
//! the expected share of false alarms is at most α (J. R. Stat. Soc. B 57 (1995) 289,
//! doi:10.1111/j.2517-6161.1995.tb02031.x).

use serde::{Deserialize, Serialize};

/// How many tests are taken into account.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Correction {
    /// The chance of any false alarm is at most α.
    #[default]
    Holm,
    /// The expected share of false alarms is at most α.
    BenjaminiHochberg,
}

impl Correction {
    /// The name it is asked for by.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Holm => "holm",
            Self::BenjaminiHochberg => "benjamini-hochberg",
        }
    }

    /// Which of the probabilities are significant at the level `alpha`.
    #[must_use]
    pub fn significant(self, probabilities: &[f64], alpha: f64) -> Vec<bool> {
        let n = probabilities.len();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&i, &j| probabilities[i].total_cmp(&probabilities[j]));
        let passes = |k: usize| match self {
            Self::Holm => probabilities[order[k]] <= alpha / (n - k) as f64,
            Self::BenjaminiHochberg => probabilities[order[k]] <= alpha * (k + 1) as f64 / n as f64,
        };
        let count = match self {
            Self::Holm => (0..n).take_while(|&k| passes(k)).count(),
            Self::BenjaminiHochberg => (0..n).rev().find(|&k| passes(k)).map_or(0, |k| k + 1),
        };
        let mut significant = vec![false; n];
        order[..count].iter().for_each(|&i| significant[i] = true);
        significant
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fifteen probabilities of the paper of Benjamini and Hochberg, § 4: four are found at 5
    /// %, three by Bonferroni and by Holm.
    #[test]
    fn the_example_of_the_paper_comes_out() {
        let p = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719,
            0.6528, 0.7590, 1.0,
        ];
        let count = |correction: Correction| correction.significant(&p, 0.05).iter().filter(|s| **s).count();
        assert_eq!((count(Correction::Holm), count(Correction::BenjaminiHochberg)), (3, 4));
        assert!(Correction::Holm.significant(&[], 0.05).is_empty());
    }
}
