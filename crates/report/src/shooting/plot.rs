//! `shots.svg`: the share of power that is still to be shot, against shots, columns computed and
//! seconds.

use std::io::{self, Write};

use super::record::{ShootingRecord, Shot};
use crate::plot::{Axis, Figure, Line, Panel, Part, Span, write_svg};

/// Writes the plot.
///
/// # Errors
/// What `out` reports.
pub fn write_shooting_plot(record: &ShootingRecord, out: &mut dyn Write) -> io::Result<()> {
    let over = |label: &str, across: fn(usize, &Shot) -> f64| {
        let points = record.shots.iter().enumerate();
        let points = points.map(|(number, shot)| (across(number + 1, shot), 1.0 - shot.distributed));
        let up = Axis::new("share of the power still to be shot", Span::Decades);
        let line = Line::distinct("", points.collect(), 0);
        Part::Panel(Panel::new(Axis::new(label, Span::WithZero), up, vec![line]))
    };
    let parts = vec![
        over("shots", |number, _| number as f64),
        over("columns computed", |_, shot| shot.columns as f64),
        over("time, s", |_, shot| shot.seconds),
    ];
    let (elements, groups) = (record.elements, record.groups);
    let title = format!("{}: progressive radiosity, {elements} elements, {groups} groups", record.scene);
    write_svg(&Figure { title, parts }, out)
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::plot::tests::texts;

    #[test]
    fn every_panel_is_drawn() {
        let mut out = Vec::new();
        write_shooting_plot(&sample(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        for label in ["shots", "columns computed", "time, s", "8 elements, 12 groups"] {
            assert!(texts(&text).iter().any(|text| text.contains(label)), "{label}");
        }
    }
}
