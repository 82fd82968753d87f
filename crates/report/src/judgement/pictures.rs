//! Pictures of other programs: the radiance of every pixel, W/(m² sr), rows from the top, as
//! NumPy's `.npy`, as OpenEXR, or as the `pixels.npz` of `fredholm trace --spp` and of other
//! bundles.
//!
//! `.npy`: f32 or f64, height × width × channels, or seeds × height × width × channels; in grey the
//! channels may be left out. `.exr`: the first layer with channels R, G and B, or Y alone. Of a
//! scene with one band the channels are taken for the same and averaged. `.npz`: radiosity and
//! standard error, W/m², which are divided by π.

use std::f64::consts::FRAC_1_PI;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::prelude::{AnyChannels, FlatSamples, Layer, MetaData, read_first_flat_layer_from_file};
use ndarray::{Array3, ArrayD};
use ndarray_npy::{NpzReader, ReadNpyError, ReadNpyExt, ReadNpzError};

use super::Measured;
use crate::ReportError;

/// Largest number of pictures in a stack, channels of a pixel: what is more is a mistake.
const MOST_LAYERS: usize = 65_536;
/// Rounding of a half, relative.
const HALF_ROUNDING: f64 = 1.0 / 2048.0;

/// A picture of this size, in pixels, is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureShape {
    /// Pixels in a row.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// Bands.
    pub bands: usize,
}

/// Reads a picture, or a stack of several.
///
/// # Errors
/// [`ReportError::Read`], and [`ReportError::Values`] for a file that is none of the two, of
/// another size, or with a pixel that is not a finite number.
pub fn read_measured_pixels(path: &Path, shape: PictureShape) -> Result<Measured, ReportError> {
    let file = File::open(path).map_err(|source| ReportError::Read { path: path.to_owned(), source })?;
    let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    let found = match ending.as_deref().and_then(|e| e.to_str()) {
        Some("npy") => numpy(path, file, shape)?,
        Some("exr") => open_exr(path, shape)?,
        Some("npz") => traced(path, file, shape)?,
        _ => {
            let what = "it is no .csv, .npy, .npz or .exr file".to_owned();
            return Err(refuse(path, what, "write the faces as CSV, or the pixels as NumPy file or OpenEXR"));
        }
    };
    let row = shape.width * shape.bands;
    for picture in &found.seeds {
        if let Some(at) = picture.iter().position(|value| !value.is_finite()) {
            let (y, x) = (at / row, at % row / shape.bands);
            let what = format!("the pixel in row {y}, column {x} is {}, not a finite number", picture[at]);
            return Err(refuse(path, what, "mend the tracer: such a value ruins every mean that it enters"));
        }
    }
    Ok(found)
}

fn refuse(path: &Path, what: String, help: &str) -> ReportError {
    ReportError::Values { path: path.to_owned(), line: None, what, help: help.to_owned() }
}

fn other_size(path: &Path, found: &str, shape: PictureShape) -> ReportError {
    let PictureShape { width, height, bands } = shape;
    let what = format!(
        "it is {found}; the bundle has {height} rows of {width} pixels with {bands} band{}",
        if bands == 1 { "" } else { "s" }
    );
    refuse(path, what, "render with the camera and the size that reference.json says")
}

fn numpy(path: &Path, file: File, shape: PictureShape) -> Result<Measured, ReportError> {
    let failed =
        |error: ReadNpyError| refuse(path, error.to_string(), "write an array of f32 or f64 by numpy.save");
    let found = match ArrayD::<f64>::read_npy(BufReader::new(file)) {
        Err(ReadNpyError::WrongDescriptor(_)) => {
            let again =
                File::open(path).map_err(|source| ReportError::Read { path: path.to_owned(), source })?;
            ArrayD::<f32>::read_npy(BufReader::new(again)).map_err(failed)?.mapv(f64::from)
        }
        other => other.map_err(failed)?,
    };
    let PictureShape { width, height, bands } = shape;
    let (seeds, channels) = match *found.shape() {
        [h, w] if (h, w, bands) == (height, width, 1) => (1, 1),
        [h, w, c] if (h, w) == (height, width) && fits(c, bands) => (1, c),
        [n, h, w] if (h, w, bands) == (height, width, 1) => (n, 1),
        [n, h, w, c] if (h, w) == (height, width) && fits(c, bands) => (n, c),
        _ => return Err(other_size(path, &format!("an array of the shape {:?}", found.shape()), shape)),
    };
    if !(1..=MOST_LAYERS).contains(&seeds) {
        return Err(other_size(path, &format!("a stack of {seeds} pictures"), shape));
    }
    let values: Vec<f64> = found.iter().copied().collect();
    let pictures = values.chunks(height * width * channels);
    let seeds = pictures.map(|picture| in_bands(picture, channels, bands)).collect();
    Ok(Measured { seeds, sigma: None, rounding: 0.0 })
}

