//! `converge.csv`: a row a level.
//!
//! Columns: `level`, `elements`, `unknowns`, `h` (m), `seconds`; band by band `difference_BAND`,
//! `error_BAND`, `order_BAND`, `remaining_BAND`; surface by surface and band by band
//! `irradiance_SURFACE_BAND` (W/m²). What is not known is empty.

use std::io::{self, Write};

use super::record::{BandConvergence, RefinementRecord};
use crate::csv::{numbers, quoted};
use crate::number::Number;

const COLUMNS: &str = "level,elements,unknowns,h,seconds";
const QUANTITIES: [&str; 4] = ["difference", "error", "order", "remaining"];

/// Writes the table of levels.
///
/// # Errors
/// What `out` reports.
pub fn write_refinement_csv(record: &RefinementRecord, out: &mut dyn Write) -> io::Result<()> {
    let bands: Vec<String> = record.bands.iter().map(|band| band.band.clone()).collect();
    out.write_all(COLUMNS.as_bytes())?;
    for title in bands.iter().flat_map(|band| QUANTITIES.map(|quantity| format!("{quantity}_{band}"))) {
        write!(out, ",{}", quoted(&title))?;
    }
    for surface in &record.surfaces {
        for band in &bands {
            write!(out, ",{}", quoted(&format!("irradiance_{surface}_{band}")))?;
        }
    }
    writeln!(out)?;
    (0..record.levels.len()).try_for_each(|level| row(record, level, out))
}

fn row(record: &RefinementRecord, at: usize, out: &mut dyn Write) -> io::Result<()> {
    let level = &record.levels[at];
    write!(out, "{},{},{}", level.level, level.elements, level.unknowns)?;
    numbers(out, [level.h, level.seconds])?;
    record.bands.iter().try_for_each(|band| convergence(band, at, out))?;
    numbers(out, level.irradiance.iter().flatten().copied())?;
    writeln!(out)
}

fn convergence(band: &BandConvergence, at: usize, out: &mut dyn Write) -> io::Result<()> {
    let known = |values: &Vec<Option<f64>>| values.get(at).copied().flatten();
    let difference = band.differences.get(at).copied();
    let values = [difference, known(&band.errors), known(&band.orders), known(&band.remainders)];
    values.into_iter().try_for_each(|value| match value {
        Some(value) => write!(out, ",{}", Number(value)),
        None => write!(out, ","),
    })
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::csv::tests::parse;

    #[test]
    fn what_is_not_known_is_empty() {
        let mut out = Vec::new();
        write_refinement_csv(&sample(), &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[0].len(), 5 + 2 * 4 + 2);
        assert_eq!(rows[0][5..9], ["difference_r", "error_r", "order_r", "remaining_r"]);
        assert_eq!(rows[0][13], "irradiance_floor, lower_r");
        assert_eq!(rows[1][..9], ["0", "2", "8", "1", "0.25", "0.9375", "1", "", ""]);
        assert_eq!(rows[3][5..], ["0", "0.0625", "2", "0.0625", "0", "", "", "", "1.0625", "2"]);
        assert_eq!(rows.len(), 4);
    }
}
