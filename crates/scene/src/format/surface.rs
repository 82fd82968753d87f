//! A surface, as it is written.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    At, BoxEntry, CylinderEntry, DiscEntry, MeshFileEntry, PolygonEntry, Shapes, SphereEntry, Triple,
};

/// A named surface: one shape, made of one material, cut into faces.
///
/// A surface has exactly one shape: quad, triangle, polygon, box, sphere, disc, cylinder, mesh or
/// obj. It is cut into faces in at most one way: `divide`, `u_lines` and `v_lines`, or
/// `largest_edge`. Results are reported for every face.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a surface")]
#[schemars(rename = "Surface", extend("oneOf" = [
    { "required": ["quad"] }, { "required": ["triangle"] }, { "required": ["polygon"] }, { "required": ["box"] },
    { "required": ["sphere"] }, { "required": ["disc"] }, { "required": ["cylinder"] }, { "required": ["mesh"] }, { "required": ["obj"] }
]))]
pub(crate) struct SurfaceEntry {
    /// Name of the surface. No two surfaces have the same.
    pub name: At<String>,
    /// Name of its material. Only a mesh whose faces all name a material can do without.
    pub material: Option<At<String>>,
    /// Four corners, m, counter-clockwise seen from the lit side. Lines along u cut the side from
    /// the first corner to the second, lines along v that from the first to the fourth. Corners
    /// that are not in a plane span a bilinear surface.
    pub quad: Option<At<[Triple; 4]>>,
    /// Three corners, m, counter-clockwise seen from the lit side.
    pub triangle: Option<At<[Triple; 3]>>,
    /// A flat polygon, with or without holes.
    pub polygon: Option<At<PolygonEntry>>,
    /// A box with sides along the axes.
    #[serde(rename = "box")]
    pub cuboid: Option<At<BoxEntry>>,
    /// A sphere.
    pub sphere: Option<At<SphereEntry>>,
    /// A disc.
    pub disc: Option<At<DiscEntry>>,
    /// A cylinder.
    pub cylinder: Option<At<CylinderEntry>>,
    /// Faces from a mesh file.
    pub mesh: Option<At<MeshFileEntry>>,
    /// The same under its first name.
    pub obj: Option<At<MeshFileEntry>>,
    /// Cut into [u, v] equal pieces. Triangles need u = v. Default: uncut.
    pub divide: Option<At<[At<u64>; 2]>>,
    /// Cut a quad, or every side of a box, at these parameters along u: from 0 to 1, strictly
    /// increasing, both ends included. Default, where only `v_lines` is given: [0, 1].
    pub u_lines: Option<At<Vec<At<f64>>>>,
    /// The same along v. Default, where only `u_lines` is given: [0, 1].
    pub v_lines: Option<At<Vec<At<f64>>>>,
    /// Cut into as few pieces as keep every edge at most this long, m.
    pub largest_edge: Option<At<f64>>,
    /// Cells [i, j] of a quad to leave out: i counts along u and j along v, from 0. Default: none.
    pub skip: Option<At<Vec<At<[usize; 2]>>>>,
    /// Elements that every face of this surface is computed on, a square number. Default: that of
    /// the scene.
    pub elements_per_face: Option<At<u64>>,
    /// Lit on both sides. The back is a surface of its own, called NAME/back. Default: false; but
    /// objects of a file whose faces are turned inconsistently have two sides.
    pub two_sided: Option<bool>,
    /// Material of the back of a two-sided surface. Default: that of the front.
    pub back_material: Option<At<String>>,
}

impl SurfaceEntry {
    /// The mesh file that the surface comes from, where it does.
    pub fn mesh_file(&self) -> Option<&At<MeshFileEntry>> {
        self.mesh.as_ref().or(self.obj.as_ref())
    }

    /// The shapes that are given.
    pub fn shapes(&self) -> Shapes<'_> {
        Shapes {
            name: &self.name,
            quad: self.quad.as_ref(),
            triangle: self.triangle.as_ref(),
            polygon: self.polygon.as_ref(),
            cuboid: self.cuboid.as_ref(),
            sphere: self.sphere.as_ref(),
            disc: self.disc.as_ref(),
            cylinder: self.cylinder.as_ref(),
            mesh: self.mesh.as_ref(),
            obj: self.obj.as_ref(),
        }
    }
}
