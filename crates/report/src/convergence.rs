//! `convergence.svg`: the relative residual ‖b − A x‖₂/‖b‖₂ of each band against iterations and against seconds.
//!
//! The residual axis is logarithmic; a residual of 0 is drawn at 10⁻¹⁷, one that is not finite is left out. A dashed line
//! marks the tolerance.

use std::io::{self, Write};

use crate::RunRecord;
use crate::axis::{Decades, Linear};
use crate::palette::line_colour;
use crate::svg::{Point, Svg};

/// Residual that stands for 0.
const FLOOR: f64 = 1e-17;
/// Most points of a line; a longer history is thinned evenly.
const POINTS: usize = 1000;
/// Most points of a line that are marked one by one.
const MARKED: usize = 30;
/// Most entries of the legend; of more bands, evenly spaced ones are named.
const ENTRIES: usize = 14;
/// Size of the drawing, pixels.
const SIZE: Point = (1100.0, 460.0);
/// Size of a panel, pixels.
const PANEL: Point = (400.0, 330.0);
/// Left edges of the panels, pixels.
const LEFT: [f64; 2] = [82.0, 572.0];
/// Upper edge of the panels, pixels.
const TOP: f64 = 62.0;
/// Left edge of the legend, pixels.
const LEGEND: f64 = 990.0;

/// One of the two plots.
struct Panel<'a> {
    left: f64,
    caption: &'a str,
    across: &'a [f64],
    axis: Linear,
    decades: Decades,
}

impl<'a> Panel<'a> {
    fn new(left: f64, caption: &'a str, across: &'a [f64], least: f64, decades: Decades) -> Self {
        Self { left, caption, across, axis: Linear::new(across, least), decades }
    }

    fn point(&self, x: f64, residual: f64) -> Point {
        (self.left + PANEL.0 * self.axis.place(x), height(self.decades.place(residual)))
    }

    fn right(&self) -> f64 {
        self.left + PANEL.0
    }
}

/// Height in the drawing of a place from 0 to 1 along the residual axis.
fn height(place: f64) -> f64 {
    TOP + PANEL.1 * (1.0 - place)
}

/// Writes the plot of a run's history.
///
/// # Errors
/// What `out` reports.
pub fn write_convergence(run: &RunRecord, out: &mut dyn Write) -> io::Result<()> {
    let iterations: Vec<f64> = run.history.iterations.iter().map(|&i| i as f64).collect();
    let decades = Decades::new(shown(run));
    let mut svg = Svg::new(SIZE);
    svg.text((LEFT[0], 34.0), "font-size=\"16\"", &title(run));
    for panel in [
        Panel::new(LEFT[0], "iterations", &iterations, 1.0, decades),
        Panel::new(LEFT[1], "seconds", &run.history.seconds, 0.0, decades),
    ] {
        draw_frame(&mut svg, &panel);
        draw_tolerance(&mut svg, &panel, run.tolerance);
        draw_lines(&mut svg, &panel, run);
    }
    draw_legend(&mut svg, &run.bands);
    out.write_all(svg.finish().as_bytes())
}

/// All values that the residual axis must hold.
fn shown(run: &RunRecord) -> impl Iterator<Item = f64> {
    let residuals = run.history.residual.iter().flatten().copied().filter(|r| r.is_finite());
    residuals.map(|r| r.max(FLOOR)).chain(tolerance(run.tolerance))
}

fn tolerance(given: Option<f64>) -> Option<f64> {
    given.filter(|t| t.is_finite() && *t > 0.0).map(|t| t.max(FLOOR))
}

fn title(run: &RunRecord) -> String {
    let iterations = run.history.iterations.last().copied().unwrap_or(0);
    let seconds = run.history.seconds.last().copied().unwrap_or(0.0);
    let plural = if iterations == 1 { "" } else { "s" };
    format!("{}: {} after {iterations} iteration{plural}, {seconds:.3} s", run.solver, run.stop_reason)
}

fn draw_frame(svg: &mut Svg, panel: &Panel<'_>) {
    for (place, label) in panel.decades.ticks() {
        let y = height(place);
        svg.line((panel.left, y), (panel.right(), y), "stroke=\"#e4e4e4\"");
        svg.text((panel.left - 8.0, y + 4.5), "text-anchor=\"end\"", &label);
    }
    let bottom = TOP + PANEL.1;
    for (place, label) in panel.axis.ticks() {
        let x = panel.left + PANEL.0 * place;
        svg.line((x, TOP), (x, bottom), "stroke=\"#f0f0f0\"");
        svg.text((x, bottom + 20.0), "text-anchor=\"middle\"", &label);
    }
    svg.frame((panel.left, TOP), PANEL);
    svg.text((panel.left + 0.5 * PANEL.0, bottom + 44.0), "text-anchor=\"middle\"", panel.caption);
    svg.upright((panel.left - 50.0, TOP + 0.5 * PANEL.1), "relative residual ‖b − A x‖ / ‖b‖");
}

fn draw_tolerance(svg: &mut Svg, panel: &Panel<'_>, given: Option<f64>) {
    if let Some(level) = tolerance(given) {
        let y = height(panel.decades.place(level));
        let style = "stroke=\"#555555\" stroke-dasharray=\"6 4\"";
        svg.line((panel.left, y), (panel.right(), y), style);
        let label = format!("tolerance {level:e}").replace('-', "−");
        svg.text((panel.left + 6.0, y - 6.0), "font-size=\"12\" fill=\"#555555\"", &label);
    }
}

