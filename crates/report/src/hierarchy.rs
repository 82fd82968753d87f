//! What hierarchical radiosity did, in the record of a run.

use serde::{Deserialize, Serialize};

/// Rounds of refinement and what they came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Hierarchy {
    /// Relative error of the irradiance of the faces that was asked for, L2.
    pub accuracy: f64,
    /// The one that is estimated, in the worst band.
    pub stated: Option<f64>,
    /// Links of the last round, each of which serves both ways.
    pub links: u64,
    /// Whether memory ended the refinement.
    pub limited: bool,
    /// All rounds.
    pub rounds: Vec<HierarchyRound>,
}

/// A round.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HierarchyRound {
    /// Relative error that one link was allowed to leave.
    pub threshold: f64,
    /// Elements.
    pub elements: u64,
    /// Links.
    pub links: u64,
    /// Relative change of the irradiance of the faces since the round before, L2, worst band.
    pub change: Option<f64>,
}
