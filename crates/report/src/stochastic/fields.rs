//! `receivers.csv` of sampled waves: the scattered field at receivers with its standard error.
//!
//! Columns: `receiver` (name), `index`, `x, y, z` (m), `frequency` (Hz),
//! `sca_ex_re, sca_ex_im, … sca_ez_im` and `standard_error` (V/m; root of the sum of squares over
//! the components).

use std::io::{self, Write};

use crate::csv::{numbers, quoted};

/// The field at one point and frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledField {
    /// Name of the receiver.
    pub receiver: String,
    /// Number of the point in the receiver.
    pub index: usize,
    /// Place, m.
    pub position: [f64; 3],
    /// Frequency, Hz.
    pub frequency: f64,
    /// Real and imaginary part of each component of E, V/m.
    pub e: [f64; 6],
    /// Standard error, V/m.
    pub error: f64,
}

/// Writes the table.
///
/// # Errors
/// What `out` reports.
pub fn write_sampled_fields(rows: &[SampledField], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "receiver,index,x,y,z,frequency")?;
    ["ex", "ey", "ez"].iter().try_for_each(|c| write!(out, ",sca_{c}_re,sca_{c}_im"))?;
    writeln!(out, ",standard_error")?;
    for row in rows {
        write!(out, "{},{}", quoted(&row.receiver), row.index)?;
        numbers(out, row.position.into_iter().chain([row.frequency]).chain(row.e).chain([row.error]))?;
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::parse;

    #[test]
    fn a_row_has_a_place_a_field_and_an_error() {
        let row = SampledField {
            receiver: "a, b".into(),
            index: 3,
            position: [1.0, 2.0, 3.0],
            frequency: 1e9,
            e: [1.0, -1.0, 2.0, -2.0, 0.5, -0.5],
            error: 0.25,
        };
        let mut out = Vec::new();
        write_sampled_fields(&[row], &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[0].len(), rows[1].len());
        assert_eq!(rows[1].join("|"), "a, b|3|1|2|3|1000000000|1|-1|2|-2|0.5|-0.5|0.25");
    }
}
