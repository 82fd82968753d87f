//! `field.npz`: the leaf elements as `NumPy` arrays, uncompressed.
//!
//! | array | type | shape | |
//! |---|---|---|---|
//! | `irradiance`, `radiosity` | f64 | n × bands | W/m² |
//! | `area` | f64 | n | m² |
//! | `exposed` | f64 | n | share that is not buried |
//! | `centroid` | f64 | n × 3 | m |
//! | `normal` | f64 | n × 3 | unit, to the lit side |
//! | `face`, `surface` | i64 | n | numbers, from 0 |
//! | `bands` | text | bands | names |
//!
//! The names of surfaces are in `surfaces.csv`, in the order of these numbers.

use std::io::{self, Cursor, Write};

use fredholm_mesh::{Patch, Vec3};
use ndarray::{Array1, Array2, ArrayView2};
use ndarray_npy::{NpzWriter, WriteNpzError};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::Field;
use crate::viewfactors::write_texts;

/// Writes the leaf elements as arrays. The file is composed in memory: about 8 (2 bands + 10) bytes
/// an element.
///
/// # Errors
/// What `out` reports.
pub fn write_npz(field: &Field<'_>, out: &mut dyn Write) -> io::Result<()> {
    let file = compose(field).map_err(io::Error::other)?;
    out.write_all(&file)
}

fn compose(field: &Field<'_>) -> Result<Vec<u8>, WriteNpzError> {
    let mesh = field.mesh();
    let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
    npz.add_array("irradiance", &rows(field, field.irradiance())?)?;
    npz.add_array("radiosity", &rows(field, field.radiosity())?)?;
    npz.add_array("area", &mesh.patches().map(Patch::area).collect::<Array1<f64>>())?;
    npz.add_array("exposed", &(0..mesh.len()).map(|leaf| field.exposed(leaf)).collect::<Array1<f64>>())?;
    npz.add_array("centroid", &vectors(mesh.patches().map(Patch::centroid)))?;
    npz.add_array("normal", &vectors(mesh.patches().map(Patch::normal)))?;
    npz.add_array("face", &numbers(mesh.len(), |leaf| mesh.face_of(leaf)))?;
    npz.add_array("surface", &numbers(mesh.len(), |leaf| mesh.surface_of(leaf)))?;
    named(npz.finish()?.into_inner(), field.bands()).map_err(|error| WriteNpzError::Zip(error.into()))
}

/// Adds the names of the bands.
fn named(file: Vec<u8>, bands: &[String]) -> io::Result<Vec<u8>> {
    let mut archive = ZipWriter::new_append(Cursor::new(file)).map_err(io::Error::other)?;
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    archive
        .start_file("bands.npy", options.last_modified_time(DateTime::default()))
        .map_err(io::Error::other)?;
    write_texts(&mut archive, bands)?;
    Ok(archive.finish().map_err(io::Error::other)?.into_inner())
}

fn rows<'a>(field: &Field<'_>, values: &'a [f64]) -> Result<ArrayView2<'a, f64>, WriteNpzError> {
    let shape = (field.mesh().len(), field.bands().len());
    ArrayView2::from_shape(shape, values).map_err(|error| WriteNpzError::Zip(io::Error::other(error).into()))
}

fn vectors(items: impl ExactSizeIterator<Item = Vec3>) -> Array2<f64> {
    let rows: Vec<[f64; 3]> = items.map(|v| v.to_array()).collect();
    Array2::from(rows)
}

fn numbers(n: usize, of: impl Fn(usize) -> usize) -> Array1<i64> {
    // A count of elements in memory always fits 63 bits.
    (0..n).map(|leaf| i64::try_from(of(leaf)).unwrap_or(i64::MAX)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{names, sample};
    use ndarray::array;
    use ndarray_npy::NpzReader;

    #[test]
    fn every_array_reads_back() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let e = [0.1, 0.2, 1.0 / 3.0, 1e-17, 5e20, 0.0];
        let b = e.map(|x| x * 1.1);
        let field = Field::new(&mesh, &bands, &e, &b).unwrap();
        let mut out = Vec::new();
        write_npz(&field, &mut out).unwrap();
        let mut npz = NpzReader::new(Cursor::new(out.clone())).unwrap();
        let irradiance: Array2<f64> = npz.by_name("irradiance").unwrap();
        assert_eq!(irradiance, array![[e[0], e[1]], [e[2], e[3]], [e[4], e[5]]]);
        let radiosity: Array2<f64> = npz.by_name("radiosity").unwrap();
        assert_eq!(radiosity, array![[b[0], b[1]], [b[2], b[3]], [b[4], b[5]]]);
        let normal: Array2<f64> = npz.by_name("normal").unwrap();
        assert_eq!(normal, array![[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
        let centroid: Array2<f64> = npz.by_name("centroid").unwrap();
        assert_eq!(centroid.row(1).to_vec(), [1.5, 0.5, 0.0]);
        let exposed: Array1<f64> = npz.by_name("exposed").unwrap();
        assert!(exposed.len() == mesh.len() && exposed.iter().all(|&w| (w - 1.0).abs() < 1e-15));
        let area: Array1<f64> = npz.by_name("area").unwrap();
        assert_eq!(area.to_vec()[..2], [1.0, 1.0]);
        let face: Array1<i64> = npz.by_name("face").unwrap();
        let surface: Array1<i64> = npz.by_name("surface").unwrap();
        assert_eq!((face, surface), (array![0, 1, 2], array![0, 0, 1]));
        assert_eq!(npz.len(), 9);
        let mut again = Vec::new();
        write_npz(&field, &mut again).unwrap();
        assert!(out == again, "no time stamp may enter the file");
    }
}
