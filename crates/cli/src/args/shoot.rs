//! Options of `shoot`.

use std::path::PathBuf;

use clap::Args;
use fredholm_study::{Bytes, ShootOptions};

use super::{LogArgs, tolerance};

/// What follows the help.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm shoot scenes/leblond_room_fine.toml
  fredholm shoot hall.toml --share 99% --pictures 1,10,100,1000 -o hall
  fredholm shoot hall.toml --keep 1GiB

No matrix is stored: a shot computes the form factors from one element, or from a rectangle of
elements that reflect alike, to all others. Written are pictures on the way (with the ambient
term), faces.csv, field.npz, field.vtu, image.png, report.html, shots.csv, shots.svg, and
shots.json last. After Ctrl-C the field so far is written.";

/// Options of `shoot`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShootArgs {
    /// Scene file (.toml), or mesh file that stands for a scene (.obj, .vs3)
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: out/<name of the scene file>-shoot]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Share of the power of the solution to distribute, such as 90% or 0.9
    #[arg(long, value_name = "SHARE", value_parser = share, default_value = percent(ShootOptions::default().share))]
    pub(crate) share: f64,
    /// Shots allowed
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), default_value_t = ShootOptions::default().max_shots)]
    pub(crate) max_shots: u32,
    /// Numbers of shots after which to write a picture
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = listed(&ShootOptions::default().pictures))]
    pub(crate) pictures: Vec<u64>,
    /// Draw no picture, neither on the way nor at the end
    #[arg(long, conflicts_with = "pictures")]
    pub(crate) no_pictures: bool,
    /// Write no report.html
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Memory for columns that are kept for the next shot from there
    #[arg(long, value_name = "LIMIT", default_value = mebibytes(ShootOptions::default().keep))]
    pub(crate) keep: Bytes,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Error asked for in a row of form factors, rounded down to a power of ten, 1e-14 at least
    /// [default: the scene's, else 1e-3]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    pub(crate) form_factor_tolerance: Option<f64>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl ShootArgs {
    pub(crate) fn options(&self) -> ShootOptions {
        ShootOptions {
            share: self.share,
            max_shots: self.max_shots,
            pictures: self.pictures.clone(),
            no_pictures: self.no_pictures,
            no_report: self.no_report,
            keep: self.keep,
            threads: self.threads,
            form_factor_tolerance: self.form_factor_tolerance,
            memory: self.memory,
        }
    }
}

/// A share as it is asked for.
fn percent(share: f64) -> String {
    format!("{}%", 100.0 * share)
}

/// Numbers as they are asked for.
fn listed(numbers: &[u64]) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

/// A memory as it is asked for.
fn mebibytes(Bytes(bytes): Bytes) -> String {
    format!("{}MiB", bytes >> 20)
}

fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 100.0));
    tolerance(&number.trim().parse::<f64>().map_or_else(|_| number.to_owned(), |x| (x / unit).to_string()))
        .map_err(|_| "must be a share between 0 and 1, such as 90% or 0.9".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_percentages_or_fractions() {
        assert_eq!((share("90%"), share("0.25")), (Ok(0.9), Ok(0.25)));
        for wrong in ["0", "100%", "-5%", "nan", "x%"] {
            assert!(share(wrong).is_err(), "{wrong}");
        }
    }
}
