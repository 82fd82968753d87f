//! Methods compared on one scene of waves: `methods.csv` (a row a method, receiver and frequency),
//! `methods_over_angle.csv` (the curves of all methods), `methods.json` last.
//!
//! Columns of the first: `method`, `outcome`, `receiver`, `frequency` (Hz), `stated_error`,
//! `difference`, `level_difference` (dB), `facets`, `seconds`, `reason`; of the second:
//! `receiver`, `frequency`, `method`, `quantity`, `unit`, `angle_degrees`, `value`. What is not
//! known is empty.

use std::io::{self, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::AngleQuantity;
use crate::csv::quoted;
use crate::number::Number;
use crate::{ReportError, ResultFolder, Timing};

/// Name of the format of `methods.json`.
pub const METHODS_FORMAT: &str = "fredholm-waves-methods-1";
/// The files of a comparison of methods, beside plots and maps of the receivers.
pub const METHODS_FILES: [&str; 3] = ["methods.csv", "methods_over_angle.csv", "methods.json"];

const COLUMNS: &str = "method,outcome,receiver,frequency,stated_error,difference,level_difference,\
                       facets,seconds,reason";
const CURVE_COLUMNS: &str = "receiver,frequency,method,quantity,unit,angle_degrees,value";

/// What methods made of a scene, and what made it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct MethodsRecord {
    /// [`METHODS_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file.
    pub scene: String,
    /// SHA-256 of the scene file and the files it names.
    pub scene_sha256: String,
    /// The method that the others are compared with: that of the least stated error.
    pub reference: String,
    /// Whether the run was cancelled before all methods were done.
    pub partial: bool,
    /// The methods in the order asked for.
    pub methods: Vec<MethodRun>,
    /// Times of the stages, a method in front.
    pub timings: Vec<Timing>,
    /// What the user should know, a method in front.
    pub warnings: Vec<String>,
}

/// One method.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct MethodRun {
    /// The method as it was asked for.
    pub method: String,
    /// `done`, `not converged`, or `refused`.
    pub outcome: String,
    /// Why it was refused.
    pub reason: Option<String>,
    /// How many bounces were summed, or the solver.
    pub solution: String,
    /// Facets of the scatterer.
    pub facets: u64,
    /// Seconds by the clock, from the scene file to the fields.
    pub seconds: f64,
    /// What it came to at every receiver and frequency.
    pub receivers: Vec<MethodAtReceiver>,
}

impl MethodRun {
    /// The largest of some figure over all receivers and frequencies.
    #[must_use]
    pub fn worst(&self, of: fn(&MethodAtReceiver) -> Option<f64>) -> Option<f64> {
        self.receivers.iter().filter_map(of).max_by(f64::total_cmp)
    }
}

/// One method at one receiver and frequency.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct MethodAtReceiver {
    /// Name of the receiver.
    pub receiver: String,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Error that the method states of itself, relative to the scattered field, L².
    pub stated_error: Option<f64>,
    /// Difference of the scattered field from that of the reference, relative to it, L² over the
    /// points or directions; none of the reference itself.
    pub difference: Option<f64>,
    /// Largest difference of the level from that of the reference where this is within 20 dB of its
    /// largest, dB; none of the reference itself.
    pub level_difference: Option<f64>,
}

/// The curves of all methods over an angle at one receiver and frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodCurves {
    /// Name of the receiver.
    pub receiver: String,
    /// Frequency, Hz.
    pub frequency: f64,
    /// What the values are.
    pub quantity: AngleQuantity,
    /// The method, and angles (degrees) with values.
    pub lines: Vec<(String, Vec<(f64, f64)>)>,
}

/// Writes the tables and the record, the record last.
///
/// # Errors
/// [`ReportError::Write`] with the path.
pub fn write_methods(
    folder: &ResultFolder,
    record: &MethodsRecord,
    curves: &[MethodCurves],
) -> Result<(), ReportError> {
    let [all, over_angle, json] = METHODS_FILES;
    folder.write(all, |out| table(record, out))?;
    if !curves.is_empty() {
        folder.write(over_angle, |out| values(curves, out))?;
    }
    let record = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, record)?;
        writeln!(out)
    };
    folder.write(json, record).map(drop)
}

