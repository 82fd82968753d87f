//! Cylinders: two convex strips that face each other, and the inside of a tube. Lambert's kernel, ρ
//! = 0.8.
//!
//! In a tube of radius 1 from z = 0 to L the kernel between points with angle δ between them is
//! c⁴/(4π (c² + t²)²), c = 2 sin(δ/2), t the difference of heights. For x(φ) the integral over t is
//! closed: ∫ c⁴/(c² + t²)² dt = ½ [c² t/(c² + t²) + c atan(t/c)], which leaves one over δ with an
//! analytic integrand.

use super::{Manufactured, resolved};
use crate::{Chart, CylinderStrip};
use fredholm_coupling::kernel::lambert;
use fredholm_mesh::Vec3;
use fredholm_quadrature::{composed_interval, gauss_legendre};
use std::f64::consts::{FRAC_PI_6, PI, TAU};

/// Distance of the axes of the two strips, and length of the tube, m.
const AXIS_DISTANCE: f64 = 4.0;
const LENGTH: f64 = 2.0;
/// Points a direction of the rule for b.
const SOURCE_RULE_POINTS: usize = 14;

/// Two strips of 60° of unit cylinders, convex sides towards each other: x = e^{z/2} cos y.
#[must_use]
pub fn two_cylinders() -> Manufactured {
    let exact = |p: Vec3| (0.5 * p.z).exp() * p.y.cos() + 0.2 * p.x;
    Manufactured {
        name: "two convex cylinders",
        curved: true,
        reflectance: 0.8,
        pieces: 2,
        kernel: Box::new(lambert),
        charts: strips,
        exact,
        irradiance: Box::new(resolved(&strips(1), SOURCE_RULE_POINTS, lambert, exact, outward)),
        peak: None,
    }
}

/// Unit normal of the strip that p is on.
fn outward(p: Vec3) -> Vec3 {
    let axis = if p.x < 0.5 * AXIS_DISTANCE { 0.0 } else { AXIS_DISTANCE };
    Vec3::new(p.x - axis, p.y, 0.0)
}

/// A strip moved along x.
#[derive(Debug)]
struct Moved(CylinderStrip, f64);

impl Chart for Moved {
    fn sides(&self) -> usize {
        self.0.sides()
    }

    fn position(&self, u: f64, v: f64) -> Vec3 {
        self.0.position(u, v) + Vec3::X * self.1
    }

    fn normal(&self, u: f64, v: f64) -> Vec3 {
        self.0.normal(u, v)
    }

    fn jacobian(&self, u: f64, v: f64) -> f64 {
        self.0.jacobian(u, v)
    }
}

fn part(range: [f64; 2], n: usize, i: usize) -> [f64; 2] {
    [i, i + 1].map(|i| range[0] + (range[1] - range[0]) * i as f64 / n as f64)
}

fn strips(n: usize) -> Vec<Box<dyn Chart>> {
    let strip = |centre: f64, k: usize| CylinderStrip {
        radius: 1.0,
        angles: part([centre - FRAC_PI_6, centre + FRAC_PI_6], n, k / n),
        heights: part([0.0, 1.0], n, k % n),
        inward: false,
    };
    let all =
        [(0.0, 0.0), (PI, AXIS_DISTANCE)].into_iter().flat_map(|side| (0..n * n).map(move |k| (side, k)));
    all.map(|((centre, x), k)| Box::new(Moved(strip(centre, k), x)) as Box<dyn Chart>).collect()
}

/// The inside of a tube: x = e^{cos φ}. The kernel has no limit at p = q.
#[must_use]
pub fn inside_of_a_cylinder() -> Manufactured {
    let exact = |p: Vec3| p.x.exp();
    Manufactured {
        name: "inside of a cylinder",
        curved: true,
        reflectance: 0.8,
        pieces: 1,
        kernel: Box::new(lambert),
        charts: tube,
        exact,
        irradiance: Box::new(in_tube(exact)),
        peak: Some(3.0),
    }
}

fn tube(n: usize) -> Vec<Box<dyn Chart>> {
    let strip = |k: usize| CylinderStrip {
        radius: 1.0,
        angles: part([0.0, TAU], 3 * n, k / n),
        heights: part([0.0, LENGTH], n, k % n),
        inward: true,
    };
    (0..3 * n * n).map(|k| Box::new(strip(k)) as Box<dyn Chart>).collect()
}

/// H x for an x that depends on the angle alone.
fn in_tube(exact: fn(Vec3) -> f64) -> impl Fn(Vec3) -> f64 {
    let rule = composed_interval(&gauss_legendre(SOURCE_RULE_POINTS), 8);
    move |p| {
        let along = |c: f64, t: f64| 0.5 * (c * c * t / (c * c + t * t) + c * (t / c).atan());
        let weigh = |delta: f64| {
            let c = 2.0 * (0.5 * delta).sin();
            let (sine, cosine) = delta.sin_cos();
            let q = Vec3::new(p.x * cosine - p.y * sine, p.x * sine + p.y * cosine, 0.0);
            exact(q) * (along(c, p.z) + along(c, LENGTH - p.z))
        };
        rule.integrate(0.0, TAU, weigh) / (4.0 * PI)
    }
}
