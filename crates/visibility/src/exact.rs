//! Does a line cross a convex polygon? Decided exactly.
//!
//! Seen along the line from p to q, the signed volume of the tetrahedron of p, q and the ends of an
//! edge says on which side of the directed edge the line passes. It crosses a triangle, outline
//! included, where no two of the three volumes have opposite signs. Signs are exact, and that of a
//! shared edge is the same for both its triangles, so that a line cannot slip between them.
//!
//! Reference: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust
//! geometric predicates", Discrete Comput. Geom. 18 (1997) 305–363,
//! [doi:10.1007/PL00009321](https://doi.org/10.1007/PL00009321).

use fredholm_mesh::Vec3;
use robust::{Coord3D, orient3d};

/// Whether the line through p and q crosses the polygon of three or four corners, outline included.
/// Four corners are two triangles that share the diagonal from the first. The line does not lie in
/// the plane of the polygon.
pub(crate) fn line_crosses(p: Vec3, q: Vec3, corners: &[Vec3]) -> bool {
    corners.windows(2).skip(1).any(|pair| crosses_triangle(p, q, [corners[0], pair[0], pair[1]]))
}

fn crosses_triangle(p: Vec3, q: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let volumes = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    volumes.iter().all(|&w| w >= 0.0) || volumes.iter().all(|&w| w <= 0.0)
}

/// Six times the signed volume; the sign is exact.
fn volume(p: Vec3, q: Vec3, a: Vec3, b: Vec3) -> f64 {
    let [p, q, a, b] = [p, q, a, b].map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
    orient3d(p, q, a, b)
}
