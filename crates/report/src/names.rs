//! Names that the files of results have.

use crate::comparison::{COMPARISON_FILES, SWEEP_PLOT};
use crate::judgement::JUDGE_FILES;
use crate::outputs::{RUN, output_files};
use crate::refinement::REFINEMENT_FILES;
use crate::shooting::SHOOTING_FILES;
use crate::spectrum::SPECTRUM_FILES;
use crate::stochastic::{CROSSCHECK_FILES, REFERENCE_FILES};
use crate::waves::METHODS_FILES;

/// Tables, arrays and plots of a result of waves, beside those of single receivers.
pub const WAVE_FILES: [&str; 9] = [
    "receivers.csv",
    "receivers.npz",
    "far.csv",
    "far.npz",
    "monostatic.csv",
    "monostatic.npz",
    "currents.vtu",
    "residuals.csv",
    "residuals.svg",
];

/// The state of a run to an accuracy that was stopped.
pub const CHECKPOINT: &str = "checkpoint.bin";
/// The state of a traced run, from which it can go on.
pub const TRACE_STATE: &str = "trace.json";
/// The pixels of a traced picture as arrays.
pub const PIXELS: &str = "pixels.npz";

/// The files of a study, by kind; the last is its record.
const STUDIES: [&[&str]; 8] = [
    &COMPARISON_FILES,
    &REFINEMENT_FILES,
    &SPECTRUM_FILES,
    &SHOOTING_FILES,
    &CROSSCHECK_FILES,
    &REFERENCE_FILES,
    &JUDGE_FILES,
    &METHODS_FILES,
];

/// The names of the records of all kinds of folders; a folder has one of them.
pub fn records() -> impl Iterator<Item = &'static str> {
    std::iter::once(RUN).chain(STUDIES.iter().filter_map(|files| files.last().copied()))
}

/// Whether a name is one of a file that some run writes into its folder, whatever the scene.
#[must_use]
pub fn is_result(name: &str) -> bool {
    let shot = name.strip_prefix("shot_").and_then(|rest| rest.strip_suffix(".png"));
    output_files().any(|file| file.name() == name)
        || STUDIES.iter().any(|names| names.contains(&name))
        || WAVE_FILES.contains(&name)
        || [SWEEP_PLOT, CHECKPOINT, TRACE_STATE].contains(&name)
        || shot.is_some_and(|number| number.len() >= 5 && number.bytes().all(|digit| digit.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_known_by_their_names() {
        for name in ["run.json", "links.png", "compare_sweep.svg", "shot_00100.png", "far.npz"] {
            assert!(is_result(name), "{name}");
        }
        for name in ["scene.toml", "shot_.png", "shot_abcde.png", "notes.csv", "check.png"] {
            assert!(!is_result(name), "{name}");
        }
    }
}
