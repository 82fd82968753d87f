//! A camera view of a solved field.
//!
//! Each pixel is the mean of the display values of [`SAMPLES`] points of a fixed lattice. What a
//! sample sees is found by ray casting among the leaves that turn their lit side to the eye; the
//! others are invisible, so that a closed room shows its inside. The colour there is the radiosity,
//! smoothly interpolated. Rows are drawn in parallel, each by itself, so that the number of threads
//! never changes a pixel. Several pictures of one view share the rays.

mod elements;
mod false_colour;
mod gathered;
mod links;
mod lit;
mod sides;

use std::io::{self, Cursor, Write};

use exr::prelude::{SpecificChannels, WritableImage};
use fredholm_mesh::Vec3;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rayon::prelude::*;

use crate::colour::Rgb;
use crate::shading::Shading;
use crate::tone::{Exposure, Tone, encode, luminance};
use crate::{Camera, Eye, Field, ReportError};
use elements::Elements;
pub use false_colour::{FalseColourPicture, PictureNumber, render_false_colour};
use gathered::GatherPainter;
pub use gathered::Gathering;
use links::LinkPainter;
pub use links::{Link, Linked};
use lit::LitView;
pub use lit::{LampLight, Lighter, Lit, LitPicture};
pub use sides::{Back, Side, render_sides};

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
    /// Writes linear colours as OpenEXR: channels R, G and B of 32-bit numbers, radiosity as linear
    /// sRGB, W/m².
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write_exr(&self, linear: &[[f32; 3]], out: &mut dyn Write) -> io::Result<()> {
        let (width, height) = (self.width as usize, self.height as usize);
        let colour = |at: exr::prelude::Vec2<usize>| {
            let [red, green, blue] = linear.get(at.y() * width + at.x()).copied().unwrap_or_default();
            (red, green, blue)
        };
        let image = exr::prelude::Image::from_channels((width, height), SpecificChannels::rgb(colour));
        // The writer goes back to fill in where the lines are.
        let mut file = Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut file).map_err(io::Error::other)?;
        out.write_all(file.get_ref())
    }

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

/// What a picture shows.
pub enum Layer<'a> {
    /// The radiosity, interpolated between the corners of elements.
    Field,
    /// The elements, drawn over the field.
    Elements,
    /// The links of the element in the middle of the picture: what is drawn of an element, of which
    /// the number is given.
    Links(&'a (dyn Fn(usize) -> Linked + Sync)),
    /// The radiosity of every pixel, gathered from all that it sees.
    Gathered(&'a dyn Gathering),
}

/// Draws a field as a camera sees it.
///
/// # Errors
/// [`ReportError::Camera`] or [`ReportError::Exposure`] for settings that make no picture,
/// [`ReportError::Visibility`] where the surfaces cannot be prepared for ray casting.
pub fn render(field: &Field<'_>, camera: &Camera, exposure: Exposure) -> Result<Picture, ReportError> {
    let mut pictures = drawn(field, camera, exposure, &[Layer::Field])?;
    Ok(pictures.swap_remove(0).0)
}

/// Draws a field as a camera sees it, with the light of the lamps taken at every pixel; `linear`
/// colours come with it where they are wanted. There is none where [`LampLight::go_on`] did not
/// want it any more before it was whole.
///
/// # Errors
/// As for [`render`], and [`ReportError::Length`] for vectors that do not fit the field.
pub fn render_lit(
    field: &Field<'_>,
    camera: &Camera,
    exposure: Exposure,
    lit: &Lit<'_>,
    linear: bool,
) -> Result<Option<LitPicture>, ReportError> {
    let eye = Eye::new(field.mesh(), camera)?;
    LitView::new(*field, &eye, lit)?.draw(exposure, linear)
}

/// Draws several pictures of a field as a camera sees it, all of one exposure, and casts the rays
/// once. There is none of what [`Gathering::go_on`] did not want any more before it was whole.
///
/// # Errors
/// As for [`render`].
pub fn render_layers<'a>(
    field: &Field<'_>,
    camera: &Camera,
    exposure: Exposure,
    layers: impl IntoIterator<Item = &'a Layer<'a>>,
) -> Result<Vec<Option<Picture>>, ReportError> {
    let pictures = drawn(field, camera, exposure, layers)?;
    Ok(pictures.into_iter().map(|(picture, whole)| whole.then_some(picture)).collect())
}

