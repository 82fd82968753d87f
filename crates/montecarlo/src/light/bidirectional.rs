//! Bidirectional path tracing: a path from the patch and one from a lamp, all their vertices
//! joined.
//!
//! A path z₀ … z_k from the patch to a lamp has edges e_j = κ(z_{j−1}, z_j). With t vertices from
//! the patch and the others from the lamp, the edge e_t is the one that joins; its density is p_L Π
//! e / e_t times the survivals q, and without any from the lamp Π e. By the balance heuristic every
//! technique then scores the same, M Π ρ/q / (1 + p_L Σ_j 1/(e_j q_{j−1} q_j)), with q = 1 at both
//! ends. E. P. Lafortune, Y. D. Willems, Compugraphics 1993; E. Veach, L. J. Guibas, Eurographics
//! workshop on rendering 1994, doi:10.1007/978-3-642-87825-1_11.

use super::{Batch, Estimator, PointEstimator, Switches, Work, add, gather};
use crate::points::Draw;
use crate::{Enclosure, Site};

/// Bidirectional path tracing from patches.
pub struct Bidirectional {
    switches: Switches,
}

impl Bidirectional {
    /// Of the switches, the roulette and the number of bounces of either half count.
    #[must_use]
    pub fn new(switches: Switches) -> Self {
        Self { switches }
    }
}

/// A vertex of half a path.
struct Vertex {
    site: Site,
    /// q, 1 at the first.
    survival: f64,
    /// Σ 1/(e q q) up to here, this vertex taken as an inner one.
    inner: f64,
    /// The same, taken as the end.
    ending: f64,
    /// Π ρ/q up to here; 1 at the first.
    weight: Vec<f64>,
}

impl Bidirectional {
    fn half(&self, scene: &Enclosure, from: Site, draw: &mut Draw<'_>) -> (Vec<Vertex>, u64) {
        let first =
            Vertex { site: from, survival: 1.0, inner: 0.0, ending: 0.0, weight: vec![1.0; scene.bands()] };
        let (mut vertices, mut rays) = (vec![first], 0);
        while let Some(last) = vertices.last() {
            rays += 1;
            let Some(site) = scene.bounce(last.site, draw.pair()) else { break };
            let next = self.vertex(scene, last, site);
            let (survival, most) = (next.survival, next.weight.iter().copied().fold(0.0, f64::max));
            vertices.push(next);
            // The first vertex is no reflection.
            let reflects = self.switches.reflects(vertices.len() as u32 - 2);
            let goes_on =
                if self.switches.roulette { draw.single() < survival } else { most > super::LEAST_WEIGHT };
            if !reflects || !goes_on {
                break;
            }
        }
        (vertices, rays)
    }

    fn vertex(&self, scene: &Enclosure, last: &Vertex, site: Site) -> Vertex {
        let survival = if self.switches.roulette { scene.survival(site.patch) } else { 1.0 };
        let edge = scene.kernel(last.site, site) * last.survival;
        let rho = scene.reflectance(site.patch);
        // A black vertex joins nothing: its weight is 0 without a division.
        let divisor = if survival > 0.0 { survival } else { 1.0 };
        let weight = last.weight.iter().zip(rho).map(|(weight, rho)| weight * rho / divisor).collect();
        let ending = last.inner + 1.0 / edge;
        Vertex { site, survival, inner: last.inner + 1.0 / (edge * divisor), ending, weight }
    }
}

impl PointEstimator for Bidirectional {
    fn irradiance(&self, scene: &Enclosure, at: Site, draw: &mut Draw<'_>, out: &mut [f64]) -> u64 {
        let lamp = scene.lamp(draw.pair());
        let density = scene.lamps().pdf(lamp.patch);
        let (eye, eye_rays) = self.half(scene, at, draw);
        let (light, light_rays) = self.half(scene, lamp, draw);
        for pair in eye.windows(2) {
            let [before, end] = pair else { continue };
            let density = scene.lamps().pdf(end.site.patch);
            let share = 1.0 / (1.0 + density * end.ending);
            add(out, &before.weight, scene.exitance(end.site.patch), share);
        }
        let mut rays = eye_rays + light_rays;
        let exitance = scene.exitance(lamp.patch);
        for z in &eye {
            for y in light.iter().filter(|y| y.survival > 0.0 && z.survival > 0.0) {
                rays += join(scene, z, y, density, exitance, out);
            }
        }
        rays
    }
}

/// The path through an edge between the halves; returns the segments tested.
fn join(scene: &Enclosure, z: &Vertex, y: &Vertex, density: f64, exitance: &[f64], out: &mut [f64]) -> u64 {
    let kernel = scene.kernel(z.site, y.site);
    if kernel <= 0.0 {
        return 0;
    }
    if scene.sees(z.site, y.site) {
        let sum = z.inner + y.inner + 1.0 / (kernel * z.survival * y.survival);
        let share = 1.0 / (1.0 + density * sum);
        let weights = z.weight.iter().zip(&y.weight).zip(exitance);
        out.iter_mut().zip(weights).for_each(|(out, ((z, y), m))| *out += z * y * m * share);
    }
    1
}

impl Estimator for Bidirectional {
    fn name(&self) -> &'static str {
        "bidirectional"
    }

    fn gathers(&self) -> bool {
        true
    }

    fn batch(&self, scene: &Enclosure, batch: &Batch, out: &mut [f64]) -> Work {
        gather(scene, batch, self, out)
    }
}
