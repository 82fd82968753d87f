//! The time of an assembly, from a sample of its pairs.

use std::time::{Duration, Instant};

use fredholm_coupling::form_factor::{PairIntegrator, Workspace};
use fredholm_coupling::sample_pairs;

use crate::problem::Problem;
use crate::threads;

/// Pairs sampled at most, and the time they may take.
const PAIRS: usize = 20_000;
const BUDGET: Duration = Duration::from_millis(500);

/// Seconds that the form factors will take: the mean time of a pair, times their number, over the
/// threads.
pub(crate) fn assembly_seconds(problem: &Problem) -> f64 {
    let integrator = problem.integrator();
    let pairs = integrator.len() as f64 * (integrator.len() as f64 - 1.0) / 2.0;
    // More threads than cores take turns.
    let at_once = problem.options.threads.min(threads::cores());
    mean_seconds(&integrator) * pairs / at_once as f64
}

fn mean_seconds(integrator: &PairIntegrator) -> f64 {
    let mut work = Workspace::default();
    let started = Instant::now();
    let mut count = 0.0;
    for [i, j] in sample_pairs(integrator.len()).take(PAIRS) {
        std::hint::black_box(integrator.exchange(i, j, &mut work));
        count += 1.0;
        if started.elapsed() > BUDGET {
            break;
        }
    }
    started.elapsed().as_secs_f64() / count
}