fn draw_lines(svg: &mut Svg, panel: &Panel<'_>, run: &RunRecord) {
    for (band, residual) in run.history.residual.iter().enumerate() {
        let (points, colour) = (thinned(panel, residual), line_colour(&run.bands, band));
        if points.len() > 1 {
            svg.polyline(&points, &colour);
        }
        if points.len() <= MARKED {
            for point in points {
                svg.dot(point, &colour);
            }
        }
    }
}

/// The finite points of a line in pixels: at most [`POINTS`] and the last.
fn thinned(panel: &Panel<'_>, residual: &[f64]) -> Vec<Point> {
    let finite = panel.across.iter().zip(residual).filter(|(x, r)| x.is_finite() && r.is_finite());
    let all: Vec<Point> = finite.map(|(&x, r)| panel.point(x, r.max(FLOOR))).collect();
    let stride = all.len().div_ceil(POINTS).max(1);
    let last = all.len().saturating_sub(1);
    all.iter().enumerate().filter(|(i, _)| i % stride == 0 || *i == last).map(|(_, p)| *p).collect()
}

fn draw_legend(svg: &mut Svg, bands: &[String]) {
    let named = bands.len().min(ENTRIES);
    let row = |entry: usize| TOP + 14.0 + 22.0 * entry as f64;
    for entry in 0..named {
        let band = if named < 2 { 0 } else { entry * (bands.len() - 1) / (named - 1) };
        let style = format!("stroke=\"{}\" stroke-width=\"2.5\"", line_colour(bands, band));
        svg.line((LEGEND, row(entry)), (LEGEND + 22.0, row(entry)), &style);
        svg.text((LEGEND + 30.0, row(entry) + 4.5), "", &short(&bands[band]));
    }
    if named < bands.len() {
        svg.text((LEGEND, row(named) + 4.5), "", &format!("{} bands", bands.len()));
    }
}

/// A name that fits beside the legend.
fn short(name: &str) -> String {
    if name.chars().count() <= 10 { name.to_owned() } else { name.chars().take(9).chain(['…']).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::History;
    use crate::field::tests::names;
    use crate::xml::tests::{attribute, tags};

    fn run(bands: &[&str], residual: Vec<Vec<f64>>) -> RunRecord {
        let points = residual.first().map_or(0, Vec::len);
        let history = History {
            iterations: (0..points as u64).collect(),
            seconds: (0..points).map(|i| i as f64 * 0.01).collect(),
            residual,
        };
        let (solver, stop_reason) = ("gauss-seidel".to_owned(), "converged".to_owned());
        RunRecord {
            bands: names(bands),
            history,
            solver,
            stop_reason,
            tolerance: Some(1e-8),
            ..RunRecord::default()
        }
    }

    fn svg(run: &RunRecord) -> String {
        let mut out = Vec::new();
        write_convergence(run, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    fn count(text: &str, tag: &str) -> usize {
        tags(text).iter().filter(|(name, _)| name == tag).count()
    }

    fn falling(rate: f64, points: i32) -> Vec<f64> {
        (0..points).map(|i| rate.powi(i)).collect()
    }

    #[test]
    fn a_line_per_band_and_panel() {
        let text = svg(&run(&["r", "g<&>", "b"], vec![falling(0.1, 9), falling(0.2, 9), falling(0.3, 9)]));
        assert_eq!(count(&text, "polyline"), 6);
        assert_eq!(text.matches("stroke-dasharray").count(), 2);
        assert!(text.contains("g&lt;&amp;&gt;") && text.contains("iterations") && text.contains("seconds"));
        assert!(text.contains("gauss-seidel: converged after 8 iterations, 0.080 s"));
    }

    #[test]
    fn the_slope_is_constant_on_the_logarithmic_axis() {
        let text = svg(&run(&["grey"], vec![falling(0.1, 11)]));
        let found = tags(&text);
        let (_, line) = found.iter().find(|(name, _)| name == "polyline").unwrap();
        let points: Vec<(f64, f64)> = attribute(line, "points")
            .split(' ')
            .map(|p| p.split_once(',').unwrap())
            .map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()))
            .collect();
        assert_eq!(points.len(), 11);
        // Ten decades from the upper left to the lower right corner of the panel.
        assert_eq!((points[0], points[10]), ((82.0, 62.0), (482.0, 392.0)));
        for pair in points.windows(2) {
            assert!(
                (pair[1].0 - pair[0].0 - 40.0).abs() < 0.011 && (pair[1].1 - pair[0].1 - 33.0).abs() < 0.011
            );
        }
    }

    #[test]
    fn odd_histories_still_make_a_plot() {
        let nan = f64::NAN;
        let cases = [
            (run(&[], vec![]), 0, 0),
            (run(&["a"], vec![vec![]]), 0, 0),
            (run(&["a"], vec![vec![0.5]]), 0, 2),
            (run(&["a"], vec![vec![1.0, 0.0]]), 2, 4),
            (run(&["a", "b"], vec![vec![nan; 3], vec![1.0, f64::INFINITY, 0.1]]), 2, 4),
            (run(&["a"], vec![falling(1e3, 60)]), 2, 0),
        ];
        for (run, lines, circles) in cases {
            let text = svg(&run);
            assert_eq!((count(&text, "polyline"), count(&text, "circle")), (lines, circles));
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }

    #[test]
    fn long_histories_and_many_bands_stay_small() {
        let bands: Vec<String> = (0..76).map(|i| format!("{}nm", 400 + 4 * i)).collect();
        let mut long = run(&[], vec![falling(0.9999, 100_000); 76]);
        long.bands = bands;
        let text = svg(&long);
        assert_eq!(count(&text, "polyline"), 152);
        assert!(text.contains(">400nm<") && text.contains(">700nm<") && text.contains(">76 bands<"));
        assert!(text.len() < 3_000_000, "{}", text.len());
    }
}
