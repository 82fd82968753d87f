//! Shooting what a known solution has missed.
//!
//! With known irradiances Ẽ of patches, the irradiance at a point y is Ẽ + e(y), and
//!
//! ```text
//! e(y) = r(y) + (K ρ e)(y),   r(y) = D(y) + (K ρ Ẽ)(y) − Ẽ
//! ```
//!
//! where D comes from lamps directly. So every point y sends out what it misses as a lamp sends its
//! light: particles leave it with the power ρ r(y), of either sign, are reflected where they arrive,
//! and leave their power there; E_i is Ẽ_i and what arrives over A_i. Where Ẽ is the mean of D + K ρ Ẽ
//! over its patch, as a solution makes it, r has the mean 0: it is the estimate at a point less the
//! mean of those at other points of the patch, by the same lamps and directions, so that what they
//! have in common, which is most of the noise, is gone. The result is then as exact as the form
//! factors behind Ẽ. Of patches on which another one lies that mean is not known, since it depends on
//! how much of them is covered, to the last digit: there r is the estimate less Ẽ, and E_i the mean of
//! the estimates and what arrives.
//!
//! The estimate at a point takes half of the rays that leave it and is sent along the other half, so
//! that the two are independent. Patches get points in proportion to the noise that they make, as a
//! trial finds it. The residual as a source: J. H. Halton, SIAM Rev. 12, 1970,
//! doi:10.1137/1012001; particles as in [`ParticleTracing`].
//!
//! [`ParticleTracing`]: super::ParticleTracing

use super::path::{Control, Numbers, PathTracing, Weight};
use super::{Batch, Estimator, Switches, Work, per_area, scale};
use crate::points::{Draw, PointSet, Samples};
use crate::{Enclosure, Groups, Site};
use fredholm_linop::Watch;
use rayon::prelude::*;
use std::sync::Arc;

/// Sets of points of a patch, the one to be compared with the other, and halves of the rays of each
/// point.
const SETS: usize = 2;
const HALVES: usize = 2;
/// Rays of a half of a point.
const RAYS: u32 = 2;
/// Points of a set for each patch in the trial, batches of it, and what keeps their random numbers
/// apart from those of a run.
const TRIAL_POINTS: u32 = 2;
const TRIAL_BATCHES: u32 = 4;
const TRIAL_SEED: u64 = 0x5bd1_e995_0000_0000;
/// Share of the points that are shared out evenly, since a trial may miss what varies.
const EVEN: f64 = 0.25;
/// Most points of a set: what their rays find is held at once.
const MOST_POINTS: f64 = 4096.0;

/// Particles that carry what a solution has missed. They are reflected as often as it may be, since
/// the solution has all reflections.
pub struct ResidualShooting {
    switches: Switches,
    paths: PathTracing,
    control: Arc<Control>,
    /// Points of a set of each patch over the mean of all.
    shares: Vec<f64>,
}

/// Points of one patch and the rays that leave them, as many of each half and point.
struct Rays<'a> {
    scene: &'a Enclosure,
    /// One set after the other.
    points: Vec<Site>,
    halves: [Samples; HALVES],
    /// Whether all points have the same directions and lamps, so that what they have in common may
    /// be taken away; else the directions of all are spread together.
    is_paired: bool,
    /// What each ray has met, and its factor: of every half, number and point.
    met: Vec<Option<(Site, f64)>>,
    /// What each half finds at every point, W/m², a row for each half and point.
    found: Vec<f64>,
    /// Rays and segments that were traced.
    traced: u64,
}

impl ResidualShooting {
    /// Shoots what these irradiances have missed, with as many points of every patch.
    #[must_use]
    pub fn new(scene: &Enclosure, control: Control, switches: Switches) -> Self {
        let control = Arc::new(control);
        let paths = PathTracing::continuous(switches).with_control(Arc::clone(&control));
        Self { switches, paths, control, shares: vec![1.0; scene.len()] }
    }

