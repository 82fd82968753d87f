//! The format of scenes of waves, as it is written. Names say units and conventions; unknown keys
//! are refused.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

type At<T> = Spanned<T>;

/// A scene: a wave, its sources, surfaces and receivers. Lengths in metres.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneEntry {
    /// What the scene is called.
    pub title: Option<String>,
    pub wave: At<WaveEntry>,
    #[serde(default)]
    pub source: Vec<At<SourceEntry>>,
    /// Materials by name; `conductor` is always there.
    #[serde(default)]
    pub materials: BTreeMap<String, At<MaterialEntry>>,
    #[serde(default)]
    pub surface: Vec<At<SurfaceEntry>>,
    #[serde(default)]
    pub receiver: Vec<At<ReceiverEntry>>,
}

/// The wave and the method.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WaveEntry {
    /// At least one, Hz.
    pub frequencies_hz: At<Vec<At<f64>>>,
    /// geometric (default), radiated, exact or thesis.
    pub shadow: Option<At<String>>,
    /// Bounces to sum; default 1.
    pub bounces: Option<At<u32>>,
    /// Solver for all bounces, instead of `bounces`.
    pub solver: Option<At<String>>,
    /// Residual for the solver; default 1e-6.
    pub tolerance: Option<At<f64>>,
    /// Iterations for the solver; default 500.
    pub max_iterations: Option<u32>,
    /// Add the edge currents that physical optics lacks. Default: false.
    pub edge_currents: Option<At<bool>>,
    /// Estimate the errors by two more runs: edges twice as long, and the magnetic form. Default:
    /// false.
    #[serde(default)]
    pub estimate_errors: bool,
}

/// A source.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, tag = "kind", rename_all = "kebab-case")]
pub(super) enum SourceEntry {
    /// E = E₀ ê e^{−jk K̂·r}: travels along `travel`, or comes from the direction with these angles
    /// (θ from +z, φ from +x about z).
    PlaneWave {
        travel: Option<[f64; 3]>,
        from_theta_degrees: Option<f64>,
        from_phi_degrees: Option<f64>,
        polarisation: PolarisationEntry,
        #[serde(default = "one")]
        amplitude_v_per_m: f64,
        #[serde(default)]
        phase_degrees: f64,
    },
    /// The same |E| in all directions, away from `axis`.
    Omnidirectional { position: [f64; 3], axis: [f64; 3], power_w: f64 },
    /// A point current I l.
    HertzianDipole {
        position: [f64; 3],
        axis: [f64; 3],
        moment_a_m: f64,
        #[serde(default)]
        phase_degrees: f64,
    },
    /// A thin wire of λ/2 with this current at its centre.
    HalfWaveDipole {
        position: [f64; 3],
        axis: [f64; 3],
        current_a: f64,
        #[serde(default)]
        phase_degrees: f64,
    },
}

fn one() -> f64 {
    1.0
}

/// A vector, or "theta" or "phi" for θ̂ or φ̂ of the direction that the wave comes from.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum PolarisationEntry {
    Vector([f64; 3]),
    Name(String),
}

/// A material: exactly one of impedance, permittivity or layers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialEntry {
    /// Surface impedance [real, imaginary], Ω.
    pub impedance_ohm: Option<[f64; 2]>,
    /// Relative permittivity of a half-space.
    pub half_space: Option<DielectricEntry>,
    /// Layers from the front to the back.
    pub layers: Option<Vec<LayerEntry>>,
}

/// A dielectric: [ε′, −ε″] or a name of ITU-R P.2040.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DielectricEntry {
    pub permittivity: Option<[f64; 2]>,
    pub itu: Option<String>,
}

/// A layer of a slab.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LayerEntry {
    pub permittivity: Option<[f64; 2]>,
    pub itu: Option<String>,
    pub thickness_m: f64,
}

/// A surface: exactly one shape.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceEntry {
    pub name: String,
    /// Default: `conductor`.
    pub material: Option<At<String>>,
    /// Corners of a flat quad, counter-clockwise seen from the side of the normal.
    pub quad: Option<[[f64; 3]; 4]>,
    pub triangle: Option<[[f64; 3]; 3]>,
    #[serde(rename = "box")]
    pub cuboid: Option<BoxEntry>,
    pub sphere: Option<SphereEntry>,
    /// Longest edge: metres, or "lambda/10" of the shortest wavelength. Default: "lambda/10".
    pub edge: Option<At<EdgeEntry>>,
    /// Part of a closed body, not a thin sheet. Default: boxes and spheres are.
    pub closed: Option<bool>,
}

/// A box along the axes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoxEntry {
    pub min: [f64; 3],
    pub max: [f64; 3],
    /// The outside of the body is inside the box, as in a room.
    #[serde(default)]
    pub inward: bool,
}

/// A sphere.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SphereEntry {
    pub centre: [f64; 3],
    pub radius: f64,
}

/// A length, or a part of the wavelength.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum EdgeEntry {
    Metres(f64),
    Text(String),
}

/// A receiver: exactly one shape.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReceiverEntry {
    pub name: At<String>,
    pub points: Option<Vec<[f64; 3]>>,
    pub line: Option<LineEntry>,
    pub circle: Option<CircleEntry>,
    pub grid: Option<GridEntry>,
    pub far: Option<FarEntry>,
    /// Plane waves from these directions, and what goes back to each.
    pub monostatic: Option<FarEntry>,
}

/// Points from one to the other, both included.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LineEntry {
    pub from: [f64; 3],
    pub to: [f64; 3],
    pub points: u32,
}

/// Points on a circle about `normal`, counter-clockwise from the direction `start`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CircleEntry {
    pub centre: [f64; 3],
    pub radius: f64,
    pub normal: [f64; 3],
    pub start: [f64; 3],
    pub points: u32,
}

/// Points of a parallelogram, edges included: `columns` along u, `rows` along v.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GridEntry {
    pub corner: [f64; 3],
    pub u: [f64; 3],
    pub v: [f64; 3],
    pub columns: u32,
    pub rows: u32,
}

/// Directions: every θ (from +z) with every φ (from +x about z).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FarEntry {
    pub theta_degrees: AnglesEntry,
    pub phi_degrees: AnglesEntry,
}

/// Angles, one, listed or evenly spaced with both ends included; degrees.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum AnglesEntry {
    One(f64),
    List(Vec<f64>),
    Range { from: f64, to: f64, points: u32 },
}