/// The pictures, and whether each is whole.
fn drawn<'a>(
    field: &Field<'_>,
    camera: &Camera,
    exposure: Exposure,
    layers: impl IntoIterator<Item = &'a Layer<'a>>,
) -> Result<Vec<(Picture, bool)>, ReportError> {
    let view = Viewer::new(field, camera)?;
    let metered = if exposure == Exposure::Auto { view.meter(field) } else { Vec::new() };
    let tone = Tone::new(exposure, &metered)?;
    let painters: Vec<Box<dyn Painter + '_>> =
        layers.into_iter().map(|layer| view.painter(field, layer)).collect();
    let row_bytes = 3 * camera.width as usize;
    let width = row_bytes * painters.len();
    let mut rows = vec![0; width * camera.height as usize];
    rows.par_chunks_mut(width).enumerate().for_each(|(y, row)| view.draw(tone, &painters, y, row));
    let mut pictures = Vec::new();
    for (k, painter) in painters.iter().enumerate() {
        let part = |row: &[u8]| row[k * row_bytes..(k + 1) * row_bytes].to_vec();
        let pixels = rows.chunks_exact(width).flat_map(part).collect();
        let mut picture = Picture { width: camera.width, height: camera.height, pixels };
        painter.finish(&view, &mut picture);
        pictures.push((picture, painter.is_whole()));
    }
    Ok(pictures)
}

/// What is seen through a point of the picture.
#[derive(Clone, Copy, Debug)]
struct Sample {
    leaf: usize,
    point: Vec3,
    /// Place in the picture, pixels from the upper left.
    at: (f64, f64),
    /// Display colour of the interpolated field, where a painter shows it.
    shown: Rgb,
}

/// Colours the pixels of a picture.
trait Painter: Sync {
    /// Paints for one thread: a linear display colour from the samples of a pixel.
    fn brush(&self) -> Brush<'_>;

    /// Whether it shows the interpolated field.
    fn shows_field(&self) -> bool {
        true
    }

    /// Adds what is drawn over the whole picture.
    fn finish(&self, _view: &Viewer<'_>, _picture: &mut Picture) {}

    /// Whether all pixels were painted.
    fn is_whole(&self) -> bool {
        true
    }
}

/// Paints a pixel.
type Brush<'a> = Box<dyn FnMut(&Viewer<'_>, Tone, &[Option<Sample>; SAMPLES]) -> Rgb + 'a>;

/// A camera before a scene.
struct Viewer<'a> {
    eye: Eye,
    shading: Shading<'a>,
}

impl<'a> Viewer<'a> {
    fn new(field: &Field<'a>, camera: &Camera) -> Result<Self, ReportError> {
        Ok(Self { eye: Eye::new(field.mesh(), camera)?, shading: Shading::new(*field) })
    }

