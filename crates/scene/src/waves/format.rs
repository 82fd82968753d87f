//! The format of scenes of waves, as it is written: types that mirror the file and know where each
//! value stands.
//!
//! The documentation of these types is the documentation of the format: it becomes the JSON Schema.
//! Whether the values make sense is decided in the other files of this folder.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::choices::{AnglesEntry, EdgeEntry, FrequenciesEntry, PolarisationEntry, ResistanceEntry};
use super::settings::{Method, Shadows};
use crate::format::{
    At, BoxEntry, CylinderEntry, DiscEntry, MeshFileEntry, PolygonEntry, Shapes, SphereEntry, Triple,
};

/// A scene of waves: a wave, its sources, surfaces and receivers.
///
/// Lengths are in metres, angles in degrees (their names say so), fields in V/m and A/m (peak
/// values). The normal of a face is on the side from which its corners run counter-clockwise. Keys
/// that are not listed here are refused.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a scene of waves")]
#[schemars(title = "Fredholm scene of waves", rename = "WaveScene")]
pub(crate) struct SceneEntry {
    /// What the scene is called. Default: no title.
    pub title: Option<String>,
    /// The wave and the method.
    pub wave: At<WaveEntry>,
    /// What sends waves: at least one source, unless all receivers are monostatic.
    #[serde(default)]
    pub source: Vec<At<SourceEntry>>,
    /// Materials by name; `conductor`, a perfect one, is always there.
    #[serde(default)]
    pub materials: BTreeMap<At<String>, At<MaterialEntry>>,
    /// The surfaces, at least one.
    #[serde(default)]
    pub surface: Vec<At<SurfaceEntry>>,
    /// Where fields are asked for, at least one receiver.
    #[serde(default)]
    pub receiver: Vec<At<ReceiverEntry>>,
}

/// The wave and the method.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of the wave")]
#[schemars(rename = "Wave")]
pub(crate) struct WaveEntry {
    /// Frequencies, Hz: a list, or a table { from, to, points, spacing } of a sweep.
    pub frequencies_hz: At<FrequenciesEntry>,
    /// How the currents are found. Default: chosen by the program.
    pub method: Option<At<Method>>,
    /// Order of the functions of boundary elements: 0, those of Rao, Wilton and Glisson, or 1,
    /// those of the first full order, which are more exact on meshes that are half as fine;
    /// spheres, cylinders and discs are then curved. Default: 0.
    pub order: Option<At<u32>>,
    /// What of physical optics blocks waves. Default: chosen by the program.
    pub shadows: Option<At<Shadows>>,
    /// Bounces to sum, at least 1. Default: 1.
    pub bounces: Option<At<u32>>,
    /// Solver for all bounces, instead of `bounces`, by its name with options, such as
    /// "gmres:restart=100".
    pub solver: Option<At<String>>,
    /// Relative residual for the solver, above 0 and below 1. Default: 1e-6.
    pub tolerance: Option<At<f64>>,
    /// Iterations for the solver, at least 1. Default: 500.
    pub max_iterations: Option<At<u32>>,
    /// Add the edge currents that physical optics lacks. Default: false.
    pub edge_currents: Option<At<bool>>,
    /// Estimate the errors by further runs. Default: false.
    #[serde(default)]
    pub estimate_errors: bool,
    /// Relative error up to which frequencies may be interpolated between computed ones, above 0
    /// and below 1. Default: all frequencies are computed.
    pub sweep_accuracy: Option<At<f64>>,
    /// A perfectly conducting plane without end under everything. Default: free space.
    pub ground: Option<At<GroundEntry>>,
}

/// A perfectly conducting plane z = height, above which everything is.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of the ground")]
#[schemars(rename = "Ground")]
pub(crate) struct GroundEntry {
    /// z of the plane, m.
    pub height_m: f64,
}

