//! Polygon to polygon as a contour integral: A_i F_ij = (1/2π) Σₑ Σ_f (dₑ·d_f) ∫ₑ∫_f ln r ds dt.
//!
//! Stokes' theorem twice; E. M. Sparrow 1963, doi:10.1115/1.3686055; J.-F. Viennot's thesis, eq.
//! 1.41. In m². Both polygons must lie in front of each other and be counter-clockwise about their
//! normals. The inner integral is closed. So is the outer one for edges that are parallel, and for
//! edges in one plane, as all that touch are. Others take as many Gauss points as a proven bound
//! asks for.

mod coplanar;
mod edge;
mod gauss;
mod parallel;

use coplanar::coplanar;
pub(crate) use edge::{Edge, ROUNDING, log_integral, rounding};
use fredholm_mesh::Vec3;
use fredholm_quadrature::Estimate;
use gauss::Outer;
use parallel::parallel;
use std::f64::consts::TAU;

/// Error of a closed form, over the rounding of the inner integrals alone, at which it is used: its
/// terms grow with the distance and cancel; quadrature of the inner integral does not.
const MOST_CANCELLATION: f64 = 50.0;
/// Gauss points up to which they cost less than a closed form.
const MOST_CHEAP_GAUSS_POINTS: usize = 6;

/// A_i F_ij (m²) between two polygons given by their corners, to an absolute `tolerance` (m²) as
/// far as rounding lets it.
///
/// ```
/// use fredholm_coupling::form_factor::contour_integral;
/// use fredholm_mesh::Vec3;
/// let v = |x, y, z| Vec3::new(x, y, z);
/// let floor = [v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)];
/// let wall = [v(0., 0., 0.), v(0., 1., 0.), v(0., 1., 1.), v(0., 0., 1.)];
/// let shared_edge = contour_integral(&floor, &wall, 1e-14);
/// assert!((shared_edge.value - 0.200_043_776_075_403).abs() < 1e-14);
/// ```
#[must_use]
pub fn contour_integral(a: &[Vec3], b: &[Vec3], tolerance: f64) -> Estimate {
    over_edges(a, b, tolerance, edge_pair)
}

/// The double sum over the edges of both polygons, in m²; `pair` computes (dₑ·d_f) ∫∫ ln r ds dt to
/// its share of the tolerance, in the pair's own unit of length.
pub(crate) fn over_edges(
    a: &[Vec3],
    b: &[Vec3],
    tolerance: f64,
    pair: impl Fn(Edge, Edge, f64) -> Estimate,
) -> Estimate {
    let Some(&origin) = a.first() else { return Estimate::default() };
    let unit = unit_of_length(origin, a, b);
    let share = tolerance * TAU / (unit * unit * (a.len() * b.len()).max(1) as f64);
    let mut sum = Estimate::default();
    for e in edges(a, origin, unit) {
        for f in edges(b, origin, unit) {
            sum = sum + pair(e, f, share);
        }
    }
    let scale = unit * unit / TAU;
    Estimate { value: sum.value * scale, error: sum.error * scale }
}

/// A typical distance. Lengths are measured in it: a constant added to ln r integrates to 0 round a
/// closed contour, but its rounding does not.
fn unit_of_length(origin: Vec3, a: &[Vec3], b: &[Vec3]) -> f64 {
    let far = a.iter().chain(b).map(|x| x.distance(origin)).fold(0.0, f64::max);
    if far > 0.0 { 0.5 * far } else { 1.0 }
}

/// The edges seen from `origin`, so that points on them do not carry the rounding of a far place.
fn edges(corners: &[Vec3], origin: Vec3, unit: f64) -> impl Iterator<Item = Edge> {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.filter_map(move |(&p, &q)| {
        let (side, length) = (q - p, (q - p).length());
        (length > 0.0).then(|| Edge {
            start: (p - origin) / unit,
            direction: side / length,
            length: length / unit,
        })
    })
}

/// (dₑ·d_f) ∫∫ ln r ds dt.
pub(crate) fn edge_pair(e: Edge, f: Edge, tolerance: f64) -> Estimate {
    let cosine = e.direction.dot(f.direction);
    if cosine.abs() <= f64::EPSILON {
        return Estimate::default();
    }
    // A point of the longer edge is rounded by more of the shorter one.
    let (e, f) = if e.length <= f.length { (e, f) } else { (f, e) };
    let rounding = rounding(e, f);
    // Below rounding two values never agree, however short the interval.
    let goal = tolerance.max(rounding);
    let sine2 = e.direction.cross(f.direction).length_squared();
    let outer = Outer::new(e, f, goal);
    let closed = if outer.points > MOST_CHEAP_GAUSS_POINTS {
        closed(e, f, goal.max(MOST_CANCELLATION * rounding))
    } else {
        None
    };
    let sum = closed.unwrap_or_else(|| outer.integrate(goal, sine2));
    Estimate { value: cosine * sum.value, error: cosine.abs() * (sum.error + rounding) }
}

/// The closed form for parallel edges or for edges in one plane, if its error is at most `goal`.
fn closed(e: Edge, f: Edge, goal: f64) -> Option<Estimate> {
    let [sine, cosine] = [e.direction.cross(f.direction).length(), e.direction.dot(f.direction)];
    let met = |closed: &Estimate| closed.error <= goal;
    Some(parallel(e, f, cosine.signum(), sine)).filter(met).or_else(|| coplanar(e, f).filter(met))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    #[test]
    fn a_turned_copy_of_both_polygons_changes_nothing() {
        let a = [v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)];
        let b = [v(0.3, 1., 1.), v(1.2, 0.9, 1.), v(1., 0., 1.), v(0., 0., 1.)];
        let turn = glam_rotation();
        let plain = contour_integral(&a, &b, 1e-14);
        let turned = contour_integral(&a.map(&turn), &b.map(&turn), 1e-14);
        assert!((plain.value - turned.value).abs() < 1e-13);
    }

    fn glam_rotation() -> impl Fn(Vec3) -> Vec3 {
        let (x, y) = (v(0.6, 0.8, 0.0), v(-0.8, 0.6, 0.0));
        move |p| x * p.x + y * p.y + Vec3::Z * p.z + v(3.0, -2.0, 5.0)
    }

    #[test]
    fn skew_touching_edges_converge_and_are_reciprocal() {
        let a = [v(0., 0., 0.), v(1., 0., 0.), v(0.3, 0.8, 0.)];
        let b = [v(0., 0., 0.), v(0.2, 0.5, 0.9), v(1., 0., 0.)];
        let (ab, ba) = (contour_integral(&a, &b, 1e-13), contour_integral(&b, &a, 1e-13));
        assert!(ab.value > 0.0 && (ab.value - ba.value).abs() < 2e-13, "{ab:?} {ba:?}");
    }
}