    fn painter<'v>(&'v self, field: &Field<'v>, layer: &Layer<'v>) -> Box<dyn Painter + 'v> {
        match *layer {
            Layer::Field => Box::new(Plain),
            Layer::Elements => Box::new(Elements { mesh: field.mesh() }),
            Layer::Links(links) => Box::new(LinkPainter::new(self, field, links)),
            Layer::Gathered(gathering) => Box::new(GatherPainter::new(*field, gathering)),
        }
    }

    /// Draws one row of all pictures, one behind the other.
    fn draw(&self, tone: Tone, painters: &[Box<dyn Painter + '_>], y: usize, rows: &mut [u8]) {
        let width = self.eye.camera().width as usize;
        let mut brushes: Vec<Brush> = painters.iter().map(|painter| painter.brush()).collect();
        let field = painters.iter().any(|painter| painter.shows_field());
        for x in 0..width {
            let samples = self.samples((x, y), field.then_some(tone));
            for (k, brush) in brushes.iter_mut().enumerate() {
                let at = 3 * (k * width + x);
                rows[at..at + 3].copy_from_slice(&brush(self, tone, &samples).map(encode));
            }
        }
    }

    /// The samples of a pixel, with the field in a tone where one is given.
    fn samples(&self, (x, y): (usize, usize), tone: Option<Tone>) -> [Option<Sample>; SAMPLES] {
        std::array::from_fn(|k| {
            let (dx, dy) = lattice(k);
            let at = (x as f64 + dx, y as f64 + dy);
            let (leaf, point) = self.eye.hit(at.0, at.1)?;
            let shown = tone.map_or([0.0; 3], |tone| tone.display(self.shading.colour(leaf, point)));
            Some(Sample { leaf, point, at, shown })
        })
    }

    /// Where a point is in the picture, pixels from the upper left; none for one behind the eye.
    fn project(&self, point: Vec3) -> Option<(f64, f64)> {
        self.eye.place(point)
    }

    /// Luminances seen through the middle of each pixel: of lit surfaces, or of lamps where there
    /// is nothing else.
    fn meter(&self, field: &Field<'_>) -> Vec<f64> {
        let Camera { width, height, .. } = *self.eye.camera();
        // One list for all: a row that sees nothing somewhere would leave gaps in the heap. Lamps
        // have the sign of a negative number there, and nothing is no number.
        let mut seen = vec![f64::NAN; width as usize * height as usize];
        let look = |(y, row): (usize, &mut [f64])| {
            for (x, value) in row.iter_mut().enumerate() {
                if let Some((leaf, p)) = self.eye.hit(x as f64 + 0.5, y as f64 + 0.5) {
                    let bright = luminance(self.shading.colour(leaf, p));
                    *value = if field.emits(leaf) { -bright } else { bright };
                }
            }
        };
        seen.par_chunks_mut(width as usize).enumerate().for_each(look);
        let reflects = |value: f64| !value.is_nan() && value.is_sign_positive();
        if seen.iter().any(|&value| reflects(value)) {
            seen.retain(|&value| reflects(value));
        } else {
            seen.retain(|value| !value.is_nan());
            for value in &mut seen {
                *value = -*value;
            }
        }
        seen
    }
}

/// Place of a sample in its pixel.
fn lattice(i: usize) -> (f64, f64) {
    let place = |i: usize| (i as f64 + 0.5) / SAMPLES as f64;
    (place(i), place(GENERATOR * i % SAMPLES))
}

/// The mean of the display colours of the samples of a pixel.
fn mean(samples: &[Option<Sample>; SAMPLES], mut colour: impl FnMut(&Sample) -> Rgb) -> Rgb {
    let mut sum = [0.0; 3];
    for sample in samples {
        let part = sample.as_ref().map_or([BACKGROUND; 3], &mut colour);
        sum = [0, 1, 2].map(|i| sum[i] + part[i]);
    }
    sum.map(|channel| channel / SAMPLES as f64)
}

/// The interpolated field.
struct Plain;

impl Painter for Plain {
    fn brush(&self) -> Brush<'_> {
        Box::new(|_, _, samples| mean(samples, |sample| sample.shown))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{grid, names};
    use fredholm_mesh::{Mesh, MeshBuilder, Patch, Vec3};
    use rayon::ThreadPoolBuilder;
    use std::ops::ControlFlow;
    use std::sync::atomic::{AtomicUsize, Ordering};

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

