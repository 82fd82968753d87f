//! Pictures of which every pixel was estimated by itself, and their errors: `pixels.npz`.
//!
//! | array | type | shape | |
//! |---|---|---|---|
//! | `radiosity`, `standard_error` | f64 | height × width × bands | W/m², means over the pixel; what is seen of nothing counts as 0 |
//! | `covered` | f64 | height × width | share of the pixel in which something is seen |

use std::io::{self, Cursor, Write};

use ndarray::{ArrayView2, ArrayView3};
use ndarray_npy::{NpzWriter, WriteNpzError};
use rayon::prelude::*;

use crate::colour::Rgb;
use crate::picture::BACKGROUND;
use crate::tone::{Tone, encode, luminance};
use crate::{Colouring, Exposure, Picture, ReportError};

/// Bytes that the archive adds to the arrays.
const BYTES_OF_HEADERS: usize = 4096;

/// Estimates of all pixels, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pixels {
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
    /// Radiosity of each pixel and band, W/m².
    pub radiosity: Vec<f64>,
    /// Standard error of it, W/m².
    pub standard_error: Vec<f64>,
    /// Share of each pixel in which something is seen.
    pub covered: Vec<f64>,
    /// Whether the middle of each pixel shows a lamp: those do not decide the exposure.
    pub lamp: Vec<bool>,
}

impl Pixels {
    /// The picture, its colours mixed from bands of these names.
    ///
    /// # Errors
    /// [`ReportError::Length`] for vectors that do not fit each other, [`ReportError::Exposure`].
    pub fn picture(&self, bands: &[String], exposure: Exposure) -> Result<Picture, ReportError> {
        self.check(bands.len())?;
        let colouring = Colouring::new(bands);
        let rows = self.radiosity.par_chunks(bands.len()).zip(&self.covered);
        let seen = |(row, &covered): (&[f64], &f64)| {
            colouring.colour(row).map(|c| if covered > 0.0 { c / covered } else { 0.0 })
        };
        let colours: Vec<Rgb> = rows.map(seen).collect();
        let tone = Tone::new(exposure, &self.metered(&colours))?;
        let pixel = |(&colour, &covered): (&Rgb, &f64)| {
            tone.display(colour).map(|c| encode(covered * c + (1.0 - covered) * BACKGROUND))
        };
        let pixels = colours.iter().zip(&self.covered).flat_map(pixel).collect();
        Ok(Picture { width: self.width, height: self.height, pixels })
    }

    /// Luminances of what is no lamp, or of lamps where there is nothing else.
    fn metered(&self, colours: &[Rgb]) -> Vec<f64> {
        let seen = || colours.iter().zip(&self.covered).zip(&self.lamp).filter(|((_, c), _)| **c > 0.0);
        let of = |lamp: bool| -> Vec<f64> {
            seen().filter(|(_, is)| **is == lamp).map(|((colour, _), _)| luminance(*colour)).collect()
        };
        let reflecting = of(false);
        if reflecting.is_empty() { of(true) } else { reflecting }
    }

    pub(super) fn check(&self, bands: usize) -> Result<(), ReportError> {
        let pixels = self.width as usize * self.height as usize;
        let lengths = [
            ("the radiosity of pixels", pixels * bands, self.radiosity.len()),
            ("the standard error of pixels", pixels * bands, self.standard_error.len()),
            ("the covered share of pixels", pixels, self.covered.len()),
            ("the lamps of pixels", pixels, self.lamp.len()),
        ];
        match lengths.into_iter().find(|(_, expected, found)| expected != found) {
            Some((what, expected, found)) => Err(ReportError::Length { what, expected, found }),
            None => Ok(()),
        }
    }

    /// Writes the arrays.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write_npz(&self, out: &mut dyn Write) -> io::Result<()> {
        let file = self.compose().map_err(io::Error::other)?;
        out.write_all(&file)
    }

    fn compose(&self) -> Result<Vec<u8>, WriteNpzError> {
        let (width, height) = (self.width as usize, self.height as usize);
        let bands = self.radiosity.len() / (width * height).max(1);
        let shaped = |error| WriteNpzError::Zip(io::Error::other(error).into());
        // A file that grows would be held twice over.
        let values = 2 * self.radiosity.len() + self.covered.len();
        let file = Vec::with_capacity(values * size_of::<f64>() + BYTES_OF_HEADERS);
        let mut npz = NpzWriter::new(Cursor::new(file));
        for (name, values) in [("radiosity", &self.radiosity), ("standard_error", &self.standard_error)] {
            npz.add_array(name, &ArrayView3::from_shape((height, width, bands), values).map_err(shaped)?)?;
        }
        let covered = ArrayView2::from_shape((height, width), &self.covered).map_err(shaped)?;
        npz.add_array("covered", &covered)?;
        Ok(npz.finish()?.into_inner())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pixel of nothing is the background, one half covered lies between, and white at a fixed
    /// exposure is bright.
    #[test]
    fn coverage_mixes_with_the_background() {
        let pixels = Pixels {
            width: 3,
            height: 1,
            radiosity: vec![0.0, 2.0, 4.0],
            standard_error: vec![0.0; 3],
            covered: vec![0.0, 0.5, 1.0],
            lamp: vec![false; 3],
        };
        let names = ["grey".to_owned()];
        let picture = pixels.picture(&names, Exposure::Fixed(1.0)).unwrap();
        let levels: Vec<u8> = picture.pixels.chunks(3).map(|pixel| pixel[0]).collect();
        // 4 is white: linear 1; half of it over the background 0.012 is 0.506, which sRGB encodes
        // as 188.52/255.
        assert_eq!(levels, [encode(BACKGROUND), 189, 255]);
        assert!(Pixels { covered: Vec::new(), ..pixels }.picture(&names, Exposure::Auto).is_err());
    }
}
