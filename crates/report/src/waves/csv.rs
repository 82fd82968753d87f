//! `receivers.csv` and `far.csv`: a row per point (or direction) and frequency.
//!
//! Columns of `receivers.csv`: `receiver` (name), `index`, `x, y, z` (m), `frequency` (Hz), then
//! with the prefixes `inc_` (incident), `sca_` (scattered) and `tot_` (both) the phasors
//! `ex_re, ex_im, … hz_im` (V/m, A/m). Columns of `far.csv`: `receiver`, `index`, `theta_degrees`,
//! `phi_degrees`, `frequency`, `f_theta_re, f_theta_im, f_phi_re, f_phi_im` (V),
//! `rcs_theta, rcs_phi` (m², empty without an incident plane wave), and with the sources in, where
//! all are at places and else empty, `t_theta_re, t_theta_im, t_phi_re, t_phi_im` (V) and `gain`
//! (over the power that the sources supply).

use std::io::{self, Write};

use super::{FarRow, WaveRow};
use crate::csv::{numbers, quoted};

const PREFIXES: [&str; 3] = ["inc", "sca", "tot"];
const COMPONENTS: [&str; 6] = ["ex", "ey", "ez", "hx", "hy", "hz"];
const FAR_HEADER: &str = "receiver,index,theta_degrees,phi_degrees,frequency,f_theta_re,f_theta_im,f_phi_re,f_phi_im,rcs_theta,rcs_phi,t_theta_re,t_theta_im,t_phi_re,t_phi_im,gain";

/// Writes the fields at the receivers, whose names are given in their order.
///
/// # Errors
/// What `out` reports.
pub fn write_receivers_csv(names: &[String], rows: &[WaveRow], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "receiver,index,x,y,z,frequency")?;
    for prefix in PREFIXES {
        COMPONENTS.iter().try_for_each(|c| write!(out, ",{prefix}_{c}_re,{prefix}_{c}_im"))?;
    }
    writeln!(out)?;
    for row in rows {
        write!(out, "{},{}", quoted(name(names, row.receiver)), row.index)?;
        numbers(out, row.position)?;
        numbers(out, [row.frequency])?;
        numbers(out, [row.incident, row.scattered, row.total()].into_iter().flatten())?;
        writeln!(out)?;
    }
    Ok(())
}

/// Writes the far fields.
///
/// # Errors
/// What `out` reports.
pub fn write_far_csv(names: &[String], rows: &[FarRow], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{FAR_HEADER}")?;
    for row in rows {
        write!(out, "{},{}", quoted(name(names, row.receiver)), row.index)?;
        numbers(out, [row.theta_degrees, row.phi_degrees, row.frequency])?;
        numbers(out, row.amplitude)?;
        match row.cross_section {
            Some(sections) => numbers(out, sections)?,
            None => write!(out, ",,")?,
        }
        match row.total {
            Some(total) => numbers(out, total.amplitude.into_iter().chain([total.gain]))?,
            None => write!(out, ",,,,,")?,
        }
        writeln!(out)?;
    }
    Ok(())
}

fn name(names: &[String], receiver: usize) -> &str {
    names.get(receiver).map_or("", String::as_str)
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "numbers are written so that they read back to the same bits")]
pub(super) mod tests {
    use super::*;
    use crate::csv::tests::{parse, values};
    use crate::waves::FarTotal;

    pub(in crate::waves) fn rows() -> Vec<WaveRow> {
        let fill = |start: f64| std::array::from_fn(|i| start + i as f64 / 7.0);
        let row = |index: usize| WaveRow {
            receiver: index % 2,
            index,
            position: [1.0, index as f64, 1.0 / 3.0],
            frequency: 2.4e9,
            incident: fill(0.1),
            scattered: fill(-3.0 * index as f64),
        };
        (0..3).map(row).collect()
    }

    #[test]
    fn every_number_reads_back_under_its_title() {
        let mut out = Vec::new();
        let names = ["near, left".to_owned(), "b".to_owned()];
        write_receivers_csv(&names, &rows(), &mut out).unwrap();
        let table = parse(&String::from_utf8(out).unwrap());
        assert_eq!(table[0].len(), 6 + 36);
        assert_eq!((table[0][6].as_str(), table[0][41].as_str()), ("inc_ex_re", "tot_hz_im"));
        let sca_ez_im = table[0].iter().position(|title| title == "sca_ez_im").unwrap();
        for (row, expected) in table[1..].iter().zip(rows()) {
            assert_eq!(row[0], names[expected.receiver]);
            let numbers = values(row, 2);
            assert_eq!(numbers[..3], expected.position);
            assert_eq!(numbers[sca_ez_im - 2], expected.scattered[5]);
            assert_eq!(numbers[4 + 24..], expected.total());
        }
    }

    #[test]
    fn a_far_field_without_plane_wave_has_no_cross_section() {
        let row = FarRow {
            receiver: 0,
            index: 4,
            theta_degrees: 90.0,
            phi_degrees: 270.0,
            frequency: 1e9,
            amplitude: [1.0, 2.0, 3.0, 4.0],
            cross_section: None,
            total: Some(FarTotal { amplitude: [5.0, 6.0, 7.0, 8.0], gain: 1.5 }),
        };
        let with = FarRow { cross_section: Some([0.5, 0.25]), total: None, ..row.clone() };
        let mut out = Vec::new();
        write_far_csv(&["f".to_owned()], &[row, with], &mut out).unwrap();
        let table = parse(&String::from_utf8(out).unwrap());
        assert_eq!(table[1][9..11], ["", ""]);
        assert_eq!(values(&table[1], 11), [5.0, 6.0, 7.0, 8.0, 1.5]);
        assert_eq!(values(&table[2][..11], 1), [4.0, 90.0, 270.0, 1e9, 1.0, 2.0, 3.0, 4.0, 0.5, 0.25]);
        assert_eq!(table[2][11..], ["", "", "", "", ""]);
        assert_eq!(table[0].len(), table[1].len());
    }
}