/// The pixels of a traced run.
fn traced(path: &Path, file: File, shape: PictureShape) -> Result<Measured, ReportError> {
    let failed = |error: ReadNpzError| refuse(path, error.to_string(), "give the pixels.npz of a traced run");
    let mut npz = NpzReader::new(file).map_err(failed)?;
    let mut array = |name: &str| -> Result<Vec<f64>, ReportError> {
        let found: Array3<f64> = npz.by_name(name).map_err(failed)?;
        if found.dim() != (shape.height, shape.width, shape.bands) {
            return Err(other_size(path, &format!("an array of the shape {:?}", found.shape()), shape));
        }
        Ok(found.iter().map(|radiosity| radiosity * FRAC_1_PI).collect())
    };
    Ok(Measured { seeds: vec![array("radiosity")?], sigma: Some(array("standard_error")?), rounding: 0.0 })
}

/// Whether so many channels stand for the bands.
fn fits(channels: usize, bands: usize) -> bool {
    channels == bands || (bands == 1 && (1..=MOST_LAYERS).contains(&channels))
}

/// The bands of channels: themselves, or their mean where there is one band.
fn in_bands(picture: &[f64], channels: usize, bands: usize) -> Vec<f64> {
    if channels == bands {
        return picture.to_vec();
    }
    picture.chunks(channels).map(|pixel| pixel.iter().sum::<f64>() / channels as f64).collect()
}

fn open_exr(path: &Path, shape: PictureShape) -> Result<Measured, ReportError> {
    let failed = |error: exr::error::Error| {
        refuse(path, error.to_string(), "write a plain OpenEXR file with the channels R, G and B")
    };
    // Nothing of another size is taken into memory.
    let meta = MetaData::read_from_file(path, false).map_err(failed)?;
    let size = meta.headers.first().map(|header| header.layer_size);
    if size.is_none_or(|size| (size.x(), size.y()) != (shape.width, shape.height)) {
        let found = size.map_or_else(String::new, |s| format!("{} rows of {} pixels", s.y(), s.x()));
        return Err(other_size(path, &found, shape));
    }
    let image = read_first_flat_layer_from_file(path).map_err(failed)?;
    let layer = image.layer_data;
    let wanted = channels(&layer, shape.bands).ok_or_else(|| {
        let names: Vec<String> =
            layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
        other_size(path, &format!("a picture with the channels {}", names.join(", ")), shape)
    })?;
    let half = layer.channel_data.list.iter().any(|c| matches!(c.sample_data, FlatSamples::F16(_)));
    let pixels = shape.width * shape.height;
    let mut values = Vec::with_capacity(pixels * wanted.len());
    for at in 0..pixels {
        values.extend(wanted.iter().map(|samples| f64::from(samples.value_by_flat_index(at).to_f32())));
    }
    let seeds = vec![in_bands(&values, wanted.len(), shape.bands)];
    Ok(Measured { seeds, sigma: None, rounding: if half { HALF_ROUNDING } else { 0.0 } })
}

