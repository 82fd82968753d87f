//! Double area integral: A_i F_ij ≈ Σ_k Σ_l w_k w_l cosθ_k cosθ_l / (π r_kl²), Gauss points on both patches.
//!
//! Viennot's thesis, eq. 1.39. In m². For patches that lie wholly in front of each other and are not close; the error falls geometrically with the
//! order. The difference of two orders is the error estimate of the lower one; the higher one is returned.

use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{Estimate, PlanePoint, collapsed_triangle, tensor_quad};
use std::f64::consts::FRAC_1_PI;
use std::sync::LazyLock;

/// Highest order that is tried; beyond it the contour integral is cheaper.
pub const MAX_ORDER: usize = 5;

/// Smallest credible ratio of two steps. Next to a much larger patch the steps change sign, and one in twenty is small by accident.
const CREDIBLE: f64 = 0.06;

static QUAD: LazyLock<Vec<Vec<PlanePoint>>> = LazyLock::new(|| (0..=MAX_ORDER).map(tensor_quad).collect());
static TRIANGLE: LazyLock<Vec<Vec<PlanePoint>>> =
    LazyLock::new(|| (0..=MAX_ORDER).map(collapsed_triangle).collect());

/// Points of a patch with weights in m², one list per order from 0 (empty) to [`MAX_ORDER`].
#[derive(Clone, Debug)]
pub struct PatchPoints(Vec<Vec<(Vec3, f64)>>);

impl PatchPoints {
    /// Places the rules of all orders on a patch.
    #[must_use]
    pub fn new(patch: &Patch) -> Self {
        Self((0..=MAX_ORDER).map(|order| place(patch, order)).collect())
    }

    /// Points and weights (m²) of one order.
    #[must_use]
    pub fn order(&self, order: usize) -> &[(Vec3, f64)] {
        &self.0[order]
    }
}

/// Points and weights (m²) of the rule of one order on a patch.
pub(crate) fn place(patch: &Patch, order: usize) -> Vec<(Vec3, f64)> {
    let rules = if patch.sides() == 3 { &TRIANGLE } else { &QUAD };
    let put = |p: &PlanePoint| (patch.point(p.u, p.v), p.weight * jacobian(patch, p.u, p.v));
    rules[order].iter().map(put).collect()
}

/// |∂x/∂u × ∂x/∂v| of the parametrisation, m².
pub(crate) fn jacobian(patch: &Patch, u: f64, v: f64) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|i| patch.corner(i));
    if patch.sides() == 3 {
        return 2.0 * patch.area();
    }
    let d = patch.corner(3);
    let along_u = (b - a) * (1.0 - v) + (c - d) * v;
    let along_v = (d - a) * (1.0 - u) + (c - b) * u;
    along_u.cross(along_v).dot(patch.normal())
}

/// A_i F_ij (m²) by one order on both patches; `a` and `b` are points with weights, `na` and `nb` the normals.
#[must_use]
pub fn double_area(a: &[(Vec3, f64)], na: Vec3, b: &[(Vec3, f64)], nb: Vec3) -> f64 {
    let mut sum = 0.0;
    for &(p, wp) in a {
        let mut inner = 0.0;
        for &(q, wq) in b {
            let d = q - p;
            let r2 = d.length_squared();
            inner += wq * (d.dot(na) * -d.dot(nb)) / (r2 * r2);
        }
        sum += wp * inner;
    }
    sum * FRAC_1_PI
}

/// Raises the order until two of them agree to `tolerance` (m², absolute); `None` where [`MAX_ORDER`] does not.
#[must_use]
pub fn area_gauss(a: (&Patch, &PatchPoints), b: (&Patch, &PatchPoints), tolerance: f64) -> Option<Estimate> {
    let value = |n: usize| double_area(a.1.order(n), a.0.normal(), b.1.order(n), b.0.normal());
    let (mut lower, mut last_step) = (value(1), f64::INFINITY);
    for order in 2..=MAX_ORDER {
        let higher = value(order);
        let step = (higher - lower).abs();
        // A step may be small by accident; the one before it bounds how small it can credibly be.
        let error = step.max(CREDIBLE * last_step);
        if error <= tolerance {
            return Some(Estimate { value: higher, error });
        }
        (lower, last_step) = (higher, step);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_the_area() {
        let quad = [Vec3::ZERO, Vec3::X * 2.0, Vec3::new(1.5, 1.0, 0.0), Vec3::Y].map(|p| p + Vec3::Z);
        let quad = Patch::quad(quad).unwrap().unwrap();
        let triangle = Patch::triangle([Vec3::ZERO, Vec3::X, Vec3::new(0.2, 0.0, 0.9)]).unwrap();
        for patch in [quad, triangle] {
            for order in 1..=MAX_ORDER {
                let sum: f64 = place(&patch, order).iter().map(|p| p.1).sum();
                assert!((sum - patch.area()).abs() < 1e-14, "order {order}: {sum}");
            }
        }
    }

    #[test]
    fn parallel_squares_converge_geometrically() {
        let v = |x, y, z| Vec3::new(x, y, z);
        let a = Patch::quad([v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)]).unwrap().unwrap();
        let b = Patch::quad([v(0., 1., 1.), v(1., 1., 1.), v(1., 0., 1.), v(0., 0., 1.)]).unwrap().unwrap();
        let error = |n: usize| {
            let value = double_area(&place(&a, n), a.normal(), &place(&b, n), b.normal());
            (value - 0.199_824_895_698_388).abs()
        };
        assert!((2..=MAX_ORDER).all(|n| error(n) < 0.25 * error(n - 1)));
        assert!(error(MAX_ORDER) < 1e-5);
    }
}
