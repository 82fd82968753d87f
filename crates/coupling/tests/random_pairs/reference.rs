//! Form factors by other formulas than those of the crate.
//!
//! Outer integral: nested triangles, 4-point Gauss in both collapsed directions, split until a
//! triangle and its four parts agree. Inner integral: Lambert's sum with angles by arc cosine of
//! the unit directions where that is accurate, else by the chord; shadows by inclusion and
//! exclusion over all sets of occluders, each set an intersection of half-spaces.

use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;

/// The part of `a` in front of `b`.
pub fn front(a: &Patch, b: &Patch) -> Vec<Vec3> {
    cut(a.corners(), b.normal(), b.normal().dot(b.corner(0)))
}

/// The part of a convex polygon with n·x ≥ c.
fn cut(polygon: &[Vec3], n: Vec3, c: f64) -> Vec<Vec3> {
    let size = polygon.iter().map(|x| (*x - polygon[0]).length()).fold(0.0, f64::max);
    let flat = 1e-13 * n.length() * (size + polygon.first().map_or(0.0, |p| p.length()));
    let heights: Vec<f64> = polygon.iter().map(|x| n.dot(*x) - c).collect();
    let mut kept = Vec::new();
    if heights.iter().all(|&h| h <= flat) {
        return kept;
    }
    for (i, &x) in polygon.iter().enumerate() {
        let j = (i + 1) % polygon.len();
        if heights[i] >= -flat {
            kept.push(x);
        }
        if (heights[i] > flat && heights[j] < -flat) || (heights[i] < -flat && heights[j] > flat) {
            let share = heights[i] / (heights[i] - heights[j]);
            kept.push(x * (1.0 - share) + polygon[j] * share);
        }
    }
    kept
}

/// Form factor from the origin with normal `n` to a polygon that is counter-clockwise seen from it.
fn lambert(n: Vec3, polygon: &[Vec3]) -> f64 {
    let mut sum = 0.0;
    for (i, p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (u, v) = (p.normalize_or_zero(), q.normalize_or_zero());
        let normal = u.cross(v).normalize_or_zero();
        let chord = (u - v).length();
        let angle =
            if chord < 1.4 { 2.0 * (0.5 * chord).asin() } else { PI - 2.0 * (0.5 * (u + v).length()).asin() };
        sum += angle * normal.dot(n);
    }
    sum.abs() / (2.0 * PI)
}

/// What the point `p` with normal `n` sees of `target` behind the `occluders`.
pub fn seen(p: Vec3, n: Vec3, target: &[Vec3], facing: Vec3, occluders: &[Vec<Vec3>]) -> f64 {
    let target: Vec<Vec3> = target.iter().map(|&x| x - p).collect();
    let shadows: Vec<Vec<Vec3>> = occluders.iter().filter_map(|o| shadow(p, n, o, &target, facing)).collect();
    lambert(n, &target) + excluded(n, &target, &shadows, -1.0)
}

/// Σ over non-empty sets S of ± F(target ∩ shadows in S).
fn excluded(n: Vec3, region: &[Vec3], shadows: &[Vec<Vec3>], sign: f64) -> f64 {
    let mut sum = 0.0;
    for (k, planes) in shadows.iter().enumerate() {
        let part = planes
            .iter()
            .fold(region.to_vec(), |part, &m| if part.is_empty() { part } else { cut(&part, m, 0.0) });
        if part.len() >= 3 {
            sum += sign * lambert(n, &part) + excluded(n, &part, &shadows[k + 1..], -sign);
        }
    }
    sum
}

/// Planes through `p` that bound what an occluder hides.
fn shadow(p: Vec3, n: Vec3, occluder: &[Vec3], target: &[Vec3], facing: Vec3) -> Option<Vec<Vec3>> {
    let local: Vec<Vec3> = occluder.iter().map(|&x| x - p).collect();
    let above = cut(&local, n, 0.0);
    if above.len() < 3 {
        return None;
    }
    let between = cut(&above, facing, facing.dot(target[0]));
    if between.len() < 3 {
        return None;
    }
    let inside = between.iter().sum::<Vec3>();
    let planes = (0..between.len()).map(|k| between[k].cross(between[(k + 1) % between.len()]));
    let planes: Vec<Vec3> = planes.filter_map(Vec3::try_normalize).collect();
    let turn: f64 = planes.iter().map(|m| m.dot(inside)).sum();
    (turn.abs() > 1e-12 * inside.length()).then(|| planes.iter().map(|m| *m * turn.signum()).collect())
}

/// An integral, what its last splitting changed, and whether the splitting came to its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reference {
    pub value: f64,
    pub error: f64,
}

/// Splits, and how many of them are made in any case: on a coarse grid values agree by accident.
const DEPTH: u32 = 24;
const SPLITS_IN_ANY_CASE: u32 = 3;
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// ∫ f over a convex polygon, to about `tolerance`.
pub fn integral(polygon: &[Vec3], tolerance: f64, f: &mut impl FnMut(Vec3) -> f64) -> Reference {
    let mut sum = Reference::default();
    for k in 2..polygon.len() {
        let triangle = [polygon[0], polygon[k - 1], polygon[k]];
        let whole = rule(triangle, f);
        let part = refined(triangle, whole, tolerance / (polygon.len() - 2) as f64, DEPTH, f);
        sum.value += part.value;
        sum.error += part.error;
    }
    sum
}

fn rule([a, b, c]: [Vec3; 3], f: &mut impl FnMut(Vec3) -> f64) -> f64 {
    let area2 = (b - a).cross(c - a).length();
    let mut sum = 0.0;
    for (s, ws) in GAUSS {
        for (t, wt) in GAUSS {
            sum += ws * wt * (1.0 - s) * f(a * s + (b * (1.0 - t) + c * t) * (1.0 - s));
        }
    }
    sum * area2
}

fn refined(
    t: [Vec3; 3],
    whole: f64,
    tolerance: f64,
    depth: u32,
    f: &mut impl FnMut(Vec3) -> f64,
) -> Reference {
    let [a, b, c] = t;
    let [d, e, g] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
    let parts = [[a, d, g], [d, b, e], [g, e, c], [e, g, d]];
    let values = parts.map(|part| rule(part, f));
    let value: f64 = values.iter().sum();
    let error = (value - whole).abs();
    if (error <= tolerance && depth <= DEPTH - SPLITS_IN_ANY_CASE) || depth == 0 {
        return Reference { value, error };
    }
    let mut sum = Reference::default();
    for (part, value) in parts.into_iter().zip(values) {
        let part = refined(part, value, 0.4 * tolerance, depth - 1, f);
        sum.value += part.value;
        sum.error += part.error;
    }
    sum
}

/// A_a F_ab behind occluders.
pub fn exchange(a: &Patch, b: &Patch, occluders: &[Patch], tolerance: f64) -> Reference {
    let (source, target) = (front(a, b), front(b, a));
    let occluders: Vec<Vec<Vec3>> = occluders.iter().map(|o| o.corners().to_vec()).collect();
    integral(&source, tolerance, &mut |p| seen(p, a.normal(), &target, b.normal(), &occluders))
}
