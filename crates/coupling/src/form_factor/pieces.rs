//! ∫ h dA over a convex polygon in parts: by cuts along critical lines, by rules of rising degree and by halving, with one error estimate for all.
//!
//! The part with the largest error is improved next. Where h is not smooth on it, it is cut along the critical line that halves it best; where there is none, or where the part is large beside its
//! distance from an edge of a body, its sides are halved; else it gets the next rule. So the cost follows the goal. In m².
//!
//! **Error.** The difference of two rules is the error of the lower one, and either may be small by accident. The error is a share of the geometric mean of that difference and the one before,
//! the first being the range of h times the area, and a smaller share of the one before alone. The shares are measured (docs/form-factors.md).

use super::critical::Plane;
use super::shadow::Kind;
use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::Vec3;
use fredholm_quadrature::{Estimate, PlanePoint, symmetric_triangle, tensor_quad};
use fredholm_visibility::body::ODD;
use std::sync::LazyLock;

/// Degrees that are tried on a triangle, and points a direction on a quad.
const DEGREES: [usize; 7] = [1, 2, 4, 7, 10, 14, 20];
const POINTS_ALONG: [usize; 7] = [1, 2, 3, 4, 6, 8, 11];
/// Ratio of two differences below which a higher degree is expected to pay.
const PAYS: f64 = 0.3;
/// Radius of a part, in its distances from what makes h steep, above which its sides are halved.
/// No simple number: in a scene with right angles the two are often equal, and rounding would decide.
const NEAR: f64 = 1.000_001;
/// Largest reach, so that the error of a part with its centre on an edge of a body is a number.
const FARTHEST: f64 = 1e3;
/// Relative difference below which two errors are equal by design of the scene.
const EQUAL: f64 = 1e-6;
/// A line that leaves less than this share of the width of a part on one side does not cut it.
const SIDE: f64 = 0.020_3;
/// Error of a rule over √(difference × difference before) and over the difference before, on a part of reach r: c₀ r + c₁ r² and c₂ r² where h is smooth,
const SMOOTH: [f64; 3] = [0.04, 0.12, 0.02];
/// c₀ + c₁ r² and c₂ + c₃ r² where it is not.
const BROKEN: [f64; 4] = [0.12, 0.25, 0.02, 0.05];
/// Growth of the error with the logarithm of the number of parts.
const MANY: f64 = 0.1;
/// Variation of h on a part that a line cuts, over its largest possible value, at least: the points may all miss it.
const UNSEEN: f64 = 0.3;
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

    fn centre(&self) -> Vec3 {
        self.corners().iter().sum::<Vec3>() / self.corners().len() as f64
    }

    /// Radius about the centre, over its distance from what is near.
    fn reach(&self, distance: impl Fn(Vec3) -> f64) -> f64 {
        let centre = self.centre();
        let radius = self.corners().iter().map(|x| x.distance(centre)).fold(0.0, f64::max);
        (radius / distance(centre)).min(FARTHEST)
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

    /// Calls `each` with the points of a rule.
    fn points(&self, degree: usize, each: impl FnMut(Vec3)) {
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
    fn sum(&self, degree: usize, found: &[(f64, Kind)]) -> f64 {
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

/// A part, its integral and how that converged.
#[derive(Clone, Copy, Debug)]
struct Piece {
    shape: Shape,
    /// Radius over the distance from what makes h steep.
    reach: f64,
    /// Whether a critical line cuts it.
    cut: bool,
    /// Place in [`DEGREES`] or [`POINTS_ALONG`].
    degree: usize,
    value: f64,
    /// Difference to the degree before.
    step: f64,
    error: f64,
    /// The kind of all points so far, or `None` where they differ.
    kind: Option<Kind>,
    pays: bool,
}

impl Piece {
    fn smooth(&self) -> bool {
        self.kind.is_some() && !self.cut
    }

    /// The part with the value of the next rule.
    fn raised(self, value: f64, kind: Option<Kind>) -> Self {
        let step = (value - self.value).abs();
        let next = Self { degree: self.degree + 1, value, step, kind: self.kind.and(kind), ..self };
        let r = self.reach;
        let [share, least] = shares(next.smooth(), r);
        let error = (share * share * step + least * least * self.step).sqrt() * self.step.sqrt();
        let pays = next.smooth() && r <= NEAR && step < PAYS * self.step && next.degree + 1 < DEGREES.len();
        Self { error, pays, ..next }
    }
}

/// Error over √(difference × difference before), and over the difference before, on a part of reach `r`.
fn shares(smooth: bool, r: f64) -> [f64; 2] {
    if smooth {
        [(SMOOTH[0] + SMOOTH[1] * r) * r, SMOOTH[2] * r * r]
    } else {
        [BROKEN[0] + BROKEN[1] * r * r, BROKEN[2] + BROKEN[3] * r * r]
    }
}

/// Where h is not smooth.
#[derive(Clone, Copy)]
pub(crate) struct Breaks<'a, D, M> {
    /// Critical planes.
    pub planes: &'a [Plane],
    /// Heights up to which a corner lies in a plane, m.
    pub flat: f64,
    /// Distance of a point from what makes h steep, m.
    pub distance: D,
    /// Largest possible h at a point.
    pub most: M,
}

/// Parts and what is known of the convergence on them.
pub(crate) struct Pieces<'a, H, D, M> {
    h: H,
    breaks: Breaks<'a, D, M>,
    work: &'a mut PiecesWork,
    points: usize,
    goal: f64,
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct PiecesWork {
    parts: Vec<Piece>,
    /// The points of a rule, and h there.
    points: Vec<Vec3>,
    found: Vec<(f64, Kind)>,
}

impl<'a, H, D, M> Pieces<'a, H, D, M>
where
    H: FnMut(&[Vec3], &mut Vec<(f64, Kind)>),
    D: Fn(Vec3) -> f64,
    M: Fn(Vec3) -> f64,
{
    /// Prepares the integral of h to an absolute `goal`. `h` appends the values and the kinds at given points.
    pub(crate) fn new(h: H, breaks: Breaks<'a, D, M>, work: &'a mut PiecesWork, goal: f64) -> Self {
        work.parts.clear();
        Self { h, breaks, work, points: 0, goal }
    }

    /// The integral over a convex polygon.
    pub(crate) fn integrate(mut self, corners: &[Vec3]) -> Estimate {
        self.add(corners);
        loop {
            let stated = self.stated();
            if stated <= self.goal || self.points >= POINTS {
                return Estimate { value: self.work.parts.iter().map(|p| p.value).sum(), error: stated };
            }
            self.improve_worst();
        }
    }

    /// Errors of parts are of either sign. Of many, some are underestimated, and those are the ones that are not improved.
    fn stated(&self) -> f64 {
        let squares: f64 = self.work.parts.iter().map(|p| p.error.powi(2)).sum();
        squares.sqrt() * (1.0 + MANY * (self.work.parts.len() as f64).ln())
    }

    /// Adds a convex polygon as quads and at most one triangle.
    fn add(&mut self, corners: &[Vec3]) {
        let mut start = 1;
        while start + 1 < corners.len() {
            let shape = match corners[start..] {
                [b, c] => Shape::Triangle([corners[0], b, c]),
                [b, c, d, ..] => Shape::Quad([corners[0], b, c, d]),
                _ => return,
            };
            self.start(shape);
            start += shape.corners().len() - 2;
        }
    }

    fn start(&mut self, shape: Shape) {
        let reach = shape.reach(&self.breaks.distance);
        let cut = self.breaks.planes.iter().any(|plane| self.halves(&shape, *plane).is_some());
        let unseen = if cut || reach > NEAR {
            UNSEEN * (self.breaks.most)(shape.centre()) * shape.area()
        } else {
            0.0
        };
        // What certainly does not suffice needs no points.
        if cut && shares(false, reach)[1] * unseen > self.goal {
            return self.divide(&shape);
        }
        let (value, kind, [low, high]) = self.rule(&shape, 0, None);
        let piece = Piece { shape, reach, cut, degree: 0, value, step: 0.0, error: 0.0, kind, pays: true };
        let (second, kind, [least, most]) = self.rule(&shape, 1, kind);
        let range = (high.max(most) - low.min(least)) * shape.area();
        self.work.parts.push(Piece { step: range.max(unseen), ..piece }.raised(second, kind));
    }

    /// Cuts a shape along a line, or halves its sides.
    fn divide(&mut self, shape: &Shape) {
        match self.line_through(shape) {
            Some(plane) => self.cut(shape, plane),
            None => shape.quarters().into_iter().for_each(|part| self.start(part)),
        }
    }

    /// The integral by a rule, the kind of its points as far as they are all of one, and the least and the largest value.
    fn rule(&mut self, shape: &Shape, degree: usize, so_far: Option<Kind>) -> (f64, Option<Kind>, [f64; 2]) {
        let PiecesWork { points, found, .. } = &mut *self.work;
        points.clear();
        found.clear();
        shape.points(degree, |x| points.push(x));
        (self.h)(points, found);
        self.points += points.len();
        let (mut kind, mut alike) = (so_far, true);
        let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
        for &(h, its) in &*found {
            (low, high) = (low.min(h), high.max(h));
            alike &= *kind.get_or_insert(its) == its;
        }
        (shape.sum(degree, found), kind.filter(|_| alike), [low, high])
    }

    /// The share of the width of a part on the smaller side of a plane that cuts it.
    fn halves(&self, shape: &Shape, (n, c): Plane) -> Option<f64> {
        let heights = shape.corners().iter().map(|x| n.dot(*x) - c);
        let [low, high] = heights.fold([0.0f64; 2], |[low, high], h| [low.min(h), high.max(h)]);
        let cuts = high > self.breaks.flat && -low > self.breaks.flat;
        let share = high.min(-low) / (high - low);
        (cuts && share > SIDE).then_some(share)
    }

    /// Improves the part with the largest error, and those that equal it: rounding does not choose between them.
    fn improve_worst(&mut self) {
        let worst = self.work.parts.iter().map(|p| p.error).fold(0.0, f64::max);
        for k in (0..self.work.parts.len()).rev() {
            if self.work.parts[k].error >= worst * (1.0 - EQUAL) {
                self.improve(k);
            }
        }
    }

    fn improve(&mut self, k: usize) {
        let piece = self.work.parts[k];
        if piece.pays {
            let (value, kind, _) = self.rule(&piece.shape, piece.degree + 1, piece.kind);
            self.work.parts[k] = piece.raised(value, kind);
            return;
        }
        self.work.parts.swap_remove(k);
        self.divide(&piece.shape);
    }

    /// The critical line that halves a part best; of equals, the place decides.
    fn line_through(&self, shape: &Shape) -> Option<Plane> {
        let planes = self.breaks.planes.iter();
        let cutting = planes.filter_map(|&plane| Some((plane, self.halves(shape, plane)?)));
        let key = |((n, _), share): &(Plane, f64)| share + 1e-3 * n.dot(ODD).abs();
        cutting.max_by(|a, b| key(a).total_cmp(&key(b))).map(|(plane, _)| plane)
    }

    fn cut(&mut self, shape: &Shape, (normal, offset): Plane) {
        let above = HalfSpace { normal, offset };
        let below = HalfSpace { normal: -normal, offset: -offset };
        for side in [above, below] {
            let mut part = Vec::with_capacity(5);
            clip(shape.corners(), side, self.breaks.flat, &mut part);
            self.add(&part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ over the unit square of a function with a kink along x = 0.3 and with its steep place at `near`.
    fn kinked(near: Vec3, planes: &[Plane], goal: f64) -> Estimate {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let value = |x: &Vec3| ((x.x - 0.3).max(0.0), Kind::default());
        let h = |points: &[Vec3], found: &mut Vec<_>| found.extend(points.iter().map(value));
        let breaks = Breaks { planes, flat: 1e-12, distance: |x: Vec3| x.distance(near), most: |_| 0.7 };
        Pieces::new(h, breaks, &mut PiecesWork::default(), goal).integrate(&square)
    }

    #[test]
    fn a_cut_along_the_kink_makes_it_exact() {
        let found = kinked(Vec3::Z * 5.0, &[(Vec3::X, 0.3)], 1e-9);
        assert!((found.value - 0.245).abs() < 1e-14 && found.error < 1e-9, "{found:?}");
    }

    #[test]
    fn a_part_on_an_edge_of_a_body_has_an_error_that_is_a_number() {
        let found = kinked(Vec3::new(0.5, 0.5, 0.0), &[], 1e-4);
        assert!(found.error <= 1e-4 && (found.value - 0.245).abs() < 1e-3, "{found:?}");
    }
}
