//! The checkpoint of a run to an accuracy: one line of JSON that says how to go on, then the state
//! of the solution, then the SHA-256 of each as a line of hexadecimal digits. A file of which one
//! bit is another one is refused.

use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use fredholm_coupling::Receiver;
use fredholm_hierarchical::State;
use fredholm_mesh::Vec3;
use fredholm_report::{CHECKPOINT, ResultFolder};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error as ThisError;

use crate::error::{Error, ErrorKind};
use crate::options::{
    FalseColour, FieldFile, GatherPoints, ProblemOptions, SolveOptions, SolveSettings, StopOptions,
};
use crate::size::Bytes;
use crate::solve::report_failure;

/// Name and version of the format.
const FORMAT: &str = "fredholm-checkpoint-2";
/// Hexadecimal digits of a checksum.
const CHECKSUM_DIGITS: usize = 64;
/// Bytes of the two checksums and the end of their line.
const BYTES_OF_CHECKSUMS: usize = 2 * CHECKSUM_DIGITS + 1;

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
    pub(crate) false_colour: Option<FalseColour>,
    #[serde(default)]
    pub(crate) discontinuity: bool,
    #[serde(default)]
    pub(crate) no_pictures: bool,
    #[serde(default)]
    pub(crate) no_report: bool,
    #[serde(default)]
    pub(crate) also: Vec<FieldFile>,
    /// Why links were taken and not the matrix.
    #[serde(default)]
    pub(crate) choice: Option<String>,
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
            false_colour: options.false_colour.clone(),
            discontinuity: options.discontinuity,
            no_pictures: options.no_pictures,
            no_report: options.no_report,
            also: options.also.clone(),
            choice: options.choice.clone(),
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
            false_colour: header.false_colour.clone(),
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

/// Writes the checkpoint into a folder. It appears whole or not at all.
pub(crate) fn write(folder: &ResultFolder, header: &Header, state: &State) -> Result<(), String> {
    let filled = folder.write(CHECKPOINT, |out| fill(out, header, |out| state.write(out)));
    filled.map(drop).map_err(|error| error.to_string())
}

fn fill(
    out: &mut dyn Write,
    header: &Header,
    state: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut first = Summed { out: &mut *out, sum: Sha256::new() };
    serde_json::to_writer(&mut first, header)?;
    first.write_all(b"\n")?;
    let first = digits(first.sum);
    let mut second = Summed { out: &mut *out, sum: Sha256::new() };
    state(&mut second)?;
    let second = digits(second.sum);
    writeln!(out, "{first}{second}")
}

/// What is written, and its checksum so far.
struct Summed<'a> {
    out: &'a mut dyn Write,
    sum: Sha256,
}

impl Write for Summed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.out.write(bytes)?;
        self.sum.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

