//! `faces.csv`: area means over the elements of each input face, x̄ = Σ Aᵢ xᵢ / Σ Aᵢ.
//!
//! Columns: `face` (number, from 0), `surface` (name), `cx, cy, cz` (centroid, m), `area` (m²),
//! then band by band `irradiance_BAND` and `radiosity_BAND` (W/m²).

use std::io::{self, Write};

use crate::Field;
use crate::csv::{header, numbers, quoted};
use crate::mean::Means;

const COLUMNS: &str = "face,surface,cx,cy,cz,area";

/// Writes the table of input faces.
///
/// # Errors
/// What `out` reports.
pub fn write_faces_csv(field: &Field<'_>, out: &mut dyn Write) -> io::Result<()> {
    let mesh = field.mesh();
    let [irradiance, radiosity] = face_means(field);
    header(out, COLUMNS, &["irradiance", "radiosity"], field.bands())?;
    for (i, face) in mesh.faces().iter().enumerate() {
        write!(out, "{i},{}", quoted(&mesh.surfaces()[face.surface].name))?;
        numbers(out, face.centroid.to_array())?;
        numbers(out, [face.area])?;
        let bands = 0..field.bands().len();
        numbers(out, bands.flat_map(|band| [irradiance.mean(i, band), radiosity.mean(i, band)]))?;
        writeln!(out)?;
    }
    Ok(())
}

/// Means of irradiance and radiosity over the faces.
fn face_means(field: &Field<'_>) -> [Means; 2] {
    let mesh = field.mesh();
    let means = |values| Means::new(field, values, mesh.faces().len(), |leaf| mesh.face_of(leaf));
    [means(field.irradiance()), means(field.radiosity())]
}

impl Field<'_> {
    /// Area means of irradiance and radiosity over the faces, each faces × bands, W/m².
    #[must_use]
    pub fn face_means(&self) -> [Vec<f64>; 2] {
        let (faces, bands) = (self.mesh().faces().len(), self.bands().len());
        let all = |means: Means| {
            (0..faces)
                .flat_map(|face| (0..bands).map(move |band| (face, band)))
                .map(move |(face, band)| means.mean(face, band))
                .collect()
        };
        face_means(self).map(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::{parse, values};
    use crate::field::tests::names;
    use fredholm_mesh::{MeshBuilder, Patch, Vec3};

    fn rectangle(x0: f64, x1: f64) -> Patch {
        let corner = |x, y| Vec3::new(x, y, 2.0);
        Patch::quad([corner(x0, 0.0), corner(x1, 0.0), corner(x1, 1.0), corner(x0, 1.0)]).unwrap().unwrap()
    }

    #[test]
    fn means_weigh_by_area() {
        let mut builder = MeshBuilder::default();
        builder.surface("floor", 0);
        builder.face(&[rectangle(0.0, 1.0), rectangle(1.0, 4.0)]).unwrap();
        builder.face(&[rectangle(4.0, 5.0)]).unwrap();
        let (mesh, bands) = (builder.build(), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[8.0, 4.0, 7.0], &[4.0, 0.0, 1.0]).unwrap();
        let mut out = Vec::new();
        write_faces_csv(&field, &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[0].join(","), "face,surface,cx,cy,cz,area,irradiance_grey,radiosity_grey");
        assert_eq!(rows[1][..2], ["0", "floor"]);
        assert_eq!(values(&rows[1], 2), [2.0, 0.5, 2.0, 4.0, 5.0, 1.0]);
        assert_eq!(values(&rows[2], 2), [4.5, 0.5, 2.0, 1.0, 7.0, 1.0]);
        assert_eq!(rows.len(), 3);
    }
}
