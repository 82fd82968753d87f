//! Polygon to polygon in closed form: A_i F_ij = (1/2π) Σₑ Σ_f (dₑ·d_f) ∫ₑ∫_f ln r ds dt with every
//! double integral closed.
//!
//! P. Schröder & P. Hanrahan, "On the form factor between two polygons", SIGGRAPH 1993,
//! doi:10.1145/166117.166138. In m². Skew and intersecting edges: see `skew_edges`; parallel ones:
//! the closed form that the contour method uses too. Where the closed form of a pair of edges loses
//! more than ten times what bisection loses (nearly parallel, or short and far), that pair alone
//! has its outer integral bisected to rounding. The stated error is rounding.

use super::facing::Facing;
use super::skew_edges::skew_edges;
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use crate::form_factor::contour::{Edge, edge_pair, over_edges, rounding};
use fredholm_mesh::Patch;
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;

/// Squared sine of the angle under which edges count as parallel.
const PARALLEL_SQUARED_SINE: f64 = 1e-28;

/// Rounding of the closed form over that of bisection, up to which it is used.
const MOST_ROUNDING_LOSS: f64 = 10.0;

pub(super) struct SchroederHanrahan;

impl FormFactorMethod for SchroederHanrahan {
    fn name(&self) -> &'static str {
        "schroeder-hanrahan"
    }

    fn summary(&self) -> &'static str {
        "closed form polygon to polygon, with complex dilogarithms"
    }

    fn convergent(&self) -> bool {
        true
    }

    fn default_setting(&self) -> Setting {
        Setting::Fixed
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        setting.fixed(self.name())?;
        let Some(facing) = Facing::new(a, b, occluders) else { return Ok(Evaluated::default()) };
        if facing.between() > 0 {
            return Err(MethodError::Occluded { method: self.name() });
        }
        let pairs = (facing.a.corners.len() * facing.b.corners.len()) as u64;
        Ok(Evaluated::new(over_edges(&facing.a.corners, &facing.b.corners, 0.0, closed), pairs))
    }
}

/// (dₑ·d_f) ∫∫ ln r ds dt.
fn closed(e: Edge, f: Edge, tolerance: f64) -> Estimate {
    let cosine = e.direction.dot(f.direction);
    if cosine.abs() <= f64::EPSILON {
        return Estimate::default();
    }
    let rounding = rounding(e, f);
    if e.direction.cross(f.direction).length_squared() > PARALLEL_SQUARED_SINE {
        let skew = skew_edges(e, f);
        if skew.error <= MOST_ROUNDING_LOSS * rounding {
            return Estimate { value: cosine * skew.value, error: cosine.abs() * (skew.error + rounding) };
        }
    }
    edge_pair(e, f, tolerance)
}
