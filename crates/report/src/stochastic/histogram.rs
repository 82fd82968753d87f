//! How the scores of a comparison are spread: a histogram over half units of z, beside the density
//! of normal scores.
//!
//! Scores beyond ±6 stand in the outermost bins.

use std::f64::consts::TAU;
use std::io::{self, Write};

use crate::plot::{Axis, Bar, Figure, Line, Panel, Part, Span, distinct, write_svg};

/// Where the outermost bins end, and how wide a bin is.
const OUTERMOST_BIN: f64 = 6.0;
const BIN_WIDTH: f64 = 0.5;
const BINS: usize = 24;

/// Writes the histogram as SVG under a title.
///
/// # Errors
/// What `out` reports.
pub fn write_score_histogram(title: &str, scores: &[f64], out: &mut dyn Write) -> io::Result<()> {
    let place = |i: usize| place_of(i, 4 * BINS);
    let normal = (0..=4 * BINS).map(|i| (place(i), expected(place(i), scores.len()))).collect();
    let line = Line { shape: 0, ..Line::new("expected of normal scores", normal, distinct(1).0) };
    let bar =
        |(bin, height): (usize, f64)| Bar { from: place_of(bin, BINS), to: place_of(bin + 1, BINS), height };
    let across = Axis::new("score z of a face and band", Span::WithZero);
    let panel = Panel {
        bars: counts(scores).into_iter().enumerate().map(bar).collect(),
        ..Panel::new(across, Axis::new("faces and bands", Span::WithZero), vec![line])
    };
    write_svg(&Figure { title: title.to_owned(), parts: vec![Part::Panel(panel)] }, out)
}

fn counts(scores: &[f64]) -> Vec<f64> {
    let mut counts = vec![0.0; BINS];
    for z in scores.iter().filter(|z| !z.is_nan()) {
        counts[(((z + OUTERMOST_BIN) / BIN_WIDTH).floor().clamp(0.0, (BINS - 1) as f64)) as usize] += 1.0;
    }
    counts
}

/// Scores expected in a bin about z, were all normal.
fn expected(z: f64, count: usize) -> f64 {
    count as f64 * BIN_WIDTH * (-0.5 * z * z).exp() / TAU.sqrt()
}

fn place_of(i: usize, of: usize) -> f64 {
    2.0 * OUTERMOST_BIN * i as f64 / of as f64 - OUTERMOST_BIN
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::{bars, curves, texts};

    #[test]
    fn bars_have_the_heights_of_their_counts() {
        let mut out = Vec::new();
        // Nine in 0 … 0.5, one beyond the end; nine is more than the 1.97 expected.
        write_score_histogram("a < b", &[&[0.1; 9][..], &[99.0]].concat(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let bars = bars(&text);
        assert_eq!((bars.len(), curves(&text).len()), (BINS, 1));
        assert!((bars[12] / bars[23] - 9.0).abs() < 0.02 && bars[11] == 0.0, "{bars:?}");
        assert!(texts(&text).contains(&"a &lt; b".to_owned()) && !text.contains("NaN"));
    }

    #[test]
    fn no_scores_make_a_plot() {
        let mut out = Vec::new();
        write_score_histogram("", &[], &mut out).unwrap();
        assert!(String::from_utf8(out).unwrap().ends_with("</svg>\n"));
    }
}
