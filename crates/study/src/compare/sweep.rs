//! The reflectances of a sweep.

use std::ops::Range;

/// Values where their number is not given.
const USUAL_VALUES: usize = 10;
/// Most values.
const MOST_VALUES: usize = 100;

/// Evenly spaced reflectances from the start of a range to its end, both of which are among them:
/// 10 where `count` says nothing. There are none unless 0 < start < end < 1, and for fewer than 2
/// or more than 100.
///
/// ```
/// assert_eq!(fredholm_study::reflectance_sweep(0.25..0.75, Some(3)), Some(vec![0.25, 0.5, 0.75]));
/// assert_eq!(fredholm_study::reflectance_sweep(0.5..1.0, None), None);
/// ```
#[must_use]
pub fn reflectance_sweep(Range { start, end }: Range<f64>, count: Option<usize>) -> Option<Vec<f64>> {
    let count = count.unwrap_or(USUAL_VALUES);
    if !(0.0 < start && start < end && end < 1.0 && (2..=MOST_VALUES).contains(&count)) {
        return None;
    }
    let step = (end - start) / (count - 1) as f64;
    let value = |i: usize| if i + 1 == count { end } else { start + i as f64 * step };
    Some((0..count).map(value).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_evenly_spaced_and_end_exactly() {
        let values = reflectance_sweep(0.1..0.9, Some(5)).unwrap();
        let exact = [0.1, 0.3, 0.5, 0.7, 0.9];
        assert!(values.iter().zip(exact).all(|(value, exact)| (value - exact).abs() < 1e-15));
        assert_eq!(values.last(), Some(&0.9));
        assert_eq!(reflectance_sweep(0.1..0.99, None).unwrap().len(), USUAL_VALUES);
        for (range, count) in [(0.0..0.5, None), (0.9..0.1, None), (0.1..1.0, None), (0.1..0.9, Some(1))] {
            assert_eq!(reflectance_sweep(range, count), None);
        }
    }
}