fn digits(sum: Sha256) -> String {
    let digit = |half: u8| char::from_digit(u32::from(half), 16).unwrap_or('0');
    sum.finalize().iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

/// What is wrong with a checkpoint.
#[derive(Debug, PartialEq, ThisError)]
pub(crate) enum Broken {
    /// Not written by this version.
    #[error("it is no checkpoint of this version")]
    Foreign,
    /// Of another checksum than it was written with.
    #[error("its {part} (bytes {} to {}) is not what was written", bytes.start, bytes.end)]
    Damaged {
        /// Which of its parts.
        part: &'static str,
        /// Where that stands in the file.
        bytes: Range<usize>,
    },
}

/// Header and range of the state of a checkpoint.
fn parts(bytes: &[u8]) -> Result<(Header, [f64; 2], Range<usize>), Broken> {
    let end = bytes.iter().position(|&byte| byte == b'\n').ok_or(Broken::Foreign)? + 1;
    let last =
        bytes.len().checked_sub(BYTES_OF_CHECKSUMS).filter(|&last| last >= end).ok_or(Broken::Foreign)?;
    if bytes.last() != Some(&b'\n') {
        return Err(Broken::Damaged { part: "end", bytes: last..bytes.len() });
    }
    let sections = [("header", 0..end, last), ("state", end..last, last + CHECKSUM_DIGITS)];
    for (part, range, at) in sections {
        if digits(Sha256::new_with_prefix(&bytes[range.clone()])).as_bytes()
            != &bytes[at..at + CHECKSUM_DIGITS]
        {
            return Err(Broken::Damaged { part, bytes: range });
        }
    }
    let header: Header = serde_json::from_slice(&bytes[..end]).map_err(|_| Broken::Foreign)?;
    if header.format != FORMAT {
        return Err(Broken::Foreign);
    }
    let numbers = header.numbers().ok_or(Broken::Foreign)?;
    Ok((header, numbers, end..last))
}

/// Reads the checkpoint of a folder.
pub(crate) fn read(folder: &Path) -> Result<Checkpoint, Error> {
    let path = folder.join(CHECKPOINT);
    let mut bytes = fs::read(&path).map_err(|error| {
        let help = "a run to an accuracy that was stopped after its first round leaves a checkpoint; others are \
                    solved again";
        let text = format!("cannot read {}: {error}", path.display());
        Error::new(ErrorKind::Files, text).with_help(help)
    })?;
    let (header, [accuracy, tolerance], state) = parts(&bytes).map_err(|broken| {
        let text = format!("{} cannot be gone on from: {broken}", path.display());
        Error::new(ErrorKind::Input, text).with_help("solve the scene again")
    })?;
    bytes.truncate(state.end);
    bytes.drain(..state.start);
    Ok(Checkpoint { header, accuracy, tolerance, state: bytes })
}

/// Removes the checkpoint of a folder, where there is one: the results are there.
pub(crate) fn remove(folder: &ResultFolder) -> Result<(), Error> {
    folder.remove(CHECKPOINT).map_err(report_failure)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        let number = || "0.5".to_owned();
        Header {
            format: FORMAT.to_owned(),
            scene: "a.toml".into(),
            scene_sha256: String::new(),
            accuracy: number(),
            goal: Vec::new(),
            solver: "gmres".to_owned(),
            tolerance: number(),
            max_iterations: 1,
            memory_limit_bytes: None,
            final_gather: false,
            false_colour: None,
            discontinuity: false,
            no_pictures: false,
            no_report: false,
            also: Vec::new(),
            choice: Some("links".to_owned()),
            points: Vec::new(),
        }
    }

    fn sample() -> Vec<u8> {
        let mut bytes = Vec::new();
        let state: Vec<u8> = (0..2000_u32).map(|at| (at * at % 251) as u8).collect();
        fill(&mut bytes, &header(), |out| out.write_all(&state)).unwrap();
        bytes
    }

    #[test]
    fn a_checkpoint_is_read_as_it_was_written() {
        let bytes = sample();
        let (header, numbers, state) = parts(&bytes).unwrap();
        assert_eq!((header.choice.as_deref(), numbers, state.len()), (Some("links"), [0.5, 0.5], 2000));
        assert_eq!(bytes[state.start + 3], 9);
    }

    #[test]
    fn every_flipped_bit_is_noticed() {
        let mut bytes = sample();
        for bit in 0..8 * bytes.len() {
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(parts(&bytes).is_err(), "bit {bit}");
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
    }

    #[test]
    fn a_damaged_part_is_named() {
        let (mut bytes, whole) = (sample(), sample());
        let state = parts(&whole).unwrap().2;
        bytes[state.start + 5] ^= 4;
        assert_eq!(parts(&bytes).err(), Some(Broken::Damaged { part: "state", bytes: state.clone() }));
        assert!((0..whole.len()).step_by(97).all(|end| parts(&whole[..end]).is_err()), "cut short");
        let older =
            serde_json::to_vec(&Header { format: "fredholm-checkpoint-1".into(), ..header() }).unwrap();
        assert_eq!(parts(&older).err(), Some(Broken::Foreign));
    }
}