    /// The same with the points shared out by what a trial finds, so that the error of the means of
    /// groups in L² is about the least; evenly where the watch breaks it off. What is sent counts as
    /// if it arrived on a mean group.
    #[must_use]
    pub fn shared_out(
        self,
        scene: &Enclosure,
        groups: &Groups,
        (seed, points): (u64, PointSet),
        watch: &dyn Watch,
    ) -> Self {
        let bands = scene.bands();
        let trial = |number: u32| {
            let batch = Batch { seed: seed ^ TRIAL_SEED, number, samples: 0, points };
            let square = |patch: usize| {
                if watch.go_on().is_break() {
                    return None;
                }
                let rays = self.rays(scene, &batch, (patch, TRIAL_POINTS));
                let (known, rho) = (self.known(scene, patch), scene.reflectance(patch));
                let of = |missed: &[f64], rho: &dyn Fn(usize) -> f64| {
                    missed.iter().enumerate().map(|(k, e)| (rho(k % bands) * e).powi(2)).sum::<f64>()
                };
                let sent = of(&rays.missed(known), &|band| rho[band]);
                let own = known.map_or(0.0, |_| of(&rays.missed(None), &|_| 1.0));
                Some(sent / groups.mean_area() + own / groups.area_of(patch))
            };
            (0..scene.len()).into_par_iter().map(square).collect()
        };
        let Some(found): Option<Vec<Vec<f64>>> = (0..TRIAL_BATCHES).map(trial).collect() else {
            return self;
        };
        let noise: Vec<f64> = (0..scene.len())
            .map(|patch| {
                let square = found.iter().map(|of_batch| of_batch[patch]).sum::<f64>();
                scene.patches()[patch].area() * square.sqrt()
            })
            .collect();
        let mean = noise.iter().sum::<f64>() / noise.len() as f64;
        let share = |noise: f64| if mean > 0.0 { EVEN + (1.0 - EVEN) * noise / mean } else { 1.0 };
        Self { shares: noise.into_iter().map(share).collect(), ..self }
    }

    /// Points of a set of a patch in a batch.
    fn size(&self, batch: &Batch, patch: usize) -> u32 {
        let mean = f64::from(batch.samples) / (f64::from(RAYS) * (SETS * HALVES) as f64);
        1 << (mean * self.shares[patch]).clamp(1.0, MOST_POINTS).log2().round() as u32
    }

    /// What r is compared with where the solution is not known to be the mean over its patch.
    fn known<'a>(&'a self, scene: &Enclosure, patch: usize) -> Option<&'a [f64]> {
        (!self.control.knows(patch)).then(|| self.control.met_at(scene, patch))
    }

    /// The rays of a patch, with so many points in a set.
    fn rays<'a>(&self, scene: &'a Enclosure, batch: &Batch, (patch, size): (usize, u32)) -> Rays<'a> {
        let bands = scene.bands();
        let stream = |k: usize| (k * scene.len() + patch) as u32;
        let points = (0..SETS).flat_map(|set| {
            let mut places = batch.samples_of(stream(HALVES + set), size);
            (0..size).map(move |k| scene.point(patch, places.draw(k).pair()))
        });
        let points: Vec<Site> = points.collect();
        let is_paired = self.control.knows(patch);
        let count = if is_paired { RAYS } else { RAYS * points.len() as u32 };
        let mut halves = std::array::from_fn(|half| batch.samples_of(stream(half), count));
        let (mut met, mut found) = (Vec::new(), vec![0.0; HALVES * points.len() * bands]);
        let mut traced = 0;
        let ones = vec![1.0; bands];
        let weight = Weight { of: &ones, share: 1.0 / f64::from(RAYS) };
        for (samples, found) in halves.iter_mut().zip(found.chunks_mut(points.len() * bands)) {
            for number in 0..RAYS {
                for ((k, &point), found) in (0..).zip(&points).zip(found.chunks_mut(bands)) {
                    let sample = sample(is_paired, number, (k, points.len()));
                    let numbers = self.numbers(&mut samples.draw(sample));
                    let left = self.paths.leave(scene, (point, 0, true), &numbers, &weight, found);
                    traced += left.rays;
                    met.push(left.reflected);
                }
            }
        }
        Rays { scene, points, halves, is_paired, met, found, traced }
    }

    /// What a ray from a point needs.
    fn numbers(&self, draw: &mut Draw) -> Numbers {
        let lamp = self.switches.next_event.then(|| draw.pair());
        Numbers { lamp, direction: draw.pair() }
    }

    /// Sends power (W) from where a ray has arrived on: it is added to that of every patch that it
    /// meets. Returns the rays that it took.
    fn fly(
        &self,
        scene: &Enclosure,
        (mut at, draw): (Site, &mut Draw),
        power: &mut [f64],
        out: &mut [f64],
    ) -> u64 {
        let start = power.iter().copied().map(f64::abs).fold(0.0, f64::max);
        let mut rays = 0;
        loop {
            let row = &mut out[at.patch * power.len()..(at.patch + 1) * power.len()];
            row.iter_mut().zip(&*power).for_each(|(sum, power)| *sum += power);
            scale(power, scene.reflectance(at.patch), 1.0);
            if !self.switches.goes_on(scene.survival(at.patch), draw, power, start) {
                return rays;
            }
            rays += 1;
            let Some(next) = scene.bounce(at, draw.pair()) else { return rays };
            at = next;
        }
    }
}