/// A source.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, tag = "kind", rename_all = "kebab-case")]
#[schemars(rename = "Source")]
pub(crate) enum SourceEntry {
    /// E = E₀ ê e^{−jk K̂·r}: travels along `travel`, or comes from the direction with these angles
    /// (θ from +z, φ from +x about z).
    PlaneWave {
        /// Direction of travel, of any length.
        travel: Option<[f64; 3]>,
        /// θ of the direction that it comes from, degrees.
        from_theta_degrees: Option<f64>,
        /// φ of the direction that it comes from, degrees.
        from_phi_degrees: Option<f64>,
        /// Direction of E: a vector, or "theta" or "phi" for θ̂ or φ̂ of the direction that the
        /// wave comes from.
        polarisation: PolarisationEntry,
        /// Peak value of E, V/m. Default: 1.
        #[serde(default = "one")]
        amplitude_v_per_m: f64,
        /// Phase at the origin, degrees. Default: 0.
        #[serde(default)]
        phase_degrees: f64,
    },
    /// The same |E| in all directions, polarised away from `axis`.
    Omnidirectional {
        /// Where it stands, m.
        position: [f64; 3],
        /// Direction of its axis, of any length.
        axis: [f64; 3],
        /// Power that it radiates, W.
        power_w: f64,
    },
    /// A point current I l.
    HertzianDipole {
        /// Where it stands, m.
        position: [f64; 3],
        /// Direction of the current, of any length.
        axis: [f64; 3],
        /// Current times length, A m.
        moment_a_m: f64,
        /// Phase, degrees. Default: 0.
        #[serde(default)]
        phase_degrees: f64,
    },
    /// A thin wire of λ/2 with this current at its centre.
    HalfWaveDipole {
        /// Its centre, m.
        position: [f64; 3],
        /// Direction of the wire, of any length.
        axis: [f64; 3],
        /// Peak current at its centre, A.
        current_a: f64,
        /// Phase, degrees. Default: 0.
        #[serde(default)]
        phase_degrees: f64,
    },
}

fn one() -> f64 {
    1.0
}

/// A material: exactly one of impedance, conductivity, half-space, layers or sheet.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a material")]
#[schemars(rename = "WaveMaterial")]
pub(crate) struct MaterialEntry {
    /// Surface impedance [real, imaginary], Ω.
    pub impedance_ohm: Option<[f64; 2]>,
    /// Conductivity of a good conductor, S/m: its surface impedance is (1 + j) √(ωμ₀/2σ).
    pub conductivity_s_per_m: Option<f64>,
    /// A dielectric that fills everything behind the surface.
    pub half_space: Option<DielectricEntry>,
    /// Layers from the front to the back.
    pub layers: Option<Vec<LayerEntry>>,
    /// A sheet without thickness: E along it is its impedance times the current that it carries,
    /// and the same on both sides.
    pub sheet: Option<FilmEntry>,
}

/// A thin sheet: exactly one of resistance, permittivity and itu, the last two with a thickness.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a sheet")]
#[schemars(rename = "ThinSheet")]
pub(crate) struct FilmEntry {
    /// Sheet impedance, Ω: a resistance, or [real, imaginary].
    pub resistance_ohm: Option<ResistanceEntry>,
    /// Relative permittivity [ε′, −ε″] of a thin layer.
    pub permittivity: Option<[f64; 2]>,
    /// Name of a material of Recommendation ITU-R P.2040, such as "glass", of a thin layer.
    pub itu: Option<String>,
    /// Thickness of the layer, m.
    pub thickness_m: Option<f64>,
}

/// A dielectric: exactly one of permittivity and itu.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a dielectric")]
#[schemars(rename = "Dielectric")]
pub(crate) struct DielectricEntry {
    /// Relative permittivity [ε′, −ε″].
    pub permittivity: Option<[f64; 2]>,
    /// Name of a material of Recommendation ITU-R P.2040, such as "concrete".
    pub itu: Option<String>,
}

/// A layer of a slab: exactly one of permittivity and itu.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a layer")]
#[schemars(rename = "Layer")]
pub(crate) struct LayerEntry {
    /// Relative permittivity [ε′, −ε″].
    pub permittivity: Option<[f64; 2]>,
    /// Name of a material of Recommendation ITU-R P.2040, such as "glass".
    pub itu: Option<String>,
    /// Thickness, m.
    pub thickness_m: f64,
}

