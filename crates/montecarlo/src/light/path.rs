//! Path tracing and patch-wise gathering walks: E(p) = E[Σ_k W_k D(y_k)] along a path p = y₀, y₁, …
//! with directions of density cosθ/π.
//!
//! W_k = Π ρ, and D is what arrives from lamps directly. It is estimated by the lamp that the next
//! ray meets, by a point q of a lamp with density p_L (next event), or both weighed by the balance
//! heuristic, M κ/(p_L + κ) and M κ/(p_L + κ) · 1/κ (E. Veach, L. J. Guibas, SIGGRAPH 1995,
//! doi:10.1145/218380.218498). Random walks on a Fredholm equation: J. T. Kajiya, SIGGRAPH 1986,
//! doi:10.1145/15922.15902; patch-wise: M. Sbert, Comput. Graph. 17 (1993) 635.
//!
//! *Control variate*, of gathering walks. With known irradiances Ẽ of patches, whose mean after one
//! application of the operator is Ẽ again, E_i = Ẽ_i + E[Σ_{k≥1} W_k (D(y_k) + ρ Ẽ(y_{k+1}) − Ẽ(y_k))]:
//! the result is as exact as the form factors behind Ẽ. Of patches on which another one lies the mean
//! is not known: rays that start under it meet what no light comes from. They are estimated without
//! it. What a solution misses of the continuous equation is shot: [`ResidualShooting`].
//!
//! [`ResidualShooting`]: super::ResidualShooting

use super::{Batch, Estimator, PointEstimator, Switches, Work, add, gather, scale};
use crate::density::{Cosine, DirectionDensity};
use crate::locator::overlaid;
use crate::points::Draw;
use crate::{Enclosure, MonteCarloError, Site};
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// Path tracing from patches, or a gathering walk where it is patch-wise.
pub struct PathTracing {
    switches: Switches,
    patchwise: bool,
    control: Option<Arc<Control>>,
    directions: Box<dyn DirectionDensity>,
}

/// Known irradiances, such as a deterministic solution.
#[derive(Clone, Debug)]
pub struct Control {
    whole: Vec<f64>,
    /// Means over the part that can be met.
    met: Vec<f64>,
    /// Of which patches the mean of D + ρ Ẽ is Ẽ.
    known: Vec<bool>,
}

impl Control {
    /// Irradiances of the patches (W/m², means over the whole, patch-major), which stand for the
    /// exposed shares that the solution has taken.
    ///
    /// # Errors
    /// [`MonteCarloError::Length`].
    pub fn new(
        scene: &Enclosure,
        (irradiance, exposed): (Vec<f64>, &[f64]),
        patchwise: bool,
    ) -> Result<Self, MonteCarloError> {
        let (bands, expected) = (scene.bands(), scene.len() * scene.bands());
        if irradiance.len() != expected {
            let found = irradiance.len();
            return Err(MonteCarloError::Length { what: "the control variate", expected, found });
        }
        if exposed.len() != scene.len() {
            let (expected, found) = (scene.len(), exposed.len());
            return Err(MonteCarloError::Length { what: "the list of exposed shares", expected, found });
        }
        let share = |at: usize| if patchwise { 1.0 } else { exposed[at / bands] };
        let met = |(at, e): (usize, &f64)| if share(at) > 0.0 { e / share(at) } else { 0.0 };
        let bare = overlaid(scene.patches()).into_iter().enumerate();
        Ok(Self {
            met: irradiance.iter().enumerate().map(met).collect(),
            known: bare.map(|(patch, overlaid)| !overlaid && exposed[patch] >= 1.0).collect(),
            whole: irradiance,
        })
    }

    /// Irradiances of a patch, means over the part that can be met, W/m².
    pub(super) fn met_at(&self, scene: &Enclosure, patch: usize) -> &[f64] {
        &self.met[patch * scene.bands()..(patch + 1) * scene.bands()]
    }

