//! A camera view of a solved field.
//!
//! What a pixel sees is found by ray casting among the leaves that turn their lit side to the eye;
//! the others are invisible, so that a closed room shows its inside. The usual picture is that of
//! [`lit`]; what is drawn of elements and links lies over it. Pixels are computed in parallel, each
//! by itself, so that the number of threads never changes one.

mod elements;
mod false_colour;
mod gathered;
mod links;
mod lit;
mod sides;
mod smoothed;

use std::io::{self, Cursor, Write};

use exr::prelude::{SpecificChannels, WritableImage};
use fredholm_mesh::{Mesh, Vec3};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rayon::prelude::*;

use crate::colour::Rgb;
use crate::tone::{Exposure, decode, encode};
use crate::{Camera, Eye, Field, ReportError};
use elements::Elements;
pub use false_colour::{FalseColourPicture, PictureNumber, render_false_colour};
pub use gathered::{DIRECTION_GROUPS, Gathering};
use links::LinkOverlay;
pub use links::{Link, Linked};
pub use lit::{LampFactors, LampLight, Lighter, Lit, LitPicture, Points, Seen, Where};
use lit::{LitView, Unlit, neighbours};
pub(crate) use sides::supersampled;
pub use sides::{Back, Side, sides_map};

/// Samples of a pixel at a border.
const SAMPLES: usize = 8;
/// Generator of the lattice of samples: sample i stands at ((i + ½)/8, ((3 i mod 8) + ½)/8).
const GENERATOR: usize = 3;
/// Cosine of the normals of two leaves of a surface from which on there is no border between them.
const SMOOTH_COSINE: f64 = 0.9;
/// Linear display value where nothing is hit: a dark grey.
pub(crate) const BACKGROUND: f64 = 0.012;

/// A finished picture: rows from the top, three bytes a pixel, sRGB.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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

/// What is drawn over a picture.
pub enum Layer<'a> {
    /// The elements.
    Elements,
    /// The links of the element in the middle of the picture: what is drawn of an element, of which
    /// the number is given.
    Links(&'a (dyn Fn(usize) -> Linked + Sync)),
}

/// Draws a field as a camera sees it, interpolated between the corners of elements.
///
/// # Errors
/// [`ReportError::Camera`] or [`ReportError::Exposure`] for settings that make no picture,
/// [`ReportError::Visibility`] where the surfaces cannot be prepared for ray casting.
pub fn render(field: &Field<'_>, camera: &Camera, exposure: Exposure) -> Result<Picture, ReportError> {
    let eye = Eye::new(field.mesh(), camera)?;
    let reflectance = vec![0.0; field.radiosity().len()];
    let lit = Lit { light: &Unlit, exitance: &[], reflectance: &reflectance, direct: None, gathering: None };
    // Nobody ends what [`Unlit`] is drawn with.
    let drawn = LitView::new(*field, &eye, &lit)?.draw(exposure, false)?;
    Ok(drawn.map(|drawn| drawn.picture).unwrap_or_default())
}

/// Draws a field as a camera sees it, with the light of the lamps taken at every pixel; `linear`
/// colours come with it where they are wanted. There is none where [`LampLight::go_on`] did not
/// want it any more before all pixels had that light.
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

/// Draws layers over a picture of a field, each by itself.
///
/// # Errors
/// [`ReportError::Camera`] for a camera that makes no picture, [`ReportError::Length`] for one of
/// another size than the picture's, [`ReportError::Visibility`] where the surfaces cannot be
/// prepared for ray casting.
pub fn render_layers<'a>(
    field: &Field<'_>,
    camera: &Camera,
    under: &Picture,
    layers: impl IntoIterator<Item = &'a Layer<'a>>,
) -> Result<Vec<Picture>, ReportError> {
    let eye = Eye::new(field.mesh(), camera)?;
    let (expected, found) = (3 * camera.width as usize * camera.height as usize, under.pixels.len());
    if expected != found {
        return Err(ReportError::Length { what: "the picture under layers", expected, found });
    }
    let view = Viewer { mesh: field.mesh(), eye };
    let leaves = view.leaves();
    let drawn = |layer: &Layer<'_>| {
        let overlay: Box<dyn Overlay> = match *layer {
            Layer::Elements => Box::new(Elements { mesh: field.mesh() }),
            Layer::Links(links) => Box::new(LinkOverlay::new(&view, field, links)),
        };
        let mut picture = under.clone();
        let width = camera.width as usize;
        let rows = picture.pixels.par_chunks_mut(3 * width).enumerate();
        rows.for_each(|(y, row)| view.draw(&*overlay, &leaves, (y, row)));
        overlay.finish(&view, &mut picture);
        picture
    };
    Ok(layers.into_iter().map(drawn).collect())
}

