//! How many rows close how well: a histogram of |Σ_j F_ij − 1| over half decades.
//!
//! A row that closes exactly counts in the bin of 10⁻¹⁷.

use std::io::{self, Write};

use super::matrix::ViewFactors;
use crate::axis::{Decades, Linear};
use crate::svg::{Point, Svg};

/// Defect that stands for 0.
const FLOOR: f64 = 1e-17;
/// Bins of a decade.
const BINS: f64 = 2.0;
/// Size of the drawing, pixels.
const SIZE: Point = (640.0, 420.0);
/// Upper left corner and size of the panel, pixels.
const CORNER: Point = (70.0, 56.0);
const PANEL: Point = (540.0, 296.0);

/// Writes the histogram of the closure errors as SVG.
///
/// # Errors
/// What `out` reports.
pub fn write_closure_histogram(factors: &ViewFactors, out: &mut dyn Write) -> io::Result<()> {
    let defects: Vec<f64> = factors.defects().into_iter().map(|defect| defect.max(FLOOR)).collect();
    let bins = bins(&defects);
    let edges = bins.iter().flat_map(|&(bin, _)| [edge(bin), edge(bin + 1)]);
    let (decades, counts) = (Decades::new(edges), bins.iter().map(|&(_, count)| count as f64));
    let counts: Vec<f64> = counts.collect();
    let axis = Linear::new(&counts, 1.0);
    let mut svg = Svg::new(SIZE);
    svg.text((CORNER.0, 30.0), "font-size=\"16\"", &title(factors));
    frame(&mut svg, decades, &axis);
    for (&(bin, _), &count) in bins.iter().zip(&counts) {
        bar(&mut svg, decades, bin, axis.place(count));
    }
    out.write_all(svg.finish().as_bytes())
}

/// Bins that are not empty, in order, with their counts: bin k begins at 10^(k / BINS).
fn bins(defects: &[f64]) -> Vec<(i32, usize)> {
    let mut places: Vec<i32> = defects.iter().map(|d| (BINS * d.log10() + 1e-9).floor() as i32).collect();
    places.sort_unstable();
    places.chunk_by(|a, b| a == b).map(|bin| (bin[0], bin.len())).collect()
}

fn edge(bin: i32) -> f64 {
    10.0_f64.powf(f64::from(bin) / BINS)
}

fn title(factors: &ViewFactors) -> String {
    let largest = factors.defects().into_iter().fold(0.0, f64::max);
    let n = factors.len();
    format!("closure of {n} row{}: largest |ΣF − 1| {largest:.1e}", if n == 1 { "" } else { "s" })
        .replace("e-", "e−")
}

fn frame(svg: &mut Svg, decades: Decades, axis: &Linear) {
    let (right, bottom) = (CORNER.0 + PANEL.0, CORNER.1 + PANEL.1);
    for (place, label) in axis.ticks() {
        let y = bottom - PANEL.1 * place;
        svg.line((CORNER.0, y), (right, y), "stroke=\"#e4e4e4\"");
        svg.text((CORNER.0 - 8.0, y + 4.5), "text-anchor=\"end\"", &label);
    }
    for (place, label) in decades.ticks() {
        let x = CORNER.0 + PANEL.0 * place;
        svg.line((x, CORNER.1), (x, bottom), "stroke=\"#f0f0f0\"");
        svg.text((x, bottom + 20.0), "text-anchor=\"middle\"", &label);
    }
    svg.frame(CORNER, PANEL);
    svg.text((CORNER.0 + 0.5 * PANEL.0, bottom + 44.0), "text-anchor=\"middle\"", "|Σ F − 1| of a row");
    svg.upright((CORNER.0 - 46.0, CORNER.1 + 0.5 * PANEL.1), "rows");
}

/// A bar, drawn as a thick line.
fn bar(svg: &mut Svg, decades: Decades, bin: i32, height: f64) {
    let [left, right] = [bin, bin + 1].map(|bin| CORNER.0 + PANEL.0 * decades.place(edge(bin)));
    let (middle, bottom) = (0.5 * (left + right), CORNER.1 + PANEL.1);
    let style = format!("stroke=\"#0072b2\" stroke-width=\"{:.2}\"", 0.86 * (right - left));
    svg.line((middle, bottom), (middle, bottom - PANEL.1 * height), &style);
}

#[cfg(test)]
mod tests {
    use super::super::matrix::tests::sample;
    use super::*;
    use crate::xml::tests::{attribute, tags};

    fn svg(row_sums: &[f64]) -> String {
        let mut factors = sample(None);
        factors.surfaces.area = vec![1.0; row_sums.len()];
        factors.row_sums = row_sums.to_vec();
        let mut out = Vec::new();
        write_closure_histogram(&factors, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn bars_have_the_heights_of_their_counts() {
        // Two rows in 10^-2 … 10^-1.5, one in 10^-4 … 10^-3.5.
        let text = svg(&[1.02, 0.98, 1.0002]);
        let bars: Vec<(f64, f64)> = tags(&text)
            .iter()
            .filter(|(name, style)| name == "line" && style.contains("#0072b2"))
            .map(|(_, style)| ["y1", "y2"].map(|y| attribute(style, y).parse::<f64>().unwrap()))
            .map(|[y1, y2]| (y1, y1 - y2))
            .collect();
        assert_eq!(bars, [(352.0, 148.0), (352.0, 296.0)]);
        assert!(text.contains("closure of 3 rows: largest |ΣF − 1| 2.0e−2"));
    }

    #[test]
    fn exact_and_missing_rows_make_a_plot() {
        for sums in [&[1.0, 1.0][..], &[], &[0.0]] {
            let text = svg(sums);
            assert!(!text.contains("NaN") && !text.contains("inf") && text.contains("</svg>"), "{text}");
        }
    }
}
