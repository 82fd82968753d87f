//! Nyström points: A_i F_ij ≈ A_i Σ_k w_k cosθ cosθ_k V_k / (π r_k²), quadrature points y_k of j
//! seen from the centroid of i.
//!
//! G. Peyré, *Équations intégrales et radiosité*, eq. 1.25–1.29: the method replaces the operator K
//! by Σ_k w_k k(x, y_k), and its matrix rows are points x, never means over a patch. What it means
//! for a pair is therefore the row of one point of i, here the centroid, times the area of i (m²).
//! With rising order this converges to A_i times the point's factor, not to A_i F_ij: the remaining
//! difference is that of collocation, of second order in the size of i. The stated error has both
//! parts. It is not reciprocal.

use super::area_gauss::tensor;
use super::facing::Facing;
use super::orders::{cost, placed, settled};
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use crate::form_factor::{contour_integral, point_to_polygon};
use fredholm_mesh::Patch;
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;

/// Highest order.
const HIGHEST_ORDER: usize = 64;
/// Points a direction on both patches for the difference between centroid and mean behind
/// occluders.
const POINTS_BEHIND_OCCLUDERS: usize = 6;

pub(super) struct Nystrom;

impl FormFactorMethod for Nystrom {
    fn name(&self) -> &'static str {
        "nystrom"
    }

    fn summary(&self) -> &'static str {
        "n × n Gauss points of the source, seen from the centroid of the receiver"
    }

    fn convergent(&self) -> bool {
        false
    }

    fn default_setting(&self) -> Setting {
        Setting::Order(4)
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
        let (p, area) = (facing.a.centroid(), facing.a.area());
        let row = |n| placed(&facing.b.cells, n).iter().map(|&(q, w)| w * facing.kernel(p, q)).sum::<f64>();
        let point = settled(order, facing.between() > 0, row);
        let error = area * point.error + collocation(&facing);
        let cells = facing.b.cells.len() as u64;
        Ok(facing.evaluated(Estimate { value: area * point.value, error }, cells * cost(order, 2)))
    }
}

/// Difference between A_i F_ij and the factor of the centroid times the area, m²: closed forms of
/// both where nothing is between, else Gauss points and their error.
pub(super) fn collocation(facing: &Facing) -> f64 {
    let (p, area) = (facing.a.centroid(), facing.a.area());
    if facing.between() > 0 {
        let target = placed(&facing.b.cells, POINTS_BEHIND_OCCLUDERS);
        let seen: f64 = target.iter().map(|&(q, weight)| weight * facing.kernel(p, q)).sum();
        let mean = settled(POINTS_BEHIND_OCCLUDERS, true, |n| tensor(facing, n));
        return (mean.value - area * seen).abs() + mean.error;
    }
    let exact = contour_integral(&facing.a.corners, &facing.b.corners, 0.0).value;
    let seen = point_to_polygon(facing.a.normal, facing.b.corners.iter().map(|&x| x - p));
    (exact - area * seen).abs()
}
