//! Planes through an edge of one convex polygon that leave both it and another polygon on one side.
//!
//! Around the line of an edge of P every point has an angle, counted from the inside of P towards
//! its lit side. Where Q lies in front of P, the corner of Q with the largest angle θ ≤ π spans,
//! with the edge, a plane that has P (angle 0) and all of Q (angles 0 to θ) on one side. With the
//! coordinates x = (w − p)·m and z = (w − p)·n of a corner w of Q, where p starts the edge e, n is
//! the normal of P and m = n × e points into P, the normal of that plane is N = z m − x n.
//!
//! Reference: E. A. Haines, J. R. Wallace, "Shaft culling for efficient ray-cast radiosity", in:
//! Photorealistic Rendering in Computer Graphics, Springer 1994, 122–138,
//! [doi:10.1007/978-3-642-57963-9_12](https://doi.org/10.1007/978-3-642-57963-9_12).

use fredholm_mesh::Vec3;

use super::HalfSpace;
use super::half_space::norm1;
use super::outline::Outline;

/// An edge, or the distance of a corner from the edge, that is shorter than this many tolerances
/// points nowhere for sure. Such a plane is left out, which only makes the shaft larger.
const LEAST_TOLERANCES: f64 = 1e3;

/// Hands the supporting plane of every edge of `polygon` to `found`. All the `others` lie in front
/// of the polygon.
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
        let area = x_last * z - z_last * x;
        // Corners at the angles 0 and π span no area.
        let wider = area > 0.0 || (area >= 0.0 && x < x_last);
        if off_the_edge && (!any || wider) {
            (x_last, z_last, any) = (x, z, true);
        }
    }
    let normal = z_last * m - x_last * n;
    let sure = length > LEAST_TOLERANCES * tolerance && norm1(normal) > LEAST_TOLERANCES * tolerance * length;
    (any && sure).then(|| HalfSpace { normal, offset: normal.dot(start) })
}

#[cfg(test)]
mod tests {
    use crate::Occluders;
    use crate::body::Bodies;
    use fredholm_mesh::{Patch, Vec3};

    fn quad(corners: [[f64; 3]; 4]) -> Patch {
        Patch::quad(corners.map(Vec3::from)).unwrap().unwrap()
    }

    /// The wall stands in the plane of the floor's first side: seen from an edge of the wall, that
    /// side lies at the angles 0 and π.
    #[test]
    fn a_screen_before_a_floor_that_ends_under_a_wall_is_in_the_shaft() {
        let floor = quad([[2.0, 8.5, 0.0], [4.0, 8.5, 0.0], [4.0, 10.0, 0.0], [2.0, 10.0, 0.0]]);
        let wall = quad([[1.0, 8.5, 0.5], [1.0, 8.5, 1.5], [2.75, 8.5, 1.5], [2.75, 8.5, 0.5]]);
        let screen = quad([[3.5, 8.0, 0.0], [3.5, 9.0, 0.0], [3.5, 9.0, 1.5], [3.5, 8.0, 1.5]]);
        let occluders = Occluders::new(&[screen]).unwrap();
        let bodies = Bodies::new(&occluders, &[&floor, &wall], &[]);
        let shaft = occluders.shaft_between(&floor, &wall).unwrap();
        assert!(occluders.reaches(&bodies.as_slice()[0], &shaft));
    }
}