fn table(record: &MethodsRecord, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{COLUMNS}")?;
    for run in &record.methods {
        let head = format!("{},{}", quoted(&run.method), quoted(&run.outcome));
        if run.receivers.is_empty() {
            let reason = quoted(run.reason.as_deref().unwrap_or_default());
            writeln!(out, "{head},,,,,,,{},{reason}", Number(run.seconds))?;
        }
        for at in &run.receivers {
            write!(out, "{head},{},{}", quoted(&at.receiver), Number(at.frequency))?;
            for value in [at.stated_error, at.difference, at.level_difference] {
                match value {
                    Some(value) => write!(out, ",{}", Number(value))?,
                    None => write!(out, ",")?,
                }
            }
            writeln!(out, ",{},{},", run.facets, Number(run.seconds))?;
        }
    }
    Ok(())
}

fn values(curves: &[MethodCurves], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{CURVE_COLUMNS}")?;
    for MethodCurves { receiver, frequency, quantity, lines } in curves {
        let AngleQuantity { name, unit, .. } = quantity;
        let (receiver, frequency) = (quoted(receiver), Number(*frequency));
        for (method, points) in lines {
            let head = format!("{receiver},{frequency},{},{},{unit}", quoted(method), quoted(name));
            for (angle, value) in points {
                writeln!(out, "{head},{},{}", Number(*angle), Number(*value))?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::parse;

    fn record() -> MethodsRecord {
        let at = |difference| MethodAtReceiver {
            receiver: "a, b".to_owned(),
            frequency: 1e9,
            stated_error: Some(0.01),
            difference,
            level_difference: difference,
        };
        let run = |method: &str, difference| MethodRun {
            method: method.to_owned(),
            outcome: "done".to_owned(),
            facets: 12,
            seconds: 0.5,
            receivers: vec![at(difference)],
            ..MethodRun::default()
        };
        let refused = MethodRun {
            method: "cfie".to_owned(),
            outcome: "refused".to_owned(),
            reason: Some("the body, \"a\", is open".to_owned()),
            ..MethodRun::default()
        };
        let methods = vec![run("efie", None), refused, run("physical-optics:edges", Some(0.25))];
        MethodsRecord { format: METHODS_FORMAT.to_owned(), methods, ..MethodsRecord::default() }
    }

    #[test]
    fn every_method_has_a_row_and_the_refused_ones_a_reason() {
        let mut out = Vec::new();
        table(&record(), &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert!(rows.len() == 4 && rows.iter().all(|row| row.len() == rows[0].len()));
        assert_eq!(rows[1][..7], ["efie", "done", "a, b", "1000000000", "0.01", "", ""]);
        assert_eq!((rows[2][1].as_str(), rows[2][9].as_str()), ("refused", "the body, \"a\", is open"));
        assert_eq!(rows[3][5..9], ["0.25", "0.25", "12", "0.5"]);
    }

    #[test]
    fn values_of_all_methods_stand_under_each_other() {
        let line = |method: &str| (method.to_owned(), vec![(0.0, 1.5), (10.0, 2.0)]);
        let curves = MethodCurves {
            receiver: "far".to_owned(),
            frequency: 1e9,
            quantity: AngleQuantity::cross_section("φ"),
            lines: vec![line("efie"), line("mfie")],
        };
        let mut out = Vec::new();
        values(&[curves], &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows.len(), 5);
        assert_eq!(rows[4], ["far", "1000000000", "mfie", "radar cross-section σ", "m²", "10", "2"]);
    }

    #[test]
    fn the_record_reads_back() {
        let text = serde_json::to_string(&record()).unwrap();
        assert_eq!(serde_json::from_str::<MethodsRecord>(&text).unwrap(), record());
    }
}
