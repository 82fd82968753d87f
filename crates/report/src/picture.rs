//! A camera view of a solved field.
//!
//! Each pixel is the mean of the display values of [`SAMPLES`] points of a fixed lattice. What a sample sees is found by
//! ray casting among the leaves that turn their lit side to the eye; the others are invisible, so that a closed room
//! shows its inside. The colour there is the radiosity, smoothly interpolated. Rows are drawn in parallel, each by
//! itself, so that the number of threads never changes a pixel.

use std::io::{self, Write};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rayon::prelude::*;

use crate::colour::Rgb;
use crate::shading::Shading;
use crate::tone::{Exposure, Tone, encode, luminance};
use crate::{Camera, Eye, Field, ReportError};

/// Samples of a pixel.
const SAMPLES: usize = 8;
/// Generator of the lattice of samples: sample i stands at ((i + ½)/8, ((3 i mod 8) + ½)/8).
const GENERATOR: usize = 3;
/// Linear display value where nothing is hit: a dark grey.
pub(crate) const BACKGROUND: f64 = 0.012;

/// A finished picture: rows from the top, three bytes a pixel, sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
    /// Red, green and blue of each pixel.
    pub pixels: Vec<u8>,
}

impl Picture {
    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write_png(&self, out: &mut dyn Write) -> io::Result<()> {
        let encoder = PngEncoder::new(out);
        let colours = ExtendedColorType::Rgb8;
        encoder.write_image(&self.pixels, self.width, self.height, colours).map_err(io::Error::other)
    }
}

/// Draws a field as a camera sees it.
///
/// # Errors
/// [`ReportError::Camera`] or [`ReportError::Exposure`] for settings that make no picture,
/// [`ReportError::Visibility`] where the surfaces cannot be prepared for ray casting.
pub fn render(field: &Field<'_>, camera: &Camera, exposure: Exposure) -> Result<Picture, ReportError> {
    let view = Viewer::new(field, camera)?;
    let tone = Tone::new(exposure, &view.meter(field))?;
    let row_bytes = 3 * camera.width as usize;
    let mut pixels = vec![0; row_bytes * camera.height as usize];
    pixels.par_chunks_mut(row_bytes).enumerate().for_each(|(y, row)| view.draw(tone, y, row));
    Ok(Picture { width: camera.width, height: camera.height, pixels })
}

/// A camera before a scene.
struct Viewer<'a> {
    eye: Eye,
    shading: Shading<'a>,
}

impl<'a> Viewer<'a> {
    fn new(field: &Field<'a>, camera: &Camera) -> Result<Self, ReportError> {
        Ok(Self { eye: Eye::new(field.mesh(), camera)?, shading: Shading::new(*field) })
    }

    fn draw(&self, tone: Tone, y: usize, row: &mut [u8]) {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            let mut sum = [0.0; 3];
            for (dx, dy) in lattice() {
                let colour = self.sample(tone, x as f64 + dx, y as f64 + dy);
                sum = [0, 1, 2].map(|i| sum[i] + colour[i]);
            }
            pixel.copy_from_slice(&sum.map(|channel| encode(channel / SAMPLES as f64)));
        }
    }

    fn sample(&self, tone: Tone, x: f64, y: f64) -> Rgb {
        self.eye.hit(x, y).map_or([BACKGROUND; 3], |(leaf, p)| tone.display(self.shading.colour(leaf, p)))
    }

    /// Luminances seen through the middle of each pixel: of lit surfaces, or of lamps where there is nothing else.
    fn meter(&self, field: &Field<'_>) -> Vec<f64> {
        let rows: Vec<Vec<(bool, f64)>> =
            (0..self.eye.camera().height).into_par_iter().map(|y| self.probe(field, y)).collect();
        let seen = rows.into_iter().flatten();
        let (lamps, reflecting): (Vec<_>, Vec<_>) = seen.partition(|(emits, _)| *emits);
        let chosen = if reflecting.is_empty() { lamps } else { reflecting };
        chosen.into_iter().map(|(_, luminance)| luminance).collect()
    }

    fn probe(&self, field: &Field<'_>, y: u32) -> Vec<(bool, f64)> {
        let look = |x| self.eye.hit(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let value = |(leaf, p)| (field.emits(leaf), luminance(self.shading.colour(leaf, p)));
        (0..self.eye.camera().width).filter_map(look).map(value).collect()
    }
}