    /// Several pictures of a square of 2 × 2 elements, which fills columns and rows 30 to 50 of 80.
    fn layers(layers: &[Layer<'_>]) -> Vec<Picture> {
        let (mesh, bands) = (square(2), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[2.0; 4], &[2.0; 4]).unwrap();
        let pictures = render_layers(&field, &above(80, 80), Exposure::Fixed(0.5), layers).unwrap();
        pictures.into_iter().map(Option::unwrap).collect()
    }

    #[test]
    fn edges_are_drawn_over_the_field() {
        let pictures = layers(&[Layer::Field, Layer::Elements]);
        assert_eq!(pixel(&pictures[0], 40, 35), [193; 3]);
        for (x, y) in [(39, 35), (40, 35), (30, 35), (35, 49), (35, 40)] {
            let [red, _, blue] = pixel(&pictures[1], x, y);
            assert!(blue > red + 20, "({x}, {y}) is on an edge");
        }
        for (x, y) in [(35, 35), (45, 36), (33, 46), (2, 2)] {
            assert_eq!(pixel(&pictures[1], x, y), pixel(&pictures[0], x, y), "({x}, {y}) is on none");
        }
    }

    #[test]
    fn links_are_tinted_by_what_they_bring() {
        let corner = |x: f64, y: f64| Vec3::new(0.5 * x, 0.5 * y, 0.0);
        let cell =
            |x: f64, y: f64| [corner(x, y), corner(x + 1., y), corner(x + 1., y + 1.), corner(x, y + 1.)];
        let link = |x: f64, y: f64, share: f64| {
            let patch = Patch::quad(cell(x, y)).unwrap().unwrap();
            Link { patch: Some(patch), centre: patch.centroid(), level: 4, share }
        };
        // The middle of the picture is a corner of all four elements: the first one is the
        // receiver.
        let linked = |_: usize| Linked {
            links: vec![link(1.0, 0.0, 0.5), link(1.0, 1.0, 1e-3)],
            link_of: vec![None, Some(0), None, Some(1)],
        };
        let picture = &layers(&[Layer::Links(&linked)])[0];
        let blueness = |x: u32, y: u32| {
            let [red, _, blue] = pixel(picture, x, y);
            i32::from(blue) - i32::from(red)
        };
        let mesh = square(2);
        let place = |leaf: usize| {
            let middle = mesh.patch(leaf).centroid();
            (30 + (20.0 * middle.x) as u32 + 2, 50 - (20.0 * middle.y) as u32 + 2)
        };
        let [strong, none, weak] = [1, 2, 3].map(|leaf| blueness(place(leaf).0, place(leaf).1));
        assert!(strong > weak && weak > none && none <= 0, "{strong} {weak} {none}");
    }

    /// Radiosity 4 x.
    struct Ramp;

    impl Gathering for Ramp {
        fn gatherer(&self) -> Box<dyn FnMut(usize, Vec3) -> Vec<f64> + '_> {
            Box::new(|_, point| vec![4.0 * point.x])
        }
    }

    #[test]
    fn gathered_pixels_have_the_radiosity_of_their_points() {
        let picture = &layers(&[Layer::Gathered(&Ramp)])[0];
        let tone = Tone::new(Exposure::Fixed(0.5), &[]).unwrap();
        for x in 31..49 {
            // The sample nearest to the middle of pixel x stands within an eighth of a pixel of it.
            let [low, high] = [-0.15, 0.15].map(|off| {
                let b = 4.0 * (f64::from(x) + 0.5 + off - 30.0) / 20.0;
                encode(tone.display([b; 3])[0])
            });
            let found = pixel(picture, x, 37)[0];
            assert!(low <= found && found <= high, "{x}: {found} is not from {low} to {high}");
        }
        assert_eq!(pixel(picture, 2, 2), pixel(picture, 70, 70), "nothing is gathered beside the square");
    }

    /// Whoever wants the first pixels only.
    struct Impatient(AtomicUsize);

    impl Gathering for Impatient {
        fn gatherer(&self) -> Box<dyn FnMut(usize, Vec3) -> Vec<f64> + '_> {
            Ramp.gatherer()
        }

        fn go_on(&self) -> ControlFlow<()> {
            let asked = self.0.fetch_add(1, Ordering::Relaxed);
            if asked < 100 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
    }

    #[test]
    fn a_picture_that_is_not_whole_is_none() {
        let (mesh, bands) = (square(2), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[2.0; 4], &[2.0; 4]).unwrap();
        let gathering = Impatient(AtomicUsize::new(0));
        let layers = [Layer::Field, Layer::Gathered(&gathering)];
        let pictures = render_layers(&field, &above(80, 80), Exposure::Fixed(0.5), &layers).unwrap();
        assert!(pictures[0].is_some() && pictures[1].is_none());
    }
}
