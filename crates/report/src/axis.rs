//! Axes of a plot: where a value stands, which ticks to draw and how to label them.

/// A linear axis from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Linear {
    high: f64,
    step: f64,
}

impl Linear {
    /// An axis that holds the finite values among those given, with about five ticks, `least` apart at the closest.
    pub(crate) fn new(values: &[f64], least: f64) -> Self {
        let high = values.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
        let high = if high > 0.0 { high } else { least.max(1e-3) };
        let step = round_step(high / 5.0).max(least);
        Self { high: high.max(step), step }
    }

    /// Place of a value, from 0 to 1.
    pub(crate) fn place(&self, x: f64) -> f64 {
        (x / self.high).clamp(0.0, 1.0)
    }

    /// Ticks: place and label.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let count = (self.high / self.step * (1.0 + 1e-12)).floor() as usize;
        let decimals = (-self.step.log10().floor()).max(0.0) as usize;
        (0..=count).map(|i| i as f64 * self.step).map(|x| (self.place(x), label(x, decimals))).collect()
    }
}

fn label(x: f64, decimals: usize) -> String {
    if x != 0.0 && (decimals > 4 || x >= 1e6) { format!("{x:.1e}") } else { format!("{x:.decimals$}") }
}

/// The smallest of 1, 2, 5 × a power of ten that is not below `x`.
fn round_step(x: f64) -> f64 {
    let power = 10.0_f64.powf(x.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    steps.iter().map(|step| step * power).find(|step| *step >= x * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

/// A logarithmic axis over whole decades.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Decades {
    low: i32,
    high: i32,
}

impl Decades {
    /// An axis that holds the given values, which must be above 0.
    pub(crate) fn new(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) =
            values.map(f64::log10).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min((x + 1e-9).floor()), high.max((x - 1e-9).ceil()))
            });
        if low > high { Self { low: -1, high: 0 } } else { Self::span(low as i32, high as i32) }
    }

    fn span(low: i32, high: i32) -> Self {
        Self { low: if low == high { low - 1 } else { low }, high }
    }

    /// Place of a value, from 0 to 1.
    pub(crate) fn place(self, y: f64) -> f64 {
        ((y.log10() - f64::from(self.low)) / f64::from(self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Ticks: place and label.
    pub(crate) fn ticks(self) -> Vec<(f64, String)> {
        let step = (self.high - self.low + 8) / 9;
        let place = |k: i32| f64::from(k - self.low) / f64::from(self.high - self.low);
        let aligned = (self.low..=self.high).filter(|k| k % step.max(1) == 0);
        aligned.map(|k| (place(k), power_of_ten(k))).collect()
    }
}

/// 10 with a raised exponent.
fn power_of_ten(exponent: i32) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    "10".chars().chain(exponent.to_string().chars().map(raised)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_ticks_are_round() {
        let axis = Linear::new(&[0.0, 43.0, f64::NAN, 7.0], 1.0);
        let labels: Vec<String> = axis.ticks().into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["0", "10", "20", "30", "40"]);
        assert!((axis.place(21.5) - 0.5).abs() < 1e-15);
        let short = Linear::new(&[0.034], 0.0).ticks();
        assert_eq!(short.last().unwrap().1, "0.03");
        assert_eq!(Linear::new(&[2.0], 1.0).ticks().len(), 3);
    }

    #[test]
    fn nothing_to_show_still_makes_an_axis() {
        for axis in [Linear::new(&[], 1.0), Linear::new(&[0.0, f64::INFINITY], 0.0)] {
            assert!(axis.ticks().len() >= 2 && axis.place(0.0) == 0.0);
        }
        assert_eq!(Decades::new([].into_iter()), Decades { low: -1, high: 0 });
        assert_eq!(Decades::new([1.0].into_iter()), Decades { low: -1, high: 0 });
    }

    #[test]
    fn decades_hold_their_values() {
        let axis = Decades::new([1.0, 3e-7, 1e-6].into_iter());
        assert_eq!(axis, Decades { low: -7, high: 0 });
        assert!((axis.place(1e-7)).abs() < 1e-12 && (axis.place(1.0) - 1.0).abs() < 1e-12);
        assert_eq!(axis.ticks().len(), 8);
        assert_eq!((axis.ticks()[0].1.as_str(), axis.ticks()[7].1.as_str()), ("10⁻⁷", "10⁰"));
        assert!(Decades::new([1e4, 1e-17].into_iter()).ticks().len() <= 10);
    }
}
