//! Pieces of geometry by the side that is seen: fronts blue, backs orange, marked pieces violet,
//! and lines, such as open sides, in yellow over everything. Brightness falls with the angle to the
//! line of sight.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use rayon::prelude::*;

use super::links::line;
use super::{BACKGROUND, Picture};
use crate::camera::Axes;
use crate::colour::Rgb;
use crate::plot::Annotated;
use crate::tone::encode;
use crate::{Camera, ReportError};

/// Linear display colours.
const FRONT_COLOUR: Rgb = [0.16, 0.34, 0.62];
const BACK_COLOUR: Rgb = [0.75, 0.24, 0.04];
const MARKED_COLOUR: Rgb = [0.55, 0.06, 0.62];
const LINE_COLOUR: [u8; 3] = [255, 225, 30];
/// Share of the brightness that is left at grazing angles.
const GRAZING_BRIGHTNESS: f64 = 0.35;
/// Share of a line over what is behind it.
const LINE_SHARE: f64 = 0.9;
/// Places of the samples in a pixel.
const SAMPLES_OF_A_PIXEL: [[f64; 2]; 4] = [[0.125, 0.625], [0.375, 0.125], [0.625, 0.875], [0.875, 0.375]];

/// What the back of a piece is drawn as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Back {
    /// As a back.
    Dark,
    /// As a front: it is lit on both sides.
    Lit,
    /// Not at all, as the walls of a room that is looked into.
    Hidden,
}

/// A piece of geometry to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The piece.
    pub patch: Patch,
    /// What its back is drawn as.
    pub back: Back,
    /// Whether it is marked.
    pub marked: bool,
}

/// Draws pieces by their sides, and lines over them. Above stands `title` with what the colours
/// tell, `called` being what the lines are, `marked` the marked pieces.
///
/// # Errors
/// [`ReportError::Camera`] for settings that make no picture, [`ReportError::Visibility`] where the
/// pieces cannot be prepared for ray casting, [`ReportError::Drawing`] where the plotting library
/// fails.
pub fn sides_map(
    sides: &[Side],
    (lines, called): (&[[Vec3; 2]], &str),
    camera: &Camera,
    (title, marked): (&str, &str),
) -> Result<Picture, ReportError> {
    let picture = render_sides(sides, lines, &camera.enlarged())?;
    let of_pieces =
        if sides.iter().any(|side| side.marked) { format!(", violet: {marked}") } else { String::new() };
    let of_lines = if lines.is_empty() { String::new() } else { format!(", yellow: {called}") };
    let title = format!("{title}: fronts blue, backs orange{of_pieces}{of_lines}");
    Annotated { title: &title, picture: &picture, bar: None, isolines: &[], numbers: &[] }.drawn()
}

fn render_sides(sides: &[Side], lines: &[[Vec3; 2]], camera: &Camera) -> Result<Picture, ReportError> {
    let axes = camera.axes()?;
    let faces_eye = |patch: &Patch| patch.normal().dot(camera.eye - patch.centroid()) > 0.0;
    let seen: Vec<&Side> =
        sides.iter().filter(|side| side.back != Back::Hidden || faces_eye(&side.patch)).collect();
    let patches: Vec<Patch> = seen.iter().map(|side| side.patch).collect();
    let pieces =
        Occluders::new(&patches).map_err(|error| ReportError::Visibility { why: error.to_string() })?;
    let mut picture = supersampled(camera, |x, y| {
        let direction = camera.direction(&axes, x, y);
        let hit = pieces.closest(camera.eye, direction, f64::INFINITY);
        hit.map_or([BACKGROUND; 3], |hit| colour(seen[hit.patch], direction))
    });
    for ends in lines {
        draw(camera, &axes, &mut picture, *ends);
    }
    Ok(picture)
}

/// A picture of the size of a camera's, each pixel the mean of the linear colours at four places.
pub(crate) fn supersampled(camera: &Camera, colour: impl Fn(f64, f64) -> Rgb + Sync) -> Picture {
    let Camera { width, height, .. } = *camera;
    let columns = width as usize;
    let pixel = |at: usize| {
        let mut sum = [0.0; 3];
        for [dx, dy] in SAMPLES_OF_A_PIXEL {
            let colour = colour((at % columns) as f64 + dx, (at / columns) as f64 + dy);
            sum = [0, 1, 2].map(|i| sum[i] + colour[i] / SAMPLES_OF_A_PIXEL.len() as f64);
        }
        sum.map(encode)
    };
    let pixels: Vec<[u8; 3]> = (0..columns * height as usize).into_par_iter().map(pixel).collect();
    Picture { width, height, pixels: pixels.into_flattened() }
}

fn colour(side: &Side, direction: Vec3) -> Rgb {
    let cosine = -side.patch.normal().dot(direction);
    let base = match (side.marked, cosine > 0.0 || side.back == Back::Lit) {
        (true, _) => MARKED_COLOUR,
        (false, true) => FRONT_COLOUR,
        (false, false) => BACK_COLOUR,
    };
    base.map(|channel| channel * (GRAZING_BRIGHTNESS + (1.0 - GRAZING_BRIGHTNESS) * cosine.abs()))
}

fn draw(camera: &Camera, axes: &Axes, picture: &mut Picture, ends: [Vec3; 2]) {
    if let [Some(a), Some(b)] = ends.map(|end| camera.place(axes, end)) {
        line(picture, [a, b], (LINE_COLOUR, LINE_SHARE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64) -> Patch {
        let v = |x, y| Vec3::new(x, y, z);
        Patch::quad([v(0., 0.), v(1., 0.), v(1., 1.), v(0., 1.)]).unwrap().unwrap()
    }

    fn middle(sides: &[Side], lines: &[[Vec3; 2]]) -> [u8; 3] {
        let camera = Camera {
            eye: Vec3::new(0.5, 0.5, 2.0),
            target: Vec3::new(0.5, 0.5, 0.0),
            up: Vec3::Y,
            vertical_fov_degrees: 60.0,
            width: 9,
            height: 9,
        };
        let picture = render_sides(sides, lines, &camera).unwrap();
        picture.pixels[3 * (4 * 9 + 4)..][..3].try_into().unwrap()
    }

    #[test]
    fn sides_marks_and_lines_have_colours_of_their_own() {
        let side = |patch, back, marked| Side { patch, back, marked };
        let front = middle(&[side(square(0.0), Back::Dark, false)], &[]);
        let back = middle(&[side(square(0.0).flipped(), Back::Dark, false)], &[]);
        assert!(front[2] > 150 && front[0] < 120 && back[0] > 180 && back[2] < 80, "{front:?} {back:?}");
        assert_eq!(middle(&[side(square(0.0).flipped(), Back::Lit, false)], &[]), front);
        let room = [side(square(0.0), Back::Dark, false), side(square(1.0).flipped(), Back::Hidden, false)];
        assert_eq!(middle(&room, &[]), front);
        let marked = middle(&[side(square(0.0), Back::Dark, true)], &[]);
        assert!(marked[0] > 150 && marked[2] > 150 && marked[1] < 110, "{marked:?}");
        let lined = middle(&[], &[[Vec3::new(0.0, 0.5, 0.0), Vec3::new(1.0, 0.5, 0.0)]]);
        assert!(lined[0] > 200 && lined[2] < 80, "{lined:?}");
    }
}
