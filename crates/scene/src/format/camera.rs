//! The camera, as it is written.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Triple};

/// A pinhole camera.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a camera")]
#[schemars(rename = "Camera")]
pub(crate) struct CameraEntry {
    /// Where the camera stands, m.
    pub eye: Triple,
    /// The point in the middle of the picture, m. Not the eye.
    pub target: Triple,
    /// Direction that points up in the picture. Default: [0, 0, 1].
    pub up: Option<Triple>,
    /// Angle from the lower to the upper edge of the picture, degrees, above 0 and below 180.
    /// Default: 45.
    pub vertical_fov_degrees: Option<At<f64>>,
    /// Width of the picture in pixels, 1 to 16384. Default: 800.
    pub width: Option<At<u32>>,
    /// Height of the picture in pixels, 1 to 16384. Default: 800.
    pub height: Option<At<u32>>,
    /// Factor on the brightness of the picture, above 0. Default: chosen from the light in the
    /// scene.
    pub exposure: Option<At<f64>>,
}
