//! Light tracing and patch-wise shooting walks: particles leave the lamps and leave their power
//! where they arrive.
//!
//! A particle starts at q with the density p_L per area and the power M(q)/(p_L n), W; directions
//! have the density cosθ/π. Every patch that it meets receives the power, and reflects ρ of it. E_i
//! is the power received over A_i. J. Arvo, SIGGRAPH course notes 1986; S. N. Pattanaik, S. P.
//! Mudur, Eurographics workshop on rendering 1992.

use super::{Batch, Estimator, Switches, Work, per_area, scale};
use crate::points::Draw;
use crate::{Enclosure, Site};

/// Particles from lamps, reflected where they arrive, or patch-wise from a new point of the patch.
pub struct ParticleTracing {
    switches: Switches,
    patchwise: bool,
}

impl ParticleTracing {
    /// Light tracing.
    #[must_use]
    pub fn continuous(switches: Switches) -> Self {
        Self { switches, patchwise: false }
    }

    /// The shooting walk.
    #[must_use]
    pub fn patchwise(switches: Switches) -> Self {
        Self { switches, patchwise: true }
    }

    /// One particle: tells `arrive` of every patch it meets and the power it brings; returns the
    /// rays it took.
    pub(crate) fn fly(
        &self,
        scene: &Enclosure,
        draw: &mut Draw<'_>,
        power: &mut [f64],
        arrive: &mut dyn FnMut(Site, &[f64]),
    ) -> u64 {
        let mut at = emitted(scene, draw, power);
        let start = power.iter().copied().fold(0.0, f64::max);
        let (mut rays, mut done) = (0, 0);
        loop {
            rays += 1;
            let Some(next) = scene.bounce(at, draw.pair()) else { return rays };
            arrive(next, power);
            let exposed = if self.patchwise { scene.exposed(next.patch) } else { 1.0 };
            if exposed <= 0.0 || !self.switches.reflects(done) {
                return rays;
            }
            scale(power, scene.reflectance(next.patch), 1.0 / exposed);
            if !self.switches.goes_on(scene.survival(next.patch), draw, power, start) {
                return rays;
            }
            at = if self.patchwise { scene.point(next.patch, draw.pair()) } else { next };
            done += 1;
        }
    }
}

/// Where a particle starts; its power, times M/p_L.
fn emitted(scene: &Enclosure, draw: &mut Draw<'_>, power: &mut [f64]) -> Site {
    let at = scene.lamp(draw.pair());
    let density = scene.lamps().pdf(at.patch);
    for power in power.iter_mut() {
        *power /= density;
    }
    scale(power, scene.exitance(at.patch), 1.0);
    at
}

impl Estimator for ParticleTracing {
    fn name(&self) -> &'static str {
        if self.patchwise { "walk-shooting" } else { "light" }
    }

    fn gathers(&self) -> bool {
        false
    }

    fn patchwise(&self) -> bool {
        self.patchwise
    }

    fn batch(&self, scene: &Enclosure, batch: &Batch, out: &mut [f64]) -> Work {
        let bands = scene.bands();
        let mut work = Work::default();
        let mut power = vec![0.0; bands];
        out.fill(0.0);
        let mut samples = batch.samples_of(0, batch.samples);
        for sample in 0..batch.samples {
            power.fill(1.0 / f64::from(batch.samples));
            let mut arrive = |at: Site, power: &[f64]| {
                let row = &mut out[at.patch * bands..(at.patch + 1) * bands];
                row.iter_mut().zip(power).for_each(|(sum, power)| *sum += power);
            };
            let mut draw = samples.draw(sample);
            work += Work { paths: 1, rays: self.fly(scene, &mut draw, &mut power, &mut arrive) };
        }
        per_area(scene, out);
        work
    }
}