fn lattice() -> impl Iterator<Item = (f64, f64)> {
    let place = |i: usize| (i as f64 + 0.5) / SAMPLES as f64;
    (0..SAMPLES).map(move |i| (place(i), place(GENERATOR * i % SAMPLES)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{grid, names};
    use fredholm_mesh::{Mesh, MeshBuilder, Patch, Vec3};
    use rayon::ThreadPoolBuilder;

    /// Looks down on the unit square from 2 m: the picture is 4 m wide and high.
    fn above(width: u32, height: u32) -> Camera {
        Camera {
            eye: Vec3::new(0.5, 0.5, 2.0),
            target: Vec3::new(0.5, 0.5, 0.0),
            up: Vec3::Y,
            vertical_fov_degrees: 90.0,
            width,
            height,
        }
    }

    fn square(cells: usize) -> Mesh {
        let lines: Vec<f64> = (0..=cells).map(|i| i as f64 / cells as f64).collect();
        let mut builder = MeshBuilder::default();
        builder.surface("square", 0);
        grid(&mut builder, &lines, &lines);
        builder.build()
    }

    fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
        let at = 3 * (y * picture.width + x) as usize;
        picture.pixels[at..at + 3].try_into().unwrap()
    }

    fn draw(mesh: &Mesh, bands: &[&str], radiosity: &[f64], camera: &Camera, exposure: Exposure) -> Picture {
        let bands = names(bands);
        let field = Field::new(mesh, &bands, radiosity, radiosity).unwrap();
        render(&field, camera, exposure).unwrap()
    }

    #[test]
    fn a_uniform_square_is_mid_grey_on_dark() {
        let picture = draw(&square(1), &["grey"], &[7.0], &above(80, 80), Exposure::Auto);
        let background = pixel(&picture, 0, 0);
        assert!(background[0] > 10 && background[0] < 60, "{background:?}");
        // The square covers columns and rows 30 to 50 of 80. Linear 0.18 has the sRGB code 118.
        for (y, x) in (0..80).flat_map(|y| (0..80).map(move |x| (y, x))) {
            let inside = (30..50).contains(&x) && (30..50).contains(&y);
            let expected = if inside { [118; 3] } else { background };
            assert_eq!(pixel(&picture, x, y), expected, "({x}, {y})");
        }
    }

    #[test]
    fn a_fixed_exposure_gives_the_curve() {
        // Exposed 1 becomes (1 + 1/16)/2 = 0.53125, whose sRGB code is 193.
        let picture = draw(&square(1), &["grey"], &[2.0], &above(8, 8), Exposure::Fixed(0.5));
        assert_eq!(pixel(&picture, 4, 4), [193; 3]);
    }

    #[test]
    fn backs_are_invisible() {
        let mut builder = MeshBuilder::default();
        builder.surface("floor", 0);
        grid(&mut builder, &[-9.0, 9.0], &[-9.0, 9.0]);
        builder.surface("ceiling", 0);
        let corner = |x, y| Vec3::new(x, y, 1.0);
        let down = [corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)];
        let back = Patch::quad(down).unwrap().unwrap();
        builder.face(&[back]).unwrap();
        let one_sided = builder.clone().build();
        builder.face(&[back.flipped()]).unwrap();
        let two_sided = builder.build();
        let through = draw(&one_sided, &["grey"], &[1.0, 50.0], &above(8, 8), Exposure::Fixed(1.0));
        assert_eq!(pixel(&through, 4, 4), [193; 3]);
        let plate = draw(&two_sided, &["grey"], &[1.0, 0.5, 4.0], &above(8, 8), Exposure::Fixed(1.0));
        assert_eq!((pixel(&plate, 4, 4), pixel(&plate, 0, 0)), ([255; 3], [193; 3]));
    }

    #[test]
    fn lamps_do_not_darken_the_picture() {
        let mut builder = MeshBuilder::default();
        builder.surface("wall", 0);
        grid(&mut builder, &[0.0, 0.5], &[0.0, 1.0]);
        builder.surface("lamp", 1);
        grid(&mut builder, &[0.5, 1.0], &[0.0, 1.0]);
        let (mesh, bands) = (builder.build(), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[3.0, 3e6], &[3.0, 3e6]).unwrap();
        let lit = field.with_exitance(&[0.0, 3e6]).unwrap();
        let picture = render(&lit, &above(80, 80), Exposure::Auto).unwrap();
        assert_eq!((pixel(&picture, 35, 40), pixel(&picture, 45, 40)), ([118; 3], [255; 3]));
        let unknown = render(&field, &above(80, 80), Exposure::Auto).unwrap();
        assert!(pixel(&unknown, 35, 40)[0] < 118);
    }

    #[test]
    fn threads_do_not_change_a_pixel() {
        let mesh = square(16);
        let radiosity: Vec<f64> = (0..256 * 3).map(|i| 1.0 + f64::from(i * 37 % 101)).collect();
        let mut camera = above(97, 61);
        camera.eye += Vec3::new(0.3, -1.1, -0.4);
        let with = |threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| draw(&mesh, &["r", "g", "b"], &radiosity, &camera, Exposure::Auto))
        };
        let one = with(1);
        assert!(one.pixels.iter().any(|&code| code > 100));
        assert!(one == with(2) && one == with(4));
    }

    #[test]
    fn the_png_holds_the_pixels() {
        let picture = draw(&square(1), &["r", "g", "b"], &[3.0, 2.0, 1.0], &above(40, 30), Exposure::Auto);
        let mut out = Vec::new();
        picture.write_png(&mut out).unwrap();
        let back = image::load_from_memory(&out).unwrap().to_rgb8();
        assert_eq!((back.width(), back.height()), (40, 30));
        assert_eq!(back.into_raw(), picture.pixels);
    }
}
