//! Levels over the frequency: `NAME_over_frequency.svg`.

use std::io::{self, Write};

use crate::palette::line_colour;
use crate::svg::{Point, Svg};

/// Size of the drawing, and of the panel in it, pixels.
const SIZE: Point = (940.0, 470.0);
const PANEL: Point = (620.0, 350.0);
/// Left and upper edge of the panel, pixels.
const CORNER: Point = (82.0, 54.0);
/// Levels further below the largest are at the lower edge.
const SPAN: f64 = 80.0;
/// Ticks of an axis, about.
const TICKS: f64 = 6.0;
/// Above so many hertz the axis is in gigahertz.
const GIGAHERTZ: f64 = 1e10;

/// A level at every frequency of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyLine {
    /// What it is called in the legend.
    pub name: String,
    /// Levels, dB; what is not finite is left out.
    pub levels: Vec<f64>,
}

/// An axis from `low` to `high`.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn new(low: f64, high: f64) -> Self {
        if high > low { Self { low, high } } else { Self { low: low - 0.5, high: low + 0.5 } }
    }

    fn place(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Multiples of 1, 2 or 5 times a power of ten within the axis.
    fn ticks(&self) -> Vec<(f64, String)> {
        let rough = (self.high - self.low) / TICKS;
        let power = 10.0_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * power).into_iter().find(|s| *s >= rough);
        let step = step.unwrap_or(rough);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        let tick = |i: i64| (i as f64 * step, format!("{:.decimals$}", i as f64 * step));
        (first..=last).map(tick).collect()
    }
}

/// Draws levels (dB, of `unit`) over frequencies (Hz).
///
/// # Errors
/// What `out` reports.
pub fn write_frequency_plot(
    title: &str,
    unit: &str,
    frequencies: &[f64],
    lines: &[FrequencyLine],
    out: &mut dyn Write,
) -> io::Result<()> {
    let top = frequencies.iter().copied().fold(0.0, f64::max);
    let (scale, name) = if top >= GIGAHERTZ { (1e9, "GHz") } else { (1e6, "MHz") };
    let bottom = frequencies.iter().copied().fold(f64::INFINITY, f64::min);
    let across = Axis::new(bottom / scale, top / scale);
    let levels = || lines.iter().flat_map(|line| &line.levels).copied().filter(|level| level.is_finite());
    let high = levels().fold(f64::NEG_INFINITY, f64::max);
    let low = levels().fold(high, f64::min).max(high - SPAN);
    let up = if high.is_finite() { Axis::new(low, high) } else { Axis::new(-1.0, 0.0) };
    let mut svg = Svg::new(SIZE);
    svg.text((CORNER.0, 32.0), "font-size=\"16\"", title);
    frame(&mut svg, &across, &up, (&format!("frequency, {name}"), unit));
    let names: Vec<String> = lines.iter().map(|line| line.name.clone()).collect();
    for (number, line) in lines.iter().enumerate() {
        let colour = line_colour(&names, number);
        let known = frequencies.iter().zip(&line.levels).filter(|(_, level)| level.is_finite());
        let points: Vec<Point> = known.map(|(f, level)| point(&across, &up, f / scale, *level)).collect();
        svg.polyline(&points, &colour);
        let y = CORNER.1 + 8.0 + 18.0 * number as f64;
        let left = CORNER.0 + PANEL.0 + 18.0;
        svg.line((left, y), (left + 20.0, y), &format!("stroke=\"{colour}\" stroke-width=\"2.5\""));
        svg.text((left + 27.0, y + 4.5), "font-size=\"12\"", &line.name);
    }
    out.write_all(svg.finish().as_bytes())
}

fn point(across: &Axis, up: &Axis, x: f64, y: f64) -> Point {
    (CORNER.0 + PANEL.0 * across.place(x), CORNER.1 + PANEL.1 * (1.0 - up.place(y)))
}

fn frame(svg: &mut Svg, across: &Axis, up: &Axis, (below, beside): (&str, &str)) {
    let bottom = CORNER.1 + PANEL.1;
    for (value, label) in up.ticks() {
        let (x, y) = point(across, up, across.low, value);
        svg.line((x, y), (x + PANEL.0, y), "stroke=\"#e4e4e4\"");
        svg.text((x - 7.0, y + 4.5), "text-anchor=\"end\" font-size=\"12\"", &label);
    }
    for (value, label) in across.ticks() {
        let (x, _) = point(across, up, value, up.low);
        svg.line((x, CORNER.1), (x, bottom), "stroke=\"#f0f0f0\"");
        svg.text((x, bottom + 19.0), "text-anchor=\"middle\" font-size=\"12\"", &label);
    }
    svg.frame(CORNER, PANEL);
    svg.text((CORNER.0 + 0.5 * PANEL.0, bottom + 44.0), "text-anchor=\"middle\"", below);
    svg.upright((CORNER.0 - 56.0, CORNER.1 + 0.5 * PANEL.1), beside);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xml::tests::{attribute, tags};

    fn drawn(frequencies: &[f64], levels: Vec<f64>) -> String {
        let line = FrequencyLine { name: "θ < 90".to_owned(), levels };
        let mut out = Vec::new();
        write_frequency_plot("a & b", "dB(m²)", frequencies, &[line], &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn the_ends_of_the_sweep_are_the_ends_of_the_panel() {
        let text = drawn(&[1e9, 1.5e9, 2e9], vec![-10.0, f64::NAN, 10.0]);
        let found = tags(&text);
        let line = found.iter().find(|(name, _)| name == "polyline").unwrap();
        let (right, bottom) = (CORNER.0 + PANEL.0, CORNER.1 + PANEL.1);
        let expected = format!("{:.2},{bottom:.2} {right:.2},{:.2}", CORNER.0, CORNER.1);
        assert_eq!(attribute(&line.1, "points"), expected);
        assert!(text.contains("frequency, MHz") && text.contains(">1400<"));
    }

    #[test]
    fn nothing_and_one_frequency_are_drawn() {
        for levels in [vec![], vec![f64::NEG_INFINITY], vec![3.0]] {
            let text = drawn(&[2e10], levels);
            assert!(text.contains("GHz") && !text.contains("NaN") && text.ends_with("</svg>\n"));
        }
    }
}
