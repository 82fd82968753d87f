//! Planes through an edge of one convex polygon that leave both it and another polygon on one side.
//!
//! Around the line of an edge of P every point has an angle, counted from the inside of P towards its lit side. Where
//! Q lies in front of P, the corner of Q with the largest angle θ ≤ π spans, with the edge, a plane that has P
//! (angle 0) and all of Q (angles 0 to θ) on one side. With the coordinates x = (w − p)·m and z = (w − p)·n of a corner
//! w of Q, where p starts the edge e, n is the normal of P and m = n × e points into P, the normal of that plane is
//! N = z m − x n.
//!
//! Reference: E. A. Haines, J. R. Wallace, "Shaft culling for efficient ray-cast radiosity", in: Photorealistic
//! Rendering in Computer Graphics, Springer 1994, 122–138,
//! [doi:10.1007/978-3-642-57963-9_12](https://doi.org/10.1007/978-3-642-57963-9_12).

use fredholm_mesh::Vec3;

use super::HalfSpace;
use super::half_space::norm1;
use super::outline::Outline;

/// An edge, or the distance of a corner from the edge, that is shorter than this many tolerances points nowhere for
/// sure. Such a plane is left out, which only makes the shaft larger.
const SURE: f64 = 1e3;

/// Hands the supporting plane of every edge of `polygon` to `found`. All the `others` lie in front of the polygon.
pub(crate) fn supporting_planes(
    polygon: &Outline,
    others: &[Vec3],
    tolerance: f64,
    mut found: impl FnMut(HalfSpace),
) {
    let corners = polygon.corners();
    let mut start = corners[corners.len() - 1];
    for &end in corners {
        if let Some(plane) = supporting_plane(start, end - start, polygon.normal, others, tolerance) {
            found(plane);
        }
        start = end;
    }
}

fn supporting_plane(start: Vec3, edge: Vec3, n: Vec3, others: &[Vec3], tolerance: f64) -> Option<HalfSpace> {
    let (length, m) = (norm1(edge), n.cross(edge));
    let (mut x_last, mut z_last) = (0.0, 0.0);
    let mut any = false;
    for &w in others {
        let (x, z) = ((w - start).dot(m), (w - start).dot(n).max(0.0));
        let off_the_edge = z > tolerance || x.abs() > tolerance * length;
        if off_the_edge && (!any || x_last * z > z_last * x) {
            (x_last, z_last, any) = (x, z, true);
        }
    }
    let normal = z_last * m - x_last * n;
    let sure = length > SURE * tolerance && norm1(normal) > SURE * tolerance * length;
    (any && sure).then(|| HalfSpace { normal, offset: normal.dot(start) })
}
