//! Options, as dictionaries that the Python sources make.

use fredholm_study::{
    Bytes, GatherPoints, PathOptions, Precision, ProblemOptions, Receiver, SamplePoints, StopOptions,
    TraceStop, Vec3, Way,
};
use pyo3::prelude::*;

use crate::failure::input;

/// A number of bytes, or a text such as 4GiB.
#[derive(FromPyObject)]
enum Memory {
    Bytes(u64),
    Text(String),
}

/// What decides the size and the effort of a problem.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Problem {
    threads: Option<u16>,
    discretisation: Option<String>,
    solver: Option<String>,
    form_factor_tolerance: Option<f64>,
    storage: Option<String>,
    memory: Option<Memory>,
}

impl Problem {
    pub(crate) fn options(self, py: Python<'_>) -> PyResult<ProblemOptions> {
        let storage = self.storage.map(|name| precision(py, &name)).transpose()?;
        let memory = match self.memory {
            None => None,
            Some(Memory::Bytes(bytes)) => Some(Bytes(bytes.into())),
            Some(Memory::Text(text)) => Some(text.parse().map_err(|error| input(py, error, None))?),
        };
        let Self { threads, discretisation, solver, form_factor_tolerance, .. } = self;
        Ok(ProblemOptions { threads, discretisation, solver, form_factor_tolerance, storage, memory })
    }
}

fn precision(py: Python<'_>, name: &str) -> PyResult<Precision> {
    match name {
        "f64" => Ok(Precision::F64),
        "f32" => Ok(Precision::F32),
        _ => Err(input(py, format!("there is no number format {name:?}"), Some("use \"f64\" or \"f32\""))),
    }
}

/// The way to an accuracy of this name.
pub(crate) fn way(py: Python<'_>, name: &str) -> PyResult<Way> {
    match name {
        "links" => Ok(Way::Links),
        "rays" => Ok(Way::Rays),
        _ => Err(input(py, format!("there is no way {name:?}"), Some("use \"links\" or \"rays\""))),
    }
}

/// When a solution ends.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Stop {
    tolerance: Option<f64>,
    max_iterations: Option<u32>,
}

impl From<Stop> for StopOptions {
    fn from(stop: Stop) -> Self {
        Self { tolerance: stop.tolerance, max_iterations: stop.max_iterations }
    }
}

/// Points and their normals, each six numbers.
pub(crate) fn points(py: Python<'_>, rows: &[[f64; 6]]) -> PyResult<GatherPoints> {
    let receiver = |&[x, y, z, nx, ny, nz]: &[f64; 6]| {
        let (point, normal) = (Vec3::new(x, y, z), Vec3::new(nx, ny, nz));
        let text = "a normal has no direction";
        Receiver::new(point, normal)
            .ok_or_else(|| input(py, text, Some("give normals of any length above 0")))
    };
    let points = rows.iter().map(receiver).collect::<PyResult<Vec<Receiver>>>()?;
    Ok(GatherPoints { points, grids: Vec::new() })
}

/// How random paths are made.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Paths {
    seed: u64,
    points: String,
    batch: Option<u32>,
}

impl Paths {
    pub(crate) fn options(&self, py: Python<'_>) -> PyResult<PathOptions> {
        let points = match self.points.as_str() {
            "independent" => SamplePoints::Independent,
            "jittered" => SamplePoints::Jittered,
            "n-rooks" => SamplePoints::NRooks,
            "multi-jittered" => SamplePoints::MultiJittered,
            "sobol" => SamplePoints::Sobol,
            other => {
                let help = "use independent, jittered, n-rooks, multi-jittered or sobol";
                return Err(input(py, format!("there is no point set {other:?}"), Some(help)));
            }
        };
        Ok(PathOptions { seed: self.seed, points, batch: self.batch, ..PathOptions::default() })
    }
}

/// When tracing ends.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Tracing {
    samples: Option<u64>,
    seconds: Option<f64>,
    error: Option<f64>,
}

impl From<Tracing> for TraceStop {
    fn from(stop: Tracing) -> Self {
        Self { samples: stop.samples, seconds: stop.seconds, error: stop.error }
    }
}
