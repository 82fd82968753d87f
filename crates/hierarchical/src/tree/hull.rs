//! The convex polygon of up to four corners that coplanar patches fill, where they do.
//!
//! A. M. Andrew, Inform. Process. Lett. 9 (1979) 216–219, doi:10.1016/0020-0190(79)90072-3, for the
//! convex hull. Patches that do not overlap fill their hull where their areas add up to that of the
//! hull. Lengths in metres.

use fredholm_mesh::{Patch, Vec3};

/// Relative difference of areas up to which the hull counts as filled, and of the doubled area of a
/// corner's triangle up to which it is none.
const AREA_TOLERANCE: f64 = 1e-9;

/// Tangent of the angle between a side and the order of corners: no simple number.
const ORDER_TANGENT: f64 = 0.412_7;

/// A point in the plane and in space.
type Corner = ([f64; 2], Vec3);

/// The hull of patches in one plane that face as the first does, if it has at most four corners and
/// they fill it.
pub(super) fn filled(patches: &[&Patch]) -> Option<Patch> {
    let area: f64 = patches.iter().map(|patch| patch.area()).sum();
    let corners = hull(&plane_corners(patches), area);
    let patch = match *corners.as_slice() {
        [a, b, c] => Patch::triangle([a, b, c]).ok()?,
        [a, b, c, d] => Patch::quad([a, b, c, d]).ok()??,
        _ => return None,
    };
    ((patch.area() - area).abs() <= AREA_TOLERANCE * area).then_some(patch)
}

/// The corners in coordinates of the plane, sorted.
fn plane_corners(patches: &[&Patch]) -> Vec<Corner> {
    let (n, origin) = (patches[0].normal(), patches[0].corner(0));
    let side = (patches[0].corner(1) - origin).normalize();
    // Askew to the sides: of corners on a side across the order, rounding would decide which is the
    // first.
    let u = (side + n.cross(side) * ORDER_TANGENT).normalize();
    let v = n.cross(u);
    let flat = |x: &Vec3| ([(*x - origin).dot(u), (*x - origin).dot(v)], *x);
    let mut corners: Vec<Corner> =
        patches.iter().flat_map(|patch| patch.corners().iter().map(flat)).collect();
    corners.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    corners
}

/// The corners of the convex hull, counter-clockwise; those nearly on a side are left out.
fn hull(corners: &[Corner], area: f64) -> Vec<Vec3> {
    let least = AREA_TOLERANCE * area;
    let mut lower = half(corners.iter().copied(), least);
    let mut upper = half(corners.iter().rev().copied(), least);
    lower.pop();
    upper.pop();
    lower.into_iter().chain(upper).map(|(_, x)| x).collect()
}

fn half(corners: impl Iterator<Item = Corner>, least: f64) -> Vec<Corner> {
    let mut kept: Vec<Corner> = Vec::new();
    for corner in corners {
        while kept.len() >= 2 && turn(kept[kept.len() - 2].0, kept[kept.len() - 1].0, corner.0) <= least {
            kept.pop();
        }
        kept.push(corner);
    }
    kept
}

/// Doubled area of a triangle, positive where it runs counter-clockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(x: f64, y: f64) -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(x, y, 3.0 + 0.1 * x);
        let corners = [corner(x, y), corner(x + 0.1, y), corner(x + 0.1, y + 0.3), corner(x, y + 0.3)];
        Patch::quad(corners).unwrap().unwrap()
    }

    #[test]
    fn cells_of_a_grid_fill_a_rectangle() {
        let cells: Vec<Patch> =
            (0..12).map(|k| cell(0.1 * f64::from(k % 4), 0.3 * f64::from(k / 4))).collect();
        let list: Vec<&Patch> = cells.iter().collect();
        let whole = filled(&list).unwrap();
        assert!((whole.area() - 12.0 * cells[0].area()).abs() < 1e-12);
        assert!(whole.normal().dot(cells[0].normal()) > 1.0 - 1e-12);
        assert!(filled(&list[..11]).is_none(), "a corner is missing");
        assert!(filled(&[&cells[0], &cells[2]]).is_none(), "there is a gap");
    }

    #[test]
    fn two_triangles_fill_a_square() {
        let (a, b, c, d) = (Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y);
        let halves = [Patch::triangle([a, b, c]).unwrap(), Patch::triangle([a, c, d]).unwrap()];
        assert_eq!(filled(&[&halves[0], &halves[1]]).unwrap().sides(), 4);
    }
}
