//! Tables as `NumPy` arrays, uncompressed. `receivers.npz`: the fields at the receivers.
//!
//! | array | type | shape | |
//! |---|---|---|---|
//! | `receiver`, `index` | i64 | n | numbers, from 0 |
//! | `position` | f64 | n × 3 | m |
//! | `frequency` | f64 | n | Hz |
//! | `incident`, `scattered`, `total` | f64 | n × 6 × 2 | ex, ey, ez (V/m), hx, hy, hz (A/m); real, imaginary part |
//!
//! `far.npz` and `monostatic.npz`: the columns of the tables of the same names.
//!
//! | array | type | shape | |
//! |---|---|---|---|
//! | `receiver`, `index` | i64 | n | numbers, from 0 |
//! | `angles` | f64 | n × 2 | θ and φ, degrees |
//! | `frequency` | f64 | n | Hz |
//! | `amplitude` (far) | f64 | n × 2 × 2 | along θ̂ and φ̂ (V); real, imaginary part |
//! | `cross_section` (far) | f64 | n × 2 | m²; not a number without an incident plane wave |
//! | `total` (far) | f64 | n × 2 × 2 | with the sources in, V; not a number where one of them is a plane wave |
//! | `gain` (far) | f64 | n | over the power that the sources supply; not a number where one of them is a plane wave |
//! | `scattering` (monostatic) | f64 | n × 4 × 2 | S_θθ, S_φθ, S_θφ, S_φφ (m), received then incident |

use std::io::{self, Cursor, Write};

use ndarray::{Array1, Array2, Array3};
use ndarray_npy::{NpzWriter, WriteNpzError};

use super::{FarRow, MonostaticRow, WaveRow};

/// Bytes of a row in the file, and of all that the archive adds.
const BYTES_OF_A_ROW: usize = 8 * (3 + 3 + 3 * 12);
const BYTES_OF_HEADERS: usize = 4096;

/// Writes the fields as arrays. The file is composed in memory.
///
/// # Errors
/// What `out` reports.
pub fn write_receivers_npz(rows: &[WaveRow], out: &mut dyn Write) -> io::Result<()> {
    let file = compose(rows).map_err(io::Error::other)?;
    out.write_all(&file)
}

/// Writes the far fields as arrays. The file is composed in memory.
///
/// # Errors
/// What `out` reports.
pub fn write_far_npz(rows: &[FarRow], out: &mut dyn Write) -> io::Result<()> {
    let key = |row: &FarRow| (row.receiver, row.index, [row.theta_degrees, row.phi_degrees], row.frequency);
    let compose = || -> Result<Vec<u8>, WriteNpzError> {
        let mut npz = directions(rows.iter().map(key))?;
        let part = |(i, along, part): (usize, usize, usize)| rows[i].amplitude[2 * along + part];
        npz.add_array("amplitude", &Array3::from_shape_fn((rows.len(), 2, 2), part))?;
        let section = |row: &FarRow| row.cross_section.unwrap_or([f64::NAN; 2]);
        npz.add_array("cross_section", &Array2::from(rows.iter().map(section).collect::<Vec<_>>()))?;
        let part = |(i, along, part): (usize, usize, usize)| {
            rows[i].total.map_or(f64::NAN, |total| total.amplitude[2 * along + part])
        };
        npz.add_array("total", &Array3::from_shape_fn((rows.len(), 2, 2), part))?;
        let gain = |row: &FarRow| row.total.map_or(f64::NAN, |total| total.gain);
        npz.add_array("gain", &rows.iter().map(gain).collect::<Array1<f64>>())?;
        Ok(npz.finish()?.into_inner())
    };
    out.write_all(&compose().map_err(io::Error::other)?)
}

/// Writes monostatic sweeps as arrays. The file is composed in memory.
///
/// # Errors
/// What `out` reports.
pub fn write_monostatic_npz(rows: &[MonostaticRow], out: &mut dyn Write) -> io::Result<()> {
    let key =
        |row: &MonostaticRow| (row.receiver, row.index, [row.theta_degrees, row.phi_degrees], row.frequency);
    let compose = || -> Result<Vec<u8>, WriteNpzError> {
        let mut npz = directions(rows.iter().map(key))?;
        let part = |(i, pair, part): (usize, usize, usize)| rows[i].scattering[pair][part];
        npz.add_array("scattering", &Array3::from_shape_fn((rows.len(), 4, 2), part))?;
        Ok(npz.finish()?.into_inner())
    };
    out.write_all(&compose().map_err(io::Error::other)?)
}

/// The arrays that say which direction a row is: receiver, index, angles and frequency.
fn directions(
    rows: impl Iterator<Item = (usize, usize, [f64; 2], f64)>,
) -> Result<NpzWriter<Cursor<Vec<u8>>>, WriteNpzError> {
    let rows: Vec<_> = rows.collect();
    let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
    npz.add_array("receiver", &rows.iter().map(|row| number(row.0)).collect::<Array1<i64>>())?;
    npz.add_array("index", &rows.iter().map(|row| number(row.1)).collect::<Array1<i64>>())?;
    npz.add_array("angles", &Array2::from(rows.iter().map(|row| row.2).collect::<Vec<_>>()))?;
    npz.add_array("frequency", &rows.iter().map(|row| row.3).collect::<Array1<f64>>())?;
    Ok(npz)
}

fn number(i: usize) -> i64 {
    i64::try_from(i).unwrap_or(i64::MAX)
}

fn compose(rows: &[WaveRow]) -> Result<Vec<u8>, WriteNpzError> {
    // A file that grows would be held twice over.
    let file = Vec::with_capacity(rows.len() * BYTES_OF_A_ROW + BYTES_OF_HEADERS);
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

    #[test]
    fn directions_read_back_with_their_numbers() {
        let far = FarRow {
            receiver: 1,
            index: 4,
            theta_degrees: 90.0,
            phi_degrees: 270.0,
            frequency: 1e9,
            amplitude: [1.0, 2.0, 3.0, 4.0],
            cross_section: Some([0.5, 0.25]),
            total: None,
        };
        let back = MonostaticRow {
            receiver: 0,
            index: 2,
            theta_degrees: 60.0,
            phi_degrees: 10.0,
            frequency: 2e9,
            scattering: [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [7.0, 8.0]],
        };
        let (mut one, mut other) = (Vec::new(), Vec::new());
        write_far_npz(&[far.clone(), far], &mut one).unwrap();
        write_monostatic_npz(&[back], &mut other).unwrap();
        let mut npz = NpzReader::new(Cursor::new(one)).unwrap();
        let amplitude: Array3<f64> = npz.by_name("amplitude").unwrap();
        assert_eq!(amplitude.iter().copied().skip(4).collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0]);
        let sections: Array2<f64> = npz.by_name("cross_section").unwrap();
        assert_eq!(sections.row(1).to_vec(), [0.5, 0.25]);
        let gain: Array1<f64> = npz.by_name("gain").unwrap();
        assert!(gain.iter().all(|gain| gain.is_nan()));
        let mut npz = NpzReader::new(Cursor::new(other)).unwrap();
        let scattering: Array3<f64> = npz.by_name("scattering").unwrap();
        assert_eq!(scattering.iter().copied().collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        let index: Array1<i64> = npz.by_name("index").unwrap();
        assert_eq!(index.to_vec(), [2]);
    }
}
