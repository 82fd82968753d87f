//! The camera of a scene.

use fredholm_mesh::Vec3;

use crate::error::SceneError;
use crate::format::{At, CameraEntry};
use crate::source::Source;

const LARGEST_PICTURE: u32 = 16384;
/// Sine of the angle between the view and up, below which up is taken for parallel to the view.
const PARALLEL_SINE: f64 = 1e-9;

/// A pinhole camera. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands, m.
    pub eye: Vec3,
    /// The point in the middle of the picture, m.
    pub target: Vec3,
    /// Direction that points up in the picture, of any length.
    pub up: Vec3,
    /// Angle from the lower to the upper edge of the picture, degrees, above 0 and below 180.
    pub vertical_fov_degrees: f64,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
    /// Factor on the brightness of the picture; `None` where it is to be chosen from the light in
    /// the scene.
    pub exposure: Option<f64>,
}

pub(super) fn camera(source: &Source, entry: &CameraEntry) -> Result<Camera, SceneError> {
    let fov = |angle| source.below(angle, 180.0, "vertical_fov_degrees");
    let pixels = |count: &Option<At<u32>>, edge| count.as_ref().map_or(Ok(800), |n| pixels(source, n, edge));
    let camera = Camera {
        eye: source.vector(&entry.eye, "eye")?,
        target: source.vector(&entry.target, "target")?,
        up: entry.up.as_ref().map_or(Ok(Vec3::Z), |up| source.direction(up, "up"))?,
        vertical_fov_degrees: entry.vertical_fov_degrees.as_ref().map_or(Ok(45.0), fov)?,
        width: pixels(&entry.width, "width")?,
        height: pixels(&entry.height, "height")?,
        exposure: entry.exposure.as_ref().map(|e| source.positive(e, "exposure")).transpose()?,
    };
    check_view(source, entry, &camera)?;
    Ok(camera)
}

fn pixels(source: &Source, count: &At<u32>, edge: &str) -> Result<u32, SceneError> {
    if (1..=LARGEST_PICTURE).contains(&**count) {
        return Ok(**count);
    }
    let what = format!("the {edge} of the picture is {} pixels", **count);
    Err(source.value_error(count, what, &format!("write a number from 1 to {LARGEST_PICTURE}")))
}

fn check_view(source: &Source, entry: &CameraEntry, camera: &Camera) -> Result<(), SceneError> {
    let view = camera.target - camera.eye;
    if !(view.length() > 0.0 && view.is_finite()) {
        let what = "the camera looks at the point where it stands".to_owned();
        return Err(source.value_error(&entry.target, what, "move eye or target, so that they differ"));
    }
    if view.normalize().cross(camera.up.normalize()).length() > PARALLEL_SINE {
        return Ok(());
    }
    let what = "the direction up is along the line of sight".to_owned();
    let help = "choose another direction for up, such as [0, 1, 0]";
    Err(source.value_error(entry.up.as_ref().unwrap_or(&entry.target), what, help))
}
