//! An axis: what it holds, where a value stands, and which numbers it names.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;

use crate::words::{number, raised};

/// Value that stands for 0 on a logarithmic axis.
pub(crate) const SMALLEST_ON_LOG_AXIS: f64 = 1e-17;

/// How an axis comes from its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Span {
    /// From the smallest to the largest value, and 0.
    WithZero,
    /// From the smallest to the largest value.
    Tight,
    /// Over decades; what is smaller than [`SMALLEST_ON_LOG_AXIS`] stands there.
    Decades,
}

/// An axis from `from` to `to`, which may lie either way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    from: f64,
    to: f64,
    logarithmic: bool,
    ticks: Vec<f64>,
}

impl Scale {
    /// An axis with ticks at round numbers.
    pub(crate) fn linear(from: f64, to: f64) -> Self {
        let to = if (to - from).is_normal() { to } else { from + from.abs().max(1.0) };
        Self { from, to, logarithmic: false, ticks: Vec::new() }
    }

    /// An axis with ticks at the given numbers.
    pub(crate) fn with_ticks(from: f64, to: f64, ticks: &[f64]) -> Self {
        Self { from, to, logarithmic: false, ticks: ticks.to_vec() }
    }

    /// A logarithmic axis with ticks at the given numbers.
    pub(crate) fn decades_with_ticks(from: f64, to: f64, ticks: &[f64]) -> Self {
        Self { ticks: ticks.to_vec(), ..Self::decades(from, to) }
    }

    /// A logarithmic axis.
    pub(crate) fn decades(from: f64, to: f64) -> Self {
        let (from, to) = (from.max(SMALLEST_ON_LOG_AXIS), to.max(SMALLEST_ON_LOG_AXIS));
        let to = if to > from { to } else { 10.0 * from };
        Self { from, to, logarithmic: true, ticks: round_logarithmic(from, to) }
    }

    /// The axis that holds the finite ones of some values.
    pub(crate) fn holding(values: impl Iterator<Item = f64>, span: Span) -> Self {
        let floor = |v: f64| if span == Span::Decades { v.abs().max(SMALLEST_ON_LOG_AXIS) } else { v };
        let start = if span == Span::WithZero { (0.0, 0.0) } else { (f64::INFINITY, f64::NEG_INFINITY) };
        let values = values.filter(|v| v.is_finite()).map(floor);
        let (low, high) = values.fold(start, |(low, high), v| (low.min(v), high.max(v)));
        match span {
            _ if low > high => Self::holding([0.1, 1.0].into_iter(), span),
            Span::Decades => {
                // Whole decades, unless there are few.
                let (low, high) = (low.log10(), high.log10());
                let step = if high - low < 1.5 { 0.25 } else { 1.0 };
                let (from, to) = ((low / step + 1e-9).floor() * step, (high / step - 1e-9).ceil() * step);
                Self::decades(10.0_f64.powf(from), 10.0_f64.powf(if to > from { to } else { from + 1.0 }))
            }
            Span::WithZero => Self::linear(low * 1.04, if high > low { high * 1.04 } else { 1.0 }),
            Span::Tight => Self::linear(low, high),
        }
    }

    /// A value as near as the axis has it.
    pub(crate) fn clamped(&self, value: f64) -> f64 {
        let value = if self.logarithmic { value.abs().max(SMALLEST_ON_LOG_AXIS) } else { value };
        value.clamp(self.from.min(self.to), self.from.max(self.to))
    }

    /// Place of a value from 0 at the beginning to 1 at the end.
    pub(crate) fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }

    /// A little more room at both ends.
    pub(crate) fn widened(mut self, share: f64) -> Self {
        let more = share * (self.to - self.from);
        if !self.logarithmic {
            (self.from, self.to) = (self.from - more, self.to + more);
        }
        self
    }
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten of which so many parts reach `top`, above 0.
pub(crate) fn round_step(top: f64, parts: f64) -> f64 {
    let power = 10.0_f64.powf((top / parts).log10().floor());
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|m| m * power);
    steps.into_iter().find(|step| parts * step >= top * (1.0 - 1e-9)).unwrap_or(top)
}

/// Powers of ten, about nine of them at most; where there are less than two decades, 2 and 5 times
/// them as well.
fn round_logarithmic(from: f64, to: f64) -> Vec<f64> {
    let (low, high) = ((from.log10() - 1e-9).ceil() as i32, (to.log10() + 1e-9).floor() as i32);
    let multiples: &[f64] = if to / from < 99.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let step = ((high - low + 8) / 9).max(1);
    let powers = (low - 1..=high).filter(|k| k % step == 0);
    let inside = |v: &f64| *v >= from * (1.0 - 1e-9) && *v <= to * (1.0 + 1e-9);
    powers.flat_map(|k| multiples.iter().map(move |m| m * 10.0_f64.powi(k))).filter(inside).collect()
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (low, high): (i32, i32)) -> i32 {
        low + (self.place(*value) * f64::from(high - low)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        if !self.ticks.is_empty() {
            return self.ticks.clone();
        }
        RangedCoordf64::from(self.from.min(self.to)..self.from.max(self.to)).key_points(hint)
    }

    fn range(&self) -> Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for Scale {
    fn format(value: &f64) -> String {
        number(*value)
    }

    fn format_ext(&self, value: &f64) -> String {
        let exponent = value.log10().round();
        let wide = self.logarithmic && (self.to / self.from).abs() >= 99.0;
        if wide && (value / 10.0_f64.powf(exponent) - 1.0).abs() < 1e-6 {
            return format!("10{}", raised(exponent as i32));
        }
        // Sums of steps leave some rounding where 0 is meant.
        number(if value.abs() < 1e-9 * (self.to - self.from).abs() { 0.0 } else { *value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::coord::ranged1d::BoldPoints;

    fn labels(scale: &Scale) -> Vec<String> {
        scale.key_points(BoldPoints(6)).iter().map(|v| scale.format_ext(v)).collect()
    }

    #[test]
    fn ticks_are_round_and_stand_where_they_belong() {
        let axis = Scale::holding([0.0, 43.0, f64::NAN, 7.0].into_iter(), Span::WithZero);
        assert_eq!(labels(&axis), ["0", "10", "20", "30", "40"]);
        let axis = Scale::holding([3e-7, 1.0].into_iter(), Span::Decades);
        assert_eq!((labels(&axis)[0].as_str(), labels(&axis).len()), ("10⁻⁷", 8));
        assert!((axis.place(1e-7)).abs() < 1e-12 && (axis.place(1.0) - 1.0).abs() < 1e-12);
        assert!(labels(&Scale::holding([1e4, 0.0].into_iter(), Span::Decades)).len() <= 10);
        let near = Scale::holding([0.11, 0.44].into_iter(), Span::Decades);
        assert_eq!(labels(&near), ["0.1", "0.2", "0.5"]);
        assert_eq!((near.map(&0.1, (0, 100)), axis.map(&1e-7, (10, 0))), (0, 10));
    }

    #[test]
    fn nothing_to_show_still_makes_an_axis() {
        for span in [Span::WithZero, Span::Tight, Span::Decades] {
            for values in [&[][..], &[0.0, f64::INFINITY], &[2.5]] {
                let axis = Scale::holding(values.iter().copied(), span);
                assert!(axis.range().start < axis.range().end, "{axis:?}");
                assert!(!labels(&axis).is_empty(), "{axis:?}");
            }
        }
    }
}
