//! A bundle of reference values, read back: `reference.json`, `reference.csv` and `pixels.npz`.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;

use ndarray::Array3;
use ndarray_npy::NpzReader;

use super::table::Table;
use crate::{REFERENCE_FORMAT, ReferenceRecord, ReportError};

/// What mends a bundle.
const BUNDLE_HELP: &str = "make the bundle again by `fredholm reference`";

/// Faces or pixels with known values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceValues {
    /// The values, place by place and band by band.
    pub values: Vec<f64>,
    /// One standard deviation of all their known errors.
    pub errors: Vec<f64>,
}

/// The faces of a bundle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceFaces {
    /// Names of the surfaces.
    pub surfaces: Vec<String>,
    /// The surface of each face.
    pub surface_of: Vec<usize>,
    /// Areas of the faces, m².
    pub areas: Vec<f64>,
    /// Their irradiance, W/m².
    pub irradiance: ReferenceValues,
}

/// Reads the record of a bundle.
///
/// # Errors
/// [`ReportError::Read`] where there is none, [`ReportError::Values`] for one that is damaged or of
/// another version.
pub fn read_reference_record(folder: &Path) -> Result<ReferenceRecord, ReportError> {
    let path = folder.join("reference.json");
    let text =
        fs::read_to_string(&path).map_err(|source| ReportError::Read { path: path.clone(), source })?;
    let refuse = |line, what: String| ReportError::Values {
        path: path.clone(),
        line,
        what,
        help: BUNDLE_HELP.to_owned(),
    };
    let record: ReferenceRecord =
        serde_json::from_str(&text).map_err(|error| refuse(Some(error.line()), error.to_string()))?;
    if record.format == REFERENCE_FORMAT {
        return Ok(record);
    }
    Err(refuse(None, format!("its format is `{}`, not `{REFERENCE_FORMAT}`", record.format)))
}

/// Reads the faces of a bundle.
///
/// # Errors
/// [`ReportError::Read`], and [`ReportError::Values`] with the line that cannot be used.
pub fn read_reference_faces(folder: &Path, bands: &[String]) -> Result<ReferenceFaces, ReportError> {
    let table = Table::read(&folder.join("reference.csv"), BUNDLE_HELP)?;
    let [surface, area] = [table.column("surface")?, table.column("area")?];
    let mut columns = Vec::new();
    for band in bands {
        columns.push([table.column(&format!("E_{band}"))?, table.column(&format!("E_error_{band}"))?]);
    }
    let (mut faces, mut numbers) = (ReferenceFaces::default(), BTreeMap::new());
    for row in table.rows() {
        let name = row.fields[surface].clone();
        let next = numbers.len();
        let number = *numbers.entry(name.clone()).or_insert(next);
        if number == faces.surfaces.len() {
            faces.surfaces.push(name);
        }
        faces.surface_of.push(number);
        faces.areas.push(table.number(row, area)?);
        for [value, error] in &columns {
            faces.irradiance.values.push(table.number(row, *value)?);
            faces.irradiance.errors.push(table.number(row, *error)?);
        }
    }
    Ok(faces)
}

/// Reads the radiosities (W/m²) of the pixels of a bundle, rows from the top.
///
/// # Errors
/// [`ReportError::Read`], and [`ReportError::Values`] for a file that does not fit the record.
pub fn read_reference_pixels(
    folder: &Path,
    record: &ReferenceRecord,
) -> Result<ReferenceValues, ReportError> {
    let path = folder.join("pixels.npz");
    let file = File::open(&path).map_err(|source| ReportError::Read { path: path.clone(), source })?;
    let refuse = |what: String| ReportError::Values {
        path: path.clone(),
        line: None,
        what,
        help: BUNDLE_HELP.to_owned(),
    };
    let mut npz = NpzReader::new(file).map_err(|error| refuse(error.to_string()))?;
    let shape = (record.pixels.height as usize, record.pixels.width as usize, record.bands.len());
    let mut array = |name: &str| {
        let found: Array3<f64> =
            npz.by_name(name).map_err(|error| refuse(format!("array `{name}`: {error}")))?;
        if found.dim() == shape {
            return Ok(found.iter().copied().collect());
        }
        Err(refuse(format!("array `{name}` has the shape {:?}, the record says {shape:?}", found.dim())))
    };
    Ok(ReferenceValues { values: array("radiosity")?, errors: array("standard_error")? })
}
