//! What can be wrong with a file of view factors.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// A file of view factors that cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ViewFactorsError {
    /// The file could not be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// File.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is no NPZ archive, or a damaged one.
    #[error("{}: not a whole NPZ archive ({why}); compute the view factors again", path.display())]
    Archive {
        /// File.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// An array is missing.
    #[error("{}: there is no array `{entry}`; compute the view factors again, or give a file that `fredholm viewfactors` wrote", path.display())]
    Missing {
        /// File.
        path: PathBuf,
        /// Name of the array.
        entry: &'static str,
    },
    /// An array is damaged or does not fit the others.
    #[error("{}: array `{entry}`, from byte {offset}: {why}; compute the view factors again", path.display())]
    Array {
        /// File.
        path: PathBuf,
        /// Name of the array.
        entry: &'static str,
        /// Where it begins in the file.
        offset: u64,
        /// What is wrong with it.
        why: String,
    },
    /// A record that is no record of view factors.
    #[error("{}: not a record of view factors ({why}); give the file that lies beside the matrix", path.display())]
    Record {
        /// File.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}
