//! Options of `compare`.

use std::path::PathBuf;

use clap::Args;
use fredholm_study::{Bytes, CompareOptions, check_solver, reflectance_sweep};

use super::{LogArgs, Precision, tolerance};

/// What follows the help.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm compare scenes/leblond_room.toml
  fredholm compare room.toml --solvers gauss-seidel,sor:omega=1.2,cg-theta --to 1e-8
  fredholm compare room.toml --solvers gauss-seidel,cg-theta --sweep reflectance=0.1..0.99

All solvers start from x = 0 on the same matrix and stop at the same residual. Errors are
those against LU where it fits the memory. Solvers that do not suit the system, or do not
fit the memory, are listed as refused. Written are compare.csv, compare_history.csv,
compare.svg, for a sweep compare_sweep.svg, report.html, and compare.json last. Ctrl-C ends
the run with nothing written.";

/// Options of `compare`.
#[derive(Clone, Debug, Args)]
pub(crate) struct CompareArgs {
    /// Scene file (TOML)
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: out/<name of the scene file>-compare]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Solvers with their options, as `fredholm solvers` lists them, or all:
    /// gauss-seidel,sor:omega=1.2,gmres
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "all", value_parser = solver)]
    pub(crate) solvers: Vec<String>,
    /// Relative residual ‖b − A x‖₂/‖b‖₂ to reach in every band
    #[arg(long, value_name = "T", value_parser = tolerance, default_value = format!("{:e}", CompareOptions::default().tolerance))]
    pub(crate) to: f64,
    /// Iterations allowed
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), default_value_t = CompareOptions::default().max_iterations)]
    pub(crate) max_iterations: u32,
    /// Repeat with all reflectances scaled so that the largest takes these values:
    /// reflectance=0.1..0.99, or reflectance=0.1..0.9:5 for five of them
    #[arg(long, value_name = "SWEEP", value_parser = sweep)]
    pub(crate) sweep: Option<Sweep>,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Threads; any number gives the same residuals [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Error asked for in a row of form factors, rounded down to a power of ten, 1e-14 at least
    /// [default: the scene's, else 1e-3]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    pub(crate) form_factor_tolerance: Option<f64>,
    /// Number format of the stored matrix [default: the scene's, else f64]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) storage: Option<Precision>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Values of the largest reflectance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sweep(Vec<f64>);

impl CompareArgs {
    pub(crate) fn options(&self) -> CompareOptions {
        CompareOptions {
            solvers: self.solvers.clone(),
            tolerance: self.to,
            max_iterations: self.max_iterations,
            sweep: self.sweep.as_ref().map(|Sweep(values)| values.clone()),
            no_report: self.no_report,
            threads: self.threads,
            form_factor_tolerance: self.form_factor_tolerance,
            storage: self.storage.map(Into::into),
            memory: self.memory,
        }
    }
}

/// A solver that can be made.
fn solver(text: &str) -> Result<String, String> {
    if text != "all" {
        check_solver(text).map_err(|error| error.to_string())?;
    }
    Ok(text.to_owned())
}

fn sweep(text: &str) -> Result<Sweep, String> {
    let wrong =
        || "must be reflectance=LOW..HIGH or reflectance=LOW..HIGH:COUNT with 0 < LOW < HIGH < 1".to_owned();
    let range = text.strip_prefix("reflectance=").ok_or_else(wrong)?;
    let (range, count) = match range.split_once(':') {
        Some((range, count)) => (range, Some(count.parse().map_err(|_| wrong())?)),
        None => (range, None),
    };
    let (low, high) = range.split_once("..").ok_or_else(wrong)?;
    let range = low.parse().map_err(|_| wrong())?..high.parse().map_err(|_| wrong())?;
    reflectance_sweep(range, count).map(Sweep).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_are_ranges_below_one() {
        let five = reflectance_sweep(0.1..0.9, Some(5)).map(Sweep);
        assert_eq!(sweep("reflectance=0.1..0.9:5").ok(), five);
        assert_eq!(sweep("reflectance=0.1..0.99").ok(), reflectance_sweep(0.1..0.99, None).map(Sweep));
        for wrong in [
            "occlusion=0..1",
            "reflectance=0.5",
            "reflectance=0.9..0.1",
            "reflectance=0..1",
            "reflectance=0.1..0.9:1",
            "reflectance=a..b",
        ] {
            assert!(sweep(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn solvers_are_checked_before_anything_is_computed() {
        assert!(solver("all").is_ok() && solver("sor:omega=1.2").is_ok());
        assert!(solver("magic").is_err() && solver("sor:omega=3").is_err());
    }
}
