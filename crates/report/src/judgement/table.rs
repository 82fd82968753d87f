//! Tables of faces: the bundle's own, and those of other programs.
//!
//! Columns of a program's table: `face`, and for every band the value and, where it is known, its
//! standard error. Their names may be `value_BAND, sigma_BAND`, those of reference.csv
//! (`E_BAND, E_error_BAND`) or those of a traced run (`irradiance_BAND, standard_error_BAND`); with
//! one band, `value, sigma` will do.

use std::fs;
use std::path::{Path, PathBuf};

use super::Measured;
use crate::ReportError;
use crate::csv::{Row, rows};

/// Names of values and of their errors.
const NAMES: [[&str; 2]; 3] = [["value", "sigma"], ["E", "E_error"], ["irradiance", "standard_error"]];
/// What a table of another program should be.
const HELP: &str = "write a table with the columns face, value_BAND and, if it is known, sigma_BAND";

/// A table with named columns.
pub(super) struct Table {
    path: PathBuf,
    names: Vec<String>,
    rows: Vec<Row>,
    help: &'static str,
}

impl Table {
    pub(super) fn read(path: &Path, help: &'static str) -> Result<Self, ReportError> {
        let text =
            fs::read_to_string(path).map_err(|source| ReportError::Read { path: path.to_owned(), source })?;
        let mut table = Self { path: path.to_owned(), names: Vec::new(), rows: Vec::new(), help };
        let unclosed = || table.refuse(None, "a quote is opened and not closed".to_owned());
        let mut rows = rows(text.trim_start_matches('\u{feff}')).ok_or_else(unclosed)?.into_iter();
        let names = rows.next().ok_or_else(|| table.refuse(None, "it is empty".to_owned()))?;
        table.names = names.fields.iter().map(|name| name.trim().to_owned()).collect();
        table.rows = rows.collect();
        let width = table.names.len();
        match table.rows.iter().find(|row| row.fields.len() != width) {
            Some(row) => {
                let what = format!("the row has {} fields, the header {width}", row.fields.len());
                Err(table.refuse(Some(row.line), what))
            }
            None => Ok(table),
        }
    }

    pub(super) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The place of a column.
    pub(super) fn column(&self, name: &str) -> Result<usize, ReportError> {
        let missing = || self.refuse(Some(1), format!("there is no column `{name}`"));
        self.place(name).ok_or_else(missing)
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    /// A finite number.
    pub(super) fn number(&self, row: &Row, column: usize) -> Result<f64, ReportError> {
        let text = row.fields[column].trim();
        let found = text.parse::<f64>().ok().filter(|x| x.is_finite());
        let what = || format!("column `{}` holds `{text}`, not a finite number", self.names[column]);
        found.ok_or_else(|| self.refuse(Some(row.line), what()))
    }

    pub(super) fn refuse(&self, line: Option<usize>, what: String) -> ReportError {
        let (path, help) = (self.path.clone(), self.help.to_owned());
        ReportError::Values { path, line, what, help }
    }

    /// The columns of values, and of errors where there are any, band by band.
    fn quantities(&self, bands: &[String]) -> Result<Vec<[Option<usize>; 2]>, ReportError> {
        for names in NAMES {
            let of = |name: &str, band: &String| {
                let plain = || self.place(name).filter(|_| bands.len() == 1);
                self.place(&format!("{name}_{band}")).or_else(plain)
            };
            let found: Vec<_> = bands.iter().map(|band| names.map(|name| of(name, band))).collect();
            if found.iter().all(|[value, _]| value.is_some()) {
                return Ok(found);
            }
        }
        let all: Vec<String> = bands.iter().map(|band| format!("value_{band}")).collect();
        Err(self.refuse(Some(1), format!("the columns {} are not all there", all.join(", "))))
    }
}

/// Reads the irradiance (W/m²) of all faces, in any order of rows.
///
/// # Errors
/// [`ReportError::Read`], and [`ReportError::Values`] with the line that cannot be used.
pub fn read_measured_faces(path: &Path, faces: usize, bands: &[String]) -> Result<Measured, ReportError> {
    let table = Table::read(path, HELP)?;
    let (face, columns) = (table.column("face")?, table.quantities(bands)?);
    let known = columns.iter().all(|[_, sigma]| sigma.is_some());
    let mut values = vec![f64::NAN; faces * bands.len()];
    let mut sigma = vec![0.0; if known { values.len() } else { 0 }];
    for row in table.rows() {
        let text = row.fields[face].trim();
        let number = text.parse::<usize>().ok().filter(|&number| number < faces);
        let what = || format!("`{text}` is no face: the scene has the faces 0 to {}", faces.max(1) - 1);
        let number = number.ok_or_else(|| table.refuse(Some(row.line), what()))?;
        for (band, [value, error]) in columns.iter().enumerate() {
            let at = number * bands.len() + band;
            if !values[at].is_nan() {
                return Err(table.refuse(Some(row.line), format!("face {number} stands here a second time")));
            }
            // All columns of values are there.
            values[at] = table.number(row, value.unwrap_or_default())?;
            if let (true, Some(error)) = (known, error) {
                sigma[at] = table.number(row, *error)?.abs();
            }
        }
    }
    let missing = values.iter().step_by(bands.len().max(1)).filter(|value| value.is_nan()).count();
    if missing > 0 {
        return Err(table.refuse(None, format!("{missing} of {faces} faces are missing")));
    }
    Ok(Measured { seeds: vec![values], sigma: known.then_some(sigma), rounding: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, bands: &[&str]) -> Result<Measured, ReportError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("found.csv");
        fs::write(&path, text).unwrap();
        read_measured_faces(&path, 2, &crate::field::tests::names(bands))
    }

    #[test]
    fn tables_of_three_kinds_are_read() {
        let one = read("face,value,sigma\n1,2.5,0.5\r\n0,1,0.25", &["grey"]).unwrap();
        assert_eq!((&one.seeds[0][..], one.sigma), (&[1.0, 2.5][..], Some(vec![0.25, 0.5])));
        let two = read("face,E_r,E_error_r,E_g,E_error_g\n0,1,0,2,0\n1,3,0,4,0\n", &["r", "g"]).unwrap();
        assert_eq!((&two.seeds[0][..], two.sigma.is_some()), (&[1.0, 2.0, 3.0, 4.0][..], true));
        let bare = read("surface,face,irradiance_r\n\"a, b\",0,1\nc,1,3\n", &["r"]).unwrap();
        assert_eq!((&bare.seeds[0][..], bare.sigma), (&[1.0, 3.0][..], None));
    }

    #[test]
    fn what_cannot_be_used_is_said_with_its_line() {
        for (text, what) in [
            ("", "is empty"),
            ("face,value\n0,1\n", "1 of 2 faces are missing"),
            ("face,value\n0,1\n0,1\n", "found.csv:3: face 0 stands here a second time"),
            ("face,value\n0,1\n2,1\n", "found.csv:3: `2` is no face: the scene has the faces 0 to 1"),
            ("face,value\n0,nan\n1,1\n", "found.csv:2: column `value` holds `nan`"),
            ("face,value\n0\n", "found.csv:2: the row has 1 fields, the header 2"),
            ("place,value\n0,1\n", "found.csv:1: there is no column `face`"),
            ("face,brightness\n0,1\n", "found.csv:1: the columns value_grey"),
            ("face,\"value\n0,1\n", "a quote is opened"),
        ] {
            let error = read(text, &["grey"]).unwrap_err().to_string();
            assert!(error.contains(what) && error.contains("help: write a table"), "{error}");
        }
    }
}
