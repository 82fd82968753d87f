//! `shots.svg`: the share of power that is still to be shot, against shots, columns computed and seconds.

use std::io::{self, Write};

use super::record::{ShootingRecord, Shot};
use crate::chart::{Panel, Series, draw};
use crate::svg::Point;

/// Writes the plot.
///
/// # Errors
/// What `out` reports.
pub fn write_shooting_plot(record: &ShootingRecord, out: &mut dyn Write) -> io::Result<()> {
    let panel =
        |across| Panel { across, up: "share of the power still to be shot", decades: true, dots: false };
    let panels = [panel("shots"), panel("columns computed"), panel("seconds")];
    let against = |across: fn(usize, &Shot) -> f64| -> Vec<Point> {
        let points = record.shots.iter().enumerate();
        points.map(|(number, shot)| (across(number + 1, shot), 1.0 - shot.distributed)).collect()
    };
    let points = vec![
        against(|number, _| number as f64),
        against(|_, shot| shot.columns as f64),
        against(|_, shot| shot.seconds),
    ];
    let title = format!("{}: {} elements, {} groups", record.scene, record.elements, record.groups);
    draw(&title, &panels, &[Series { name: "progressive".to_owned(), points }], out)
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;

    #[test]
    fn every_panel_is_drawn() {
        let mut out = Vec::new();
        write_shooting_plot(&sample(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        for label in ["shots", "columns computed", "seconds", "8 elements, 12 groups"] {
            assert!(text.contains(label), "{label}");
        }
    }
}
