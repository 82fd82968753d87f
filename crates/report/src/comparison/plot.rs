//! `compare.svg`: the residual of every solver against iterations, entries read and seconds;
//! `compare_sweep.svg`: what the tolerance takes against the largest reflectance.
//!
//! Axes end at a few times the median of what the solvers took: the slowest ones run out of the
//! panel.

use std::io::{self, Write};

use super::record::{ComparisonCase, ComparisonRecord, ComparisonRun};
use crate::plot::{Axis, Figure, Line, Panel, Part, Point, Span, write_svg};

/// An axis ends at this many medians, unless all end before.
const MEDIANS_OF_AN_AXIS: f64 = 4.0;
const RESIDUAL_LABEL: &str = "relative residual, worst band";
const LABELS_ACROSS: [&str; 3] = ["iterations", "readings of the matrix", "time, s"];

/// Writes the plot of the case of the largest reflectance.
///
/// # Errors
/// What `out` reports.
pub fn write_comparison_plot(record: &ComparisonRecord, out: &mut dyn Write) -> io::Result<()> {
    let Some(case) = record.cases.last() else {
        return write_svg(&Figure { title: "Nothing to compare".to_owned(), parts: Vec::new() }, out);
    };
    let readings = 1.0 / record.entries.max(1) as f64;
    let curves: Vec<[Vec<Point>; 3]> = solved(case).map(|run| curves(run, readings)).collect();
    let part = |(at, across): (usize, &str)| {
        let end = end(&curves, at);
        let line = |(number, (run, curves)): (usize, (&ComparisonRun, &[Vec<Point>; 3]))| {
            let points = curves[at].iter().copied().filter(|point| point.0 <= end).collect();
            Line::distinct(&run.solver, points, number)
        };
        let lines = solved(case).zip(&curves).enumerate().map(line).collect();
        let (across, up) = (Axis::new(across, Span::WithZero), Axis::new(RESIDUAL_LABEL, Span::Decades));
        Part::Panel(Panel::new(across, up, lines))
    };
    let title =
        format!("{}: {} unknowns, reflectance up to {}", record.scene, record.unknowns, case.reflectance);
    write_svg(&Figure { title, parts: LABELS_ACROSS.into_iter().enumerate().map(part).collect() }, out)
}

fn solved(case: &ComparisonCase) -> impl Iterator<Item = &ComparisonRun> {
    case.runs.iter().filter(|run| !run.history.residual.is_empty())
}

/// The residual against iterations, readings of the matrix and seconds.
fn curves(run: &ComparisonRun, readings: f64) -> [Vec<Point>; 3] {
    let history = &run.history;
    let against = |across: Vec<f64>| across.into_iter().zip(history.residual.iter().copied()).collect();
    [
        against((0..history.residual.len()).map(|iteration| iteration as f64).collect()),
        against(history.entries.iter().map(|&entries| entries as f64 * readings).collect()),
        against(history.seconds.clone()),
    ]
}

/// Where the axis of a panel ends.
fn end(lines: &[[Vec<Point>; 3]], at: usize) -> f64 {
    let mut ends: Vec<f64> =
        lines.iter().filter_map(|panels| panels[at].last()).map(|point| point.0).collect();
    ends.sort_by(f64::total_cmp);
    let median = ends.get(ends.len() / 2).copied().unwrap_or(1.0);
    ends.last().copied().unwrap_or(1.0).min(MEDIANS_OF_AN_AXIS * median)
}

/// Writes the plot of a sweep: iterations and readings of the matrix of every solver that
/// converged, against the reflectance.
///
/// # Errors
/// What `out` reports.
pub fn write_sweep_plot(record: &ComparisonRecord, out: &mut dyn Write) -> io::Result<()> {
    let solvers: Vec<&str> = match record.cases.first() {
        Some(case) => case.runs.iter().map(|run| run.solver.as_str()).collect(),
        None => Vec::new(),
    };
    let part = |up: &str, value: &dyn Fn(&ComparisonRun) -> f64| {
        let line = |(number, solver): (usize, &&str)| {
            let runs = record.cases.iter().map(|case| (case.reflectance, &case.runs[number]));
            let converged = runs.filter(|(_, run)| run.outcome == "converged");
            Line::distinct(solver, converged.map(|(rho, run)| (rho, value(run))).collect(), number)
        };
        let lines = solvers.iter().enumerate().map(line).collect();
        let across = Axis::new("largest reflectance ρ", Span::Tight);
        Part::Panel(Panel::new(across, Axis::new(up, Span::Decades), lines))
    };
    let entries = record.entries.max(1) as f64;
    let parts = vec![
        part(LABELS_ACROSS[0], &|run| run.iterations as f64),
        part(LABELS_ACROSS[1], &|run| run.entries as f64 / entries),
        part(LABELS_ACROSS[2], &|run| run.seconds),
    ];
    write_svg(&Figure { title: format!("{}: {} unknowns", record.scene, record.unknowns), parts }, out)
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::plot::tests::curves;

    fn lines(write: fn(&ComparisonRecord, &mut dyn Write) -> io::Result<()>) -> usize {
        let mut out = Vec::new();
        write(&sample(), &mut out).unwrap();
        curves(&String::from_utf8(out).unwrap()).len()
    }

    #[test]
    fn a_refused_solver_has_no_line() {
        assert_eq!(lines(write_comparison_plot), 3);
        assert_eq!(lines(write_sweep_plot), 3);
    }

    #[test]
    fn the_slowest_do_not_stretch_the_axis() {
        let line = |end: f64| [(); 3].map(|()| vec![(0.0, 1.0), (end, 1e-9)]);
        assert_eq!(end(&[line(10.0), line(20.0), line(1e6)], 0).to_bits(), 80.0_f64.to_bits());
        assert_eq!(end(&[line(10.0), line(20.0), line(30.0)], 0).to_bits(), 30.0_f64.to_bits());
    }
}
