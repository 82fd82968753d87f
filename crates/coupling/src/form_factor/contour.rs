//! Polygon to polygon as a contour integral: A_i F_ij = (1/2π) Σₑ Σ_f (dₑ·d_f) ∫ₑ∫_f ln r ds dt.
//!
//! Stokes' theorem twice; E. M. Sparrow 1963, doi:10.1115/1.3686055; J.-F. Viennot's thesis, eq. 1.41. In m². Both polygons must lie in
//! front of each other and be counter-clockwise about their normals. The inner integral is closed; with parallel
//! edges so is the outer one, else it is bisected adaptively, which copes with edges that touch or cross.

use fredholm_mesh::Vec3;
use fredholm_quadrature::{Estimate, IntervalRule, gauss_legendre, integrate_adaptive};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Points of the rule that is bisected along an edge.
const POINTS: usize = 10;
/// Bisections towards a touching corner: 2⁻⁵⁰ of the edge is below rounding.
const DEPTH: u32 = 50;
/// Squared sine of the angle under which edges count as parallel.
pub(crate) const PARALLEL: f64 = 1e-28;
/// Rounding of one edge pair, relative to the largest term of its closed form.
pub(crate) const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Largest term of the closed form for parallel edges, over the product of their lengths, at which it is used. Its four terms grow
/// with the squared distance and cancel; quadrature of the inner integral does not.
const CANCELLING: f64 = 100.0;

static RULE: LazyLock<IntervalRule> = LazyLock::new(|| gauss_legendre(POINTS));

/// An oriented edge: start, unit direction, length.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    pub start: Vec3,
    pub direction: Vec3,
    pub length: f64,
}

/// A_i F_ij (m²) between two polygons given by their corners, to an absolute `tolerance` (m²) as far as rounding lets it.
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

/// The double sum over the edges of both polygons, in m²; `pair` computes (dₑ·d_f) ∫∫ ln r ds dt to its share of the tolerance, in the
/// pair's own unit of length.
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

/// A typical distance. Lengths are measured in it: a constant added to ln r integrates to 0 round a closed contour, but its rounding does not.
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
    let (e, f) = if e.length <= f.length { (e, f) } else { (f, e) };
    let rounding = rounding(e, f);
    if e.direction.cross(f.direction).length_squared() <= PARALLEL {
        let closed = parallel(e, f, cosine.signum());
        if closed.error <= CANCELLING * rounding {
            return closed;
        }
    }
    let inner = |s: f64| log_integral(e.start + e.direction * s, f);
    // Below rounding two values never agree, however short the interval.
    let outer = integrate_adaptive(&RULE, 0.0, e.length, tolerance.max(rounding), DEPTH, &inner);
    Estimate { value: cosine * outer.value, error: cosine.abs() * (outer.error + rounding) }
}

/// Rounding of ∫∫ ln r ds dt: that of the terms of the inner integral, and that of a point of `e`, of order 1, times the change
/// of the inner integral with it, the angle under which it sees `f`.
pub(crate) fn rounding(e: Edge, f: Edge) -> f64 {
    let gap = e.start.distance(f.start) - e.length - f.length;
    let angle = f.length / gap.max(f.length);
    ROUNDING * e.length * (f.length + angle)
}

/// ∫ ln |p − q(t)| dt along an edge of length L: with r₀, r₁ the distances of its ends, t₀, t₁ = t₀ + L their places along it from the foot
/// of p and h the height of p, ½ L ln(r₀ r₁) + ½ (t₀ + t₁) ln(r₁/r₀) − L + h θ. θ is the angle under which p sees the edge. Every term
/// is of the order of L: nothing cancels where the edge is short and far.
pub(crate) fn log_integral(p: Vec3, f: Edge) -> f64 {
    let d = f.start - p;
    let t0 = d.dot(f.direction);
    let t1 = t0 + f.length;
    let h2 = (d - f.direction * t0).length_squared();
    let (r0, r1) = (t0 * t0 + h2, t1 * t1 + h2);
    let near = r0.min(r1);
    if near == 0.0 {
        return f.length * (f.length.ln() - 1.0);
    }
    let middle = t0 + t1;
    let ratio = 0.5 * (f.length * middle.abs() / near).ln_1p();
    let h = h2.sqrt();
    let angle = (h * f.length).atan2(h2 + t0 * t1);
    0.25 * f.length * (r0.ln() + r1.ln()) + 0.5 * middle.abs() * ratio - f.length + h * angle
}

/// Both integrals closed for parallel edges: with w the distance along them and h across,
/// Φ(w) = ¼ (w² − h²) ln(w² + h²) − ¾ w² + h w atan(w/h) has Φ″ = ½ ln(w² + h²) up to a constant of Φ.
fn parallel(e: Edge, f: Edge, sign: f64) -> Estimate {
    let d = e.start - f.start;
    let along = d.dot(e.direction);
    let h2 = (d - e.direction * along).length_squared();
    let h = h2.sqrt();
    let primitive = |w: f64| {
        let r2 = w * w + h2;
        let log = if r2 == 0.0 { 0.0 } else { 0.25 * (w * w - h2) * r2.ln() };
        let angle = if h == 0.0 { 0.0 } else { h * w * (w / h).atan() };
        log - 0.75 * w * w + angle
    };
    let (a, b) = (along + e.length, sign * f.length);
    let terms = [primitive(a), primitive(along - b), -primitive(a - b), -primitive(along)];
    let largest = terms.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
    // ∂ₛ∂ₜ Φ(w₀ + s − σt) = −σ Φ″, and the factor dₑ·d_f = σ squares it away.
    Estimate { value: terms.iter().sum(), error: ROUNDING * largest }
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
