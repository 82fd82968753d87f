//! The options of a run, defaults included.

use fredholm_report::MatrixFormat;
use fredholm_scene::{By, Geometry};
use serde::Serialize;

use super::args::{Format, Plane, RowsBy, ViewFactorsArgs};
use super::method::Chosen;
use super::target::Target;
use crate::args::LogFormat;
use crate::memory::Limit;
use crate::size::Bytes;
use crate::{memory, threads};

const TOLERANCE: f64 = 1e-3;

/// All options.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Options {
    pub(super) tolerance: f64,
    pub(super) method: String,
    /// Setting of a method other than auto, in words.
    pub(super) setting: Option<String>,
    pub(super) rows: RowsBy,
    pub(super) threshold: Option<f64>,
    pub(super) close: bool,
    pub(super) sky: bool,
    /// Number of points, those of planes included.
    pub(super) points: usize,
    pub(super) format: Format,
    pub(super) output: String,
    pub(super) threads: usize,
    /// `None`: most of what the system has.
    pub(super) memory_limit_bytes: Option<u64>,
    pub(super) log: LogFormat,
    pub(super) quiet: bool,
}

impl Options {
    pub(super) fn new(
        args: &ViewFactorsArgs,
        geometry: &Geometry,
        target: &Target,
        method: Option<&Chosen>,
    ) -> Self {
        let format = match target.format {
            MatrixFormat::Npz => Format::Npz,
            MatrixFormat::Csv => Format::Csv,
            MatrixFormat::View3d => Format::View3d,
        };
        Self {
            tolerance: args.tolerance.or(geometry.tolerance()).unwrap_or(TOLERANCE),
            method: args.method.clone(),
            setting: method.map(|method| method.setting.to_string()),
            rows: args.rows,
            threshold: args.threshold,
            close: args.close,
            sky: args.sky,
            points: args.point.len() + args.plane.iter().map(Plane::count).sum::<usize>(),
            format,
            output: target.files.matrix.display().to_string(),
            threads: threads::count(args.threads),
            memory_limit_bytes: args.memory.map(|Bytes(limit)| u64::try_from(limit).unwrap_or(u64::MAX)),
            log: args.log.log,
            quiet: args.log.quiet,
        }
    }

    pub(super) fn by(&self) -> By {
        match self.rows {
            RowsBy::Element => By::Element,
            RowsBy::Face => By::Face,
            RowsBy::Surface => By::Surface,
        }
    }

    pub(super) fn memory_limit(&self) -> Limit {
        memory::limit(self.memory_limit_bytes.map(|bytes| Bytes(bytes.into())))
    }
}
