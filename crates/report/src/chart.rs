//! Panels side by side with the same lines in each, and a legend: what the plots of a comparison and of a spectrum are made of.

use std::io::{self, Write};

use crate::axis::Decades;
use crate::palette::line_colour;
use crate::svg::{Point, Svg};

/// Value that stands for 0 on a logarithmic axis.
const FLOOR: f64 = 1e-17;
/// Most points of a line; longer ones are thinned evenly.
const POINTS: usize = 600;
/// Most points of a line that are marked one by one.
const MARKED: usize = 12;
/// Size of a panel, pixels.
const PANEL: Point = (330.0, 400.0);
/// Upper edge of the panels, pixels.
const TOP: f64 = 62.0;
/// Left edge of the first panel and distance between those of neighbours, pixels.
const LEFT: f64 = 78.0;
const STEP: f64 = 420.0;
/// Width of the legend, pixels.
const LEGEND: f64 = 220.0;
/// Distance between the entries of the legend, pixels.
const ROW: f64 = 16.0;

/// One of the panels.
pub(crate) struct Panel<'a> {
    pub(crate) across: &'a str,
    pub(crate) up: &'a str,
    /// Whether the upward axis is logarithmic.
    pub(crate) decades: bool,
    /// Dots without lines.
    pub(crate) dots: bool,
}

/// One of the lines, with its points in each panel.
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) points: Vec<Vec<Point>>,
}

/// An axis, either way.
enum Axis {
    Linear { low: f64, high: f64, step: f64 },
    Decades(Decades),
}

impl Axis {
    fn new(values: &[f64], decades: bool) -> Self {
        if decades {
            return Self::Decades(Decades::new(values.iter().map(|value| value.abs().max(FLOOR))));
        }
        let low = values.iter().copied().fold(0.0, f64::min);
        let high = values.iter().copied().fold(0.0, f64::max);
        let high = if high > low { high } else { low + 1.0 };
        let step = step((high - low) / 5.0);
        Self::Linear { low: (low / step).floor() * step, high: (high / step).ceil() * step, step }
    }

    /// Place from 0 to 1 of what the axis holds.
    fn place(&self, value: f64) -> f64 {
        match self {
            Self::Linear { low, high, .. } => (value - low) / (high - low),
            Self::Decades(decades) => decades.place(value.abs().max(FLOOR)),
        }
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        match self {
            Self::Decades(decades) => decades.ticks(),
            Self::Linear { low, high, step } => {
                let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
                let count = ((high - low) / step).round() as usize;
                let value = |i: usize| low + i as f64 * step;
                (0..=count).map(|i| (self.place(value(i)), label(value(i), decimals))).collect()
            }
        }
    }
}

fn label(value: f64, decimals: usize) -> String {
    let text = if value.abs() >= 1e5 { format!("{value:.1e}") } else { format!("{value:.decimals$}") };
    text.replace('-', "−")
}

