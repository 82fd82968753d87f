//! ∫ f dA over a convex polygon, f with layers along its edges and peaks at its corners.
//!
//! Fanned into triangles, each collapsed towards a corner (M. G. Duffy, SIAM J. Numer. Anal. 19
//! (1982) 1260, doi:10.1137/0719090) and graded towards all edges by x = 1/(1 + e^(−π sinh τ)) (H.
//! Takahasi & M. Mori, Publ. RIMS 9 (1974) 721, doi:10.2977/prims/1195192451), which leaves a layer
//! of width δ a width of the order of 1/ln(1/δ). Cells in τ are then cut where the error is
//! largest. In m² times the unit of f.

use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{Estimate, Goal, PlanePoint, adaptive_quad};
use std::f64::consts::PI;

/// |τ| at the ends: the rest of [0, 1] beyond is below rounding.
const TAU_AT_ENDS: f64 = 3.2;

/// ∫ f dA over a triangle by a rule for the unit square.
pub(super) fn graded(triangle: &Patch, rule: &[PlanePoint], goal: Goal, f: impl Fn(Vec3) -> f64) -> Estimate {
    let [a, b, c] = [0, 1, 2].map(|k| triangle.corner(k));
    let (to_b, to_c) = (b - a, c - a);
    let twice_area = 2.0 * triangle.area();
    let integrand = |u: f64, v: f64| {
        let ((s, ds), (t, dt)) = (grade(u), grade(v));
        twice_area * s * ds * dt * f(a + (to_b * (1.0 - t) + to_c * t) * s)
    };
    adaptive_quad(rule, goal, integrand)
}

/// x and dx/du, u in [0, 1].
fn grade(u: f64) -> (f64, f64) {
    let tau = TAU_AT_ENDS * (2.0 * u - 1.0);
    let growth = (-PI * tau.sinh()).exp();
    let x = 1.0 / (1.0 + growth);
    (x, 2.0 * TAU_AT_ENDS * PI * tau.cosh() * x * (growth * x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_quadrature::tensor_quad;

    /// Over the unit triangle ∫ x/√(x² + δ²) dx dy = ∫₀¹ (1 − x) x/√(x² + δ²) dx.
    #[test]
    fn a_layer_along_an_edge_costs_its_logarithm() {
        let triangle = Patch::triangle([Vec3::ZERO, Vec3::X, Vec3::Y]).unwrap();
        let goal = Goal { tolerance: 1e-10, cuts: 200 };
        for width in [1.0f64, 1e-3, 1e-6, 1e-9] {
            let got = graded(&triangle, &tensor_quad(8), goal, |p| p.x / p.x.hypot(width));
            let (far, log) = (1f64.hypot(width), (1.0 / width).asinh());
            let exact = far - width - 0.5 * (far - width * width * log);
            assert!((got.value - exact).abs() <= 1e-10 && got.error <= 1e-10, "{width:e}: {got:?} {exact}");
        }
    }
}
