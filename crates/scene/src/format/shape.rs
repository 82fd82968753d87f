//! Shapes, as they are written.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Triple};

/// The shapes that a surface may have, of light and of waves; exactly one is given.
#[derive(Clone, Copy)]
pub(crate) struct Shapes<'a> {
    /// Name of the surface.
    pub name: &'a At<String>,
    pub quad: Option<&'a At<[Triple; 4]>>,
    pub triangle: Option<&'a At<[Triple; 3]>>,
    pub polygon: Option<&'a At<PolygonEntry>>,
    pub cuboid: Option<&'a At<BoxEntry>>,
    pub sphere: Option<&'a At<SphereEntry>>,
    pub disc: Option<&'a At<DiscEntry>>,
    pub cylinder: Option<&'a At<CylinderEntry>>,
    pub mesh: Option<&'a At<MeshFileEntry>>,
    /// The same under its first name, of light alone.
    pub obj: Option<&'a At<MeshFileEntry>>,
}

/// A flat polygon, not necessarily convex.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a polygon")]
#[schemars(rename = "Polygon")]
pub(crate) struct PolygonEntry {
    /// Corners of the border, m, counter-clockwise seen from the lit side.
    pub outline: Vec<Triple>,
    /// Corners of each hole, m, either way round. Holes touch neither each other nor the border.
    /// Default: none.
    #[serde(default)]
    pub holes: Vec<Vec<Triple>>,
}

/// A box with sides along the axes.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a box")]
#[schemars(rename = "Box")]
pub(crate) struct BoxEntry {
    /// Corner of least coordinates, m.
    pub min: Triple,
    /// Corner of largest coordinates, m.
    pub max: Triple,
    /// Lit inside, as a room is. Default: false, lit outside.
    #[serde(default)]
    pub inward: bool,
}

/// A sphere of flat triangles, with exactly the area of the true sphere.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a sphere")]
#[schemars(rename = "Sphere")]
pub(crate) struct SphereEntry {
    /// Centre, m.
    pub centre: Triple,
    /// Radius, m, above 0.
    pub radius: At<f64>,
    /// Lit inside. Default: false, lit outside.
    #[serde(default)]
    pub inward: bool,
    /// Edges around, at least 3; rounded up to a multiple of five. Default: 20.
    pub segments: Option<At<u32>>,
}

/// A disc of flat triangles, with exactly the area of the true disc.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a disc")]
#[schemars(rename = "Disc")]
pub(crate) struct DiscEntry {
    /// Centre, m.
    pub centre: Triple,
    /// Direction of the lit side, of any length.
    pub normal: Triple,
    /// Radius, m, above 0.
    pub radius: At<f64>,
    /// Edges around, at least 3. Default: 32.
    pub segments: Option<At<u32>>,
}

/// A cylinder of flat quads, with triangles for its caps, with exactly the area of the true
/// cylinder.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a cylinder")]
#[schemars(rename = "Cylinder")]
pub(crate) struct CylinderEntry {
    /// Centre of the base, m.
    pub base: Triple,
    /// From the centre of the base to the centre of the top, m.
    pub axis: Triple,
    /// Radius, m, above 0.
    pub radius: At<f64>,
    /// Whether base and top are closed. Default: true.
    pub caps: Option<bool>,
    /// Lit inside. Default: false, lit outside.
    #[serde(default)]
    pub inward: bool,
    /// Edges around, at least 3. Default: 32.
    pub segments: Option<At<u32>>,
}

/// Faces from a mesh file: OBJ, STL, PLY, glTF (.gltf, .glb), Gmsh 4.1 (.msh), Radiance (.rad),
/// Mitsuba 3 (.xml) or View3D (.vs3), known by the ending of its name. Every object, group, solid
/// or node becomes a surface called NAME/object.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a mesh file")]
#[schemars(rename = "Mesh")]
pub(crate) struct MeshFileEntry {
    /// The file, relative to the scene file.
    pub file: At<String>,
    /// Length of one unit of the file, m, above 0. Default: 1.
    pub scale: Option<At<f64>>,
    /// Turned after scaling. Default: not at all.
    pub turn: Option<Turn>,
    /// Moved after turning, m. Default: [0, 0, 0].
    pub translate: Option<Triple>,
    /// Material of the scene for each material of the file; for faces without one, for each object.
    /// Default: the one of the same name as the material, else what the file or its material
    /// library says: the reflectance, and the exitance π L of a radiance L (in an .mtl file Kd and
    /// Ke).
    #[serde(default)]
    pub materials: BTreeMap<At<String>, At<String>>,
}

/// A turn about an axis through the origin.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a turn")]
pub(crate) struct Turn {
    /// Direction of the axis, of any length.
    pub axis: Triple,
    /// Angle, degrees, counter-clockwise seen from the tip of the axis.
    pub degrees: At<f64>,
}
