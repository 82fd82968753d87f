//! `field.csv`: a row per leaf element.
//!
//! Columns: `element` (number of the unknown, from 0), `face` (number of its input face), `surface`
//! (name), `cx, cy, cz` (centroid, m), `nx, ny, nz` (unit normal to the lit side), `area` (m²),
//! then band by band `irradiance_BAND` and `radiosity_BAND` (W/m²).

use std::io::{self, Write};

use crate::Field;
use crate::csv::{header, numbers, quoted};

const COLUMNS: &str = "element,face,surface,cx,cy,cz,nx,ny,nz,area";

/// Writes the table of leaf elements.
///
/// # Errors
/// What `out` reports.
pub fn write_field_csv(field: &Field<'_>, out: &mut dyn Write) -> io::Result<()> {
    header(out, COLUMNS, &["irradiance", "radiosity"], field.bands())?;
    (0..field.mesh().len()).try_for_each(|leaf| row(field, leaf, out))
}

fn row(field: &Field<'_>, leaf: usize, out: &mut dyn Write) -> io::Result<()> {
    let (mesh, patch) = (field.mesh(), field.mesh().patch(leaf));
    let surface = &mesh.surfaces()[mesh.surface_of(leaf)].name;
    write!(out, "{leaf},{},{}", mesh.face_of(leaf), quoted(surface))?;
    numbers(out, patch.centroid().to_array())?;
    numbers(out, patch.normal().to_array())?;
    numbers(out, [patch.area()])?;
    let (e, b) = (field.row(field.irradiance(), leaf), field.row(field.radiosity(), leaf));
    numbers(out, e.iter().zip(b).flat_map(|(&e, &b)| [e, b]))?;
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::{parse, values};
    use crate::field::tests::{names, sample};

    #[test]
    fn every_value_reads_back() {
        let (mesh, bands) = (sample(), names(&["r", "540nm"]));
        let e = [0.1, 0.2, 1.0 / 3.0, 1e-17, 5e20, 0.0];
        let b = e.map(|x| x * 1.1);
        let field = Field::new(&mesh, &bands, &e, &b).unwrap();
        let mut out = Vec::new();
        write_field_csv(&field, &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        let titles = [
            "element",
            "face",
            "surface",
            "cx",
            "cy",
            "cz",
            "nx",
            "ny",
            "nz",
            "area",
            "irradiance_r",
            "radiosity_r",
            "irradiance_540nm",
            "radiosity_540nm",
        ];
        assert_eq!(rows[0], titles);
        assert_eq!(rows.len(), 4);
        assert_eq!(rows[1][2], "wall, \"north\"");
        assert_eq!(rows[3][..3], ["2", "2", "<lamp & shade>"]);
        assert_eq!(values(&rows[2], 3), [1.5, 0.5, 0.0, 0.0, 0.0, 1.0, 1.0, e[2], b[2], e[3], b[3]]);
        assert_eq!(values(&rows[3], 6)[..3], [0.0, 0.0, -1.0]);
        approx_eq(values(&rows[3], 9)[0], 1.0 / 6.0);
    }

    fn approx_eq(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-15, "{a} {b}");
    }
}
