//! Building materials by name and frequency: ε′ = a f^b, σ = c f^d (f in GHz, σ in S/m), ε = ε′ −
//! jσ/(ωε₀).
//!
//! Source: Recommendation ITU-R P.2040-3 (08/2023), Effects of building materials and structures on
//! radiowave propagation above about 100 MHz, Table 3, <https://www.itu.int/rec/R-REC-P.2040>. The
//! table is `itu_p2040_3.csv`.

use crate::WaveError;
use crate::medium::PERMITTIVITY;
use num_complex::Complex64;
use std::f64::consts::TAU;

const TABLE: &str = include_str!("itu_p2040_3.csv");

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ItuMaterial {
    /// Name: lower case, words joined by hyphens.
    pub name: &'static str,
    /// a, b, c, d.
    pub constants: [f64; 4],
    /// Frequencies it holds for, GHz.
    pub gigahertz: [f64; 2],
}

/// All rows.
#[must_use]
pub fn itu_materials() -> Vec<ItuMaterial> {
    TABLE.lines().skip(1).filter_map(row).collect()
}

fn row(line: &'static str) -> Option<ItuMaterial> {
    let mut cells = line.split(',');
    let name = cells.next()?;
    let numbers: Vec<f64> = cells.map_while(|cell| cell.parse().ok()).collect();
    let [a, b, c, d, low, high] = *numbers.as_slice() else { return None };
    Some(ItuMaterial { name, constants: [a, b, c, d], gigahertz: [low, high] })
}

/// The relative permittivity of a material of the table at a frequency, Hz.
///
/// # Errors
/// [`WaveError::Material`] for a name that is not in the table, or a frequency that it does not
/// hold for.
pub fn itu_permittivity(name: &str, frequency: f64) -> Result<Complex64, WaveError> {
    let fail = |reason| Err(WaveError::Material { what: name.to_owned(), reason });
    let gigahertz = frequency / 1e9;
    let mut rows = itu_materials().into_iter().filter(|row| row.name == name).peekable();
    if rows.peek().is_none() {
        return fail("it is not in the table of ITU-R P.2040");
    }
    let Some(row) = rows.find(|row| (row.gigahertz[0]..=row.gigahertz[1]).contains(&gigahertz)) else {
        return fail("ITU-R P.2040 gives no values for it at this frequency");
    };
    let [a, b, c, d] = row.constants;
    let conductivity = c * gigahertz.powf(d);
    Ok(Complex64::new(a * gigahertz.powf(b), -conductivity / (TAU * frequency * PERMITTIVITY)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_table_is_read() {
        assert_eq!(itu_materials().len(), TABLE.lines().count() - 1);
    }

    #[test]
    fn concrete_at_wireless_frequencies() {
        let concrete = itu_permittivity("concrete", 2.4e9).unwrap();
        assert!((concrete - Complex64::new(5.24, -0.687)).norm() < 1e-3, "{concrete}");
        // The other row of glass begins at 220 GHz.
        assert!((itu_permittivity("glass", 300e9).unwrap().re - 5.79).abs() < 1e-12);
    }

    #[test]
    fn names_and_frequencies_outside_the_table_are_refused() {
        for (name, frequency) in [("cheese", 1e9), ("concrete", 500e9), ("glass", 150e9), ("wood", 0.0)] {
            assert!(itu_permittivity(name, frequency).is_err(), "{name}");
        }
    }
}
