//! How random paths are made, and when tracing ends.

use fredholm_montecarlo::light::Switches;
use fredholm_montecarlo::points::PointSet;
use serde::Serialize;

/// How paths are made.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PathOptions {
    /// Seed of the random numbers; the same seed gives the same results for any number of threads.
    pub seed: u64,
    /// How the samples of a batch share out their random numbers.
    pub points: SamplePoints,
    /// Samples of a batch, of each element where a method gathers. None: 4, else 8 an element.
    pub batch: Option<u32>,
    /// Whether paths end when they weigh nothing, not by chance.
    pub no_roulette: bool,
    /// Whether the lamps are not sampled at every vertex.
    pub no_next_event: bool,
    /// Whether lamps that are met are not weighed against lamps that are sampled.
    pub no_multiple_importance: bool,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            points: SamplePoints::default(),
            batch: None,
            no_roulette: false,
            no_next_event: false,
            no_multiple_importance: false,
        }
    }
}

/// Point sets of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SamplePoints {
    /// No order.
    Independent,
    /// A grid, one sample a cell.
    Jittered,
    /// One sample in each row and column.
    NRooks,
    /// Both of these.
    MultiJittered,
    /// Owen-scrambled Sobol points.
    #[default]
    Sobol,
}

impl PathOptions {
    pub(crate) fn switches(&self) -> Switches {
        Switches {
            roulette: !self.no_roulette,
            next_event: !self.no_next_event,
            multiple_importance: !self.no_multiple_importance,
            ..Switches::default()
        }
    }

    /// Whether only the seed and the batch were chosen: what the sampling of fields takes.
    pub(crate) fn is_plain(&self) -> bool {
        self.points == SamplePoints::Sobol && self.switches() == Switches::default()
    }

    pub(crate) fn point_set(&self) -> PointSet {
        match self.points {
            SamplePoints::Independent => PointSet::Independent,
            SamplePoints::Jittered => PointSet::Jittered,
            SamplePoints::NRooks => PointSet::NRooks,
            SamplePoints::MultiJittered => PointSet::MultiJittered,
            SamplePoints::Sobol => PointSet::Sobol,
        }
    }
}

/// When tracing ends: at the first of what is given. Where nothing is, each study has an error of
/// its own that it goes on to.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct TraceStop {
    /// Samples in all (of each element where a method gathers), in whole batches.
    pub samples: Option<u64>,
    /// Seconds after which no further batches are begun.
    pub seconds: Option<f64>,
    /// Standard error to reach, root mean square over the faces, relative.
    #[serde(rename = "to")]
    pub error: Option<f64>,
}

impl TraceStop {
    /// Whether nothing says when tracing ends.
    pub(crate) fn is_empty(&self) -> bool {
        self.samples.is_none() && self.seconds.is_none() && self.error.is_none()
    }

    /// The same, or up to an error where nothing is said.
    pub(crate) fn or_to(self, error: f64) -> Self {
        if self.is_empty() { Self { error: Some(error), ..self } } else { self }
    }
}