    /// Irradiances of a patch, means over the whole, W/m².
    pub(super) fn whole_at(&self, scene: &Enclosure, patch: usize) -> &[f64] {
        &self.whole[patch * scene.bands()..(patch + 1) * scene.bands()]
    }

    /// Whether the mean of D + ρ Ẽ over a patch is Ẽ.
    pub(super) fn knows(&self, patch: usize) -> bool {
        self.known[patch]
    }
}

impl PathTracing {
    /// Path tracing: reflected where it meets a patch.
    #[must_use]
    pub fn continuous(switches: Switches) -> Self {
        let directions = Box::new(Cosine);
        Self { switches, patchwise: false, control: None, directions }
    }

    /// The gathering walk: goes on from a new point of the patch that it met.
    #[must_use]
    pub fn patchwise(switches: Switches) -> Self {
        Self { patchwise: true, ..Self::continuous(switches) }
    }

    /// The same with a control variate.
    #[must_use]
    pub fn with_control(self, control: impl Into<Arc<Control>>) -> Self {
        Self { control: Some(control.into()), ..self }
    }

    /// The same with another density of directions than the cosine.
    #[must_use]
    pub fn with_directions(self, directions: Box<dyn DirectionDensity>) -> Self {
        Self { directions, ..self }
    }

    /// What a point of a lamp brings.
    fn next_event(
        &self,
        scene: &Enclosure,
        at: Site,
        numbers: [f64; 2],
        weight: &Weight<'_>,
        out: &mut [f64],
    ) -> u64 {
        let lamp = scene.lamp(numbers);
        let kernel = scene.kernel(at, lamp);
        if kernel <= 0.0 {
            return 0;
        }
        if scene.sees(at, lamp) {
            let sampled = scene.lamps().pdf(lamp.patch);
            let met = if self.switches.multiple_importance { self.met(scene, at, lamp, kernel) } else { 0.0 };
            weight.add(out, scene.exitance(lamp.patch), kernel / (sampled + met));
        }
        1
    }

    /// Density per area with which a ray from one site meets another, 1/m².
    fn met(&self, scene: &Enclosure, from: Site, to: Site, kernel: f64) -> f64 {
        let direction = scene.direction(from, to.point);
        kernel * self.directions.pdf(direction) / (direction.z * FRAC_1_PI)
    }

    /// Share of the exitance of what a ray has met.
    fn share(&self, scene: &Enclosure, from: Site, to: Site, factor: f64) -> f64 {
        match (self.switches.next_event, self.switches.multiple_importance) {
            (false, _) => factor,
            (true, false) => 0.0,
            (true, true) => {
                // The density of rays per area is κ over the factor.
                let kernel = scene.kernel(from, to);
                if kernel > 0.0 { kernel / (scene.lamps().pdf(to.patch) + kernel / factor) } else { 0.0 }
            }
        }
    }

    /// One step: from a vertex to the next, or the end.
    pub(super) fn step(
        &self,
        scene: &Enclosure,
        step: &mut Step<'_>,
        draw: &mut Draw<'_>,
        out: &mut [f64],
    ) -> Option<Site> {
        let scored = self.scores(step);
        let numbers = Numbers {
            lamp: (scored && self.switches.next_event).then(|| draw.pair()),
            direction: draw.pair(),
        };
        if let Some(control) = self.control.as_ref().filter(|_| step.done > 0) {
            add(out, step.weight, control.met_at(scene, step.at.patch), -1.0);
        }
        let weight = Weight { of: &*step.weight, share: 1.0 };
        let left = self.leave(scene, (step.at, step.done, scored), &numbers, &weight, out);
        step.rays += left.rays;
        let (next, factor) = left.reflected?;
        scale(step.weight, scene.reflectance(next.patch), factor);
        self.switches.goes_on(scene.survival(next.patch), draw, step.weight, 1.0).then_some(next)
    }

    /// Whether a control variate knows the mean of a patch.
    fn knows(&self, patch: usize) -> bool {
        self.control.as_ref().is_some_and(|control| control.knows(patch))
    }

