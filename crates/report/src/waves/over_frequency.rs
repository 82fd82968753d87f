//! Levels over the frequency: `NAME_over_frequency.svg`.

use std::io::{self, Write};

use crate::plot::{Axis, Figure, Line, Panel, Part, Span, write_svg};

/// Levels further below the largest are at the lower edge, dB.
const DECIBELS_SHOWN: f64 = 80.0;
/// From so many hertz on the axis is in gigahertz.
const LEAST_IN_GIGAHERTZ: f64 = 1e10;

/// A level at every frequency of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyLine {
    /// What it is called in the legend.
    pub name: String,
    /// Levels, dB; what is not finite is left out.
    pub levels: Vec<f64>,
}

/// Frequencies in a unit that suits them, and its name.
#[must_use]
pub fn scaled_frequencies(frequencies: &[f64]) -> (Vec<f64>, &'static str) {
    let top = frequencies.iter().copied().fold(0.0, f64::max);
    let (scale, name) = if top >= LEAST_IN_GIGAHERTZ { (1e9, "GHz") } else { (1e6, "MHz") };
    (frequencies.iter().map(|frequency| frequency / scale).collect(), name)
}

/// Draws levels over frequencies (Hz); `up` names quantity and unit.
///
/// # Errors
/// What `out` reports.
pub fn write_frequency_plot(
    title: &str,
    up: &str,
    frequencies: &[f64],
    lines: &[FrequencyLine],
    out: &mut dyn Write,
) -> io::Result<()> {
    let (frequencies, unit) = scaled_frequencies(frequencies);
    let line = |(number, line): (usize, &FrequencyLine)| {
        let points = frequencies.iter().copied().zip(line.levels.iter().copied());
        Line { shape: number % 4, ..Line::distinct(&line.name, points.collect(), number) }
    };
    let across = Axis::new(&format!("frequency, {unit}"), Span::Tight);
    let lines = lines.iter().enumerate().map(line).collect();
    let panel = Panel { reach: DECIBELS_SHOWN, ..Panel::new(across, Axis::new(up, Span::Tight), lines) };
    write_svg(&Figure { title: title.to_owned(), parts: vec![Part::Panel(panel)] }, out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::{curves, texts};

    fn drawn(frequencies: &[f64], levels: Vec<f64>) -> String {
        let line = FrequencyLine { name: "θ < 90".to_owned(), levels };
        let mut out = Vec::new();
        write_frequency_plot("a & b", "σ, dBsm", frequencies, &[line], &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn the_ends_of_the_sweep_are_the_ends_of_the_line() {
        let text = drawn(&[1e9, 1.5e9, 2e9], vec![-10.0, f64::NAN, 10.0]);
        let lines = curves(&text);
        assert_eq!((lines.len(), lines[0].len()), (1, 2));
        assert!(lines[0][1].0 > lines[0][0].0 + 3000.0 && lines[0][1].1 < lines[0][0].1 - 2000.0);
        let texts = texts(&text);
        assert!(["frequency, MHz", "σ, dBsm", "1400"].iter().all(|label| texts.iter().any(|t| t == label)));
    }

    #[test]
    fn nothing_and_one_frequency_are_drawn() {
        for levels in [vec![], vec![f64::NEG_INFINITY], vec![3.0]] {
            let text = drawn(&[2e10], levels);
            assert!(text.contains("GHz") && !text.contains("NaN") && text.ends_with("</svg>\n"));
        }
    }
}
