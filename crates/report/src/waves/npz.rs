//! `receivers.npz`: the fields at the receivers as `NumPy` arrays, uncompressed.
//!
//! | array | type | shape | |
//! |---|---|---|---|
//! | `receiver`, `index` | i64 | n | numbers, from 0 |
//! | `position` | f64 | n × 3 | m |
//! | `frequency` | f64 | n | Hz |
//! | `incident`, `scattered`, `total` | f64 | n × 6 × 2 | ex, ey, ez (V/m), hx, hy, hz (A/m); real, imaginary part |

use std::io::{self, Cursor, Write};

use ndarray::{Array1, Array2, Array3};
use ndarray_npy::{NpzWriter, WriteNpzError};

use super::WaveRow;

/// Bytes of a row in the file, and of all that the archive adds.
const ROW: usize = 8 * (3 + 3 + 3 * 12);
const HEADERS: usize = 4096;

/// Writes the fields as arrays. The file is composed in memory.
///
/// # Errors
/// What `out` reports.
pub fn write_receivers_npz(rows: &[WaveRow], out: &mut dyn Write) -> io::Result<()> {
    let file = compose(rows).map_err(io::Error::other)?;
    out.write_all(&file)
}

fn compose(rows: &[WaveRow]) -> Result<Vec<u8>, WriteNpzError> {
    let number = |i: usize| i64::try_from(i).unwrap_or(i64::MAX);
    // A file that grows would be held twice over.
    let file = Vec::with_capacity(rows.len() * ROW + HEADERS);
    let mut npz = NpzWriter::new(Cursor::new(file));
    npz.add_array("receiver", &rows.iter().map(|row| number(row.receiver)).collect::<Array1<i64>>())?;
    npz.add_array("index", &rows.iter().map(|row| number(row.index)).collect::<Array1<i64>>())?;
    npz.add_array("position", &Array2::from(rows.iter().map(|row| row.position).collect::<Vec<_>>()))?;
    npz.add_array("frequency", &rows.iter().map(|row| row.frequency).collect::<Array1<f64>>())?;
    npz.add_array("incident", &phasors(rows, |row| row.incident))?;
    npz.add_array("scattered", &phasors(rows, |row| row.scattered))?;
    npz.add_array("total", &phasors(rows, WaveRow::total))?;
    Ok(npz.finish()?.into_inner())
}

fn phasors(rows: &[WaveRow], of: impl Fn(&WaveRow) -> [f64; 12]) -> Array3<f64> {
    let value = |(i, component, part): (usize, usize, usize)| of(&rows[i])[2 * component + part];
    Array3::from_shape_fn((rows.len(), 6, 2), value)
}

#[cfg(test)]
mod tests {
    use super::super::csv::tests::rows;
    use super::*;
    use ndarray_npy::NpzReader;

    #[test]
    fn every_array_reads_back() {
        let mut out = Vec::new();
        write_receivers_npz(&rows(), &mut out).unwrap();
        let mut npz = NpzReader::new(Cursor::new(out)).unwrap();
        let total: Array3<f64> = npz.by_name("total").unwrap();
        assert_eq!(total.dim(), (3, 6, 2));
        assert_eq!(total.iter().copied().skip(12).take(12).collect::<Vec<_>>(), rows()[1].total());
        let position: Array2<f64> = npz.by_name("position").unwrap();
        assert_eq!(position.row(2).to_vec(), rows()[2].position);
        assert_eq!(npz.len(), 7);
    }
}
