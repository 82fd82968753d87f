//! Triangles and convex quads, their rules and their parts.

use crate::form_factor::critical::Plane;
use crate::form_factor::shadow::Topology;
use fredholm_mesh::Vec3;
use fredholm_quadrature::{PlanePoint, symmetric_triangle, tensor_quad};
use fredholm_visibility::body::GENERIC_DIRECTION;
use std::sync::LazyLock;

/// Degrees that are tried on a triangle, and points a direction on a quad.
pub(super) const DEGREES: [usize; 7] = [1, 2, 4, 7, 10, 14, 20];
const POINTS_ALONG: [usize; 7] = [1, 2, 3, 4, 6, 8, 11];
/// Largest reach, so that the error of a part with its centre on an edge of a body is a number.
const LARGEST_REACH: f64 = 1e3;

static TRIANGLE: LazyLock<Vec<Vec<PlanePoint>>> =
    LazyLock::new(|| DEGREES.iter().filter_map(|&degree| symmetric_triangle(degree).ok()).collect());
static QUAD: LazyLock<Vec<Vec<PlanePoint>>> = LazyLock::new(|| POINTS_ALONG.map(tensor_quad).to_vec());

/// A triangle, or a convex quad.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    Triangle([Vec3; 3]),
    Quad([Vec3; 4]),
}

/// Largest distance of a corner from the first.
pub(super) fn width(corners: &[Vec3]) -> f64 {
    let [first, others @ ..] = corners else { return 0.0 };
    others.iter().map(|x| x.distance_squared(*first)).fold(0.0, f64::max).sqrt()
}

impl Shape {
    pub(super) fn corners(&self) -> &[Vec3] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Quad(corners) => corners,
        }
    }

    pub(super) fn area(&self) -> f64 {
        match *self {
            Self::Triangle([a, b, c]) => 0.5 * (b - a).cross(c - a).length(),
            Self::Quad([a, b, c, d]) => 0.5 * (c - a).cross(d - b).length(),
        }
    }

    pub(super) fn centre(&self) -> Vec3 {
        self.corners().iter().sum::<Vec3>() / self.corners().len() as f64
    }

    /// Radius about the centre, over its distance from what is near.
    pub(super) fn reach(&self, distance: impl Fn(Vec3) -> f64) -> f64 {
        let centre = self.centre();
        let radius = self.corners().iter().map(|x| x.distance_squared(centre)).fold(0.0, f64::max);
        (radius.sqrt() / distance(centre)).min(LARGEST_REACH)
    }

    /// The parts between the middles of the sides.
    pub(super) fn quarters(&self) -> [Self; 4] {
        let middle = |p: Vec3, q: Vec3| 0.5 * (p + q);
        match *self {
            Self::Triangle([a, b, c]) => {
                let [d, e, f] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]].map(Self::Triangle)
            }
            Self::Quad([a, b, c, d]) => {
                let [e, f, g, h] = [middle(a, b), middle(b, c), middle(c, d), middle(d, a)];
                let o = middle(e, g);
                [[a, e, o, h], [e, b, f, o], [o, f, c, g], [h, o, g, d]].map(Self::Quad)
            }
        }
    }

    /// A point behind a line, seen from the centre: half way from it to the corners there. Where
    /// the line passes within `flat` of the centre, its normal decides.
    pub(super) fn behind(&self, (n, c): Plane, flat: f64) -> Vec3 {
        let centre = self.centre();
        let middle = n.dot(centre) - c;
        let side = if middle.abs() > flat { middle } else { n.dot(GENERIC_DIRECTION) };
        let depth = |x: &Vec3| ((c - n.dot(*x)) * side.signum()).max(0.0);
        let weight: f64 = self.corners().iter().map(depth).sum();
        let far = self.corners().iter().map(|x| *x * depth(x)).sum::<Vec3>() / weight;
        let (up, down) = (depth(&far), middle.abs());
        far.lerp(centre, 0.5 * up / (up + down))
    }

    /// Calls `each` with the points of a rule.
    pub(super) fn points(&self, degree: usize, each: impl FnMut(Vec3)) {
        match *self {
            Self::Triangle([a, b, c]) => {
                TRIANGLE[degree].iter().map(|p| a + (b - a) * p.u + (c - a) * p.v).for_each(each);
            }
            Self::Quad([a, b, c, d]) => {
                let twist = a - b + (c - d);
                QUAD[degree].iter().map(|p| a + (b - a) * p.u + (d - a + twist * p.u) * p.v).for_each(each);
            }
        }
    }

    /// The integral by a rule of which `found` are the values.
    pub(super) fn sum(&self, degree: usize, found: &[(f64, Topology)]) -> f64 {
        match *self {
            Self::Triangle([a, b, c]) => {
                let doubled = (b - a).cross(c - a).length();
                let terms = TRIANGLE[degree].iter().zip(found).map(|(p, (h, _))| p.weight * h);
                doubled * terms.sum::<f64>()
            }
            Self::Quad([a, b, c, d]) => {
                let (u, v, twist) = (b - a, d - a, a - b + (c - d));
                let stretch = |p: &PlanePoint| (u + twist * p.v).cross(v + twist * p.u).length();
                QUAD[degree].iter().zip(found).map(|(p, (h, _))| p.weight * stretch(p) * h).sum()
            }
        }
    }
}
