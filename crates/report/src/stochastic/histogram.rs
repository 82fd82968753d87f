//! How the scores of a comparison are spread: a histogram over half units of z, beside the density of normal scores.
//!
//! Scores beyond ±6 stand in the outermost bins.

use std::f64::consts::TAU;
use std::io::{self, Write};

use crate::axis::Linear;
use crate::svg::{Point, Svg};

/// Where the outermost bins end, and how wide a bin is.
const REACH: f64 = 6.0;
const BIN: f64 = 0.5;
const BINS: usize = 24;
/// Size of the drawing, pixels.
const SIZE: Point = (640.0, 420.0);
/// Upper left corner and size of the panel, pixels.
const CORNER: Point = (70.0, 56.0);
const PANEL: Point = (540.0, 296.0);

/// Writes the histogram as SVG under a title.
///
/// # Errors
/// What `out` reports.
pub fn write_score_histogram(title: &str, scores: &[f64], out: &mut dyn Write) -> io::Result<()> {
    let counts = counts(scores);
    let normal: Vec<f64> = (0..=4 * BINS).map(|i| expected(place_of(i, 4 * BINS), scores.len())).collect();
    let axis = Linear::new(&[&counts[..], &normal[..]].concat(), 1.0);
    let mut svg = Svg::new(SIZE);
    svg.text((CORNER.0, 30.0), "font-size=\"16\"", title);
    frame(&mut svg, &axis);
    for (bin, &count) in counts.iter().enumerate() {
        bar(&mut svg, bin, axis.place(count));
    }
    let curve: Vec<Point> = normal
        .iter()
        .enumerate()
        .map(|(i, &count)| (across(place_of(i, 4 * BINS)), bottom() - PANEL.1 * axis.place(count)))
        .collect();
    svg.polyline(&curve, "#d55e00");
    out.write_all(svg.finish().as_bytes())
}

fn counts(scores: &[f64]) -> Vec<f64> {
    let mut counts = vec![0.0; BINS];
    for z in scores.iter().filter(|z| !z.is_nan()) {
        counts[(((z + REACH) / BIN).floor().clamp(0.0, (BINS - 1) as f64)) as usize] += 1.0;
    }
    counts
}

/// Scores expected in a bin about z, were all normal.
fn expected(z: f64, count: usize) -> f64 {
    count as f64 * BIN * (-0.5 * z * z).exp() / TAU.sqrt()
}

fn place_of(i: usize, of: usize) -> f64 {
    2.0 * REACH * i as f64 / of as f64 - REACH
}

fn across(z: f64) -> f64 {
    CORNER.0 + PANEL.0 * (z + REACH) / (2.0 * REACH)
}

fn bottom() -> f64 {
    CORNER.1 + PANEL.1
}

fn frame(svg: &mut Svg, axis: &Linear) {
    let right = CORNER.0 + PANEL.0;
    for (place, label) in axis.ticks() {
        let y = bottom() - PANEL.1 * place;
        svg.line((CORNER.0, y), (right, y), "stroke=\"#e4e4e4\"");
        svg.text((CORNER.0 - 8.0, y + 4.5), "text-anchor=\"end\"", &label);
    }
    for z in [-6, -4, -2, 0, 2, 4, 6] {
        let label = z.to_string().replace('-', "−");
        svg.text((across(f64::from(z)), bottom() + 20.0), "text-anchor=\"middle\"", &label);
    }
    svg.frame(CORNER, PANEL);
    svg.text((CORNER.0 + 0.5 * PANEL.0, bottom() + 44.0), "text-anchor=\"middle\"", "z of a face and band");
    svg.upright((CORNER.0 - 46.0, CORNER.1 + 0.5 * PANEL.1), "faces and bands");
}

/// A bar, drawn as a thick line.
fn bar(svg: &mut Svg, bin: usize, height: f64) {
    let middle = across(place_of(2 * bin + 1, 2 * BINS));
    let style = format!("stroke=\"#0072b2\" stroke-width=\"{:.2}\"", 0.86 * PANEL.0 / BINS as f64);
    svg.line((middle, bottom()), (middle, bottom() - PANEL.1 * height), &style);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xml::tests::{attribute, tags};

    #[test]
    fn bars_have_the_heights_of_their_counts() {
        let mut out = Vec::new();
        // Nine in 0 … 0.5, one beyond the end; nine is more than the 1.97 expected.
        write_score_histogram("a < b", &[&[0.1; 9][..], &[99.0]].concat(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let bars: Vec<f64> = tags(&text)
            .iter()
            .filter(|(name, style)| name == "line" && style.contains("#0072b2"))
            .map(|(_, style)| ["y1", "y2"].map(|y| attribute(style, y).parse::<f64>().unwrap()))
            .map(|[y1, y2]| y1 - y2)
            .collect();
        assert_eq!(bars.len(), BINS);
        assert!((bars[12] / bars[23] - 9.0).abs() < 0.01 && bars[11] == 0.0, "{bars:?}");
        assert!(text.contains("a &lt; b") && !text.contains("NaN"));
    }

    #[test]
    fn no_scores_make_a_plot() {
        let mut out = Vec::new();
        write_score_histogram("", &[], &mut out).unwrap();
        assert!(String::from_utf8(out).unwrap().ends_with("</svg>\n"));
    }
}
