//! What progressive radiosity without a matrix leaves: pictures on the way, `shots.csv`,
//! `shots.svg`, the field so far (`faces.csv`, `field.npz`, `field.vtu`, `image.png`), and
//! `shots.json` last.
//!
//! Columns of the table: `shot`, `elements` (that shot as one), `columns` (computed so far),
//! `seconds`, `distributed` (share of the power of the solution that has been shot, at least).

mod plot;
mod record;

use std::io::{self, Write};

use crate::number::Number;
use crate::{
    Field, REPORT, ReportError, ReportModel, ReportPage, ResultFolder, RunReport, View, render,
    write_faces_csv, write_npz, write_vtu,
};

pub use plot::write_shooting_plot;
pub use record::{SHOOTING_FORMAT, ShootingRecord, Shot};

/// The files of the end, in the order in which they are written.
pub const SHOOTING_FILES: [&str; 7] =
    ["faces.csv", "field.npz", "field.vtu", "image.png", "shots.csv", "shots.svg", "shots.json"];

/// Writes the field so far and the record into a folder. Without a view no picture is drawn,
/// without what makes a report none is written.
///
/// # Errors
/// [`ReportError::Write`] with the path, and what [`render`] refuses.
pub fn write_shooting(
    folder: &ResultFolder,
    field: &Field<'_>,
    record: &ShootingRecord,
    view: Option<&View>,
    report: Option<&RunReport<'_>>,
) -> Result<(), ReportError> {
    let picture = view.map(|view| render(field, &view.camera, view.exposure)).transpose()?;
    let [faces, npz, vtu, image, table, plot, json] = SHOOTING_FILES;
    folder.write(faces, |out| write_faces_csv(field, out))?;
    folder.write(npz, |out| write_npz(field, out))?;
    folder.write(vtu, |out| write_vtu(field, out))?;
    if let Some(report) = report {
        let (steps_title, steps) = report.steps;
        let model = ReportModel { steps, steps_title, ..ReportModel::lit(field, report.view) };
        let page = ReportPage::of_shooting(report.title, field, record, model, picture.as_ref());
        folder.write(REPORT, |out| page.write(out))?;
    }
    if let Some(picture) = &picture {
        folder.write(image, |out| picture.write_png(out))?;
    }
    folder.write(table, |out| write_shots_csv(record, out))?;
    folder.write(plot, |out| write_shooting_plot(record, out))?;
    let record = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, record)?;
        writeln!(out)
    };
    folder.write(json, record).map(drop)
}

/// Writes the picture after some shots, `shot_00010.png`, into a folder.
///
/// # Errors
/// As for [`write_shooting`].
pub fn write_shot_picture(
    folder: &ResultFolder,
    shots: u64,
    field: &Field<'_>,
    view: &View,
) -> Result<(), ReportError> {
    let picture = render(field, &view.camera, view.exposure)?;
    folder.write(&format!("shot_{shots:05}.png"), |out| picture.write_png(out)).map(drop)
}

/// Writes the table of shots.
///
/// # Errors
/// What `out` reports.
pub fn write_shots_csv(record: &ShootingRecord, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "shot,elements,columns,seconds,distributed")?;
    for (number, shot) in (1..).zip(&record.shots) {
        let Shot { elements, columns, seconds, distributed } = *shot;
        writeln!(out, "{number},{elements},{columns},{},{}", Number(seconds), Number(distributed))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::record::tests::sample;
    use super::*;

    #[test]
    fn the_table_has_a_row_a_shot() {
        let mut out = Vec::new();
        write_shots_csv(&sample(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(text, "shot,elements,columns,seconds,distributed\n1,4,1,0.5,0.25\n2,1,2,0.75,0.5\n");
    }
}
