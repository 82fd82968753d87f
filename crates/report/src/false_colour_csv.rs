//! `false_colour.csv`: the numbers of the picture in false colour.
//!
//! Columns: `column, row` (of the pixel, from the upper left), `element`, `face` (numbers, from 0),
//! `surface` (name), `x, y, z` (the point, m), `irradiance` (W/m²).

use std::io::{self, Write};

use fredholm_mesh::Mesh;

use crate::PictureNumber;
use crate::csv::{numbers, quoted};

/// Writes the table of the numbers of a picture in false colour.
///
/// # Errors
/// What `out` reports.
pub fn write_false_colour_csv(mesh: &Mesh, found: &[PictureNumber], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "column,row,element,face,surface,x,y,z,irradiance")?;
    for PictureNumber { pixel: [column, row], element, point, irradiance } in found {
        let surface = quoted(&mesh.surfaces()[mesh.surface_of(*element)].name);
        write!(out, "{column},{row},{element},{},{surface}", mesh.face_of(*element))?;
        numbers(out, point.to_array().into_iter().chain([*irradiance]))?;
        writeln!(out)?;
    }
    Ok(())
}
