//! `convergence.svg`: the relative residual ‖b − A x‖₂/‖b‖₂ of each band against iterations and
//! against seconds.
//!
//! The residual axis is logarithmic; a residual of 0 is drawn at 10⁻¹⁷, one that is not finite is
//! left out. A dashed line marks the tolerance.

use std::io::{self, Write};

use crate::RunRecord;
use crate::plot::{Axis, Figure, Line, Panel, Part, Span, band_colours, write_svg};
use crate::words::number;

const RESIDUAL_LABEL: &str = "relative residual ‖b − A x‖ / ‖b‖";

/// Writes the plot of a run's history.
///
/// # Errors
/// What `out` reports.
pub fn write_convergence(run: &RunRecord, out: &mut dyn Write) -> io::Result<()> {
    let iterations: Vec<f64> = run.history.iterations.iter().map(|&i| i as f64).collect();
    let colours = band_colours(&run.bands);
    let over = |label: &str, across: &[f64]| {
        let line = |((name, residual), colour): ((&String, &Vec<f64>), _)| {
            Line::new(name, across.iter().copied().zip(residual.iter().copied()).collect(), colour)
        };
        let mut lines: Vec<Line> =
            run.bands.iter().zip(&run.history.residual).zip(colours.iter().copied()).map(line).collect();
        let level = run.tolerance.filter(|t| t.is_finite() && *t > 0.0);
        let end = across.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
        lines.extend(level.map(|level| {
            Line::level(&format!("tolerance {}", number(level)), vec![(0.0, level), (end, level)])
        }));
        Part::Panel(Panel::new(
            Axis::new(label, Span::WithZero),
            Axis::new(RESIDUAL_LABEL, Span::Decades),
            lines,
        ))
    };
    let parts = vec![over("iterations", &iterations), over("time, s", &run.history.seconds)];
    write_svg(&Figure { title: title(run), parts }, out)
}

fn title(run: &RunRecord) -> String {
    let iterations = run.history.iterations.last().copied().unwrap_or(0);
    let seconds = run.history.seconds.last().copied().unwrap_or(0.0);
    let plural = if iterations == 1 { "" } else { "s" };
    format!("{}: {} after {iterations} iteration{plural}, {seconds:.3} s", run.solver, run.stop_reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::History;
    use crate::field::tests::names;
    use crate::plot::tests::{curves, texts};
    use crate::xml::tests::tags;

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
        assert_eq!(curves(&text).len(), 6);
        let texts = texts(&text);
        for label in ["iterations", "time, s", "g&lt;&amp;&gt;", "tolerance 10⁻⁸"] {
            assert_eq!(texts.iter().filter(|text| *text == label).count(), 1, "{label}");
        }
        assert!(texts.contains(&"gauss-seidel: converged after 8 iterations, 0.080 s".to_owned()));
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
            assert_eq!((curves(&text).len(), count(&text, "circle")), (lines, circles));
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }

    #[test]
    fn long_histories_and_many_bands_stay_small() {
        let bands: Vec<String> = (0..76).map(|i| format!("{}nm", 400 + 4 * i)).collect();
        let mut long = run(&[], vec![falling(0.9999, 100_000); 76]);
        long.bands = bands;
        let text = svg(&long);
        assert_eq!(curves(&text).len(), 152);
        let texts = texts(&text);
        for label in ["400nm", "700nm", "and so on: 76 lines"] {
            assert!(texts.iter().any(|text| text == label), "{label}");
        }
        assert!(text.len() < 3_000_000, "{}", text.len());
    }
}
