//! How the form factor varies over the two patches of an open pair, from a few points of each.
//!
//! A patch is five points: four of a quarter each and the centroid. Between points the kernel is
//! that of a disc, F(x) = cosθ cosθ' A/(π r² + A) with A a quarter of the larger patch: it stays
//! below 1 where patches touch. J. R. Wallace, K. A. Elmquist, E. A. Haines, SIGGRAPH 1989,
//! doi:10.1145/74334.74366. Points of close pairs see the other patch as it is.

use super::side::{POINTS, Points, Side};
use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;

/// Distance, over the mean diameter, below which a pair is close.
pub(crate) const CLOSE_DISTANCE: f64 = 1.5;
/// Least deviation over the larger patch of a close pair, and over a side of which no point sees
/// anything.
pub(super) const CLOSE_DEVIATION: f64 = 1.0;

/// How far inside a corner its factor is taken, over the distance from the centroid.
const CORNER_INSET: f64 = 0.1;
/// Share of a close patch that may see what one of its corners sees.
const CORNER_SHARE: f64 = 0.1;

/// What a pair exchanges when open, roughly, and how that varies over both patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    /// A_a F_ab, m².
    pub exchange: f64,
    /// Over a, over b.
    pub sides: [Side; 2],
}

/// Looks at an open pair.
pub(crate) fn spread(a: &Patch, b: &Patch, front: &mut Vec<Vec3>) -> Spread {
    let (xs, ys) = (Points::of(a), Points::of(b));
    if near(a, b) { close([a, b], [&xs, &ys], front) } else { far([a, b], [&xs, &ys]) }
}

/// Whether points of the larger patch are too coarse for the smaller one.
fn near(a: &Patch, b: &Patch) -> bool {
    a.centroid().distance(b.centroid()) < 0.5 * CLOSE_DISTANCE * (a.diameter() + b.diameter())
}

/// The points of each patch see the quarters of the other one.
fn far([a, b]: [&Patch; 2], [xs, ys]: [&Points; 2]) -> Spread {
    let quarter = 0.25 * a.area().max(b.area());
    let (mut from_a, mut from_b) = ([0.0; POINTS], [0.0; POINTS]);
    for (i, &x) in xs.at.iter().enumerate() {
        for (j, &y) in ys.at.iter().enumerate() {
            let density = disc([x, a.normal()], [y, b.normal()], quarter);
            from_a[i] += if j < POINTS - 1 { density } else { 0.0 };
            from_b[j] += if i < POINTS - 1 { density } else { 0.0 };
        }
    }
    let sides = [xs.side(&from_a), ys.side(&from_b)];
    Spread { exchange: sides[0].mean / (POINTS - 1) as f64 * a.area() * b.area(), sides }
}

/// Points see the other patch as it is, and the larger one varies by as much as itself.
fn close([a, b]: [&Patch; 2], [xs, ys]: [&Points; 2], front: &mut Vec<Vec3>) -> Spread {
    let mut seen = |points: &Points, p: &Patch, q: &Patch| {
        let side = points.side(&points.at.map(|x| open_factor(x, p.normal(), q, front)));
        let inset = |x: &Vec3| x.lerp(points.at[POINTS - 1], CORNER_INSET);
        let corners = p.corners().iter().map(|x| open_factor(inset(x), p.normal(), q, front));
        (side, p.area() * side.mean.max(CORNER_SHARE * corners.fold(0.0, f64::max)))
    };
    let ((over_a, from_a), (over_b, from_b)) = (seen(xs, a, b), seen(ys, b, a));
    let (mut sides, exchange) = ([over_a, over_b], from_a.max(from_b));
    let larger = usize::from(a.area() <= b.area());
    for (k, side) in sides.iter_mut().enumerate() {
        // Points that see nothing do not tell what the rest sees.
        if k == larger || side.mean <= 0.0 {
            *side = side.at_least(CLOSE_DEVIATION);
        }
    }
    Spread { exchange, sides }
}

/// Form factor from a point with its normal to the part of a patch above its horizon.
pub(crate) fn open_factor(x: Vec3, normal: Vec3, to: &Patch, front: &mut Vec<Vec3>) -> f64 {
    front.clear();
    if (x - to.corner(0)).dot(to.normal()) <= 0.0 {
        return 0.0;
    }
    clip(to.corners(), HalfSpace::through(x, normal), 0.0, front);
    point_to_polygon(normal, front.iter().map(|&y| y - x)).max(0.0)
}

/// Form factor over area, 1/m², between a point and a disc of some area, both with their normals.
pub(super) fn disc([x, nx]: [Vec3; 2], [y, ny]: [Vec3; 2], area: f64) -> f64 {
    let line = y - x;
    let r2 = line.length_squared();
    let cosines = line.dot(nx).max(0.0) * (-line.dot(ny)).max(0.0);
    if r2 > 0.0 { cosines / (r2 * (PI * r2 + area)) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, half: f64, up: bool) -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(half * x, half * y, z);
        let corners = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        let patch = Patch::quad(corners).unwrap().unwrap();
        if up { patch } else { patch.flipped() }
    }

    fn look(a: &Patch, b: &Patch) -> Spread {
        spread(a, b, &mut Vec::new())
    }

    #[test]
    fn far_squares_exchange_as_points_do_and_hardly_vary() {
        let found = look(&square(0.0, 0.5, true), &square(100.0, 0.5, false));
        assert!((found.exchange * PI * 1e4 - 1.0).abs() < 1e-3, "{found:?}");
        assert!(found.sides.iter().all(|side| side.deviation < 1e-3), "{found:?}");
    }

    #[test]
    fn a_square_at_right_angles_varies_as_its_height() {
        // Far away the factor is proportional to the height over the other plane: a deviation of
        // 1/√3, all of it a gradient of 2 a metre.
        let corner = |y: f64, z: f64| Vec3::new(100.0, y, z);
        let wall = Patch::quad([corner(-0.5, 0.), corner(-0.5, 1.), corner(0.5, 1.), corner(0.5, 0.)]);
        let found = look(&square(0.0, 0.5, true), &wall.unwrap().unwrap());
        let [floor, wall] = found.sides;
        assert!((wall.deviation * 3f64.sqrt() - 1.0).abs() < 1e-2, "{found:?}");
        assert!((wall.gradient - Vec3::Z * 2.0).length() < 1e-3 && wall.rest < 1e-3, "{found:?}");
        assert!(floor.deviation < 2e-2, "{found:?}");
    }

    #[test]
    fn close_squares_are_seen_as_they_are() {
        // Unit squares at distance 1: 0.1998, Howell's catalogue C-11.
        let found = look(&square(0.0, 0.5, true), &square(1.0, 0.5, false));
        assert!((found.exchange - 0.199_824_895_698_388).abs() < 1e-2, "{found:?}");
    }

    #[test]
    fn what_only_a_corner_sees_is_noticed() {
        // A strip of a twentieth of the floor lies in front of the wall.
        let floor = square(0.0, 0.5, true);
        let corner = |y: f64, z: f64| Vec3::new(0.45, y, z);
        let wall = Patch::quad([corner(-0.5, 0.), corner(0.5, 0.), corner(0.5, 1.), corner(-0.5, 1.)]);
        let wall = wall.unwrap().unwrap();
        let found = look(&floor, &wall);
        assert!(found.exchange > 0.01 && found.sides.iter().all(|side| side.rest >= 1.0), "{found:?}");
    }

    #[test]
    fn nothing_is_exchanged_back_to_back() {
        assert!(look(&square(0.0, 0.5, false), &square(9.0, 0.5, true)).exchange == 0.0);
    }
}
