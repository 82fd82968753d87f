//! Newton–Cotes rules: n equally spaced points, degree n − 1, or n where n is odd.
//!
//! P. J. Davis, P. Rabinowitz, *Methods of Numerical Integration*, 2nd ed., Academic Press 1984,
//! section 2.5. The weights are wᵢ = (1/L) ∫₀ᴸ Πⱼ≠ᵢ (t − tⱼ)/(tᵢ − tⱼ) dt with integer nodes tⱼ.
//! They are rational, and are found in integers, so that only the last division rounds. Some are
//! negative for 9 points (open: 3) and for most counts beyond; Σ|wᵢ| then grows without bound, and
//! the rounding with it.

use crate::{IntervalRule, RuleError};

/// Most points of a closed rule; Σ|wᵢ| is 7.5 there.
const MOST_CLOSED: usize = 13;
/// Most points of an open rule; Σ|wᵢ| is 30 there.
const MOST_OPEN: usize = 9;

/// The closed rule, both ends among its `points`: trapezoid (2), Simpson (3), Boole (5).
///
/// # Errors
/// [`RuleError::PointCount`] unless there are 2 to 13 points.
///
/// ```
/// let simpson = fredholm_quadrature::newton_cotes_closed(3)?;
/// assert_eq!(simpson.weights, [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]);
/// # Ok::<(), fredholm_quadrature::RuleError>(())
/// ```
pub fn newton_cotes_closed(points: usize) -> Result<IntervalRule, RuleError> {
    check(points, 2, MOST_CLOSED)?;
    Ok(equally_spaced(0, points, points - 1))
}

/// The open rule, without the ends: midpoint (1), and `points` at i / (points + 1) in general.
///
/// # Errors
/// [`RuleError::PointCount`] unless there are 1 to 9 points.
///
/// ```
/// let rule = fredholm_quadrature::newton_cotes_open(2)?;
/// assert_eq!(rule.points, [1.0 / 3.0, 2.0 / 3.0]);
/// # Ok::<(), fredholm_quadrature::RuleError>(())
/// ```
pub fn newton_cotes_open(points: usize) -> Result<IntervalRule, RuleError> {
    check(points, 1, MOST_OPEN)?;
    Ok(equally_spaced(1, points, points + 1))
}

fn check(points: usize, lowest: usize, highest: usize) -> Result<(), RuleError> {
    if (lowest..=highest).contains(&points) {
        return Ok(());
    }
    Err(RuleError::PointCount { points, lowest, highest })
}

/// Nodes first, first + 1, … on [0, length], scaled to [0, 1].
fn equally_spaced(first: usize, n: usize, length: usize) -> IntervalRule {
    let nodes: Vec<i128> = (first..first + n).map(|t| t as i128).collect();
    let points = nodes.iter().map(|&t| t as f64 / length as f64).collect();
    let weights = (0..n).map(|i| weight(&nodes, i, length as i128)).collect();
    IntervalRule { points, weights, degree: if n % 2 == 1 { n } else { n - 1 } }
}

/// (1/L) ∫₀ᴸ of the Lagrange polynomial of node i: Σₖ cₖ Lᵏ / (k + 1) over one common denominator.
fn weight(nodes: &[i128], i: usize, length: i128) -> f64 {
    let others = || nodes.iter().enumerate().filter(|&(j, _)| j != i).map(|(_, &t)| t);
    let common = (1..=nodes.len() as i128).fold(1, least_common_multiple);
    let (mut sum, mut power) = (0, 1);
    for (k, c) in expand(others()).into_iter().enumerate() {
        sum += c * power * (common / (k as i128 + 1));
        power *= length;
    }
    let denominator = common * others().map(|t| nodes[i] - t).product::<i128>();
    sum as f64 / denominator as f64
}

/// Coefficients of Π (t − root), constant first.
fn expand(roots: impl Iterator<Item = i128>) -> Vec<i128> {
    let mut coefficients = vec![1];
    for root in roots {
        let mut next = vec![0; coefficients.len() + 1];
        for (k, c) in coefficients.into_iter().enumerate() {
            next[k] -= root * c;
            next[k + 1] += c;
        }
        coefficients = next;
    }
    coefficients
}

fn least_common_multiple(a: i128, b: i128) -> i128 {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a / x * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exactness::interval_degree;

    #[test]
    fn every_closed_rule_has_its_degree_and_no_more() {
        for n in 2..=MOST_CLOSED {
            interval_degree(&newton_cotes_closed(n).unwrap());
        }
    }

    #[test]
    fn every_open_rule_has_its_degree_and_no_more() {
        for n in 1..=MOST_OPEN {
            interval_degree(&newton_cotes_open(n).unwrap());
        }
    }

    #[test]
    fn agrees_with_the_published_weights() {
        let boole = [7.0, 32.0, 12.0, 32.0, 7.0].map(|w| w / 90.0);
        assert_eq!(newton_cotes_closed(5).unwrap().weights, boole);
        let milne = [2.0, -1.0, 2.0].map(|w| w / 3.0);
        assert_eq!(newton_cotes_open(3).unwrap().weights, milne);
    }

    #[test]
    fn refuses_what_rounding_would_spoil() {
        assert_eq!(
            newton_cotes_closed(1),
            Err(RuleError::PointCount { points: 1, lowest: 2, highest: MOST_CLOSED })
        );
        assert!(newton_cotes_open(0).is_err() && newton_cotes_open(MOST_OPEN + 1).is_err());
    }
}
