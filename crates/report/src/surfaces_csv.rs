//! `surfaces.csv`: area means and powers of each named surface.
//!
//! Columns: `surface` (name), `faces`, `elements`, `area` (m²), then band by band
//! `irradiance_BAND`, `radiosity_BAND` (area means, W/m²) and, where the exitance M is known, the
//! powers in W
//!
//! - `emitted_BAND`   Σ Aᵢ Mᵢ
//! - `reflected_BAND` Σ Aᵢ (Bᵢ − Mᵢ)
//! - `absorbed_BAND`  Σ Aᵢ (Eᵢ − (Bᵢ − Mᵢ))
//!
//! with the irradiance E and the radiosity B. A surface without elements has area 0 and values 0.

use std::io::{self, Write};

use crate::Field;
use crate::csv::{header, numbers, quoted};
use crate::mean::Means;

const COLUMNS: &str = "surface,faces,elements,area";
const MEAN_COLUMNS: [&str; 2] = ["irradiance", "radiosity"];
const ALL_COLUMNS: [&str; 5] = ["irradiance", "radiosity", "emitted", "reflected", "absorbed"];

struct Quantities {
    irradiance: Means,
    radiosity: Means,
    exitance: Option<Means>,
}

impl Quantities {
    fn new(field: &Field<'_>) -> Self {
        let mesh = field.mesh();
        let means = |values| Means::new(field, values, mesh.surfaces().len(), |leaf| mesh.surface_of(leaf));
        Self {
            irradiance: means(field.irradiance()),
            radiosity: means(field.radiosity()),
            exitance: field.exitance().map(means),
        }
    }

    fn values(&self, surface: usize, band: usize) -> Vec<f64> {
        let mut row = vec![self.irradiance.mean(surface, band), self.radiosity.mean(surface, band)];
        if let Some(exitance) = &self.exitance {
            let emitted = exitance.integral(surface, band);
            let reflected = self.radiosity.integral(surface, band) - emitted;
            row.extend([emitted, reflected, self.irradiance.integral(surface, band) - reflected]);
        }
        row
    }
}

/// Writes the table of surfaces.
///
/// # Errors
/// What `out` reports.
pub fn write_surfaces_csv(field: &Field<'_>, out: &mut dyn Write) -> io::Result<()> {
    let quantities = Quantities::new(field);
    let titles = if quantities.exitance.is_some() { &ALL_COLUMNS[..] } else { &MEAN_COLUMNS[..] };
    header(out, COLUMNS, titles, field.bands())?;
    let (faces, elements) = counts(field);
    for (i, surface) in field.mesh().surfaces().iter().enumerate() {
        write!(out, "{},{},{}", quoted(&surface.name), faces[i], elements[i])?;
        numbers(out, [quantities.irradiance.area(i)])?;
        numbers(out, (0..field.bands().len()).flat_map(|band| quantities.values(i, band)))?;
        writeln!(out)?;
    }
    Ok(())
}

fn counts(field: &Field<'_>) -> (Vec<usize>, Vec<usize>) {
    let mesh = field.mesh();
    let (mut faces, mut elements) = (vec![0; mesh.surfaces().len()], vec![0; mesh.surfaces().len()]);
    mesh.faces().iter().for_each(|face| faces[face.surface] += 1);
    (0..mesh.len()).for_each(|leaf| elements[mesh.surface_of(leaf)] += 1);
    (faces, elements)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::{parse, values};
    use crate::field::tests::{names, sample};

    fn table(field: &Field<'_>) -> Vec<Vec<String>> {
        let mut out = Vec::new();
        write_surfaces_csv(field, &mut out).unwrap();
        parse(&String::from_utf8(out).unwrap())
    }

    #[test]
    fn powers_balance() {
        let (mesh, bands) = (sample(), names(&["grey"]));
        // Reflectance 0.5 on the wall; the lamp emits 3 W/m² and reflects nothing.
        let field = Field::new(&mesh, &bands, &[2.0, 4.0, 6.0], &[1.0, 2.0, 3.0]).unwrap();
        let field = field.with_exitance(&[0.0, 0.0, 3.0]).unwrap();
        let rows = table(&field);
        assert_eq!(
            rows[0].join(","),
            "surface,faces,elements,area,irradiance_grey,radiosity_grey,emitted_grey,reflected_grey,absorbed_grey"
        );
        assert_eq!(rows[1][0], "wall, \"north\"");
        assert_eq!(values(&rows[1], 1), [2.0, 2.0, 2.0, 3.0, 1.5, 0.0, 3.0, 3.0]);
        let lamp = values(&rows[2], 1);
        for (found, expected) in lamp.iter().zip([1.0, 1.0, 1.0 / 6.0, 6.0, 3.0, 0.5, 0.0, 1.0]) {
            assert!((found - expected).abs() < 1e-15, "{lamp:?}");
        }
    }

    #[test]
    fn without_exitance_there_are_no_powers() {
        let (mesh, bands) = (sample(), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[2.0, 4.0, 6.0], &[1.0, 2.0, 3.0]).unwrap();
        assert_eq!(table(&field)[0].join(","), "surface,faces,elements,area,irradiance_grey,radiosity_grey");
    }
}
