//! ∫ h dA over triangles and quads by rules of rising degree and by halving, with one error estimate for all.
//!
//! The difference of two degrees is the error of the lower one; that of the higher one is smaller by the ratio to the difference before. Where h is steep close to a corner or an
//! edge of a body, the points of a large part all miss it alike and any two values agree, so parts are first cut until they are no larger than their distance from such places.
//! The one with the largest error is improved next, by degree while that pays, else by halving its sides. In m².

use fredholm_mesh::Vec3;
use fredholm_quadrature::{Estimate, PlanePoint, symmetric_triangle, tensor_quad};
use std::sync::LazyLock;

/// Degrees that are tried on a triangle, and points a direction on a quad.
const DEGREES: [usize; 7] = [1, 2, 4, 7, 10, 14, 20];
const POINTS_ALONG: [usize; 7] = [1, 2, 3, 4, 6, 8, 11];
/// Ratio of two differences below which a higher degree is expected to pay.
const PAYS: f64 = 0.3;
/// Radius of a part, in its distances from what makes h steep, above which it is cut.
const NEAR: f64 = 1.0;
/// Stated error over the root of the summed squares: errors of parts are of either sign.
const SAFETY: f64 = 1.0;
/// Smallest credible ratio of two errors.
const CREDIBLE: f64 = 0.05;
/// Points after which an integral ends with the error that it has.
const POINTS: usize = 100_000;

static TRIANGLE: LazyLock<Vec<Vec<PlanePoint>>> =
    LazyLock::new(|| DEGREES.iter().filter_map(|&degree| symmetric_triangle(degree).ok()).collect());
static QUAD: LazyLock<Vec<Vec<PlanePoint>>> = LazyLock::new(|| POINTS_ALONG.map(tensor_quad).to_vec());

/// A triangle, or a convex quad.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Triangle([Vec3; 3]),
    Quad([Vec3; 4]),
}

impl Shape {
    fn corners(&self) -> &[Vec3] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Quad(corners) => corners,
        }
    }

    fn area(&self) -> f64 {
        match *self {
            Self::Triangle([a, b, c]) => 0.5 * (b - a).cross(c - a).length(),
            Self::Quad([a, b, c, d]) => 0.5 * (c - a).cross(d - b).length(),
        }
    }

    /// The parts between the middles of the sides.
    fn quarters(&self) -> [Self; 4] {
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

    /// Calls `each` with the points of a rule and their weights in m².
    fn rule(&self, degree: usize, mut each: impl FnMut(Vec3, f64)) {
        match *self {
            Self::Triangle([a, b, c]) => {
                let (u, v) = (b - a, c - a);
                let doubled = u.cross(v).length();
                TRIANGLE[degree].iter().for_each(|p| each(a + u * p.u + v * p.v, p.weight * doubled));
            }
            Self::Quad([a, b, c, d]) => {
                let (u, v, twist) = (b - a, d - a, a - b + (c - d));
                for p in &QUAD[degree] {
                    let (along_u, along_v) = (u + twist * p.v, v + twist * p.u);
                    each(a + u * p.u + along_v * p.v, p.weight * along_u.cross(along_v).length());
                }
            }
        }
    }
}

/// A part, its integral and how that converged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    shape: Shape,
    /// Place in [`DEGREES`] or [`POINTS_ALONG`].
    degree: usize,
    value: f64,
    /// Difference to the degree before.
    step: f64,
    error: f64,
    pays: bool,
}

/// Parts and what is known of the convergence on them.
pub(crate) struct Pieces<'a, H, D> {
    h: H,
    /// Distance of a point from what makes h steep, m.
    distance: D,
    parts: &'a mut Vec<Piece>,
    points: usize,
}

impl<'a, H: FnMut(Vec3) -> f64, D: Fn(Vec3) -> f64> Pieces<'a, H, D> {
    /// Prepares the integral of `h` with values up to 1; `pieces` is a buffer.
    pub(crate) fn new(h: H, distance: D, pieces: &'a mut Vec<Piece>) -> Self {
        pieces.clear();
        Self { h, distance, parts: pieces, points: 0 }
    }

    /// Adds a convex polygon, cut into parts that are no larger than their distance from what makes h steep, or of an area of at most `least` (m²).
    pub(crate) fn add(&mut self, corners: &[Vec3], least: f64) {
        let mut start = 1;
        while start + 1 < corners.len() {
            let shape = match corners[start..] {
                [b, c] => Shape::Triangle([corners[0], b, c]),
                [b, c, d, ..] => Shape::Quad([corners[0], b, c, d]),
                _ => return,
            };
            self.grade(shape, least);
            start += shape.corners().len() - 2;
        }
    }

    fn grade(&mut self, shape: Shape, least: f64) {
        let corners = shape.corners();
        let centre = corners.iter().sum::<Vec3>() / corners.len() as f64;
        let radius = corners.iter().map(|x| x.distance(centre)).fold(0.0, f64::max);
        if shape.area() > least && radius > NEAR * (self.distance)(centre) {
            shape.quarters().into_iter().for_each(|part| self.grade(part, least));
        } else {
            let piece = self.start(shape);
            self.parts.push(piece);
        }
    }

    /// The integral to an absolute `goal`.
    pub(crate) fn integrate(mut self, goal: f64) -> Estimate {
        loop {
            let stated = SAFETY * self.parts.iter().map(|p| p.error.powi(2)).sum::<f64>().sqrt();
            let errors = self.parts.iter().map(|p| p.error);
            let worst = errors.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
            match worst.filter(|_| stated > goal && self.points < POINTS) {
                Some(worst) => self.improve(worst),
                None => return Estimate { value: self.parts.iter().map(|p| p.value).sum(), error: stated },
            }
        }
    }

    fn start(&mut self, shape: Shape) -> Piece {
        let [first, value] = [0, 1].map(|degree| self.rule(&shape, degree));
        let step = (value - first).abs();
        Piece { shape, degree: 1, value, step, error: step, pays: true }
    }

    fn rule(&mut self, shape: &Shape, degree: usize) -> f64 {
        let mut sum = 0.0;
        shape.rule(degree, |x, weight| {
            sum += weight * (self.h)(x);
            self.points += 1;
        });
        sum
    }

    fn improve(&mut self, k: usize) {
        if self.parts[k].pays {
            self.parts[k] = self.raise(self.parts[k]);
        } else {
            let parts = self.parts[k].shape.quarters().map(|shape| self.start(shape));
            self.parts[k] = parts[0];
            self.parts.extend_from_slice(&parts[1..]);
        }
    }

    fn raise(&mut self, piece: Piece) -> Piece {
        let degree = piece.degree + 1;
        let value = self.rule(&piece.shape, degree);
        let step = (value - piece.value).abs();
        let ratio = if piece.step > 0.0 { step / piece.step } else { 1.0 };
        // Two values may agree by accident; the error before bounds how well they credibly do.
        let error = (step * ratio.min(1.0)).max(CREDIBLE * piece.error);
        let pays = ratio < PAYS && degree + 1 < DEGREES.len();
        Piece { degree, value, step, error, pays, ..piece }
    }
}
