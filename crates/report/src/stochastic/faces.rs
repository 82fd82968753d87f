//! `faces.csv` of a stochastic run: means of the irradiance over input faces with their standard
//! errors.
//!
//! Columns: `face` (number, from 0), `surface` (name), `cx, cy, cz` (centroid, m), `area` (m²),
//! then band by band `irradiance_BAND` and `standard_error_BAND` (W/m²).

use std::io::{self, Write};

use fredholm_mesh::Mesh;

use crate::ReportError;
use crate::csv::{header, numbers, quoted};

pub(super) const COLUMNS: &str = "face,surface,cx,cy,cz,area";

/// Estimates of every input face and band, face-major, W/m².
#[derive(Clone, Copy, Debug)]
pub struct FaceEstimates<'a> {
    mesh: &'a Mesh,
    bands: &'a [String],
    irradiance: &'a [f64],
    error: &'a [f64],
}

impl<'a> FaceEstimates<'a> {
    /// Irradiances and their standard errors.
    ///
    /// # Errors
    /// [`ReportError::Length`] where there is not one of each a face and band.
    pub fn new(
        mesh: &'a Mesh,
        bands: &'a [String],
        irradiance: &'a [f64],
        error: &'a [f64],
    ) -> Result<Self, ReportError> {
        let expected = mesh.faces().len() * bands.len();
        for (what, values) in [("the irradiance of faces", irradiance), ("their standard error", error)] {
            if values.len() != expected {
                return Err(ReportError::Length { what, expected, found: values.len() });
            }
        }
        Ok(Self { mesh, bands, irradiance, error })
    }
}

/// Writes the table.
///
/// # Errors
/// What `out` reports.
pub fn write_face_estimates(faces: &FaceEstimates<'_>, out: &mut dyn Write) -> io::Result<()> {
    let bands = faces.bands.len();
    header(out, COLUMNS, &["irradiance", "standard_error"], faces.bands)?;
    for face in 0..faces.mesh.faces().len() {
        place(faces.mesh, face, out)?;
        let at = face * bands..(face + 1) * bands;
        numbers(out, at.flat_map(|at| [faces.irradiance[at], faces.error[at]]))?;
        writeln!(out)?;
    }
    Ok(())
}

/// The columns that say which face it is.
pub(super) fn place(mesh: &Mesh, number: usize, out: &mut dyn Write) -> io::Result<()> {
    let face = &mesh.faces()[number];
    write!(out, "{number},{}", quoted(&mesh.surfaces()[face.surface].name))?;
    numbers(out, face.centroid.to_array())?;
    numbers(out, [face.area])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::parse;
    use crate::field::tests::{names, sample};

    #[test]
    fn each_band_has_a_value_and_an_error() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let (values, errors) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
        let faces = FaceEstimates::new(&mesh, &bands, &values, &errors).unwrap();
        let mut out = Vec::new();
        write_face_estimates(&faces, &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[0][6..], ["irradiance_r", "standard_error_r", "irradiance_g", "standard_error_g"]);
        assert_eq!(rows[2][6..], ["3", "0.3", "4", "0.4"]);
        assert_eq!(rows.len(), 4);
        assert!(FaceEstimates::new(&mesh, &bands, &values, &errors[1..]).is_err());
    }
}
