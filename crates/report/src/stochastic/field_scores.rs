//! The files of a comparison of sampled with computed waves. `crosscheck.json` is written last.
//!
//! Columns of `crosscheck.csv`: `receiver, index, x, y, z, frequency, component`, then
//! `deterministic`, `deterministic_error`, `stochastic`, `standard_error` (scattered E, V/m),
//! `score`, `p`, and `significant` (1 or 0). A component is `ex_re`, `ex_im`, … `ez_im`.

use std::io::{self, Write};

use super::crosscheck::{CrosscheckRecord, json};
use super::histogram::write_score_histogram;
use crate::csv::{numbers, quoted};
use crate::{CROSSCHECK_FILES, ReportError, ResultFolder};

/// Names of the six numbers of a field.
pub const COMPONENTS: [&str; 6] = ["ex_re", "ex_im", "ey_re", "ey_im", "ez_re", "ez_im"];

/// One number of the field at one point and frequency; V/m.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldScore {
    /// Name of the receiver.
    pub receiver: String,
    /// Number of the point in the receiver.
    pub index: usize,
    /// Place, m.
    pub position: [f64; 3],
    /// Frequency, Hz.
    pub frequency: f64,
    /// Number of the component, as [`COMPONENTS`] has them.
    pub component: usize,
    /// Deterministic value and what it says of its error.
    pub deterministic: [f64; 2],
    /// Stochastic value and its standard error.
    pub stochastic: [f64; 2],
    /// Normal score of the difference.
    pub score: f64,
    /// Two-sided probability of it.
    pub p: f64,
    /// Whether it is significant.
    pub significant: bool,
}

fn table(rows: &[FieldScore], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "receiver,index,x,y,z,frequency,component")?;
    writeln!(out, ",deterministic,deterministic_error,stochastic,standard_error,score,p,significant")?;
    for row in rows {
        write!(out, "{},{}", quoted(&row.receiver), row.index)?;
        numbers(out, row.position.into_iter().chain([row.frequency]))?;
        write!(out, ",{}", COMPONENTS[row.component])?;
        numbers(out, row.deterministic.into_iter().chain(row.stochastic).chain([row.score, row.p]))?;
        writeln!(out, ",{}", u8::from(row.significant))?;
    }
    Ok(())
}

/// Writes table, histogram and record into a folder.
///
/// # Errors
/// [`ReportError::Write`] with the file or folder that could not be written. The folder then has no
/// `crosscheck.json`.
pub fn write_field_crosscheck(
    folder: &ResultFolder,
    rows: &[FieldScore],
    record: &CrosscheckRecord,
) -> Result<(), ReportError> {
    let [values, histogram, _, last] = CROSSCHECK_FILES;
    let scores: Vec<f64> = rows.iter().map(|row| row.score).collect();
    folder.write(values, |out| table(rows, out))?;
    folder.write(histogram, |out| write_score_histogram(&record.headline(), &scores, out))?;
    folder.write(last, |out| json(record, out)).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::parse;

    #[test]
    fn a_row_says_where_and_how_far() {
        let row = FieldScore {
            receiver: "a".into(),
            index: 2,
            position: [1.0, 2.0, 3.0],
            frequency: 1e9,
            component: 4,
            deterministic: [2.0, 0.5],
            stochastic: [3.0, 0.25],
            score: 1.5,
            p: 0.125,
            significant: true,
        };
        let mut out = Vec::new();
        table(&[row], &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[0].len(), rows[1].len());
        assert_eq!(rows[1][6..].join(","), "ez_re,2,0.5,3,0.25,1.5,0.125,1");
    }
}
