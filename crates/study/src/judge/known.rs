//! The reference values of a bundle, and where they are.

use std::f64::consts::FRAC_1_PI;
use std::path::Path;

use fredholm_report::{
    Measured, PictureShape, ReferenceRecord, ReferenceValues, read_measured_faces, read_measured_pixels,
    read_reference_faces, read_reference_pixels,
};

use crate::crosscheck::places::{Place, Places};
use crate::error::Error;
use crate::solve::report_failure;

/// Sides of a tile, pixels.
const TILE_SIDE: usize = 8;

/// What is known.
pub(super) struct Known {
    /// Faces, surfaces and the whole, or pixels, tiles and the picture.
    pub(super) places: Places,
    /// Faces (irradiance, W/m²), or pixels (radiance, W/(m² sr)).
    pub(super) reference: ReferenceValues,
    /// Batches behind the errors.
    pub(super) batches: u64,
    /// The size of the picture, of pixels.
    pub(super) shape: Option<PictureShape>,
    bands: Vec<String>,
    /// Names of the surfaces, of faces, and the surface of each.
    surfaces: Vec<String>,
    surface_of: Vec<usize>,
}

impl Known {
    pub(super) fn faces(bundle: &Path, record: &ReferenceRecord) -> Result<Self, Error> {
        let faces = read_reference_faces(bundle, &record.bands).map_err(report_failure)?;
        let on = (faces.surface_of.clone(), faces.surfaces.len());
        Ok(Self {
            places: Places::of(record.bands.len(), on, faces.areas),
            reference: faces.irradiance,
            batches: record.batches,
            shape: None,
            bands: record.bands.clone(),
            surfaces: faces.surfaces,
            surface_of: faces.surface_of,
        })
    }

    pub(super) fn pixels(bundle: &Path, record: &ReferenceRecord) -> Result<Self, Error> {
        let mut reference = read_reference_pixels(bundle, record).map_err(report_failure)?;
        for value in reference.values.iter_mut().chain(&mut reference.errors) {
            *value *= FRAC_1_PI;
        }
        let [width, height] = [record.pixels.width, record.pixels.height].map(|side| side as usize);
        let shape = PictureShape { width, height, bands: record.bands.len() };
        let across = width.div_ceil(TILE_SIDE);
        let tile = |pixel: usize| pixel / width / TILE_SIDE * across + pixel % width / TILE_SIDE;
        let tile_of: Vec<usize> = (0..width * height).map(tile).collect();
        let on = (tile_of, across * height.div_ceil(TILE_SIDE));
        Ok(Self {
            places: Places::of(shape.bands, on, vec![1.0; width * height]),
            reference,
            batches: record.pixels.batches.into(),
            shape: Some(shape),
            bands: record.bands.clone(),
            surfaces: Vec::new(),
            surface_of: Vec::new(),
        })
    }

    /// What a tracer has found of the same.
    pub(super) fn read(&self, file: &Path) -> Result<Measured, Error> {
        let found = match self.shape {
            Some(shape) => read_measured_pixels(file, shape),
            None => read_measured_faces(file, self.surface_of.len(), &self.bands),
        };
        found.map_err(report_failure)
    }

    /// The values at all places.
    pub(super) fn values(&self) -> Vec<f64> {
        self.places.means(&self.reference.values)
    }

    /// The standard deviations of the values with their rounding.
    pub(super) fn errors(&self, values: &[f64], rounding: f64) -> Vec<f64> {
        let own = self.combined(&self.reference.errors);
        own.iter().zip(values).map(|(error, value)| error.hypot(rounding * value)).collect()
    }

    /// Errors of pixels or faces, followed by those of the means. Pixels are sampled by themselves;
    /// of faces the errors may go together, and that of a mean is at most what it then is.
    pub(super) fn combined(&self, errors: &[f64]) -> Vec<f64> {
        match self.shape {
            Some(_) => self.places.independent(errors),
            None => self.places.root_mean_squares(errors),
        }
    }

    pub(super) fn quantity(&self) -> &'static str {
        if self.shape.is_some() { "radiance of pixels" } else { "irradiance of faces" }
    }

    /// The kind of a place, its number, where it is in words, and the band.
    pub(super) fn named(&self, index: usize) -> (&'static str, usize, String, usize) {
        let (place, band) = self.places.at(index);
        let (kind, number, name) = match (place, self.shape) {
            (Place::Face(number), Some(shape)) => {
                let (row, column) = (number / shape.width, number % shape.width);
                ("pixel", number, format!("the pixel in row {row}, column {column}"))
            }
            (Place::Surface(number), Some(shape)) => {
                let across = shape.width.div_ceil(TILE_SIDE);
                let (row, column) = (number / across * TILE_SIDE, number % across * TILE_SIDE);
                ("tile", number, format!("{TILE_SIDE} × {TILE_SIDE} pixels from row {row}, column {column}"))
            }
            (Place::Whole, Some(_)) => ("picture", 0, "the picture".to_owned()),
            (Place::Face(number), None) => {
                let surface = &self.surfaces[self.surface_of[number]];
                ("face", number, format!("face {number} of {surface}"))
            }
            (Place::Surface(number), None) => {
                ("surface", number, format!("surface {}", self.surfaces[number]))
            }
            (Place::Whole, None) => ("whole", 0, "the whole".to_owned()),
        };
        (kind, number, name, band)
    }
}
