//! How many rows close how well: a histogram of |Σ_j F_ij − 1| over half decades.
//!
//! A row that closes exactly counts in the bin of 10⁻¹⁷.

use std::io::{self, Write};

use super::matrix::ViewFactors;
use crate::plot::{Axis, Bar, Figure, Panel, Part, SMALLEST_ON_LOG_AXIS, Span, write_svg};
use crate::words::number;

/// Bins of a decade.
const BINS_OF_A_DECADE: f64 = 2.0;

/// Writes the histogram of the closure errors as SVG.
///
/// # Errors
/// What `out` reports.
pub fn write_closure_histogram(factors: &ViewFactors, out: &mut dyn Write) -> io::Result<()> {
    let defects: Vec<f64> =
        factors.defects().into_iter().map(|defect| defect.max(SMALLEST_ON_LOG_AXIS)).collect();
    let bar = |(bin, count): (i32, usize)| Bar { from: edge(bin), to: edge(bin + 1), height: count as f64 };
    let across = Axis::new("|Σ F − 1| of a row", Span::Decades);
    let panel = Panel {
        bars: bins(&defects).into_iter().map(bar).collect(),
        ..Panel::new(across, Axis::new("rows", Span::WithZero), Vec::new())
    };
    write_svg(&Figure { title: title(factors), parts: vec![Part::Panel(panel)] }, out)
}

/// Bins that are not empty, in order, with their counts: bin k begins at 10^(k / BINS).
pub(crate) fn bins(defects: &[f64]) -> Vec<(i32, usize)> {
    let mut places: Vec<i32> =
        defects.iter().map(|d| (BINS_OF_A_DECADE * d.log10() + 1e-9).floor() as i32).collect();
    places.sort_unstable();
    places.chunk_by(|a, b| a == b).map(|bin| (bin[0], bin.len())).collect()
}

pub(crate) fn edge(bin: i32) -> f64 {
    10.0_f64.powf(f64::from(bin) / BINS_OF_A_DECADE)
}

fn title(factors: &ViewFactors) -> String {
    let largest = factors.defects().into_iter().fold(0.0, f64::max);
    let n = factors.len();
    format!("Closure of {n} row{}: largest |ΣF − 1| {}", if n == 1 { "" } else { "s" }, number(largest))
}

#[cfg(test)]
mod tests {
    use super::super::matrix::tests::sample;
    use super::*;
    use crate::plot::tests::{bars, texts};

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
        let bars = bars(&text);
        assert!((bars[0] / bars[1] - 0.5).abs() < 0.01, "{bars:?}");
        let title = "Closure of 3 rows: largest |ΣF − 1| 0.02".to_owned();
        assert!(texts(&text).contains(&title), "{:?}", texts(&text));
    }

    #[test]
    fn exact_and_missing_rows_make_a_plot() {
        for sums in [&[1.0, 1.0][..], &[], &[0.0]] {
            let text = svg(sums);
            assert!(!text.contains("NaN") && !text.contains("inf") && text.contains("</svg>"), "{text}");
        }
    }
}
