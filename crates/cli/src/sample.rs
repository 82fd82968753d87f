//! The time of an assembly, from a sample of its pairs.

use std::time::{Duration, Instant};

use fredholm_coupling::form_factor::{PairIntegrator, Workspace};

use crate::problem::Problem;
use crate::threads;

/// Pairs sampled at most, and the time they may take.
const PAIRS: u64 = 20_000;
const BUDGET: Duration = Duration::from_millis(500);
/// Fractional parts of the powers of 1/φ₂, φ₂³ = φ₂ + 1: their multiples spread evenly over the unit square.
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Seconds that the form factors will take: the mean time of a pair, times their number, over the threads.
pub(crate) fn assembly_seconds(problem: &Problem) -> f64 {
    let integrator = problem.integrator();
    let pairs = integrator.len() as f64 * (integrator.len() as f64 - 1.0) / 2.0;
    // More threads than cores take turns.
    let at_once = problem.options.threads.min(threads::default_count());
    mean_seconds(&integrator) * pairs / at_once as f64
}

fn mean_seconds(integrator: &PairIntegrator) -> f64 {
    let mut work = Workspace::default();
    let n = integrator.len() as f64;
    let started = Instant::now();
    let mut count = 0;
    while count < PAIRS && started.elapsed() < BUDGET {
        count += 1;
        let [i, j] = STEPS.map(|step| ((count as f64 * step).fract() * n) as usize);
        std::hint::black_box(integrator.exchange(i, j, &mut work));
    }
    started.elapsed().as_secs_f64() / count as f64
}
