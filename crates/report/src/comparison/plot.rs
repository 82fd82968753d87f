//! `compare.svg`: the residual of every solver against iterations, entries read and seconds; `compare_sweep.svg`: what the tolerance takes
//! against the largest reflectance.
//!
//! Axes end at a few times the median of what the solvers took: the slowest ones run out of the panel.

use std::io::{self, Write};

use super::record::{ComparisonCase, ComparisonRecord, ComparisonRun};
use crate::chart::{Panel, Series, draw};
use crate::svg::Point;

/// An axis ends at this many medians, unless all end before.
const MEDIANS: f64 = 4.0;
const RESIDUAL: &str = "relative residual ‖b − A x‖ / ‖b‖, worst band";

/// Writes the plot of the case of the largest reflectance.
///
/// # Errors
/// What `out` reports.
pub fn write_comparison_plot(record: &ComparisonRecord, out: &mut dyn Write) -> io::Result<()> {
    let panel = |across| Panel { across, up: RESIDUAL, decades: true, dots: false };
    let panels = [panel("iterations"), panel("readings of the matrix"), panel("seconds")];
    let Some(case) = record.cases.last() else { return draw("nothing to compare", &panels, &[], out) };
    let readings = 1.0 / record.entries.max(1) as f64;
    let lines: Vec<Vec<Vec<Point>>> = solved(case).map(|run| curves(run, readings)).collect();
    let ends: [f64; 3] = std::array::from_fn(|at| end(&lines, at));
    let series: Vec<Series> = solved(case).zip(lines).map(|(run, lines)| cut(run, lines, ends)).collect();
    let title =
        format!("{}: {} unknowns, reflectance up to {}", record.scene, record.unknowns, case.reflectance);
    draw(&title, &panels, &series, out)
}

fn solved(case: &ComparisonCase) -> impl Iterator<Item = &ComparisonRun> {
    case.runs.iter().filter(|run| !run.history.residual.is_empty())
}

/// The residual against iterations, readings of the matrix and seconds.
fn curves(run: &ComparisonRun, readings: f64) -> Vec<Vec<Point>> {
    let history = &run.history;
    let against = |across: Vec<f64>| across.into_iter().zip(history.residual.iter().copied()).collect();
    vec![
        against((0..history.residual.len()).map(|iteration| iteration as f64).collect()),
        against(history.entries.iter().map(|&entries| entries as f64 * readings).collect()),
        against(history.seconds.clone()),
    ]
}

/// Where the axis of a panel ends.
fn end(lines: &[Vec<Vec<Point>>], at: usize) -> f64 {
    let mut ends: Vec<f64> =
        lines.iter().filter_map(|panels| panels[at].last()).map(|point| point.0).collect();
    ends.sort_by(f64::total_cmp);
    let median = ends.get(ends.len() / 2).copied().unwrap_or(1.0);
    ends.last().copied().unwrap_or(1.0).min(MEDIANS * median)
}

fn cut(run: &ComparisonRun, mut lines: Vec<Vec<Point>>, ends: [f64; 3]) -> Series {
    for (points, end) in lines.iter_mut().zip(ends) {
        points.retain(|point| point.0 <= end);
    }
    Series { name: run.solver.clone(), points: lines }
}

/// Writes the plot of a sweep: iterations and readings of the matrix of every solver that converged, against the reflectance.
///
/// # Errors
/// What `out` reports.
pub fn write_sweep_plot(record: &ComparisonRecord, out: &mut dyn Write) -> io::Result<()> {
    let panel = |up| Panel { across: "largest reflectance", up, decades: true, dots: false };
    let panels = [panel("iterations"), panel("readings of the matrix"), panel("seconds")];
    let solvers: Vec<&str> = match record.cases.first() {
        Some(case) => case.runs.iter().map(|run| run.solver.as_str()).collect(),
        None => Vec::new(),
    };
    let entries = record.entries.max(1) as f64;
    let series: Vec<Series> = solvers
        .iter()
        .enumerate()
        .map(|(number, solver)| {
            let against = |value: fn(&ComparisonRun) -> f64, unit: f64| -> Vec<Point> {
                let runs = record.cases.iter().map(|case| (case.reflectance, &case.runs[number]));
                let converged = runs.filter(|(_, run)| run.outcome == "converged");
                converged.map(|(reflectance, run)| (reflectance, value(run) / unit)).collect()
            };
            let points = vec![
                against(|run| run.iterations as f64, 1.0),
                against(|run| run.entries as f64, entries),
                against(|run| run.seconds, 1.0),
            ];
            Series { name: (*solver).to_owned(), points }
        })
        .collect();
    draw(&format!("{}: {} unknowns", record.scene, record.unknowns), &panels, &series, out)
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::xml::tests::tags;

    fn lines(write: fn(&ComparisonRecord, &mut dyn Write) -> io::Result<()>) -> usize {
        let mut out = Vec::new();
        write(&sample(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        tags(&text).iter().filter(|(name, _)| name == "polyline").count()
    }

    #[test]
    fn a_refused_solver_has_no_line() {
        assert_eq!(lines(write_comparison_plot), 3);
        assert_eq!(lines(write_sweep_plot), 3);
    }

    #[test]
    fn the_slowest_do_not_stretch_the_axis() {
        let line = |end: f64| vec![vec![(0.0, 1.0), (end, 1e-9)]];
        assert_eq!(end(&[line(10.0), line(20.0), line(1e6)], 0).to_bits(), 80.0_f64.to_bits());
        assert_eq!(end(&[line(10.0), line(20.0), line(30.0)], 0).to_bits(), 30.0_f64.to_bits());
    }
}
