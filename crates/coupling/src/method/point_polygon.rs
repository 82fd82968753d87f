//! Point to polygon inside, adaptive outside: A_i F_ij = ∫_i F(p → j) dA, F(p → j) Lambert's closed
//! form.
//!
//! Inner integral: see [`point_to_polygon`]. In m². The outer integral goes over the patch of the
//! smaller diameter, cut where the error is largest (R. Piessens et al., *QUADPACK*, 1983, section
//! 2.2.3). Where j is close, F(p → j) has layers along the projection of its edges and no limit at
//! corners that touch: then the patch is cut along these projections (`pieces`) and graded towards
//! the cuts (`graded`). With occluders between, what the point sees is cut out exactly; see
//! [`PairIntegrator`].

use super::facing::{Facing, Part, fan};
use super::graded::graded;
use super::pieces::pieces;
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use crate::form_factor::{PairIntegrator, Workspace, facing_exchange, jacobian, point_to_polygon};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{
    Estimate, Goal, adaptive_quad, adaptive_triangle, collapsed_triangle, tensor_quad,
};
use fredholm_visibility::Occluders;
use std::cell::Cell;

/// Points a direction of the rule on a cell of patches that are apart, and on a graded one.
const POINTS: usize = 6;
const POINTS_CLOSE: usize = 10;
/// Distance, in radii of the outer part, below which layers are looked for.
const LAYER_DISTANCE: f64 = 0.4;
/// Most cells that are cut.
const MOST_CUTS: usize = 4000;
/// Stated error over the difference that one more cut makes, which may be small by accident.
const SAFETY: f64 = 10.0;
/// Rounding of Lambert's sum for a point at unit distance.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

pub(super) struct PointPolygon;

impl FormFactorMethod for PointPolygon {
    fn name(&self) -> &'static str {
        "point-polygon"
    }

    fn summary(&self) -> &'static str {
        "Lambert's closed form from points to the polygon, adaptive over the points"
    }

    fn convergent(&self) -> bool {
        true
    }

    fn default_setting(&self) -> Setting {
        Setting::Tolerance(1e-6)
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        let tolerance = setting.tolerance(self.name())?;
        let Some(facing) = Facing::new(a, b, occluders) else { return Ok(Evaluated::default()) };
        if facing.between() > 0 {
            return Ok(shadowed([a, b], occluders, tolerance));
        }
        Ok(if a.diameter() <= b.diameter() {
            open(&facing.a, &facing.b, tolerance * facing_exchange(a, b))
        } else {
            open(&facing.b, &facing.a, tolerance * facing_exchange(a, b))
        })
    }
}

/// ∫ over `outer` of the factors to `target`, to an absolute tolerance in m².
fn open(outer: &Part, target: &Part, tolerance: f64) -> Evaluated {
    let evaluations = Cell::new(0);
    let seen = |p: Vec3| {
        evaluations.set(evaluations.get() + 1);
        point_to_polygon(outer.normal, target.corners.iter().map(|&x| x - p))
    };
    let rounding = ROUNDING * outer.area();
    let tolerance = tolerance.max(rounding) / SAFETY;
    let sum = if is_close(outer, target) {
        let triangles: Vec<_> = pieces(outer, target).iter().flat_map(|piece| fan(piece)).collect();
        let rule = tensor_quad(POINTS_CLOSE);
        total(&triangles, tolerance, |triangle, goal| graded(triangle, &rule, goal, seen))
    } else {
        total(&outer.cells, tolerance, |cell, goal| over_cell(cell, goal, seen))
    };
    Evaluated::new(Estimate { error: SAFETY * sum.error + rounding, ..sum }, evaluations.get())
}

/// Whether points of both parts may be so close that the factor varies over a small part of the
/// outer one.
fn is_close(outer: &Part, target: &Part) -> bool {
    let gap = outer.centroid().distance(target.centroid()) - outer.radius() - target.radius();
    gap.max(outer.clearance(target)).max(target.clearance(outer)) < LAYER_DISTANCE * outer.radius()
}

/// The sum over all cells, each with an even share of the tolerance.
fn total(cells: &[Patch], tolerance: f64, integral: impl Fn(&Patch, Goal) -> Estimate) -> Estimate {
    let goal = Goal { tolerance: tolerance / cells.len() as f64, cuts: MOST_CUTS };
    cells.iter().map(|cell| integral(cell, goal)).fold(Estimate::default(), |a, b| a + b)
}

fn over_cell(cell: &Patch, goal: Goal, seen: impl Fn(Vec3) -> f64) -> Estimate {
    let integrand = |u: f64, v: f64| jacobian(cell, u, v) * seen(cell.point(u, v));
    if cell.sides() == 3 {
        adaptive_triangle(&collapsed_triangle(POINTS), goal, integrand)
    } else {
        adaptive_quad(&tensor_quad(POINTS), goal, integrand)
    }
}

/// The same behind occluders, by exact shadows.
fn shadowed(pair: [&Patch; 2], occluders: &Occluders, tolerance: f64) -> Evaluated {
    let integrator = PairIntegrator::new(pair, occluders, tolerance).without_sampling();
    let got = integrator.exchange(0, 1, &mut Workspace::default());
    Evaluated::new(Estimate { value: got.value, error: got.error }, 1)
}
