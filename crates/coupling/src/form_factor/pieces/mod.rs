//! ∫ h dA over a convex polygon in parts: by cuts along critical lines, by rules of rising degree
//! and by halving, with one error estimate for all.
//!
//! The part with the largest error is improved next. Where its points are of several topologies it
//! is cut along the critical line that parts them, and halves it best; where there is none its
//! sides are halved. Where all are of one topology it gets the next rule as long as that pays, or
//! its sides are halved. So the cost follows the goal. In m².
//!
//! Most critical lines are not active. Of lines of single bodies it is known where they are, unless
//! another body hides that ([`EdgeVertexEvents`]): the source is cut along those that may matter
//! before anything is asked. Of the others the topologies of points on both sides tell. A line may
//! also pass between the points and the border of a part: before the part is left as it is, one
//! point behind the line is looked at, if that could hide something that matters.

mod evidence;
mod observed;
mod piece;
mod shape;

use super::ErrorModel;
use super::critical::Plane;
use super::ev_events::{Active, CriticalPlane, EdgeVertexEvents, chord};
use super::shadow::Topology;
use crate::polygon::{HalfSpace, clip};
use evidence::{Line, Points};
use fredholm_mesh::Vec3;
use fredholm_quadrature::Estimate;
use fredholm_visibility::body::GENERIC_DIRECTION;
use observed::Observed;
use piece::Piece;
use shape::{Shape, width};
use std::ops::Range;

/// Relative difference below which two errors are equal by design of the scene.
const EQUAL_ERROR_TOLERANCE: f64 = 1e-6;
/// A line that leaves less than this share of the width of a part on one side does not cut it,
const LEAST_CUT_SHARE: f64 = 0.020_3;
/// and what it may cost at most that it does not, in goals.
const MOST_COST_OF_NO_CUT: f64 = 0.1;
/// Heights over a line below this share of the width of a part count as 0: often several lines meet
/// in one point.
const ON_THE_LINE: f64 = 1e-9;
/// What may be hidden behind a line, in goals, from which on a point there is looked at.
const LEAST_HIDDEN_TO_LOOK_AT: f64 = 0.15;
/// What may be hidden behind a line that is certainly active, in goals, from which on the source is
/// cut along it at once.
const LEAST_HIDDEN_TO_CUT: f64 = 2.2;
/// Points after which an integral ends with the error that it has.
const MOST_POINTS: usize = 100_000;

/// Where h is not smooth.
#[derive(Clone, Copy)]
pub(crate) struct Breaks<'a, D, M> {
    /// Critical planes.
    pub events: &'a [CriticalPlane],
    pub ev_events: &'a EdgeVertexEvents,
    /// Whether edge–vertex events tell of all of them.
    pub sure: bool,
    /// Heights up to which a point lies in a plane, m.
    pub flat: f64,
    /// Distance of a point from what makes h steep, m.
    pub distance: D,
    /// Largest possible h at a point.
    pub most: M,
}

impl<D, M> Breaks<'_, D, M> {
    /// A critical plane, if it may be active on a convex polygon.
    fn cutting(&self, event: u32, corners: &[Vec3], flat: f64) -> Option<Cutting> {
        let its = &self.events[event as usize];
        let (share, chord) = cut(corners, its.plane, flat)?;
        let active = self.ev_events.ask(its, chord);
        (active != Active::No).then_some(Cutting { event, share, surely: active == Active::Yes })
    }
}

/// Parts and what is known of the convergence on them.
pub(crate) struct Pieces<'a, H, D, M> {
    h: H,
    breaks: Breaks<'a, D, M>,
    work: &'a mut PiecesWork,
    model: &'a ErrorModel,
    observed: Observed,
    points: usize,
    goal: f64,
    /// The mean over the whole of what h could be at most.
    density: f64,
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct PiecesWork {
    /// Points at which h was asked for, of all integrals.
    pub(crate) points_asked: u64,
    parts: Vec<Piece>,
    /// Lines through parts, each list by its range. A part of a part looks no further than into the
    /// list of the whole.
    cutting: Vec<Cutting>,
    /// The points of the last rules, all on one part.
    points: Points,
    /// Lines through that part, each with the share of the width on its smaller side, and those
    /// that have no point there.
    lines: Vec<(Plane, f64)>,
    unseen: Vec<(Plane, f64)>,
    /// Polygons for the next cuts.
    spare: Vec<Vec<Vec3>>,
}

/// A line that cuts a part and may be active there.
#[derive(Clone, Copy, Debug)]
struct Cutting {
    /// The place of its event.
    event: u32,
    /// The share of the width on its smaller side.
    share: f64,
    /// Whether it is certainly active.
    surely: bool,
}

