//! The record of progressive radiosity without a matrix.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{MeshError, Timing, reading};

/// Name of the format of `shots.json`.
pub const SHOOTING_FORMAT: &str = "fredholm-shots-1";

/// One shot, and where it has led.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Shot {
    /// Elements that shot as one.
    pub elements: u64,
    /// Columns computed so far.
    pub columns: u64,
    /// Seconds since the first shot began, without the pictures.
    pub seconds: f64,
    /// Share of the power of the solution that has been shot, at least, in the slowest band.
    #[serde(deserialize_with = "reading::number")]
    pub distributed: f64,
}

/// Everything about a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct ShootingRecord {
    /// [`SHOOTING_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file.
    pub scene: String,
    /// SHA-256 of the scene file.
    pub scene_sha256: String,
    /// Options in force.
    pub options: serde_json::Value,
    /// Names of the bands.
    pub bands: Vec<String>,
    /// Number of elements.
    pub elements: u64,
    /// Number of elements and groups of elements that could shoot.
    pub groups: u64,
    /// Whether the picture was drawn.
    pub drawn: bool,
    /// Whether the share asked for was reached.
    pub reached: bool,
    /// Estimated error of the irradiance of the faces: of the mesh, and of what is unshot; none
    /// where the run was interrupted.
    pub mesh_error: Option<MeshError>,
    /// Largest estimated error of a form factor of the columns computed.
    #[serde(deserialize_with = "reading::number")]
    pub form_factor_error: f64,
    /// Largest memory held, bytes, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// The shots.
    pub shots: Vec<Shot>,
    /// Times of the stages.
    pub timings: Vec<Timing>,
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A run of two shots.
    pub fn sample() -> ShootingRecord {
        let shot = |elements, columns, seconds, distributed| Shot { elements, columns, seconds, distributed };
        ShootingRecord {
            format: SHOOTING_FORMAT.into(),
            version: "0".into(),
            scene: "room.toml".into(),
            scene_sha256: String::new(),
            options: serde_json::Value::Null,
            bands: vec!["grey".into()],
            elements: 8,
            groups: 12,
            drawn: true,
            reached: false,
            mesh_error: None,
            form_factor_error: 1e-4,
            peak_memory_bytes: None,
            warnings: Vec::new(),
            shots: vec![shot(4, 1, 0.5, 0.25), shot(1, 2, 0.75, 0.5)],
            timings: Vec::new(),
        }
    }
}
