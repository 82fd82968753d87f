//! Richardson's extrapolation: A(h) = A + c₁ h^p₁ + c₂ h^p₂ + … is combined over h, h/r, h/r², … to
//! cancel the terms in turn, Tₖⱼ = Tₖ,ⱼ₋₁ + (Tₖ,ⱼ₋₁ − Tₖ₋₁,ⱼ₋₁) / (r^pⱼ − 1).
//!
//! L. F. Richardson, J. A. Gaunt, Phil. Trans. R. Soc. A 226 (1927) 299,
//! doi:10.1098/rsta.1927.0008.

use crate::Estimate;

/// The limit of `values` = A(h), A(h/r), A(h/r²), …, r = `ratio` > 1, whose error has the
/// `exponents` p₁ < p₂
/// < …; k + 1 values cancel the first k terms. The error is the step that the last value brought; it is
/// infinite for fewer than two.
///
/// ```
/// // Half the perimeters of regular polygons in the unit circle.
/// use std::f64::consts::PI;
/// let halves = [6.0, 12.0, 24.0, 48.0].map(|n: f64| n * (PI / n).sin());
/// let got = fredholm_quadrature::richardson(&halves, 2.0, &[2.0, 4.0, 6.0]);
/// assert!((got.value - PI).abs() < 1e-10);
/// ```
#[must_use]
pub fn richardson(values: &[f64], ratio: f64, exponents: &[f64]) -> Estimate {
    let mut row: Vec<f64> = Vec::with_capacity(values.len());
    let mut estimate = Estimate { value: 0.0, error: f64::INFINITY };
    for &value in values {
        let before = row.last().copied();
        extend(&mut row, value, ratio, exponents);
        let last = row.last().copied().unwrap_or(value);
        estimate = Estimate { value: last, error: before.map_or(f64::INFINITY, |b| (last - b).abs()) };
    }
    estimate
}

/// Replaces row k − 1 of the tableau by row k, which starts with `value`.
pub(crate) fn extend(row: &mut Vec<f64>, value: f64, ratio: f64, exponents: &[f64]) {
    let mut entry = value;
    for (above, exponent) in row.iter_mut().zip(exponents) {
        let next = entry + (entry - *above) / (ratio.powf(*exponent) - 1.0);
        *above = entry;
        entry = next;
    }
    if row.len() <= exponents.len() {
        row.push(entry);
    } else if let Some(last) = row.last_mut() {
        *last = entry;
    }
}

#[cfg(test)]
mod tests {
    use super::richardson;

    #[test]
    fn cancels_exactly_the_terms_it_is_told() {
        let series = |h: f64| 3.0 + 2.0 * h - 5.0 * h * h + 7.0 * h.powi(3);
        let values = [series(1.0), series(0.5), series(0.25), series(0.125)];
        assert!((richardson(&values, 2.0, &[1.0, 2.0, 3.0]).value - 3.0).abs() < 1e-14);
        assert!((richardson(&values, 2.0, &[1.0, 2.0]).value - 3.0).abs() > 1e-3);
    }

    #[test]
    fn handles_fractional_exponents_and_other_ratios() {
        let series = |h: f64| 1.0 + h.sqrt() - h.powf(1.5);
        let values = [series(1.0), series(1.0 / 3.0), series(1.0 / 9.0)];
        assert!((richardson(&values, 3.0, &[0.5, 1.5]).value - 1.0).abs() < 1e-14);
    }

    #[test]
    fn without_a_second_value_it_vouches_for_nothing() {
        assert!(richardson(&[], 2.0, &[2.0]).error.is_infinite());
        assert!(richardson(&[4.0], 2.0, &[2.0]).error.is_infinite());
    }
}
