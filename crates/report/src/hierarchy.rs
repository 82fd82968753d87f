//! What hierarchical radiosity did, in the record of a run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rounds of refinement and what they came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Hierarchy {
    /// Relative error that was asked for: of the irradiance of the faces, L2, or of the mean
    /// irradiance of the goal alone, where there is one.
    pub accuracy: f64,
    /// The one that is estimated, in the worst band.
    pub stated: Option<f64>,
    /// Where the accuracy is that of some surfaces alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<HierarchyGoal>,
    /// Links of the last round, each of which serves both ways.
    pub links: u64,
    /// Whether memory ended the refinement.
    pub limited: bool,
    /// All rounds.
    pub rounds: Vec<HierarchyRound>,
}

/// The mean irradiance that an accuracy was asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct HierarchyGoal {
    /// Names of the surfaces that it is the mean over.
    pub surfaces: Vec<String>,
    /// Mean irradiance, W/m², of each band.
    pub irradiance: Vec<f64>,
    /// Its estimated relative error, of each band; empty where there is no estimate.
    pub relative_error: Vec<f64>,
}

/// A round.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct HierarchyRound {
    /// Relative error that one link was allowed to leave.
    pub threshold: f64,
    /// Elements.
    pub elements: u64,
    /// Links.
    pub links: u64,
    /// Relative change of the irradiance of the faces since the round before, L2, or of that of the
    /// goal, worst band.
    pub change: Option<f64>,
}
