//! Rays from elements: where they begin, where they go and what they meet.
//!
//! What an element sends is spread as cosθ dω/π over the half-space before it. Rays whose origins
//! are even over its area and whose directions follow that density tell where the light goes,
//! without any form factor: the share that meets the lit side of a patch is Σ_j F_ij. Their numbers
//! are those of the additive recurrence x_k = x_0 + k (φ⁻¹, φ⁻², φ⁻³, φ⁻⁴) mod 1 with φ⁵ = φ + 1
//! (M. Roberts, *The Unreasonable Effectiveness of Quasirandom Sequences*, 2018).

use crate::polygon::folded;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use std::f64::consts::TAU;

/// φ⁻¹, φ⁻², φ⁻³, φ⁻⁴ with φ⁵ = φ + 1.
const STEPS: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_808_6, 0.538_597_257_223_61];
/// Tilts (cosines) of the rings of rays about the normal that tell whether a point is buried, and
/// rays in a ring.
const TILTS: [f64; 2] = [0.75, 0.3];
const RAYS_IN_A_RING: usize = 6;

/// The k-th point of the recurrence in [0, 1)⁴ that begins at `start`.
#[must_use]
pub fn recurrence(k: usize, start: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| (start[i] + k as f64 * STEPS[i]).fract())
}

/// A ray of a patch from four numbers in [0, 1): its origin, even over the parameters of the patch,
/// and its direction, a unit vector of density cosθ/π about the normal.
#[must_use]
pub fn cosine_ray(patch: &Patch, [u, v, tilt, turn]: [f64; 4]) -> (Vec3, Vec3) {
    let (u, v) = folded(patch, u, v);
    let normal = patch.normal();
    let across = normal.any_orthonormal_vector();
    let other = normal.cross(across);
    let (sine, (y, x)) = (tilt.sqrt(), (TAU * turn).sin_cos());
    (patch.point(u, v), normal * (1.0 - tilt).sqrt() + (across * x + other * y) * sine)
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meets {
    /// The side of a patch to which its normal points.
    Lit,
    /// The other side.
    Back,
    /// Nothing: it leaves the scene.
    Nothing,
}

/// What a ray meets; `lit` holds these patches, in order.
#[must_use]
pub fn meets(from: Vec3, direction: Vec3, patches: &[&Patch], lit: &Occluders) -> Meets {
    match lit.closest(from, direction, f64::INFINITY) {
        Some(hit) if patches[hit.patch].normal().dot(direction) < 0.0 => Meets::Lit,
        Some(_) => Meets::Back,
        None => Meets::Nothing,
    }
}

/// The directions that decide whether a point is buried: the normal of its patch and two rings
/// about it.
#[derive(Clone, Debug)]
pub struct Bundle(Vec<Vec3>);

impl Bundle {
    /// That of a patch.
    #[must_use]
    pub fn of(patch: &Patch) -> Self {
        let n = patch.normal();
        let across = n.any_orthonormal_vector();
        let other = n.cross(across);
        let ring = |tilt: f64| {
            let sine = (1.0 - tilt * tilt).sqrt();
            (0..RAYS_IN_A_RING).map(move |k| {
                let angle = TAU * (k as f64 + tilt) / RAYS_IN_A_RING as f64;
                n * tilt + (across * angle.cos() + other * angle.sin()) * sine
            })
        };
        Self(std::iter::once(n).chain(TILTS.into_iter().flat_map(ring)).collect())
    }

    /// Whether a point of the patch is buried: every ray from it ends on the back of a patch.
    #[must_use]
    pub fn buried(&self, point: Vec3, patches: &[&Patch], lit: &Occluders) -> bool {
        self.0.iter().all(|&direction| meets(point, direction, patches, lit) == Meets::Back)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_square() -> Patch {
        let corners = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]].map(Vec3::from);
        Patch::quad(corners).unwrap().unwrap()
    }

    #[test]
    fn directions_follow_the_cosine() {
        let n = 4096;
        let patch = unit_square();
        let mean = |of: fn(Vec3) -> f64| {
            (0..n).map(|k| of(cosine_ray(&patch, recurrence(k, [0.5; 4])).1)).sum::<f64>() / n as f64
        };
        // ∫ cosθ · cosθ/π dω = 2/3, ∫ sin²θ cos²φ cosθ/π dω = 1/4.
        assert!((mean(|d| d.z) - 2.0 / 3.0).abs() < 1e-3);
        assert!((mean(|d| d.x * d.x) - 0.25).abs() < 1e-3);
        assert!(mean(|d| d.y).abs() < 1e-3);
    }

    #[test]
    fn rays_tell_the_form_factor_of_two_squares() {
        // Parallel unit squares at distance 1: F = 0.199825 (J. R. Howell, configuration C-11).
        let floor = unit_square();
        let ceiling = Patch::quad([[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]].map(Vec3::from));
        let patches = [floor, ceiling.unwrap().unwrap()];
        let all: Vec<&Patch> = patches.iter().collect();
        let lit = Occluders::new(&patches).unwrap();
        let n = 1 << 16;
        let met = (0..n).filter(|&k| {
            let (from, direction) = cosine_ray(&floor, recurrence(k, [0.5; 4]));
            meets(from, direction, &all, &lit) == Meets::Lit
        });
        let share = met.count() as f64 / n as f64;
        assert!((share - 0.199_825).abs() < 5e-4, "{share}");
    }
}
