//! The time of a run to an accuracy, and how many elements and links it comes to, from its first
//! rounds.
//!
//! Elements and links grow with a power of the accuracy ε, and so do the seconds:
//!
//! ```text
//! T(ε) = T_k (e_k/ε)^p
//! ```
//!
//! after a round k that states the error e_k. Of elements and links there are whole rounds. The run
//! is begun, and ended where it takes too long; p is what its rounds grew with. Rays take (e/ε)^1.4
//! times what they took to the error e. The picture is drawn small, and takes as much more
//! as it has more pixels.

use std::ops::ControlFlow;
use std::sync::Arc;

use fredholm_linop::{Quiet, Watch};
use fredholm_report::USUAL_PIXELS;
use fredholm_scene::Scene;

use crate::hierarchical::{self, Answer, Reached};
use crate::meter::{Meter, alone, spent};
use crate::options::SolveSettings;
use crate::problem::{Problem, pixels};
use crate::rays;
use crate::solution::Solution;
use crate::solve::Solved;
use crate::stages::Stages;

/// Seconds after which a run to little accuracy, and one to that asked for, are ended.
const LOOSE_SECONDS: f64 = 3.0;
const CLOSE_SECONDS: f64 = 3.5;
/// The little accuracy.
const LOOSE_ACCURACY: f64 = 0.5;
/// Exponents of links, as far as they are to be expected, and that which is measured in the mean.
const LINK_EXPONENTS: [f64; 2] = [0.5, 1.6];
const MEAN_EXPONENT: f64 = 0.9;
/// What a round divides the error by where only one has stated it, and at least; what it multiplies
/// the sizes by at least, since the first rounds of many faces divide few of them.
const USUAL_ERROR_RATIO: f64 = 2.0;
const LEAST_ERROR_RATIO: f64 = 1.3;
const LEAST_GROWTH: f64 = 2.0;
/// Widths of the small pictures, pixels.
const PICTURE_WIDTHS: [u32; 2] = [40, 160];
/// Seconds for a value in the files, and for a pixel of the pictures of elements and of links.
const SECONDS_A_VALUE: f64 = 2e-6;
const SECONDS_A_PIXEL: f64 = 2e-6;
/// Exponent with which the time of rays grows with the accuracy.
const RAYS_EXPONENT: f64 = 1.4;

/// What a run to an accuracy is expected to come to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Expected {
    /// Seconds that it takes one thread, with its files and its picture; none where its first
    /// rounds take too long to be tried.
    pub(crate) seconds: Option<f64>,
    /// Elements and links in the end, where links answer it and a round has stated an error.
    pub(crate) sizes: Option<[usize; 2]>,
}

/// What a run to an accuracy comes to, from its beginning, by rays or by links.
pub(crate) fn expected(
    scene: &Arc<Scene>,
    options: &SolveSettings,
    (accuracy, rays): (f64, bool),
    watch: &dyn Watch,
) -> Expected {
    let found = alone(|| {
        if rays {
            return Expected { seconds: by_rays(scene, options, accuracy, watch), sizes: None };
        }
        by_links(scene, options, accuracy, watch)
    });
    found.unwrap_or_default()
}

fn by_links(scene: &Arc<Scene>, options: &SolveSettings, accuracy: f64, watch: &dyn Watch) -> Expected {
    let known = |whole: f64, solved: (Problem, Solution)| {
        let sizes = sizes(&solved);
        Expected { seconds: written(options, solved).map(|written| whole + written), sizes }
    };
    let meter = Meter::new(watch, LOOSE_SECONDS);
    let little = accuracy.max(LOOSE_ACCURACY);
    let loose = SolveSettings { accuracy: Some(little), ..options.clone() };
    let found = hierarchical::compute(scene, &loose, (little, None, None), &mut Stages::new(&meter));
    let whole = meter.seconds();
    let solved = match found {
        Ok(Answer::Solved(solved)) => *solved,
        Ok(Answer::Begun { .. }) | Err(_) => return Expected::default(),
    };
    if accuracy >= little {
        return known(whole, solved);
    }
    // What comes after the last round, beside it.
    let after =
        meter.readings().shares.last().map_or(1.0, |&[last, _]| whole / last.max(1e-3)).clamp(1.0, 2.0);
    let meter = Meter::new(watch, CLOSE_SECONDS);
    let found = hierarchical::compute(scene, options, (accuracy, None, None), &mut Stages::new(&meter));
    let whole = meter.seconds();
    match found {
        Ok(Answer::Solved(solved)) => known(whole, *solved),
        Ok(Answer::Begun { rounds }) if watch.go_on() == ControlFlow::Continue(()) => Expected {
            seconds: extrapolated(&meter.readings().shares, accuracy)
                .and_then(|rounds| Some(after * rounds + written(options, solved)?)),
            sizes: followed(&rounds, accuracy),
        },
        Ok(Answer::Begun { .. }) | Err(_) => Expected::default(),
    }
}

/// Elements and links of a solution.
fn sizes((problem, solution): &(Problem, Solution)) -> Option<[usize; 2]> {
    let links = usize::try_from(solution.hierarchy.as_ref()?.links).ok()?;
    Some([problem.mesh.len(), links])
}

