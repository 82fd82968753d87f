//! Options of random paths.

use clap::{Args, ValueEnum};
use fredholm_study::{PathOptions, SamplePoints, TraceStop};

/// How paths are made.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct PathArgs {
    /// Seed of the random numbers; the same seed gives the same results for any number of threads
    #[arg(long, value_name = "N", default_value_t = PathOptions::default().seed)]
    pub(crate) seed: u64,
    /// How the samples of a batch share out their random numbers
    #[arg(long, value_enum, value_name = "SET", default_value_t = Points::Sobol)]
    pub(crate) points: Points,
    /// Samples of a batch, of each element where a method gathers [default: 4 to 32, else 8 an element]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub(crate) batch: Option<u32>,
    /// Let paths end when they weigh nothing, not by chance
    #[arg(long)]
    pub(crate) no_roulette: bool,
    /// Do not sample the lamps at every vertex
    #[arg(long)]
    pub(crate) no_next_event: bool,
    /// Do not weigh lamps that are met against lamps that are sampled
    #[arg(long)]
    pub(crate) no_multiple_importance: bool,
}

/// Point sets, as the command line names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Points {
    /// No order
    Independent,
    /// A grid, one sample a cell
    Jittered,
    /// One sample in each row and column
    NRooks,
    /// Both of these
    MultiJittered,
    /// Owen-scrambled Sobol points
    Sobol,
}

impl PathArgs {
    pub(crate) fn options(self) -> PathOptions {
        PathOptions {
            seed: self.seed,
            points: self.points.into(),
            batch: self.batch,
            no_roulette: self.no_roulette,
            no_next_event: self.no_next_event,
            no_multiple_importance: self.no_multiple_importance,
        }
    }
}

impl From<Points> for SamplePoints {
    fn from(points: Points) -> Self {
        match points {
            Points::Independent => Self::Independent,
            Points::Jittered => Self::Jittered,
            Points::NRooks => Self::NRooks,
            Points::MultiJittered => Self::MultiJittered,
            Points::Sobol => Self::Sobol,
        }
    }
}

/// When tracing ends.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct TraceStopArgs {
    /// Samples in all (of each element where a method gathers), in whole batches
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) samples: Option<u64>,
    /// Seconds after which no further batches are begun
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub(crate) seconds: Option<f64>,
    /// Standard error to reach, in L2 over the faces, such as 1% or 0.01
    #[arg(long, value_name = "E", value_parser = share)]
    pub(crate) to: Option<f64>,
}

impl TraceStopArgs {
    pub(crate) fn options(self) -> TraceStop {
        TraceStop { samples: self.samples, seconds: self.seconds, error: self.to }
    }
}

/// A share above 0 and below 1, as a number or in percent.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let value = text.strip_suffix('%').map_or_else(|| number(text), |text| number(text).map(|x| x / 100.0));
    value
        .filter(|&x| x > 0.0 && x < 1.0)
        .ok_or_else(|| "must be above 0 and below 1, such as 0.01 or 1%".to_owned())
}

fn seconds(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|&x| x > 0.0 && x.is_finite());
    value.ok_or_else(|| "must be a number of seconds above 0".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_numbers_or_percentages() {
        assert_eq!(share("1%"), Ok(0.01));
        assert_eq!(share("0.5 %"), Ok(0.005));
        assert_eq!(share("0.02"), Ok(0.02));
        for text in ["0", "0%", "100%", "1", "-1%", "nan", "%", "x"] {
            assert!(share(text).is_err(), "{text}");
        }
        assert!(seconds("0").is_err() && seconds("inf").is_err() && seconds("2.5") == Ok(2.5));
    }
}
