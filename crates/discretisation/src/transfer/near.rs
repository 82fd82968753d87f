//! Points on an element graded towards a point p close to it or on it, in the element's parameters.
//!
//! The domain is cut into triangles, and each gets the nearly singular rule of [`near_triangle`],
//! which collapses it towards its point closest to p. On the element of p itself that is p's own
//! parameters; elsewhere the closest point of the flat triangle through the corners, which grades
//! well enough.

use crate::{Chart, Site};
use fredholm_quadrature::{PlanePoint, near_triangle};

type Corner = [f64; 2];

/// The triangles that a domain is cut into, by their corners.
fn triangles(sides: usize) -> &'static [[Corner; 3]] {
    const HALVES: [[Corner; 3]; 2] =
        [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[1.0, 1.0], [0.0, 1.0], [1.0, 0.0]]];
    if sides == 3 { &HALVES[..1] } else { &HALVES }
}

/// The graded rule for the domain of `chart` (element `j`) seen from `p`; weights sum to about the
/// measure of the domain.
pub(super) fn graded(chart: &dyn Chart, j: usize, p: &Site, n: usize) -> Vec<PlanePoint> {
    let mut points = Vec::new();
    for corners in triangles(chart.sides()) {
        let ([a, b, c], x) = if p.element == j { own(chart, corners, p) } else { seen(chart, corners, p) };
        let [[u0, v0], [u1, v1], [u2, v2]] = *corners;
        points.extend(near_triangle([a, b, c], x, n).into_iter().map(|s| PlanePoint {
            u: u0 + s.u * (u1 - u0) + s.v * (u2 - u0),
            v: v0 + s.u * (v1 - v0) + s.v * (v2 - v0),
            weight: s.weight,
        }));
    }
    points
}

/// Corners and p in the plane of the parameters, stretched to the lengths on the surface.
fn own(chart: &dyn Chart, corners: &[Corner; 3], p: &Site) -> ([[f64; 3]; 3], [f64; 3]) {
    let step = 1e-4;
    let length = |du: f64, dv: f64| chart.position(p.u + du, p.v + dv).distance(p.position) / step;
    let (along_u, along_v) = (length(step, 0.0), length(0.0, step));
    let put = |u: f64, v: f64| [u * along_u, v * along_v, 0.0];
    (corners.map(|[u, v]| put(u, v)), put(p.u, p.v))
}

fn seen(chart: &dyn Chart, corners: &[Corner; 3], p: &Site) -> ([[f64; 3]; 3], [f64; 3]) {
    (corners.map(|[u, v]| chart.position(u, v).to_array()), p.position.to_array())
}
