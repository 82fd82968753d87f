//! Double area integral: A_i F_ij ≈ Σ_k Σ_l w_k w_l cosθ_k cosθ_l V_kl / (π r_kl²), n × n Gauss
//! points on both patches.
//!
//! J.-F. Viennot's thesis, eq. 1.39. In m². Where the patches share corners the kernel jumps there;
//! the rules of S. A. Sauter & C. Schwab (2011, section 5.2) for triangles with a common corner or
//! edge make it analytic. So the error falls geometrically with n for patches that are apart or
//! share whole edges; the closer they come without touching, the slower. Where they touch otherwise
//! (part of an edge), or something stands between, it falls algebraically.

use super::facing::Facing;
use super::orders::{cost, placed, settled};
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{PairPoint, triangle_pair};
use fredholm_visibility::Occluders;

/// Highest order: 64⁴ point pairs.
const HIGHEST_ORDER: usize = 64;
/// Corners closer than this part of the extent are one.
const SAME_CORNER_DISTANCE: f64 = 1e-12;

pub(super) struct AreaGauss;

impl FormFactorMethod for AreaGauss {
    fn name(&self) -> &'static str {
        "area-gauss"
    }

    fn summary(&self) -> &'static str {
        "n × n Gauss points on both patches, singular rules where they share corners"
    }

    fn convergent(&self) -> bool {
        true
    }

    fn default_setting(&self) -> Setting {
        Setting::Order(8)
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        let order = setting.order(self.name(), HIGHEST_ORDER)?;
        let Some(facing) = Facing::new(a, b, occluders) else { return Ok(Evaluated::default()) };
        let touching = touching_pairs(&facing);
        if touching.iter().all(|pair| pair.labels.is_none()) {
            let cells = (facing.a.cells.len() * facing.b.cells.len()) as u64;
            let estimate = settled(order, facing.between() > 0, |n| tensor(&facing, n));
            return Ok(facing.evaluated(estimate, cells * cost(order, 4)));
        }
        let pieces: u64 = touching.iter().map(TrianglePair::pieces).sum();
        let estimate = settled(order, facing.between() > 0, |n| {
            touching.iter().map(|pair| pair.integral(&facing, n)).sum()
        });
        Ok(facing.evaluated(estimate, pieces * cost(order, 4)))
    }
}

/// The double sum of order n over all cells of both parts, m².
pub(super) fn tensor(facing: &Facing, n: usize) -> f64 {
    let (a, b) = (placed(&facing.a.cells, n), placed(&facing.b.cells, n));
    let inner = |p: Vec3| b.iter().map(|&(q, weight)| weight * facing.kernel(p, q)).sum::<f64>();
    a.iter().map(|&(p, weight)| weight * inner(p)).sum()
}

/// Two triangles with labels that are equal where corners are; no labels where there are no such
/// corners.
struct TrianglePair {
    triangles: [Patch; 2],
    labels: Option<[[usize; 3]; 2]>,
}

/// All pairs of triangles of both parts.
fn touching_pairs(facing: &Facing) -> Vec<TrianglePair> {
    let (first, second) = (facing.a.triangles(), facing.b.triangles());
    let reach = SAME_CORNER_DISTANCE * facing.extent();
    let pairs = first.iter().flat_map(|a| second.iter().map(move |b| [*a, *b]));
    pairs.map(|triangles| TrianglePair { labels: labels(&triangles, reach), triangles }).collect()
}

/// Labels 0, 1, 2 for the first triangle; a corner of the second has that of the corner it lies on,
/// or one of its own.
fn labels([a, b]: &[Patch; 2], reach: f64) -> Option<[[usize; 3]; 2]> {
    let on = |k: usize| a.corners().iter().position(|x| x.distance(b.corner(k)) <= reach);
    let second = [0, 1, 2].map(|k| on(k).unwrap_or(3 + k));
    second.iter().any(|&label| label < 3).then_some([[0, 1, 2], second])
}

impl TrianglePair {
    fn rule(&self, n: usize) -> Vec<PairPoint> {
        let [first, second] = self.labels.unwrap_or([[0, 1, 2], [3, 4, 5]]);
        triangle_pair(first, second, n)
    }

    /// Points over n⁴.
    fn pieces(&self) -> u64 {
        self.rule(1).len() as u64
    }

    fn integral(&self, facing: &Facing, n: usize) -> f64 {
        let [a, b] = &self.triangles;
        let term = |x: &PairPoint| x.weight * facing.kernel(a.point(x.x[0], x.x[1]), b.point(x.y[0], x.y[1]));
        4.0 * a.area() * b.area() * self.rule(n).iter().map(term).sum::<f64>()
    }
}
