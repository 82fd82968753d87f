//! Path tracing and patch-wise gathering walks: E(p) = E[Σ_k W_k D(y_k)] along a path p = y₀, y₁, …
//! with directions of density cosθ/π.
//!
//! W_k = Π ρ, and D is what arrives from lamps directly. It is estimated by the lamp that the next
//! ray meets, by a point q of a lamp with density p_L (next event), or both weighed by the balance
//! heuristic, M κ/(p_L + κ) and M κ/(p_L + κ) · 1/κ (E. Veach, L. J. Guibas, SIGGRAPH 1995,
//! doi:10.1145/218380.218498). Random walks on a Fredholm equation: J. T. Kajiya, SIGGRAPH 1986,
//! doi:10.1145/15922.15902; patch-wise: M. Sbert, Comput. Graph. 17 (1993) 635.
//!
//! *Control variate.* With known irradiances Ẽ of patches, whose mean after one application of the
//! operator is Ẽ again, E_i = Ẽ_i + E[Σ_{k≥1} W_k (D(y_k) + ρ Ẽ(y_{k+1}) − Ẽ(y_k))]: only what the
//! discretisation missed is sampled. The result is then as exact as the form factors behind Ẽ.

use super::{Batch, Estimator, PointEstimator, Switches, Work, add, gather, scale};
use crate::density::{Cosine, DirectionDensity};
use crate::points::Draw;
use crate::{Enclosure, MonteCarloError, Site};
use std::f64::consts::FRAC_1_PI;

/// Path tracing from patches, or a gathering walk where it is patch-wise.
pub struct PathTracing {
    switches: Switches,
    patchwise: bool,
    control: Option<Control>,
    directions: Box<dyn DirectionDensity>,
}

/// Known irradiances, such as a deterministic solution.
#[derive(Clone, Debug)]
pub struct Control {
    whole: Vec<f64>,
    /// Means over the part that can be met.
    met: Vec<f64>,
}

impl Control {
    /// Irradiances of the patches (W/m², means over the whole, patch-major).
    ///
    /// # Errors
    /// [`MonteCarloError::Length`].
    pub fn new(scene: &Enclosure, irradiance: Vec<f64>, patchwise: bool) -> Result<Self, MonteCarloError> {
        let (bands, expected) = (scene.bands(), scene.len() * scene.bands());
        if irradiance.len() != expected {
            let found = irradiance.len();
            return Err(MonteCarloError::Length { what: "the control variate", expected, found });
        }
        let share = |at: usize| if patchwise { 1.0 } else { scene.exposed(at / bands) };
        let met = |(at, e): (usize, &f64)| if share(at) > 0.0 { e / share(at) } else { 0.0 };
        Ok(Self { met: irradiance.iter().enumerate().map(met).collect(), whole: irradiance })
    }
}

impl PathTracing {
    /// Path tracing: reflected where it meets a patch.
    #[must_use]
    pub fn continuous(switches: Switches) -> Self {
        Self { switches, patchwise: false, control: None, directions: Box::new(Cosine) }
    }

    /// The gathering walk: goes on from a new point of the patch that it met.
    #[must_use]
    pub fn patchwise(switches: Switches) -> Self {
        Self { patchwise: true, ..Self::continuous(switches) }
    }

    /// The same with a control variate.
    #[must_use]
    pub fn with_control(self, control: Control) -> Self {
        Self { control: Some(control), ..self }
    }

    /// The same with another density of directions than the cosine.
    #[must_use]
    pub fn with_directions(self, directions: Box<dyn DirectionDensity>) -> Self {
        Self { directions, ..self }
    }

    /// A point of a lamp.
    fn next_event(
        &self,
        scene: &Enclosure,
        at: Site,
        draw: &mut Draw,
        weight: &[f64],
        out: &mut [f64],
    ) -> u64 {
        let lamp = scene.lamp(draw.pair());
        let kernel = scene.kernel(at, lamp);
        if kernel <= 0.0 {
            return 0;
        }
        if scene.sees(at, lamp) {
            let sampled = scene.lamps().pdf(lamp.patch);
            let met = if self.switches.multiple_importance { self.met(scene, at, lamp, kernel) } else { 0.0 };
            add(out, weight, scene.exitance(lamp.patch), kernel / (sampled + met));
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

    /// What the control variate has put in the place of the irradiance here, or of what is
    /// reflected next.
    fn correct(&self, scene: &Enclosure, patch: usize, weight: &[f64], sign: f64, out: &mut [f64]) {
        if let Some(control) = &self.control {
            let bands = scene.bands();
            add(out, weight, &control.met[patch * bands..(patch + 1) * bands], sign);
        }
    }

    /// One step: from a vertex to the next, or the end.
    pub(super) fn step(
        &self,
        scene: &Enclosure,
        step: &mut Step<'_>,
        draw: &mut Draw,
        out: &mut [f64],
    ) -> Option<Site> {
        self.leave(scene, step, draw, out);
        let direction = self.directions.sample(draw.pair());
        if direction.z <= 0.0 {
            return None;
        }
        let factor = direction.z * FRAC_1_PI / self.directions.pdf(direction);
        step.rays += 1;
        let next = scene.ray(step.at, direction)?;
        if !self.arrive(scene, step, (next, factor), out) {
            return None;
        }
        let survival = scene.survival(next.patch);
        self.switches.goes_on(survival, draw, step.weight, 1.0).then_some(next)
    }

    /// What is scored at a vertex before a ray leaves it.
    fn leave(&self, scene: &Enclosure, step: &mut Step<'_>, draw: &mut Draw, out: &mut [f64]) {
        if step.done > 0 {
            self.correct(scene, step.at.patch, step.weight, -1.0, out);
        }
        if self.scores(step) && self.switches.next_event {
            step.rays += self.next_event(scene, step.at, draw, step.weight, out);
        }
    }

    /// What is scored where a ray of this factor arrives; whether it is reflected.
    fn arrive(
        &self,
        scene: &Enclosure,
        step: &mut Step<'_>,
        (next, factor): (Site, f64),
        out: &mut [f64],
    ) -> bool {
        let scored = self.scores(step);
        if scored {
            add(out, step.weight, scene.exitance(next.patch), self.share(scene, step.at, next, factor));
        }
        let exposed = if self.patchwise { scene.exposed(next.patch) } else { 1.0 };
        if exposed <= 0.0 || !self.switches.reflects(step.done) {
            return false;
        }
        scale(step.weight, scene.reflectance(next.patch), factor / exposed);
        if scored {
            self.correct(scene, next.patch, step.weight, 1.0, out);
        }
        true
    }

    /// A control variate has scored the first vertex already.
    fn scores(&self, step: &Step<'_>) -> bool {
        self.control.is_none() || step.done > 0
    }
}

/// Where a path is, how often it was reflected, and what it weighs.
pub(super) struct Step<'a> {
    pub(super) at: Site,
    pub(super) done: u32,
    pub(super) rays: u64,
    pub(super) weight: &'a mut [f64],
}

impl PointEstimator for PathTracing {
    fn irradiance(&self, scene: &Enclosure, at: Site, draw: &mut Draw, out: &mut [f64]) -> u64 {
        let mut weight = vec![1.0; scene.bands()];
        if let Some(control) = &self.control {
            let bands = scene.bands();
            add(out, &weight, &control.whole[at.patch * bands..(at.patch + 1) * bands], 1.0);
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
