//! What can go wrong when results are written or read.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A result that could not be written, read or drawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file or folder could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// File or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Another run writes to the same place.
    #[error("another run of Fredholm writes into {}; wait until it has ended, or choose another folder", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// A file stands where one of a result would be written, and no run is known to have written
    /// it.
    #[error(
        "{} would be replaced, but is not listed as the file of an earlier run; move it away, or choose another folder",
        path.display()
    )]
    Occupied {
        /// The file.
        path: PathBuf,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// File.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A vector does not have a value for every element and band.
    #[error("{what} has {found} values, but {expected} are needed: one for each leaf element and band")]
    Length {
        /// Name of the vector.
        what: &'static str,
        /// Leaf elements × bands.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A value is NaN or infinite.
    #[error(
        "{what} of element {element} in band {band} is {value}, not a finite number; the solution is unusable"
    )]
    NotFinite {
        /// Name of the vector.
        what: &'static str,
        /// Leaf element.
        element: usize,
        /// Name of the band.
        band: String,
        /// The value.
        value: f64,
    },
    /// A camera that sees nothing.
    #[error("the camera cannot be used: {why}")]
    Camera {
        /// What is wrong and how to mend it.
        why: String,
    },
    /// An exposure that is not a positive number.
    #[error("exposure is {value}; give a finite number above 0, or leave it out to have it chosen")]
    Exposure {
        /// The value given.
        value: f64,
    },
    /// The patches could not be prepared for ray casting.
    #[error("the surfaces cannot be drawn: {why}")]
    Visibility {
        /// What is wrong.
        why: String,
    },
    /// A drawing that the plotting library could not make.
    #[error("the picture cannot be drawn: {why}")]
    Drawing {
        /// What the library said.
        why: String,
    },
    /// A run record that is cut short or damaged.
    #[error("{}: the run record is cut short or damaged ({why}); solve the scene again", path.display())]
    BrokenRun {
        /// File.
        path: PathBuf,
        /// What the parser said, with line and column where there is one.
        why: String,
    },
    /// A JSON file that is not a run record of this format.
    #[error(
        "{} is not a run record: its \"format\" is {found}, not \"{expected}\"; give the run.json of a result folder",
        path.display()
    )]
    ForeignRun {
        /// File.
        path: PathBuf,
        /// Format found, as JSON, or `missing`.
        found: String,
        /// Format that this version reads.
        expected: &'static str,
    },
    /// A file of values that cannot be used.
    #[error("{}: {what}\n  help: {help}", place(path, *line))]
    Values {
        /// File.
        path: PathBuf,
        /// Line, from 1, where there is one.
        line: Option<usize>,
        /// What is wrong.
        what: String,
        /// How to mend it.
        help: String,
    },
}

/// A file, and a line of it.
fn place(path: &Path, line: Option<usize>) -> String {
    line.map_or_else(|| path.display().to_string(), |line| format!("{}:{line}", path.display()))
}