/// From the elements and links of rounds to those at the accuracy: there are whole rounds only, each
/// of which divides the error, and multiplies the sizes, as the last one did.
fn followed(rounds: &[Reached], accuracy: f64) -> Option<[usize; 2]> {
    let last = rounds.last()?;
    let before = rounds.len().checked_sub(2).map(|i| rounds[i]);
    let divided = before.map_or(USUAL_ERROR_RATIO, |before| before.error / last.error);
    let more = (last.error / accuracy).max(1.0).ln() / divided.max(LEAST_ERROR_RATIO).ln();
    let of = |k: usize| {
        let grown = before.map_or(0.0, |before| last.sizes[k] as f64 / before.sizes[k].max(1) as f64);
        (last.sizes[k] as f64 * grown.max(LEAST_GROWTH).powf(more.ceil())) as usize
    };
    Some([of(0), of(1)])
}

/// From the seconds of rounds, and the shares of the digits asked for that they gained, to all.
fn extrapolated(rounds: &[[f64; 2]], accuracy: f64) -> Option<f64> {
    let digits = (1.0 / accuracy).ln();
    // Before an error is stated there are no digits.
    let known: Vec<[f64; 2]> = rounds
        .iter()
        .filter(|round| round[1] > 0.0)
        .map(|&[t, share]| [t.max(1e-3).ln(), share * digits])
        .collect();
    let last = *known.last()?;
    let n = known.len() as f64;
    let mean = [0, 1].map(|i| known.iter().map(|round| round[i]).sum::<f64>() / n);
    let moment = |i: usize| known.iter().map(|r| (r[i] - mean[i]) * (r[1] - mean[1])).sum::<f64>();
    let exponent = if known.len() > 1 && moment(1) > 0.0 { moment(0) / moment(1) } else { MEAN_EXPONENT };
    Some((last[0] + exponent.clamp(LINK_EXPONENTS[0], LINK_EXPONENTS[1]) * (digits - last[1])).exp())
}

fn by_rays(scene: &Arc<Scene>, options: &SolveSettings, accuracy: f64, watch: &dyn Watch) -> Option<f64> {
    let meter = Meter::new(watch, CLOSE_SECONDS);
    let (problem, solution) = rays::compute(scene, options, accuracy, &mut Stages::new(&meter)).ok()?;
    if watch.go_on() == ControlFlow::Break(()) {
        return None;
    }
    let reached = solution.mesh_error.as_ref()?.relative_l2.iter().copied().fold(0.0, f64::max);
    let stages = meter.readings().stages;
    let of = |traced: bool| {
        let stages = stages.iter().filter(|(stage, _)| (stage == "solution") == traced);
        stages.map(|(_, seconds)| seconds).sum::<f64>()
    };
    let more = (reached / accuracy).powf(RAYS_EXPONENT).max(1.0);
    Some(of(false) + of(true) * more + written(options, (problem, solution))?)
}

/// Seconds for the picture and the files of a solution.
fn written(options: &SolveSettings, (problem, solution): (Problem, Solution)) -> Option<f64> {
    let values = problem.mesh.len() as f64 * problem.scene.bands().len() as f64;
    let full = f64::from(problem.scene.camera().map_or(USUAL_PIXELS[0], |camera| camera.width));
    let solved = Solved { settings: options.clone(), problem, solution, stages: Stages::new(&Quiet) };
    let drawn = |width: u32| -> Option<f64> {
        let began = spent();
        solved.picture(width).ok()?;
        Some(spent() - began)
    };
    let [few, more] = [drawn(PICTURE_WIDTHS[0])?, drawn(PICTURE_WIDTHS[1])?];
    let square = |width: u32| f64::from(width).powi(2);
    let each = ((more - few) / (square(PICTURE_WIDTHS[1]) - square(PICTURE_WIDTHS[0]))).max(0.0);
    let layers = SECONDS_A_PIXEL * pixels(&solved.problem.scene) as f64;
    Some(SECONDS_A_VALUE * values + layers + few + each * (full * full - square(PICTURE_WIDTHS[0])).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_followed_in_whole_rounds() {
        let round = |error: f64, elements: usize| Reached { error, sizes: [elements, 10 * elements] };
        // Half the error with three times the elements: 10 and 5, then 2.5, 1.25 and 0.6 %.
        let rounds = [round(0.1, 1000), round(0.05, 3000)];
        assert_eq!(followed(&rounds, 0.01), Some([81_000, 810_000]));
        assert_eq!(followed(&rounds, 0.05), Some([3000, 30_000]));
        assert!(followed(&rounds[..1], 0.05).is_some_and(|[elements, _]| (2000..2200).contains(&elements)));
        assert!(followed(&[], 0.01).is_none());
    }

    #[test]
    fn rounds_are_followed_to_the_accuracy() {
        // Seconds 0.1/e: at errors of 10 and of 5 %, to 1 %.
        let share = |error: f64| error.ln() / 0.01_f64.ln();
        let rounds = [[0.5, 0.0], [1.0, share(0.1)], [2.0, share(0.05)]];
        let found = extrapolated(&rounds, 0.01).unwrap();
        assert!((found - 10.0).abs() < 1e-9, "{found}");
        assert!(extrapolated(&rounds[..1], 0.01).is_none());
        assert!(extrapolated(&rounds[..2], 0.01).is_some_and(|found| found > 5.0 && found < 10.0));
    }
}
