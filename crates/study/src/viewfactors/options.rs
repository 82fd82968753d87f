//! What is asked for, and the options in force as the record has them.

use fredholm_scene::{By, Geometry};
use serde::Serialize;

use super::method::{BUDGET, Chosen};
use crate::memory::Limit;
use crate::options::{GatherPoints, Recorded, SceneSource};
use crate::size::Bytes;
use crate::{memory, threads};

const TOLERANCE: f64 = 1e-3;

/// What is asked of [`view_factors`](super::view_factors).
#[derive(Clone, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct ViewFactorOptions {
    /// Scene, or mesh file whose faces are the patches.
    pub input: SceneSource,
    /// Error asked for in a row, of `auto` in a pair. None: the input's, else 1e-3; of a method for
    /// study its usual one.
    pub tolerance: Option<f64>,
    /// How form factors are computed, one of [`view_factor_methods`](super::view_factor_methods).
    pub method: String,
    /// Setting of a method for study: its order, tolerance, samples or pixels. None: its usual one.
    pub setting: Option<String>,
    /// What a row stands for.
    pub rows: MatrixRows,
    /// Least factor that is kept; what a row drops is stated. None: all are.
    pub threshold: Option<f64>,
    /// Whether the factors are changed so that every row sums to 1; the change is stated.
    pub close: bool,
    /// Whether the sky is added as the last row and column.
    pub sky: bool,
    /// Points that see the surfaces.
    pub points: GatherPoints,
    /// Whether the page for the browser is left out.
    pub no_report: bool,
    /// Threads of the run; see [`ProblemOptions`](crate::ProblemOptions).
    pub threads: Option<u16>,
    /// Memory allowed; see [`ProblemOptions`](crate::ProblemOptions).
    pub memory: Option<Bytes>,
    /// What else the record of the run is to say.
    pub recorded: Recorded,
}

impl ViewFactorOptions {
    /// The factors between the faces of a file, to a tolerance of rows.
    pub fn new(input: impl Into<SceneSource>) -> Self {
        Self {
            input: input.into(),
            tolerance: None,
            method: BUDGET.to_owned(),
            setting: None,
            rows: MatrixRows::default(),
            threshold: None,
            close: false,
            sky: false,
            points: GatherPoints::default(),
            no_report: false,
            threads: None,
            memory: None,
            recorded: Recorded::new(),
        }
    }
}

/// What a row stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MatrixRows {
    /// An element of the mesh.
    Element,
    /// A face of the input; of a .vs3, a surface with what is combined with it.
    #[default]
    Face,
    /// A named surface.
    Surface,
}

/// All options in force.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Settings {
    pub(super) tolerance: f64,
    pub(super) method: String,
    /// Setting of a method for study, in words.
    pub(super) setting: Option<String>,
    pub(super) rows: MatrixRows,
    pub(super) threshold: Option<f64>,
    pub(super) close: bool,
    pub(super) sky: bool,
    /// Number of points, those of grids included.
    pub(super) points: usize,
    threads: usize,
    /// `None`: most of what the system has.
    memory_limit_bytes: Option<u64>,
    #[serde(flatten)]
    recorded: Recorded,
}

impl Settings {
    pub(super) fn new(asked: &ViewFactorOptions, geometry: &Geometry, method: Option<&Chosen>) -> Self {
        Self {
            tolerance: asked.tolerance.or(geometry.tolerance()).unwrap_or(TOLERANCE),
            method: asked.method.clone(),
            setting: method.map(|method| method.setting.to_string()),
            rows: asked.rows,
            threshold: asked.threshold,
            close: asked.close,
            sky: asked.sky,
            points: asked.points.count(),
            threads: threads::count(asked.threads),
            memory_limit_bytes: asked.memory.map(Bytes::as_u64),
            recorded: asked.recorded.clone(),
        }
    }

    pub(super) fn by(&self) -> By {
        match self.rows {
            MatrixRows::Element => By::Element,
            MatrixRows::Face => By::Face,
            MatrixRows::Surface => By::Surface,
        }
    }

    pub(super) fn memory_limit(&self) -> Limit {
        memory::limit(self.memory_limit_bytes.map(|bytes| Bytes(bytes.into())))
    }
}