/// A range of a list of lines.
#[derive(Clone, Copy, Debug)]
struct Lines {
    start: u32,
    end: u32,
}

impl Lines {
    fn places(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

impl<'a, H, D, M> Pieces<'a, H, D, M>
where
    H: FnMut(&[Vec3], &mut Vec<(f64, Topology)>),
    D: Fn(Vec3) -> f64,
    M: Fn(Vec3) -> f64,
{
    /// Prepares the integral of h to an absolute `goal`. `h` appends the values and the topologies
    /// at given points.
    pub(crate) fn new(
        h: H,
        breaks: Breaks<'a, D, M>,
        work: &'a mut PiecesWork,
        model: &'a ErrorModel,
        goal: f64,
    ) -> Self {
        work.parts.clear();
        work.cutting.clear();
        let observed = Observed::new(*model, breaks.sure);
        Self { h, breaks, work, model, observed, points: 0, goal, density: 0.0 }
    }

    /// The integral over a convex polygon; it is at most `most`.
    pub(crate) fn integrate(mut self, corners: &[Vec3], most: f64) -> Estimate {
        self.density = most / area(corners);
        let lines = self.lines(corners);
        self.cut_surely(corners, lines);
        loop {
            let error = self.observed.error(&self.work.parts);
            if error <= self.goal || self.points >= MOST_POINTS {
                self.work.points_asked += self.points as u64;
                return Estimate { value: self.work.parts.iter().map(|p| p.value).sum(), error };
            }
            self.improve_worst();
        }
    }

    /// Lists all lines that cut a convex polygon and may be active there.
    fn lines(&mut self, corners: &[Vec3]) -> Lines {
        let flat = self.flat(corners);
        let found = (0..self.breaks.events.len() as u32)
            .filter_map(|event| self.breaks.cutting(event, corners, flat));
        self.work.cutting.extend(found);
        Lines { start: 0, end: self.work.cutting.len() as u32 }
    }

    /// Lists those of the lines through a whole that cut a part of it.
    fn narrow(&mut self, corners: &[Vec3], whole: Lines) -> Lines {
        let (flat, list) = (self.flat(corners), &mut self.work.cutting);
        let start = list.len() as u32;
        for k in whole.places() {
            let found = self.breaks.cutting(list[k].event, corners, flat);
            list.extend(found);
        }
        Lines { start, end: list.len() as u32 }
    }

    /// Adds a convex polygon, cut along the lines that are certainly active, where much may be
    /// hidden behind them.
    fn cut_surely(&mut self, corners: &[Vec3], lines: Lines) {
        let worth = self.side(corners).max(LEAST_HIDDEN_TO_CUT * self.goal / self.most_over(corners));
        let list = &self.work.cutting[lines.places()];
        let matter = list.iter().filter(|line| line.surely && line.share >= worth);
        let found = matter.map(|line| self.line(line));
        let Some((plane, _)) = found.max_by(|a, b| merit(a).total_cmp(&merit(b))) else {
            return self.add(corners, lines);
        };
        for part in self.halves(corners, plane) {
            let narrower = self.narrow(&part, lines);
            self.cut_surely(&part, narrower);
            self.work.spare.push(part);
        }
    }

    fn line(&self, line: &Cutting) -> (Plane, f64) {
        (self.breaks.events[line.event as usize].plane, line.share)
    }

    /// Adds a convex polygon as quads and at most one triangle.
    fn add(&mut self, corners: &[Vec3], lines: Lines) {
        let mut start = 1;
        while start + 1 < corners.len() {
            let shape = match corners[start..] {
                [b, c] => Shape::Triangle([corners[0], b, c]),
                [b, c, d, ..] => Shape::Quad([corners[0], b, c, d]),
                _ => return,
            };
            let whole = shape.corners().len() == corners.len();
            let lines = if whole { lines } else { self.narrow(shape.corners(), lines) };
            self.start(shape, lines);
            start += shape.corners().len() - 2;
        }
    }

    /// Adds a part with its integral by the first two rules.
    fn start(&mut self, shape: Shape, lines: Lines) {
        let reach = shape.reach(&self.breaks.distance);
        let [first, second] = self.rules(&shape, [0, 1]);
        let range = self.work.points.range() * shape.area();
        let piece = self.learn(Piece::new(shape, lines, reach, first, range), second);
        self.work.parts.push(piece);
    }

    /// The integrals by some rules, the points of which are asked about together.
    fn rules<const N: usize>(&mut self, shape: &Shape, degrees: [usize; N]) -> [f64; N] {
        let points = &mut self.work.points;
        points.clear();
        let ends = degrees.map(|degree| {
            shape.points(degree, |x| points.places.push(x));
            points.places.len()
        });
        points.ask(&mut self.h);
        self.points += points.places.len();
        let mut start = 0;
        std::array::from_fn(|k| {
            let values = start..ends[k];
            start = ends[k];
            shape.sum(degrees[k], &self.work.points.found[values])
        })
    }

    /// A part with the integral by the next rule, and with what its points tell.
    fn learn(&mut self, mut piece: Piece, value: f64) -> Piece {
        piece.line = self.line_through(&piece);
        piece.cut = self.work.lines.iter().map(|(_, share)| *share).fold(0.0, f64::max);
        if piece.asks_most() {
            piece.most = self.most(&piece);
        }
        piece.raise(self.model, value, self.work.points.topology(), self.goal);
        if self.observed.scale() * piece.error < self.goal {
            self.look_behind(&mut piece);
        }
        piece
    }

    /// Largest value that h could have on a part at the points of its first rules, or at its centre
    /// where h is not steep, times the area, m².
    fn most(&self, piece: &Piece) -> f64 {
        let (most, shape) = (&self.breaks.most, &piece.shape);
        shape.area() * if piece.is_near() { self.work.points.largest(most) } else { most(shape.centre()) }
    }

    /// The active line that halves a part best, with the share of the width on its smaller side.
    /// Lists the lines behind which no point lies.
    fn line_through(&mut self, piece: &Piece) -> Option<(Plane, f64)> {
        let (flat, events) = (self.flat(piece.shape.corners()), self.breaks.events);
        let side = self.side(piece.shape.corners());
        let PiecesWork { points, cutting, lines, unseen, .. } = &mut *self.work;
        lines.clear();
        let cutting = cutting[piece.lines.places()].iter().filter(|line| line.share > side);
        lines.extend(cutting.map(|line| (events[line.event as usize].plane, line.share)));
        points.leave_out(lines, flat);
        unseen.clear();
        unseen.extend(lines.iter().filter(|(plane, _)| points.judge(*plane) == Line::Unseen));
        let shown = lines.iter().filter(|(plane, _)| points.judge(*plane) == Line::Active).copied();
        shown.max_by(|a, b| merit(a).total_cmp(&merit(b)))
    }

    /// Looks at a point behind each line that has none, where much may be hidden.
    fn look_behind(&mut self, piece: &mut Piece) {
        let flat = self.flat(piece.shape.corners());
        let PiecesWork { points, lines, unseen, .. } = &mut *self.work;
        for &(plane, share) in unseen.iter() {
            let matters = share * piece.most >= LEAST_HIDDEN_TO_LOOK_AT * self.goal;
            if !matters || points.judge(plane) != Line::Unseen {
                continue;
            }
            points.places.push(piece.shape.behind(plane, flat));
            points.ask(&mut self.h);
            self.points += 1;
            points.leave_out(lines, flat);
            if points.judge(plane) == Line::Active {
                piece.reveal(self.model, (plane, share), points.jump() * share * piece.shape.area());
            }
        }
    }

    /// Improves the part with the largest error, and those that equal it: rounding does not choose
    /// between them.
    fn improve_worst(&mut self) {
        let worst = self.work.parts.iter().map(|p| p.error).fold(0.0, f64::max);
        for k in (0..self.work.parts.len()).rev() {
            if self.work.parts[k].error >= worst * (1.0 - EQUAL_ERROR_TOLERANCE) {
                self.improve(k);
            }
        }
    }

    fn improve(&mut self, k: usize) {
        let piece = self.work.parts.swap_remove(k);
        let start = self.work.parts.len();
        if piece.pays {
            let [value] = self.rules(&piece.shape, [piece.degree + 1]);
            let piece = self.learn(piece, value);
            self.work.parts.push(piece);
        } else {
            self.divide(&piece);
        }
        let value: f64 = self.work.parts[start..].iter().map(|p| p.value).sum();
        self.observed.add(value - piece.value, piece.error);
    }

    /// Cuts a part along a line, or halves its sides. Where most of its error is what may hide
    /// between its points near lines, it is cut along these although none is known to be active:
    /// halves that they still cut keep most of that error.
    fn divide(&mut self, piece: &Piece) {
        let hidden = if piece.hides_most(self.model) { self.widest(piece) } else { None };
        match piece.line.or(hidden) {
            Some((plane, _)) => self.cut(piece, plane),
            None => {
                for part in piece.shape.quarters() {
                    let lines = self.narrow(part.corners(), piece.lines);
                    self.start(part, lines);
                }
            }
        }
    }

    /// The line that halves a part best.
    fn widest(&self, piece: &Piece) -> Option<(Plane, f64)> {
        let side = self.side(piece.shape.corners());
        let lines = self.work.cutting[piece.lines.places()].iter().filter(|line| line.share > side);
        lines.map(|line| self.line(line)).max_by(|a, b| merit(a).total_cmp(&merit(b)))
    }

    /// The two parts of a convex polygon on both sides of a plane.
    fn halves(&mut self, corners: &[Vec3], (normal, offset): Plane) -> [Vec<Vec3>; 2] {
        let (flat, spare) = (self.flat(corners), &mut self.work.spare);
        let mut half = |normal, offset| {
            let mut part = spare.pop().unwrap_or_default();
            part.clear();
            clip(corners, HalfSpace { normal, offset }, flat, &mut part);
            part
        };
        [half(normal, offset), half(-normal, -offset)]
    }

    /// What the integral over a convex polygon could be at most, m².
    fn most_over(&self, corners: &[Vec3]) -> f64 {
        self.density * area(corners)
    }

    /// The share of the width of a part which a line must leave on both sides to cut it. Behind a
    /// line h has another slope: what a rule misses there grows with the square of the share.
    fn side(&self, corners: &[Vec3]) -> f64 {
        LEAST_CUT_SHARE.min((MOST_COST_OF_NO_CUT * self.goal / self.most_over(corners)).sqrt())
    }

    /// Heights over a line that count as 0 on a part, m.
    fn flat(&self, corners: &[Vec3]) -> f64 {
        self.breaks.flat.max(ON_THE_LINE * width(corners))
    }

    fn cut(&mut self, piece: &Piece, plane: Plane) {
        let corners = piece.shape.corners();
        for part in self.halves(corners, plane) {
            let lines = self.narrow(&part, piece.lines);
            self.add(&part, lines);
            self.work.spare.push(part);
        }
    }
}

/// Area of a convex polygon, m².
fn area(corners: &[Vec3]) -> f64 {
    let doubled = corners.windows(2).map(|e| (e[0] - corners[0]).cross(e[1] - corners[0]));
    0.5 * doubled.sum::<Vec3>().length()
}

/// How well a line with this share of the width on its smaller side halves a part; of equals, the
/// place decides.
fn merit(((n, _), share): &(Plane, f64)) -> f64 {
    share + 1e-3 * n.dot(GENERIC_DIRECTION).abs()
}

/// The share of the width of a convex polygon on the smaller side of a plane that cuts it, and the
/// two ends of the cut.
fn cut(corners: &[Vec3], (n, c): Plane, flat: f64) -> Option<(f64, Option<[Vec3; 2]>)> {
    let (mut low, mut high) = (0.0f64, 0.0f64);
    let chord = chord(corners, |k| {
        let height = n.dot(corners[k]) - c;
        low = low.min(height);
        high = high.max(height);
        height
    });
    (high > flat && -low > flat).then(|| (high.min(-low) / (high - low), chord))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ over the unit square of a function with a kink along x = 0.3 and with its steep place at
    /// `near`.
    fn kinked(near: Vec3, events: &[CriticalPlane], goal: f64) -> Estimate {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let other = Topology::of(&[1]);
        let topology = |x: &Vec3| if x.x < 0.3 { other } else { Topology::default() };
        let value = |x: &Vec3| ((x.x - 0.3).max(0.0), topology(x));
        let h = |points: &[Vec3], found: &mut Vec<_>| found.extend(points.iter().map(value));
        let ev_events = &EdgeVertexEvents::default();
        let breaks = Breaks {
            events,
            ev_events,
            sure: false,
            flat: 1e-12,
            distance: |x: Vec3| x.distance(near),
            most: |_| 0.7,
        };
        Pieces::new(h, breaks, &mut PiecesWork::default(), &ErrorModel::FITTED, goal).integrate(&square, 0.7)
    }

    #[test]
    fn a_cut_along_the_kink_makes_it_exact() {
        let found = kinked(Vec3::Z * 5.0, &[CriticalPlane::always((Vec3::X, 0.3))], 1e-9);
        assert!((found.value - 0.245).abs() < 1e-14 && found.error < 1e-9, "{found:?}");
    }

    #[test]
    fn a_part_on_an_edge_of_a_body_has_an_error_that_is_a_number() {
        let found = kinked(Vec3::new(0.5, 0.5, 0.0), &[], 1e-4);
        assert!(found.error <= 1e-4 && (found.value - 0.245).abs() < 1e-3, "{found:?}");
    }
}