impl Rays<'_> {
    /// What each half of the rays finds at the points, less the mean of the other set, or else less
    /// `known`; W/m².
    fn missed(&self, known: Option<&[f64]>) -> Vec<f64> {
        let bands = self.scene.bands();
        let size = self.points.len() / SETS;
        let mut missed = self.found.clone();
        for (set, missed) in missed.chunks_mut(size * bands).enumerate() {
            // The sets of a half follow each other.
            let other = &self.found[(set ^ 1) * size * bands..][..size * bands];
            for band in 0..bands {
                let known = known.map_or_else(|| mean(other, bands, band), |known| known[band]);
                missed.iter_mut().skip(band).step_by(bands).for_each(|value| *value -= known);
            }
        }
        missed
    }
}

/// Which sample of a half has the numbers of a ray of the k-th of so many points.
fn sample(is_paired: bool, number: u32, (k, points): (u32, usize)) -> u32 {
    if is_paired { number } else { number * points as u32 + k }
}

/// Mean of a band.
fn mean(rows: &[f64], bands: usize, band: usize) -> f64 {
    rows.iter().skip(band).step_by(bands).sum::<f64>() / (rows.len() / bands) as f64
}

impl Estimator for ResidualShooting {
    fn name(&self) -> &'static str {
        "residual-shooting"
    }

    fn gathers(&self) -> bool {
        true
    }

    fn batch(&self, scene: &Enclosure, batch: &Batch, out: &mut [f64]) -> Work {
        let bands = scene.bands();
        let mut work = Work::default();
        out.fill(0.0);
        let mut power = vec![0.0; bands];
        let mut means = Vec::new();
        for patch in 0..scene.len() {
            if self.control.knows(patch) && scene.reflectance(patch).iter().all(|&rho| rho == 0.0) {
                // It sends nothing on.
                continue;
            }
            let mut rays = self.rays(scene, batch, (patch, self.size(batch, patch)));
            work += Work { paths: rays.met.len() as u64, rays: rays.traced };
            let known = self.known(scene, patch);
            if known.is_some() {
                means.extend((0..bands).map(|band| mean(&rays.found, bands, band)));
            }
            let missed = rays.missed(known);
            let (rho, points) = (scene.reflectance(patch), rays.points.len());
            let share = scene.patches()[patch].area() / rays.met.len() as f64;
            let mut met = rays.met.iter();
            for (half, samples) in rays.halves.iter_mut().enumerate() {
                let other = &missed[(HALVES - 1 - half) * points * bands..][..points * bands];
                for number in 0..RAYS {
                    for ((k, missed), arrived) in (0..).zip(other.chunks(bands)).zip(met.by_ref()) {
                        let &Some((site, factor)) = arrived else { continue };
                        let sent = power.iter_mut().zip(rho).zip(missed);
                        sent.for_each(|((power, rho), missed)| *power = rho * missed * factor * share);
                        if power.iter().all(|&power| power == 0.0) {
                            continue;
                        }
                        let sample = sample(rays.is_paired, number, (k, points));
                        let mut draw = samples.draw(sample);
                        // The numbers of the ray itself come first.
                        self.numbers(&mut draw);
                        work.rays += self.fly(scene, (site, &mut draw), &mut power, out);
                    }
                }
            }
        }
        per_area(scene, out);
        let mut means = means.chunks(bands);
        for (patch, row) in out.chunks_mut(bands).enumerate() {
            let is_known = self.control.knows(patch);
            let mean = if is_known { Some(self.control.whole_at(scene, patch)) } else { means.next() };
            row.iter_mut().zip(mean.into_iter().flatten()).for_each(|(out, mean)| *out += mean);
        }
        work
    }
}