/// The channels R, G and B, or Y, or the only one; their names may stand after a point.
fn channels(layer: &Layer<AnyChannels<FlatSamples>>, bands: usize) -> Option<Vec<&FlatSamples>> {
    let list = &layer.channel_data.list;
    let named = |name: &str| {
        let own = |full: String| full.rsplit('.').next().is_some_and(|last| last == name);
        list.iter().find(|channel| own(channel.name.to_string())).map(|channel| &channel.sample_data)
    };
    let colours: Option<Vec<_>> = ["R", "G", "B"].into_iter().map(named).collect();
    let grey = || named("Y").or_else(|| list.first().filter(|_| list.len() == 1).map(|c| &c.sample_data));
    colours.or_else(|| grey().map(|grey| vec![grey])).filter(|found| fits(found.len(), bands))
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::write_rgb_file;
    use ndarray::{Array, Dimension};
    use ndarray_npy::write_npy;

    const SHAPE: PictureShape = PictureShape { width: 3, height: 2, bands: 3 };

    fn values(count: usize) -> Vec<f64> {
        (0..count).map(|i| i as f64 / 4.0).collect()
    }

    fn numbers<D: Dimension>(array: &Array<f64, D>, shape: PictureShape) -> Result<Measured, ReportError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npy");
        write_npy(&path, array).unwrap();
        read_measured_pixels(&path, shape)
    }

    #[test]
    fn arrays_of_all_shapes_are_read() {
        let one = Array::from_shape_vec((2, 3, 3), values(18)).unwrap();
        assert_eq!(numbers(&one, SHAPE).unwrap().seeds, [values(18)]);
        let two = Array::from_shape_vec((2, 2, 3, 3), values(36)).unwrap();
        assert_eq!(numbers(&two, SHAPE).unwrap().seeds.concat(), values(36));
        let grey = PictureShape { bands: 1, ..SHAPE };
        let stack = Array::from_shape_vec((4, 2, 3), values(24)).unwrap();
        assert_eq!(numbers(&stack, grey).unwrap().seeds.len(), 4);
        // Of three channels of one band, the mean.
        let mean = values(18)[3..6].iter().sum::<f64>() / 3.0;
        assert!((numbers(&one, grey).unwrap().seeds[0][1] - mean).abs() < 1e-15 * mean.abs());
        // f32, columns first.
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npy");
        write_npy(&path, &one.mapv(|x| x as f32)).unwrap();
        assert_eq!(read_measured_pixels(&path, SHAPE).unwrap().seeds, [values(18)]);
        assert_eq!(numbers(&one.t().as_standard_layout().t().to_owned(), SHAPE).unwrap().seeds, [values(18)]);
    }

    #[test]
    fn exr_files_are_read_by_the_names_of_their_channels() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let value = |x: usize, y: usize, c: usize| values(18)[(y * 3 + x) * 3 + c] as f32;
        write_rgb_file(&path, 3, 2, |x, y| (value(x, y, 0), value(x, y, 1), value(x, y, 2))).unwrap();
        let found = read_measured_pixels(&path, SHAPE).unwrap();
        assert_eq!((found.seeds, found.rounding), (vec![values(18)], 0.0));
        let error = read_measured_pixels(&path, PictureShape { width: 4, ..SHAPE }).unwrap_err();
        assert!(error.to_string().contains("2 rows of 3 pixels"), "{error}");
    }

    #[test]
    fn what_cannot_be_used_is_said() {
        let mut nan = Array::from_shape_vec((2, 3, 3), values(18)).unwrap();
        nan[[1, 2, 0]] = f64::NAN;
        let error = numbers(&nan, SHAPE).unwrap_err().to_string();
        assert!(error.contains("row 1, column 2 is NaN"), "{error}");
        let narrow = Array::from_shape_vec((2, 2, 3), values(12)).unwrap();
        let error = numbers(&narrow, SHAPE).unwrap_err().to_string();
        assert!(error.contains("shape [2, 2, 3]") && error.contains("2 rows of 3 pixels"), "{error}");
        let folder = tempfile::tempdir().unwrap();
        for (name, what) in [
            ("a.png", "no .csv, .npy, .npz or .exr"),
            ("a.exr", "help: "),
            ("a.npy", "help: "),
            ("a.npz", "help: "),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, b"nothing of the kind").unwrap();
            let error = read_measured_pixels(&path, SHAPE).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
