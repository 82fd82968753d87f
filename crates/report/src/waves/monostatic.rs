//! `monostatic.csv`: what a plane wave from a direction sends back to it, a row per direction and
//! frequency.
//!
//! Columns: `receiver`, `index`, `theta_degrees`, `phi_degrees`, `frequency` (Hz), the scattering
//! amplitudes `s_tt_re, s_tt_im, s_pt_…, s_tp_…, s_pp_…` (m; E → S E₀ e^{−jkr}/r, first received,
//! then incident, t along θ̂ and p along φ̂), and `rcs_tt, rcs_pt, rcs_tp, rcs_pp` = 4π|S|² (m²).

use std::io::{self, Write};

use crate::csv::{numbers, quoted};

const NAMES: [&str; 4] = ["tt", "pt", "tp", "pp"];

/// A direction.
#[derive(Clone, Debug, PartialEq)]
pub struct MonostaticRow {
    /// Index of the receiver.
    pub receiver: usize,
    /// Index of the direction in it.
    pub index: usize,
    /// Angle from +z, degrees.
    pub theta_degrees: f64,
    /// Angle from +x about z, degrees.
    pub phi_degrees: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// S_θθ, S_φθ, S_θφ, S_φφ, received then incident: real and imaginary part, m.
    pub scattering: [[f64; 2]; 4],
}

impl MonostaticRow {
    /// Radar cross-sections θθ, φθ, θφ, φφ, m².
    #[must_use]
    pub fn cross_sections(&self) -> [f64; 4] {
        self.scattering.map(|[re, im]| 4.0 * std::f64::consts::PI * (re * re + im * im))
    }
}

/// Writes the sweeps of the receivers, whose names are given in their order.
///
/// # Errors
/// What `out` reports.
pub fn write_monostatic_csv(names: &[String], rows: &[MonostaticRow], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "receiver,index,theta_degrees,phi_degrees,frequency")?;
    NAMES.iter().try_for_each(|name| write!(out, ",s_{name}_re,s_{name}_im"))?;
    NAMES.iter().try_for_each(|name| write!(out, ",rcs_{name}"))?;
    writeln!(out)?;
    for row in rows {
        let name = names.get(row.receiver).map_or("", String::as_str);
        write!(out, "{},{}", quoted(name), row.index)?;
        numbers(out, [row.theta_degrees, row.phi_degrees, row.frequency])?;
        numbers(out, row.scattering.into_iter().flatten())?;
        numbers(out, row.cross_sections())?;
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::{parse, values};

    #[test]
    fn amplitudes_and_cross_sections_stand_under_their_titles() {
        let row = MonostaticRow {
            receiver: 0,
            index: 7,
            theta_degrees: 90.0,
            phi_degrees: 12.5,
            frequency: 1e9,
            scattering: [[3.0, 4.0], [0.0, 0.5], [1.0, 0.0], [0.0, 0.0]],
        };
        let mut out = Vec::new();
        write_monostatic_csv(&["sweep".to_owned()], &[row], &mut out).unwrap();
        let table = parse(&String::from_utf8(out).unwrap());
        assert_eq!((table[0].len(), table[0][13].as_str()), (17, "rcs_tt"));
        assert_eq!(table[0].len(), table[1].len());
        let found = values(&table[1], 1);
        assert_eq!(found[..8], [7.0, 90.0, 12.5, 1e9, 3.0, 4.0, 0.0, 0.5]);
        let expected = [25.0, 0.25, 1.0, 0.0].map(|s| 4.0 * std::f64::consts::PI * s);
        assert!(found[12..].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
