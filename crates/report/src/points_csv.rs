//! `points.csv`: the irradiance of points with a normal.
//!
//! Columns: `x, y, z` (m), `nx, ny, nz` (unit normal), then `irradiance_BAND` (W/m²) of each band.

use std::io::{self, Write};

use fredholm_mesh::Vec3;

use crate::csv::{header, numbers};
use crate::number::Number;

/// The irradiance of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointTable {
    /// Places (m) and unit normals.
    pub points: Vec<[Vec3; 2]>,
    /// Points × bands, W/m².
    pub irradiance: Vec<f64>,
}

/// Writes the table of points.
///
/// # Errors
/// What `out` reports.
pub fn write_points_csv(table: &PointTable, bands: &[String], out: &mut dyn Write) -> io::Result<()> {
    header(out, "x,y,z,nx,ny,nz", &["irradiance"], bands)?;
    for ([point, normal], row) in table.points.iter().zip(table.irradiance.chunks(bands.len())) {
        write!(out, "{}", Number(point.x))?;
        numbers(out, [point.y, point.z].into_iter().chain(normal.to_array()))?;
        numbers(out, row.iter().copied())?;
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::tests::parse;
    use crate::field::tests::names;

    #[test]
    fn every_number_reads_back() {
        let points = vec![[Vec3::new(0.1, -2.0, 1e-9), Vec3::Z], [Vec3::ZERO, Vec3::NEG_X]];
        let table = PointTable { points, irradiance: vec![1.0 / 3.0, 2.0, 5e20, 0.0] };
        let mut out = Vec::new();
        write_points_csv(&table, &names(&["r", "g"]), &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows[0], ["x", "y", "z", "nx", "ny", "nz", "irradiance_r", "irradiance_g"]);
        let read = |row: &[String]| row.iter().map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
        assert_eq!(read(&rows[1]), [0.1, -2.0, 1e-9, 0.0, 0.0, 1.0, 1.0 / 3.0, 2.0]);
        assert_eq!(read(&rows[2]), [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 5e20, 0.0]);
    }
}
