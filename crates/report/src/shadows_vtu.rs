//! `shadows.vtu`: triangles that are cut along the borders of shadows, with the irradiance at their
//! corners, as a VTK unstructured grid for `ParaView`.
//!
//! Triangles share no points: on a border each side has its own irradiance. Point data:
//! `irradiance_BAND` (W/m²). Cell data: `element`, the number of the element that the triangle is a
//! part of. Metres.

use std::io::{self, Write};

use fredholm_mesh::Vec3;

use crate::vtu::{Array, TRIANGLE, write_grid};

/// Triangles with the irradiance at their corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShadowMesh {
    /// Corners, m.
    pub triangles: Vec<[Vec3; 3]>,
    /// Element that each triangle is a part of.
    pub elements: Vec<usize>,
    /// Corners × bands, W/m².
    pub irradiance: Vec<f64>,
}

/// Writes the triangles.
///
/// # Errors
/// What `out` reports.
pub fn write_shadows_vtu(mesh: &ShadowMesh, bands: &[String], out: &mut dyn Write) -> io::Result<()> {
    let (n, corners) = (mesh.triangles.len(), 3 * mesh.triangles.len());
    let places = || mesh.triangles.iter().flatten().flat_map(Vec3::to_array);
    let kinds = Array {
        name: "types".to_owned(),
        kind: "UInt8",
        components: 1,
        fill: Box::new(move |out| (0..n).try_for_each(|_| out.write_all(&[TRIANGLE]))),
    };
    let band = |(k, name): (usize, &String)| {
        let values = move || mesh.irradiance.iter().skip(k).step_by(bands.len()).copied();
        Array::floats(format!("irradiance_{name}"), 1, values)
    };
    let cells = vec![
        Array::integers("connectivity", move || 0..corners),
        Array::integers("offsets", move || (1..=n).map(|k| 3 * k)),
        kinds,
    ];
    let sections = [
        ("Points", vec![Array::floats("Points".to_owned(), 3, places)]),
        ("Cells", cells),
        ("PointData", bands.iter().enumerate().map(band).collect()),
        ("CellData", vec![Array::integers("element", || mesh.elements.iter().copied())]),
    ];
    write_grid([corners, n], &sections, out)
}
