//! What an earlier run has left for `--continue`, and whether it is the same run.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};

use fredholm_montecarlo::MonteCarloError;
use fredholm_report::{ResultFolder, TRACE_STATE};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::TraceOptions;
use crate::error::{Error, ErrorKind};
use crate::stochastic::failure;

/// What helps where it cannot be read.
const START_ANEW_HELP: &str = "without --continue the run starts anew";

/// Everything that the numbers of a run depend on, beside what its state knows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Origin {
    scene_sha256: String,
    switches: BTreeMap<String, bool>,
    /// Bounces of waves; 0 for light.
    bounces: usize,
}

impl Origin {
    pub(super) fn new(asked: &TraceOptions, scene_sha256: &str, bounces: usize) -> Self {
        let switches = [
            ("--control", asked.control),
            ("--no-roulette", asked.paths.no_roulette),
            ("--no-next-event", asked.paths.no_next_event),
            ("--no-multiple-importance", asked.paths.no_multiple_importance),
        ];
        let switches = switches.into_iter().map(|(name, on)| (name.to_owned(), on)).collect();
        Self { scene_sha256: scene_sha256.to_owned(), switches, bounces }
    }

    /// Fails where an earlier run was another one.
    fn check(&self, earlier: &Self) -> Result<(), MonteCarloError> {
        let what = if self.scene_sha256 != earlier.scene_sha256 {
            "the scene file"
        } else if self.bounces != earlier.bounces {
            "the number of bounces"
        } else if self.switches != earlier.switches {
            "one of --control, --no-roulette, --no-next-event and --no-multiple-importance"
        } else {
            return Ok(());
        };
        Err(MonteCarloError::Foreign { what })
    }

    /// The state that an earlier run of the same kind has left in a folder, where it is kept until
    /// there is a newer one.
    pub(super) fn earlier<S: DeserializeOwned>(&self, folder: &ResultFolder) -> Result<S, Error> {
        folder.keep(TRACE_STATE);
        let path = folder.path().join(TRACE_STATE);
        let text = fs::read_to_string(&path).map_err(|error| {
            Error::new(ErrorKind::Files, format!("cannot read {}: {error}", path.display()))
                .with_help(START_ANEW_HELP)
        })?;
        let saved: Saved<S> = serde_json::from_str(&text).map_err(|error| {
            let text = format!("{} is no state of such a run: {error}", path.display());
            Error::new(ErrorKind::Input, text).with_help(START_ANEW_HELP)
        })?;
        self.check(&saved.origin).map_err(failure)?;
        Ok(saved.state)
    }

    /// Writes a state so that it can be read again.
    pub(super) fn save(&self, state: &impl Serialize, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer(out, &Saved { origin: self.clone(), state }).map_err(io::Error::from)
    }
}

#[derive(Serialize, Deserialize)]
struct Saved<S> {
    origin: Origin,
    state: S,
}
