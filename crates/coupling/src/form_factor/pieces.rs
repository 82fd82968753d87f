//! ∫ h dA over triangles by symmetric rules of rising degree and by halving, with one error estimate for all.
//!
//! The difference of two degrees is the error of the lower one; that of the higher one is smaller by the ratio to the difference before. Where h is steep close to a corner or an
//! edge of a body, the points of a large triangle all miss it alike and any two values agree, so triangles are first cut until they are no larger than their distance from such places.
//! The one with the largest error is improved next, by degree while that pays, else by halving its sides. In m².

use fredholm_mesh::Vec3;
use fredholm_quadrature::{Estimate, PlanePoint, symmetric_triangle};
use std::sync::LazyLock;

/// Degrees that are tried on a triangle.
const DEGREES: [usize; 7] = [1, 2, 4, 7, 10, 14, 20];
/// Ratio of two differences below which a higher degree is expected to pay.
const PAYS: f64 = 0.3;
/// Radius of a triangle, in its distances from what makes h steep, above which it is cut.
/// No simple number: in a scene with right angles the two are often equal, and rounding would decide.
const NEAR: f64 = 1.000_001;
/// Relative difference below which two errors are equal by design of the scene.
const EQUAL: f64 = 1e-6;
/// Stated error over the root of the summed squares: errors of triangles are of either sign.
const SAFETY: f64 = 1.0;
/// Smallest credible ratio of two errors.
const CREDIBLE: f64 = 0.05;
/// Points after which an integral ends with the error that it has.
const POINTS: usize = 100_000;

static RULES: LazyLock<Vec<Vec<PlanePoint>>> =
    LazyLock::new(|| DEGREES.iter().filter_map(|&degree| symmetric_triangle(degree).ok()).collect());

/// A triangle, its integral and how that converged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    corners: [Vec3; 3],
    /// Place in [`DEGREES`].
    degree: usize,
    value: f64,
    /// Difference to the degree before.
    step: f64,
    error: f64,
    pays: bool,
}

/// Triangles and what is known of the convergence on them.
pub(crate) struct Pieces<'a, H, D> {
    h: H,
    /// Distance of a point from what makes h steep, m.
    distance: D,
    pieces: &'a mut Vec<Piece>,
    points: usize,
}

impl<'a, H: FnMut(Vec3) -> f64, D: Fn(Vec3) -> f64> Pieces<'a, H, D> {
    /// Prepares the integral of `h` with values up to 1; `pieces` is a buffer.
    pub(crate) fn new(h: H, distance: D, pieces: &'a mut Vec<Piece>) -> Self {
        pieces.clear();
        Self { h, distance, pieces, points: 0 }
    }

    /// Adds a triangle, cut into parts that are no larger than their distance from what makes h steep, or of an area of at most `least` (m²).
    pub(crate) fn add(&mut self, corners: [Vec3; 3], least: f64) {
        let [a, b, c] = corners;
        let centre = (a + b + c) / 3.0;
        let radius = corners.iter().map(|x| x.distance(centre)).fold(0.0, f64::max);
        let area = 0.5 * (b - a).cross(c - a).length();
        if area > least && radius > NEAR * (self.distance)(centre) {
            quarters(&corners).into_iter().for_each(|part| self.add(part, least));
        } else {
            let piece = self.start(corners);
            self.pieces.push(piece);
        }
    }

    /// The integral to an absolute `goal`.
    pub(crate) fn integrate(mut self, goal: f64) -> Estimate {
        loop {
            let stated = SAFETY * self.pieces.iter().map(|p| p.error.powi(2)).sum::<f64>().sqrt();
            if stated <= goal || self.points >= POINTS {
                return Estimate { value: self.pieces.iter().map(|p| p.value).sum(), error: stated };
            }
            self.improve_worst();
        }
    }

    /// Improves the triangle with the largest error, and those that equal it: rounding does not choose between them.
    fn improve_worst(&mut self) {
        let worst = self.pieces.iter().map(|p| p.error).fold(0.0, f64::max);
        for k in 0..self.pieces.len() {
            if self.pieces[k].error >= worst * (1.0 - EQUAL) {
                self.improve(k);
            }
        }
    }

    fn start(&mut self, corners: [Vec3; 3]) -> Piece {
        let [first, value] = [0, 1].map(|degree| self.rule(&corners, degree));
        let step = (value - first).abs();
        Piece { corners, degree: 1, value, step, error: step, pays: true }
    }

    fn rule(&mut self, &[a, b, c]: &[Vec3; 3], degree: usize) -> f64 {
        let (u, v) = (b - a, c - a);
        let rule = &RULES[degree];
        self.points += rule.len();
        let sum: f64 = rule.iter().map(|p| p.weight * (self.h)(a + u * p.u + v * p.v)).sum();
        sum * u.cross(v).length()
    }

    fn improve(&mut self, k: usize) {
        if self.pieces[k].pays {
            self.pieces[k] = self.raise(self.pieces[k]);
        } else {
            let parts = quarters(&self.pieces[k].corners).map(|corners| self.start(corners));
            self.pieces[k] = parts[0];
            self.pieces.extend_from_slice(&parts[1..]);
        }
    }

    fn raise(&mut self, piece: Piece) -> Piece {
        let degree = piece.degree + 1;
        let value = self.rule(&piece.corners, degree);
        let step = (value - piece.value).abs();
        let ratio = if piece.step > 0.0 { step / piece.step } else { 1.0 };
        // Two values may agree by accident; the error before bounds how well they credibly do.
        let error = (step * ratio.min(1.0)).max(CREDIBLE * piece.error);
        let pays = ratio < PAYS && degree + 1 < DEGREES.len();
        Piece { degree, value, step, error, pays, ..piece }
    }
}

/// A triangle cut at the middles of its sides.
fn quarters(&[a, b, c]: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(p, q)| 0.5 * (p + q));
    [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
}