/// What is seen through a point of the picture.
#[derive(Clone, Copy, Debug)]
struct Sample {
    leaf: usize,
    point: Vec3,
    /// Place in the picture, pixels from the upper left.
    at: (f64, f64),
    /// Whether it stands for a whole pixel.
    is_pixel: bool,
}

/// What is drawn over a picture.
trait Overlay: Sync {
    /// The linear display colour of a sample, where the picture has another one.
    fn colour(&self, view: &Viewer<'_>, sample: &Sample, under: Rgb) -> Rgb;

    /// Adds what is drawn over the whole picture.
    fn finish(&self, _view: &Viewer<'_>, _picture: &mut Picture) {}
}

/// A camera before a scene.
struct Viewer<'a> {
    mesh: &'a Mesh,
    eye: Eye,
}

impl Viewer<'_> {
    /// The leaves seen through the middles of the pixels, row by row.
    fn leaves(&self) -> Vec<Option<u32>> {
        let Camera { width, height, .. } = *self.eye.camera();
        let look = |k: usize| {
            let (x, y) = (k % width as usize, k / width as usize);
            self.eye.hit(x as f64 + 0.5, y as f64 + 0.5).map(|(leaf, _)| leaf as u32)
        };
        (0..width as usize * height as usize).into_par_iter().map(look).collect()
    }

    /// Draws an overlay over a row.
    fn draw(&self, overlay: &dyn Overlay, leaves: &[Option<u32>], (y, row): (usize, &mut [u8])) {
        let Camera { width, height, .. } = *self.eye.camera();
        let size = (width as usize, height as usize);
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            let under = [0, 1, 2].map(|i| decode(pixel[i]));
            let own = leaves[y * size.0 + x];
            let even = neighbours(size, (x, y)).all(|at| self.is_smooth(own, leaves[at]));
            let colour = match own {
                // Nothing is drawn beside the scene.
                None if even => continue,
                Some(leaf) if even => {
                    let (leaf, at) = (leaf as usize, (x as f64 + 0.5, y as f64 + 0.5));
                    let point = self.eye.on_plane(self.mesh.patch(leaf), at.0, at.1);
                    overlay.colour(self, &Sample { leaf, point, at, is_pixel: true }, under)
                }
                _ => self.mean(overlay, (x, y), under),
            };
            pixel.copy_from_slice(&colour.map(encode));
        }
    }

    /// Whether there is no border between two leaves.
    fn is_smooth(&self, a: Option<u32>, b: Option<u32>) -> bool {
        let (Some(p), Some(q)) = (a.map(|leaf| leaf as usize), b.map(|leaf| leaf as usize)) else {
            return a == b;
        };
        p == q
            || (self.mesh.surface_of(p) == self.mesh.surface_of(q)
                && self.mesh.patch(p).normal().dot(self.mesh.patch(q).normal()) > SMOOTH_COSINE)
    }

    /// The mean of the display colours of the samples of a pixel.
    fn mean(&self, overlay: &dyn Overlay, (x, y): (usize, usize), under: Rgb) -> Rgb {
        let mut sum = [0.0; 3];
        for k in 0..SAMPLES {
            let (dx, dy) = lattice(k);
            let at = (x as f64 + dx, y as f64 + dy);
            let part = self.eye.hit(at.0, at.1).map_or(under, |(leaf, point)| {
                overlay.colour(self, &Sample { leaf, point, at, is_pixel: false }, under)
            });
            sum = [0, 1, 2].map(|i| sum[i] + part[i] / SAMPLES as f64);
        }
        sum
    }

    /// Where a point is in the picture, pixels from the upper left; none for one behind the eye.
    fn project(&self, point: Vec3) -> Option<(f64, f64)> {
        self.eye.place(point)
    }
}

/// Place of a sample in its pixel.
fn lattice(i: usize) -> (f64, f64) {
    let place = |i: usize| (i as f64 + 0.5) / SAMPLES as f64;
    (place(i), place(GENERATOR * i % SAMPLES))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{grid, names};
    use fredholm_mesh::{MeshBuilder, Patch};
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

    /// A picture, and it with layers, of a square of 2 × 2 elements, which fills columns and rows 30 to 50 of 80.
    fn layers(layers: &[Layer<'_>]) -> Vec<Picture> {
        let (mesh, bands) = (square(2), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[2.0; 4], &[2.0; 4]).unwrap();
        let camera = above(80, 80);
        let under = render(&field, &camera, Exposure::Fixed(0.5)).unwrap();
        let over = render_layers(&field, &camera, &under, layers).unwrap();
        [vec![under], over].concat()
    }

    #[test]
    fn edges_are_drawn_over_the_field() {
        let pictures = layers(&[Layer::Elements]);
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
        let picture = &layers(&[Layer::Links(&linked)])[1];
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
}