    /// What is scored at a vertex and where a ray from it arrives: D and, with a control variate,
    /// ρ Ẽ.
    pub(super) fn leave(
        &self,
        scene: &Enclosure,
        (at, done, scored): (Site, u32, bool),
        numbers: &Numbers,
        weight: &Weight<'_>,
        out: &mut [f64],
    ) -> Left {
        let mut left = Left { rays: 0, reflected: None };
        if let Some(numbers) = numbers.lamp {
            left.rays += self.next_event(scene, at, numbers, weight, out);
        }
        let direction = self.directions.sample(numbers.direction);
        if direction.z <= 0.0 {
            return left;
        }
        let factor = direction.z * FRAC_1_PI / self.directions.pdf(direction);
        left.rays += 1;
        let Some(next) = scene.ray(at, direction) else { return left };
        if scored {
            weight.add(out, scene.exitance(next.patch), self.share(scene, at, next, factor));
        }
        let exposed = if self.patchwise { scene.exposed(next.patch) } else { 1.0 };
        if exposed > 0.0 && self.switches.reflects(done) {
            let factor = factor / exposed;
            left.reflected = Some((next, factor));
            if let Some(control) = self.control.as_ref().filter(|_| scored) {
                let reflected = scene.reflectance(next.patch).iter().zip(control.met_at(scene, next.patch));
                let sums = out.iter_mut().zip(weight.of).zip(reflected);
                sums.for_each(|((out, w), (rho, e))| *out += w * rho * e * factor * weight.share);
            }
        }
        left
    }

    /// A control variate that knows the mean of the first vertex has scored it already.
    fn scores(&self, step: &Step<'_>) -> bool {
        step.done > 0 || !self.knows(step.at.patch)
    }
}

/// What is drawn at a vertex.
pub(super) struct Numbers {
    /// The point of a lamp, where one is looked at.
    pub(super) lamp: Option<[f64; 2]>,
    pub(super) direction: [f64; 2],
}

/// What a vertex weighs, band by band and in all of them.
pub(super) struct Weight<'a> {
    pub(super) of: &'a [f64],
    pub(super) share: f64,
}

impl Weight<'_> {
    fn add(&self, out: &mut [f64], values: &[f64], factor: f64) {
        add(out, self.of, values, factor * self.share);
    }
}

/// The rays that a vertex took, and what one met that reflects it, with its factor.
pub(super) struct Left {
    pub(super) rays: u64,
    pub(super) reflected: Option<(Site, f64)>,
}

/// Where a path is, how often it was reflected, and what it weighs.
pub(super) struct Step<'a> {
    pub(super) at: Site,
    pub(super) done: u32,
    pub(super) rays: u64,
    pub(super) weight: &'a mut [f64],
}

impl PointEstimator for PathTracing {
    fn irradiance(&self, scene: &Enclosure, at: Site, draw: &mut Draw<'_>, out: &mut [f64]) -> u64 {
        let mut weight = vec![1.0; scene.bands()];
        if let Some(control) = self.control.as_ref().filter(|control| control.knows(at.patch)) {
            add(out, &weight, control.whole_at(scene, at.patch), 1.0);
        }
        let mut step = Step { at, done: 0, rays: 0, weight: &mut weight };
        while let Some(next) = self.step(scene, &mut step, draw, out) {
            step.at = if self.patchwise { scene.point(next.patch, draw.pair()) } else { next };
            step.done += 1;
        }
        step.rays
    }
}

impl Estimator for PathTracing {
    fn name(&self) -> &'static str {
        if self.patchwise { "walk-gathering" } else { "path" }
    }

    fn gathers(&self) -> bool {
        true
    }

    fn patchwise(&self) -> bool {
        self.patchwise
    }

    fn batch(&self, scene: &Enclosure, batch: &Batch, out: &mut [f64]) -> Work {
        gather(scene, batch, self, out)
    }
}