/// The smallest of 1, 2, 5 × a power of ten that is not below `x`.
fn step(x: f64) -> f64 {
    let power = 10.0_f64.powf(x.log10().floor());
    [1.0, 2.0, 5.0]
        .iter()
        .map(|step| step * power)
        .find(|step| *step >= x * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// A panel with its axes and where it stands.
struct Frame<'a> {
    panel: &'a Panel<'a>,
    left: f64,
    across: Axis,
    up: Axis,
}

impl<'a> Frame<'a> {
    fn new(at: usize, panel: &'a Panel<'a>, series: &[Series]) -> Self {
        let points = || series.iter().flat_map(|series| &series.points[at]).filter(|point| finite(point));
        let across: Vec<f64> = points().map(|point| point.0).collect();
        let up: Vec<f64> = points().map(|point| point.1).collect();
        let (across, up) = (Axis::new(&across, false), Axis::new(&up, panel.decades));
        Self { panel, left: LEFT + STEP * at as f64, across, up }
    }

    fn point(&self, (x, y): Point) -> Point {
        (self.left + PANEL.0 * self.across.place(x), TOP + PANEL.1 * (1.0 - self.up.place(y)))
    }
}

fn finite(point: &Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Draws all panels.
pub(crate) fn draw(
    title: &str,
    panels: &[Panel<'_>],
    series: &[Series],
    out: &mut dyn Write,
) -> io::Result<()> {
    let height = (TOP + PANEL.1 + 64.0).max(TOP + ROW * series.len() as f64 + 24.0);
    let legend = LEFT + STEP * panels.len() as f64 - 60.0;
    let mut svg = Svg::new((legend + LEGEND, height));
    svg.text((LEFT, 34.0), "font-size=\"16\"", title);
    let names: Vec<String> = series.iter().map(|series| series.name.clone()).collect();
    for (at, panel) in panels.iter().enumerate() {
        let frame = Frame::new(at, panel, series);
        draw_frame(&mut svg, &frame);
        for (number, series) in series.iter().enumerate() {
            draw_line(&mut svg, &frame, &series.points[at], &line_colour(&names, number));
        }
    }
    for (number, name) in names.iter().enumerate() {
        let y = TOP + 8.0 + ROW * number as f64;
        let style = format!("stroke=\"{}\" stroke-width=\"2.5\"", line_colour(&names, number));
        svg.line((legend, y), (legend + 20.0, y), &style);
        svg.text((legend + 27.0, y + 4.5), "font-size=\"12\"", name);
    }
    out.write_all(svg.finish().as_bytes())
}

fn draw_frame(svg: &mut Svg, frame: &Frame<'_>) {
    let (left, right, bottom) = (frame.left, frame.left + PANEL.0, TOP + PANEL.1);
    for (place, label) in frame.up.ticks() {
        let y = TOP + PANEL.1 * (1.0 - place);
        svg.line((left, y), (right, y), "stroke=\"#e4e4e4\"");
        svg.text((left - 7.0, y + 4.5), "text-anchor=\"end\" font-size=\"12\"", &label);
    }
    for (place, label) in frame.across.ticks() {
        let x = left + PANEL.0 * place;
        svg.line((x, TOP), (x, bottom), "stroke=\"#f0f0f0\"");
        svg.text((x, bottom + 19.0), "text-anchor=\"middle\" font-size=\"12\"", &label);
    }
    svg.frame((left, TOP), PANEL);
    svg.text((left + 0.5 * PANEL.0, bottom + 44.0), "text-anchor=\"middle\"", frame.panel.across);
    svg.upright((left - 52.0, TOP + 0.5 * PANEL.1), frame.panel.up);
}

fn draw_line(svg: &mut Svg, frame: &Frame<'_>, points: &[Point], colour: &str) {
    let finite: Vec<Point> = points.iter().copied().filter(finite).collect();
    let every = finite.len().div_ceil(POINTS).max(1);
    let last = finite.len().saturating_sub(1);
    let kept = finite.iter().enumerate().filter(|(at, _)| at % every == 0 || *at == last);
    let placed: Vec<Point> = kept.map(|(_, &point)| frame.point(point)).collect();
    if placed.len() > 1 && !frame.panel.dots {
        svg.polyline(&placed, colour);
    }
    if frame.panel.dots || placed.len() <= MARKED {
        for point in placed {
            svg.dot(point, colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xml::tests::{attribute, tags};

    fn drawn(panel: Panel<'_>, points: Vec<Point>) -> String {
        let mut out = Vec::new();
        draw("a < b", &[panel], &[Series { name: "one".into(), points: vec![points] }], &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn points_stand_where_the_axes_say() {
        let panel = Panel { across: "x", up: "y", decades: true, dots: false };
        let text = drawn(panel, vec![(0.0, 1.0), (10.0, 1e-4), (5.0, f64::NAN)]);
        let found = tags(&text);
        let line = found.iter().find(|(name, _)| name == "polyline").unwrap();
        let (left, right, bottom) = (LEFT, LEFT + PANEL.0, TOP + PANEL.1);
        let expected = format!("{left:.2},{TOP:.2} {right:.2},{bottom:.2}");
        assert_eq!(attribute(&line.1, "points"), expected);
        assert!(text.contains("a &lt; b") && text.contains("10⁻⁴"));
    }

    #[test]
    fn negative_values_and_nothing_at_all_have_axes() {
        let panel = || Panel { across: "x", up: "y", decades: false, dots: true };
        let text = drawn(panel(), vec![(1.0, -0.25), (2.0, 0.5)]);
        assert!(text.contains("−0.2") && !text.contains("polyline"));
        assert!(drawn(panel(), Vec::new()).ends_with("</svg>\n"));
    }

    #[test]
    fn long_lines_are_thinned_and_keep_their_end() {
        let panel = Panel { across: "x", up: "y", decades: false, dots: false };
        let text = drawn(panel, (0..10_000).map(|i| (f64::from(i), f64::from(i))).collect());
        let line = tags(&text).into_iter().find(|(name, _)| name == "polyline").unwrap();
        let points = attribute(&line.1, "points").split(' ').count();
        assert!(points > 100 && points < 2 * POINTS);
    }
}
