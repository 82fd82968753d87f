//! The format of scene files, as it is written: types that mirror the file and know where each
//! value stands.
//!
//! The documentation of these types is the documentation of the format: it becomes the JSON Schema.
//! Whether the values make sense is decided in [`crate::resolve`].

mod at;
mod camera;
mod material;
mod per_band;
mod shape;
mod solve;
mod surface;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

pub(crate) use at::At;
pub(crate) use camera::CameraEntry;
pub(crate) use material::MaterialEntry;
pub(crate) use per_band::PerBand;
pub(crate) use shape::{
    BoxEntry, CylinderEntry, DiscEntry, MeshFileEntry, PolygonEntry, Shapes, SphereEntry, Turn,
};
pub(crate) use solve::{SolveEntry, StorageEntry};
pub(crate) use surface::SurfaceEntry;

/// Three numbers: x, y and z.
pub(crate) type Triple = At<[At<f64>; 3]>;

/// A scene: surfaces, what they are made of, and how to compute and show the light on them.
///
/// Lengths are in metres, angles in degrees (their names say so), exitance in W/m². A face is lit
/// on the side from which its corners run counter-clockwise. Keys that are not listed here are
/// refused.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a scene file")]
#[schemars(title = "Fredholm scene", rename = "Scene")]
pub(crate) struct SceneEntry {
    /// What the scene is called. Default: no title.
    pub title: Option<String>,
    /// Names of the spectral bands, at least one: letters, digits and `_ - . +`. Names such as
    /// `540nm` are taken for wavelengths by the picture, and r, g, b (or red, green, blue) for
    /// colours. Default: one band, `grey`.
    pub bands: Option<At<Vec<At<String>>>>,
    /// Elements that every face is computed on: a square number k², for k × k. Default: 1.
    pub elements_per_face: Option<At<u64>>,
    /// How to solve, where the command line does not say.
    pub solve: Option<SolveEntry>,
    /// Where the picture is taken from. Default: a view that takes in the whole scene.
    pub camera: Option<CameraEntry>,
    /// Materials by name.
    #[serde(default)]
    pub materials: BTreeMap<At<String>, MaterialEntry>,
    /// The surfaces, at least one.
    #[serde(default)]
    pub surface: Vec<At<SurfaceEntry>>,
}
