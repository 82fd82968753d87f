//! Where rays go that look for a scatterer: by a lobe about it, or by the solid angles of its
//! facets.
//!
//! Of facets: f is chosen with P_f in proportion to A_f |cosθ_f|/R_f², and on it an even point q; a
//! direction then has the density Σ P_f R²/(A_f |cosθ|) over all facets f that its line meets, in
//! 1/sr, since each of them may have sent it there. The weight R²/(|cosθ| pdf) of a facet met is at
//! most A_f/P_f: that of a plate stays even in its plane.

use super::Scattering;
use super::scattering::{Spot, pick};
use crate::density::{Cosine, DirectionDensity, Frame, UniformSphere, VonMisesFisher};
use fredholm_mesh::Vec3;
use fredholm_waves::Facet;

/// Where rays from a receiver go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// Everywhere alike.
    Sphere,
    /// By the cosine about the direction to the scatterer.
    Cosine,
    /// About that direction, with this κ; `None` for one that just covers the scatterer.
    Lobe(Option<f64>),
    /// By the solid angles of the facets.
    Facets,
}

/// The density at the rim of the scatterer is that at its middle times e^{−RIM_DECAY}.
const RIM_DECAY: f64 = 1.0;

/// A density of directions from one point.
pub(super) enum Directions {
    Lobe(Frame, Box<dyn DirectionDensity>),
    Facets(SolidAngles),
}

impl Directions {
    pub(super) fn new(problem: &Scattering<'_>, aim: Aim, receiver: Vec3) -> Self {
        let (centre, radius) = problem.ball();
        let towards = centre - receiver;
        let sine = (radius / towards.length()).min(1.0);
        // 1 − cosθ of the rim.
        let rim = 1.0 - (1.0 - sine * sine).sqrt();
        let density: Box<dyn DirectionDensity> = match aim {
            Aim::Sphere => Box::new(UniformSphere),
            Aim::Cosine => Box::new(Cosine),
            Aim::Lobe(kappa) => Box::new(VonMisesFisher::new(kappa.unwrap_or(RIM_DECAY / rim))),
            Aim::Facets => return Self::Facets(SolidAngles::new(problem, receiver, |_, _| true)),
        };
        Self::Lobe(Frame::about(towards.normalize_or(Vec3::Z)), density)
    }

    /// All surfaces along a ray, and the density of its direction, 1/sr.
    pub(super) fn shoot(&self, problem: &Scattering<'_>, from: Vec3, numbers: [f64; 2]) -> (Vec<Spot>, f64) {
        match self {
            Self::Lobe(frame, density) => {
                let local = density.sample(numbers);
                (problem.pierced(from, frame.world(local)), density.pdf(local))
            }
            Self::Facets(angles) => angles.shoot(problem, from, numbers),
        }
    }
}

/// Facets in proportion to the solid angles in which a point sees them.
pub(super) struct SolidAngles {
    cumulated: Vec<f64>,
}

impl SolidAngles {
    /// Of the facets that are wanted.
    pub(super) fn new(problem: &Scattering<'_>, from: Vec3, wanted: impl Fn(usize, &Facet) -> bool) -> Self {
        let mut sum = 0.0;
        let mut cumulate = |(number, facet): (usize, &Facet)| {
            let between = facet.centre - from;
            let square = between.length_squared();
            if wanted(number, facet) && square > 0.0 {
                sum += facet.patch.area() * facet.normal.dot(between).abs() / (square * square.sqrt());
            }
            sum
        };
        Self { cumulated: problem.facets().iter().enumerate().map(&mut cumulate).collect() }
    }

    fn total(&self) -> f64 {
        self.cumulated.last().copied().unwrap_or(0.0)
    }

    /// Whether there is anything to look at.
    pub(super) fn any(&self) -> bool {
        self.total() > 0.0
    }

    /// P of a facet.
    fn probability(&self, facet: usize) -> f64 {
        let before = if facet == 0 { 0.0 } else { self.cumulated[facet - 1] };
        (self.cumulated[facet] - before) / self.total()
    }

    /// All surfaces along a ray to one of the facets, and the density of its direction, 1/sr.
    pub(super) fn shoot(&self, problem: &Scattering<'_>, from: Vec3, [u, v]: [f64; 2]) -> (Vec<Spot>, f64) {
        if !self.any() {
            return (Vec::new(), 1.0);
        }
        let (facet, rest) = pick(&self.cumulated, u);
        let towards = problem.on(facet, [rest, v]) - from;
        let spots = problem.pierced(from, towards.normalize_or(Vec3::Z));
        let density = spots.iter().map(|&spot| self.density(problem, spot, from)).sum();
        (spots, density)
    }

    fn density(&self, problem: &Scattering<'_>, spot: Spot, from: Vec3) -> f64 {
        let share = self.probability(spot.facet) / problem.facet(spot).patch.area();
        shown(problem, spot, from, 1.0).map_or(0.0, |area| share * area)
    }
}

/// Ω R²/|cosθ|, m²; none where the surface is seen exactly edge-on.
pub(super) fn shown(problem: &Scattering<'_>, spot: Spot, from: Vec3, angle: f64) -> Option<f64> {
    let between = spot.point - from;
    let cosine = problem.facet(spot).normal.dot(between).abs() / between.length();
    (cosine > 0.0).then(|| angle * between.length_squared() / cosine)
}
