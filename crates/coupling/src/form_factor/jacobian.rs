//! |∂x/∂u × ∂x/∂v| of the parametrisation of a patch, m²: the area that a point of the unit square or triangle stands for.

use fredholm_mesh::Patch;

/// The Jacobian at (u, v): bilinear on a quad, twice the area on a triangle.
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