/// A named surface: one shape, made of one material, cut into facets.
///
/// A surface has exactly one shape: quad, triangle, polygon, box, sphere, disc, cylinder or mesh.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a surface")]
#[schemars(rename = "WaveSurface", extend("oneOf" = [
    { "required": ["quad"] }, { "required": ["triangle"] }, { "required": ["polygon"] }, { "required": ["box"] },
    { "required": ["sphere"] }, { "required": ["disc"] }, { "required": ["cylinder"] }, { "required": ["mesh"] }
]))]
pub(crate) struct SurfaceEntry {
    /// Name of the surface. No two surfaces have the same.
    pub name: At<String>,
    /// Name of its material. Default: `conductor`; faces of a file may name others.
    pub material: Option<At<String>>,
    /// Four corners, m, counter-clockwise seen from the side of the normal.
    pub quad: Option<At<[Triple; 4]>>,
    /// Three corners, m, counter-clockwise seen from the side of the normal.
    pub triangle: Option<At<[Triple; 3]>>,
    /// A flat polygon, with or without holes.
    pub polygon: Option<At<PolygonEntry>>,
    /// A box with sides along the axes; `inward`: the body is around the room inside.
    #[serde(rename = "box")]
    pub cuboid: Option<At<BoxEntry>>,
    /// A sphere. Default of its segments: as many as `edge` asks for.
    pub sphere: Option<At<SphereEntry>>,
    /// A disc. Default of its segments: as many as `edge` asks for.
    pub disc: Option<At<DiscEntry>>,
    /// A cylinder. Default of its segments: as many as `edge` asks for.
    pub cylinder: Option<At<CylinderEntry>>,
    /// Faces from a mesh file. Materials of its libraries say nothing of waves: faces are of the
    /// surface's material, unless the scene has one of the name that they give.
    pub mesh: Option<At<MeshFileEntry>>,
    /// Longest edge of a facet: metres, or a part such as "lambda/10" of the shortest wavelength.
    /// Default: "lambda/10"; a single flat plate or box seen from far away in one bounce of plane
    /// waves is left whole.
    pub edge: Option<At<EdgeEntry>>,
    /// Part of a closed body, not a thin sheet. Default: boxes, spheres and cylinders with caps
    /// are, and the objects of a file that are closed.
    pub closed: Option<At<bool>>,
}

impl SurfaceEntry {
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
            obj: None,
        }
    }
}

/// A receiver: exactly one of points, line, circle, grid, far and monostatic.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a receiver")]
#[schemars(rename = "Receiver", extend("oneOf" = [
    { "required": ["points"] }, { "required": ["line"] }, { "required": ["circle"] }, { "required": ["grid"] },
    { "required": ["far"] }, { "required": ["monostatic"] }
]))]
pub(crate) struct ReceiverEntry {
    /// Name of the receiver, of letters, digits, - and _. No two receivers have the same.
    pub name: At<String>,
    /// Points, m.
    pub points: Option<At<Vec<[f64; 3]>>>,
    /// Points along a line.
    pub line: Option<At<LineEntry>>,
    /// Points around a circle; a polar plot is drawn of them.
    pub circle: Option<At<CircleEntry>>,
    /// Points of a parallelogram; pictures are drawn of them.
    pub grid: Option<At<GridEntry>>,
    /// Directions of the far field.
    pub far: Option<At<FarEntry>>,
    /// Directions that plane waves of both polarisations come from, and what goes back to each; no
    /// source is needed.
    pub monostatic: Option<At<FarEntry>>,
}

/// Points from one to the other, both included.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a line")]
#[schemars(rename = "Line")]
pub(crate) struct LineEntry {
    /// First point, m.
    pub from: [f64; 3],
    /// Last point, m.
    pub to: [f64; 3],
    /// How many.
    pub points: u32,
}

/// Points on a circle about `normal`, counter-clockwise from the direction `start`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a circle")]
#[schemars(rename = "Circle")]
pub(crate) struct CircleEntry {
    /// Centre, m.
    pub centre: [f64; 3],
    /// Radius, m, above 0.
    pub radius: f64,
    /// Direction of the axis, of any length.
    pub normal: [f64; 3],
    /// Direction from the centre to the first point; what of it is along the normal does not count.
    pub start: [f64; 3],
    /// How many.
    pub points: u32,
}

/// Points of a parallelogram, edges included: `columns` along u, `rows` along v.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a grid")]
#[schemars(rename = "Grid")]
pub(crate) struct GridEntry {
    /// First point, m.
    pub corner: [f64; 3],
    /// From the first to the last point of a row, m.
    pub u: [f64; 3],
    /// From the first to the last point of a column, m.
    pub v: [f64; 3],
    /// Points in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
}

/// Directions: every θ (from +z) with every φ (from +x about z).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of directions")]
#[schemars(rename = "Far")]
pub(crate) struct FarEntry {
    /// θ, degrees: a number, a list, or a table { from, to, points } with both ends included.
    pub theta_degrees: AnglesEntry,
    /// φ, degrees: a number, a list, or a table { from, to, points } with both ends included.
    pub phi_degrees: AnglesEntry,
}
