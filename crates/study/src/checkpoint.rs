//! The checkpoint of a run to an accuracy: one line of JSON that says how to go on, then the state
//! of the solution.

use std::fs;
use std::path::{Path, PathBuf};

use fredholm_coupling::Receiver;
use fredholm_hierarchical::State;
use fredholm_mesh::Vec3;
use fredholm_report::write_atomically;
use serde::{Deserialize, Serialize};

use crate::error::{Error, ErrorKind};
use crate::options::{FieldFile, GatherPoints, ProblemOptions, SolveOptions, SolveSettings, StopOptions};
use crate::size::Bytes;

/// Name and version of the format.
const FORMAT: &str = "fredholm-checkpoint-1";
/// The file in the folder for the results.
const FILE: &str = "checkpoint.bin";

/// What a run needs to go on besides the state.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(crate) struct Header {
    format: String,
    /// The scene file, as it was given.
    pub(crate) scene: PathBuf,
    pub(crate) scene_sha256: String,
    accuracy: String,
    /// Surfaces of the goal; none without one.
    #[serde(default)]
    pub(crate) goal: Vec<String>,
    pub(crate) solver: String,
    tolerance: String,
    pub(crate) max_iterations: u64,
    pub(crate) memory_limit_bytes: Option<u64>,
    #[serde(default)]
    pub(crate) final_gather: bool,
    #[serde(default)]
    pub(crate) discontinuity: bool,
    #[serde(default)]
    pub(crate) no_pictures: bool,
    #[serde(default)]
    pub(crate) no_report: bool,
    #[serde(default)]
    pub(crate) also: Vec<FieldFile>,
    /// Points whose irradiance is gathered, six numbers each.
    #[serde(default)]
    points: Vec<[String; 6]>,
}

impl Header {
    /// What is kept of the options of a run.
    pub(crate) fn new(scene: &fredholm_scene::Scene, options: &SolveSettings, accuracy: f64) -> Self {
        Self {
            format: FORMAT.to_owned(),
            scene: scene.path().to_owned(),
            scene_sha256: scene.sha256().to_owned(),
            // As text, which is read back to the same bits.
            accuracy: accuracy.to_string(),
            goal: options.goal.clone(),
            solver: options.problem.solver.clone(),
            tolerance: options.tolerance.to_string(),
            max_iterations: options.max_iterations,
            memory_limit_bytes: options.problem.memory_limit_bytes,
            final_gather: options.final_gather,
            discontinuity: options.discontinuity,
            no_pictures: options.no_pictures,
            no_report: options.no_report,
            also: options.also.clone(),
            points: options.points.iter().map(written).collect(),
        }
    }

    /// The points; those that cannot be read are left out.
    pub(crate) fn receivers(&self) -> Vec<Receiver> {
        let number = |text: &String| text.parse::<f64>().ok().filter(|x| x.is_finite());
        let receiver = |texts: &[String; 6]| {
            let [x, y, z, nx, ny, nz] = texts.each_ref().map(number);
            Some(Receiver { point: Vec3::new(x?, y?, z?), normal: Vec3::new(nx?, ny?, nz?) })
        };
        self.points.iter().filter_map(receiver).collect()
    }

    /// Accuracy and tolerance; none where they are no numbers between 0 and 1.
    fn numbers(&self) -> Option<[f64; 2]> {
        let number = |text: &str| text.parse().ok().filter(|&value: &f64| value > 0.0 && value < 1.0);
        Some([number(&self.accuracy)?, number(&self.tolerance)?])
    }
}

/// A point as text, which is read back to the same bits.
fn written(receiver: &Receiver) -> [String; 6] {
    let (p, n) = (receiver.point, receiver.normal);
    [p.x, p.y, p.z, n.x, n.y, n.z].map(|number| number.to_string())
}

/// The checkpoint of a run that was stopped.
pub struct Checkpoint {
    pub(crate) header: Header,
    accuracy: f64,
    tolerance: f64,
    pub(crate) state: Vec<u8>,
}

impl Checkpoint {
    /// Reads the checkpoint that a run to an accuracy has left in the folder for its results.
    ///
    /// # Errors
    /// [`ErrorKind::Files`] where there is none; [`ErrorKind::Input`] for one of another version.
    pub fn read(folder: impl AsRef<Path>) -> Result<Self, Error> {
        read(folder.as_ref())
    }

    /// The scene file of the run.
    #[must_use]
    pub fn scene(&self) -> &Path {
        &self.header.scene
    }

    /// The options of the run, without a number of threads, a folder, and what the caller recorded.
    #[must_use]
    pub fn options(&self) -> SolveOptions {
        let header = &self.header;
        SolveOptions {
            accuracy: Some(self.accuracy),
            goal: header.goal.clone(),
            final_gather: header.final_gather,
            discontinuity: header.discontinuity,
            no_pictures: header.no_pictures,
            no_report: header.no_report,
            also: header.also.clone(),
            points: GatherPoints { points: header.receivers(), grids: Vec::new() },
            problem: ProblemOptions {
                solver: Some(header.solver.clone()),
                memory: header.memory_limit_bytes.map(|bytes| Bytes(bytes.into())),
                ..ProblemOptions::default()
            },
            stop: StopOptions {
                tolerance: Some(self.tolerance),
                max_iterations: Some(u32::try_from(header.max_iterations).unwrap_or(u32::MAX)),
            },
            ..SolveOptions::default()
        }
    }
}

/// Writes the checkpoint into a folder, which is made where it does not exist. It appears whole or
/// not at all.
pub(crate) fn write(folder: &Path, header: &Header, state: &State) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|error| error.to_string())?;
    let filled = write_atomically(&folder.join(FILE), |out| {
        serde_json::to_writer(&mut *out, header)?;
        out.write_all(b"\n")?;
        state.write(out)
    });
    filled.map_err(|error| error.to_string())
}

/// Reads the checkpoint of a folder.
pub(crate) fn read(folder: &Path) -> Result<Checkpoint, Error> {
    let path = folder.join(FILE);
    let bytes = fs::read(&path).map_err(|error| {
        let help = "a run to an accuracy that was stopped after its first round leaves a checkpoint; others are \
                    solved again";
        let text = format!("cannot read {}: {error}", path.display());
        Error::new(ErrorKind::Files, text).with_help(help)
    })?;
    let broken = || {
        let text = format!("{} is no checkpoint of this version", path.display());
        Error::new(ErrorKind::Input, text).with_help("solve the scene again")
    };
    let end = bytes.iter().position(|&byte| byte == b'\n').ok_or_else(broken)?;
    let header: Header = serde_json::from_slice(&bytes[..end]).map_err(|_| broken())?;
    if header.format != FORMAT {
        return Err(broken());
    }
    let [accuracy, tolerance] = header.numbers().ok_or_else(broken)?;
    Ok(Checkpoint { header, accuracy, tolerance, state: bytes[end + 1..].to_vec() })
}

/// Removes the checkpoint of a folder, where there is one: the results are there.
pub(crate) fn remove(folder: &Path) -> Result<(), Error> {
    match fs::remove_file(folder.join(FILE)) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            let text = format!("cannot remove {}: {error}", folder.join(FILE).display());
            Err(Error::new(ErrorKind::Files, text))
        }
        _ => Ok(()),
    }
}
