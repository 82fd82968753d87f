//! Stochastic Jacobi iteration: the unshot power of all patches is shot at once, by lines in
//! proportion to it.
//!
//! P ← R Fᵀ P: every line carries the same power φ = Σ A M/N, averaged over the bands; patch i
//! sends ⌊c_i + ξ⌋ − ⌊c_{i−1} + ξ⌋ lines, c the running sum of the unshot powers over φ and ξ one
//! random number, so that each gets its share in the mean. The lines become fewer as power is
//! absorbed, and the iteration ends where none is left: nothing is cut off. L. Neumann, Monte Carlo
//! radiosity, Computing 55 (1995) 23, doi:10.1007/BF02238235; P. Bekaert, thesis, Leuven 1999.

use super::{Batch, Estimator, Work, per_area, scale};
use crate::Enclosure;
use crate::points::{Key, PointSet, Samples};

/// Stochastic Jacobi radiosity.
#[derive(Clone, Copy, Debug, Default)]
pub struct StochasticJacobi;

/// Streams from here on hold the ξ of the iterations.
const ROUNDING_STREAMS: u32 = 1 << 31;

impl Estimator for StochasticJacobi {
    fn name(&self) -> &'static str {
        "jacobi"
    }

    fn gathers(&self) -> bool {
        false
    }

    fn patchwise(&self) -> bool {
        true
    }

    fn batch(&self, scene: &Enclosure, batch: &Batch, out: &mut [f64]) -> Work {
        let mut work = Work { paths: u64::from(batch.samples), rays: 0 };
        let mut unshot = emitted(scene);
        let total: f64 = powers(scene, &unshot).iter().sum();
        let line = total / f64::from(batch.samples);
        out.fill(0.0);
        for iteration in 0.. {
            let lines = lines(scene, batch, &unshot, line, iteration);
            let count: u32 = lines.iter().sum();
            if count == 0 {
                break;
            }
            work.rays += u64::from(count);
            let received = shoot(scene, batch, &Shot { unshot: &unshot, lines: &lines, line, iteration });
            out.iter_mut().zip(&received).for_each(|(sum, power)| *sum += power);
            unshot = reflected(scene, received);
        }
        per_area(scene, out);
        work
    }
}

/// What is shot in one iteration.
struct Shot<'a> {
    unshot: &'a [f64],
    lines: &'a [u32],
    line: f64,
    iteration: u32,
}

/// A M, W.
fn emitted(scene: &Enclosure) -> Vec<f64> {
    let power = |i: usize| scene.exitance(i).iter().map(move |m| m * scene.patches()[i].area());
    (0..scene.len()).flat_map(power).collect()
}

/// Means over the bands.
fn powers(scene: &Enclosure, unshot: &[f64]) -> Vec<f64> {
    let bands = scene.bands();
    unshot.chunks(bands).map(|row| row.iter().sum::<f64>() / bands as f64).collect()
}

/// Lines of each patch.
fn lines(scene: &Enclosure, batch: &Batch, unshot: &[f64], line: f64, iteration: u32) -> Vec<u32> {
    let key = Key { seed: batch.seed, batch: batch.number, stream: ROUNDING_STREAMS | iteration };
    let mut sum = Samples::new(PointSet::Independent, key, 1).draw(0).single();
    let mut share = |power: f64| {
        let before = sum.floor();
        sum += power / line;
        (sum.floor() - before) as u32
    };
    powers(scene, unshot).into_iter().map(&mut share).collect()
}

/// Power that each patch receives, W.
fn shoot(scene: &Enclosure, batch: &Batch, shot: &Shot<'_>) -> Vec<f64> {
    let bands = scene.bands();
    let means = powers(scene, shot.unshot);
    let mut received = vec![0.0; shot.unshot.len()];
    let size = shot.lines.iter().sum();
    let senders = shot.lines.iter().enumerate().flat_map(|(i, &count)| (0..count).map(move |_| i));
    let mut samples = batch.samples_of(shot.iteration, size);
    for (i, sample) in senders.zip(0..size) {
        let mut draw = samples.draw(sample);
        let from = scene.point(i, draw.pair());
        if let Some(to) = scene.bounce(from, draw.pair()) {
            let row = &mut received[to.patch * bands..(to.patch + 1) * bands];
            let power = &shot.unshot[i * bands..(i + 1) * bands];
            row.iter_mut().zip(power).for_each(|(sum, power)| *sum += power * shot.line / means[i]);
        }
    }
    received
}

/// What is to be shot of what was received; what is buried sends nothing, so the rest sends all.
fn reflected(scene: &Enclosure, mut received: Vec<f64>) -> Vec<f64> {
    for (i, row) in received.chunks_mut(scene.bands()).enumerate() {
        let exposed = scene.exposed(i);
        scale(row, scene.reflectance(i), if exposed > 0.0 { 1.0 / exposed } else { 0.0 });
    }
    received
}
