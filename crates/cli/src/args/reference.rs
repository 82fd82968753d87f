//! Options of `reference`.

use std::path::PathBuf;

use clap::Args;
use fredholm_study::ReferenceOptions;

use super::paths::{PathArgs, TraceStopArgs};
use super::{LogArgs, ProblemArgs};

/// What follows the help of `reference`.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm reference scenes/cornell_planar.toml -o out/reference
  fredholm reference room.toml --to 0.1% -o reference --form-factor-tolerance 1e-7
  fredholm reference room.toml --size 96x64 --spp 65536

The irradiance of every face: the deterministic solution, and what it has missed, carried by
particles. What remains are the standard error and the error of the form factors, both stated. And
the radiosity of every pixel of the camera by path tracing alone, with its standard error. Without
--size the picture is that of the scene, made smaller to 64 pixels along its longer side. Where
the scene has no camera one is chosen that takes in all of it. Other programs show the backs of
walls: an eye that would see one is moved through it.

Written are reference.csv, patches.obj, pixels.npz, report.html, the scene for Mitsuba 3 (scene.xml) and for
pbrt-v4 (scene.pbrt) and judge_mitsuba.py where its bands are colours or grey, and reference.json
last, which says what the numbers mean. `fredholm judge` judges what other tracers find. Ctrl-C
ends the run with nothing written.";

/// Options of `reference`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ReferenceArgs {
    /// Folder for the bundle [default: out/<name of the scene file>-reference]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Width and height of the picture in pixels, such as 96x64 [default: the scene's, at most 64
    /// along the longer side]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Samples of every pixel, at least [default: 1024]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 24))]
    pub(crate) spp: Option<u32>,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    #[command(flatten)]
    pub(crate) paths: PathArgs,
    #[command(flatten)]
    pub(crate) stop: TraceStopArgs,
    #[command(flatten)]
    pub(crate) problem: ProblemArgs,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl ReferenceArgs {
    pub(crate) fn options(&self) -> ReferenceOptions {
        let (paths, stop) = (self.paths.options(), self.stop.options());
        let (no_report, problem) = (self.no_report, self.problem.options());
        ReferenceOptions { size: self.size, spp: self.spp, no_report, paths, stop, problem }
    }
}

/// Width and height, such as `96x64`.
fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', '×']).map(|(width, height)| [width, height].map(|s| s.trim().parse()));
    match sides {
        Some([Ok(width), Ok(height)]) => Ok([width, height]),
        _ => Err("must be width and height in pixels, such as 96x64".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers() {
        assert_eq!((size("96x64"), size("1 × 2")), (Ok([96, 64]), Ok([1, 2])));
        for text in ["", "96", "x", "96x", "-1x2", "1x2x3"] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
