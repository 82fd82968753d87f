//! Options of `judge`.

use std::path::PathBuf;

use clap::Args;
use fredholm_study::JudgeOptions;

use super::LogArgs;
use super::crosscheck::CorrectionName;
use super::paths::share;

/// What follows the help of `judge`.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm reference scenes/cornell_planar.toml -o bundle --to 0.1% --spp 16384
  fredholm judge bundle seeds.npy
  fredholm judge bundle seed_0.exr seed_1.exr seed_2.exr seed_3.exr seed_4.exr seed_5.exr
  fredholm judge bundle faces.csv -o out/judged
  fredholm judge bundle faces.csv --exact

BUNDLE is a folder of `fredholm reference`. Pictures (.npy, .exr) hold the radiance of the pixels,
rows from the top, W/(m² sr), pixels.npz of a traced run their radiosity; tables (.csv) hold the
irradiance of the faces, W/m², in the columns face and value_BAND, E_BAND or irradiance_BAND. The
error of the tracer comes from the spread of several files or of the pictures of one .npy file
(seeds × height × width × bands), or from columns sigma_BAND, E_error_BAND or standard_error_BAND
of one table.

Every pixel, every tile of 8 × 8 pixels and the picture, or every face, every surface and the whole,
is compared in every band by its z: the difference over the errors of both sides and rounding. The
verdict takes the number of places into account; a tracer that is right fails with a probability of
--significance at most. The power says which deviation would have been found nine times out of ten;
where that is no use, the exit code is 3. Exit code 6 where the two disagree.

Written are judge.csv, judge.svg, of pictures judge.png (red: the tracer is the brighter), and
judge.json last.";

/// Options of `judge`.
#[derive(Clone, Debug, Args)]
pub(crate) struct JudgeArgs {
    /// Folder that `fredholm reference` has written
    pub(crate) bundle: PathBuf,
    /// What the tracer has found: .csv, .npy, .npz or .exr; several files are independent runs
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Folder for the results [default: out/<name of the bundle>-judge]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Probability of a false alarm that is allowed
    #[arg(long, value_name = "P", default_value_t = JudgeOptions::default().significance, value_parser = share)]
    pub(crate) significance: f64,
    /// How many tests are taken into account
    #[arg(long, value_enum, value_name = "NAME", default_value_t = CorrectionName::Holm)]
    pub(crate) correction: CorrectionName,
    /// The values have no random error, as those of a deterministic program
    #[arg(long)]
    pub(crate) exact: bool,
    /// Standard deviation of rounding, relative to the value [default: 1e-5, of half precision
    /// 2^-11]
    #[arg(long, value_name = "R", value_parser = share)]
    pub(crate) rounding: Option<f64>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl JudgeArgs {
    pub(crate) fn options(&self) -> JudgeOptions {
        JudgeOptions {
            significance: self.significance,
            correction: self.correction.into(),
            exact: self.exact,
            rounding: self.rounding,
        }
    }
}
