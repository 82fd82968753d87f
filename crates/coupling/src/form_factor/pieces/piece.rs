//! A part of the source: the integral over it, and how well that is known. Its error is estimated
//! by the [`error_model`](crate::form_factor::error_model), which has the formula.

use super::shape::{DEGREES, Shape};
use super::{Lines, merit};
use crate::form_factor::ErrorModel;
use crate::form_factor::critical::Plane;
use crate::form_factor::shadow::Topology;

/// Ratio of two changes, and of the first change to v, below which the next rule is expected to
/// pay.
const LARGEST_CHANGE_RATIO: f64 = 0.3;
const LARGEST_FIRST_CHANGE_RATIO: f64 = 0.26;
/// Radius of a part, in its distances from what makes h steep, above which its sides are halved. No
/// simple number: in a scene with right angles the two are often equal, and rounding would decide.
const NEAR_RADIUS: f64 = 1.000_001;

/// Changes below these shares of an integral and of the goal count as that: else rounding would
/// decide what is improved next.
const ROUNDING: f64 = 1e-10;
const BESIDE_THE_GOAL: f64 = 1e-5;

/// A part, its integral and how that converged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub shape: Shape,
    /// Lines that cut it and may be active.
    pub lines: Lines,
    /// Radius over the distance from what makes h steep.
    reach: f64,
    /// Largest value that h could have at the first points, times the area, m², where that has a
    /// say.
    pub most: f64,
    /// Range of h at the first points, times the area, m².
    range: f64,
    /// Place in [`DEGREES`].
    pub degree: usize,
    pub value: f64,
    /// Difference to the degree before.
    step: f64,
    pub error: f64,
    /// The topology of all points so far, or `None` where they differ.
    topology: Option<Topology>,
    /// Largest share of the width behind a line.
    pub cut: f64,
    /// The line along which the part is cut next, and the share of the width on its smaller side.
    pub line: Option<(Plane, f64)>,
    /// Whether the next rule pays more than smaller parts.
    pub pays: bool,
}

impl Piece {
    /// A part with the lines through it, its reach, the integral by the first rule, and the range
    /// of h at the points of the first two times the area.
    pub(super) fn new(shape: Shape, lines: Lines, reach: f64, value: f64, range: f64) -> Self {
        let (most, step, error, cut, topology, line) = (0.0, 0.0, 0.0, 0.0, None, None);
        Self {
            shape,
            lines,
            reach,
            most,
            range,
            degree: 0,
            value,
            step,
            error,
            topology,
            cut,
            line,
            pays: true,
        }
    }

    /// Whether h is steep on it.
    pub(super) fn is_near(&self) -> bool {
        self.reach > NEAR_RADIUS
    }

    /// Whether the largest value that h could have has a say in the error, and is not known yet.
    pub(super) fn asks_most(&self) -> bool {
        self.degree == 0 && (self.is_near() || self.cut > 0.0)
    }

    /// Takes the integral by the next rule, with the topology of its points. `goal` is the error
    /// allowed to the whole, m².
    pub(super) fn raise(&mut self, model: &ErrorModel, value: f64, topology: Option<Topology>, goal: f64) {
        let negligible = (ROUNDING * value.abs()).min(BESIDE_THE_GOAL * goal);
        let step = (value - self.value).abs().max(negligible);
        let first = self.degree == 0;
        self.topology = topology.filter(|_| first || self.topology == topology);
        let before = if first || self.topology.is_none() { self.range } else { self.step }.max(step);
        self.degree += 1;
        self.error = self.estimate(model, step, before) + self.between(model);
        let quick = step < if first { LARGEST_FIRST_CHANGE_RATIO } else { LARGEST_CHANGE_RATIO } * before
            || self.hides_most(model);
        self.pays = self.topology.is_some() && !self.is_near() && quick && self.degree + 1 < DEGREES.len();
        (self.value, self.step) = (value, step);
    }

    /// Whether what may hide between its points is most of its error.
    pub(super) fn hides_most(&self, model: &ErrorModel) -> bool {
        2.0 * self.between(model) > self.error
    }

    /// What may hide between the points near a line, m².
    fn between(&self, model: &ErrorModel) -> f64 {
        model.between[0] * model.between[1].powi(self.degree as i32 - 1) * self.cut * self.most
    }

    fn estimate(&self, model: &ErrorModel, s: f64, v: f64) -> f64 {
        let (r, m) = (self.reach, self.most);
        let ([a, a1, a2], [b, c], [e, f, g]) = (model.smooth, model.smooth_near, model.broken_near);
        match (self.topology.is_some(), r <= NEAR_RADIUS) {
            (true, true) => r * (r * (a * a * s * v + a1 * a1 * v * v + a2 * a2 * s * s)).sqrt(),
            (false, true) => model.broken * (s * v).sqrt(),
            (true, false) => (r * (b * b * m * m + c * c * s * s)).sqrt(),
            (false, false) => r * (e * e * s * m + f * f * m * m + g * g * s * s).sqrt(),
        }
    }

    /// An active line has no point of the rule behind it; `missed` is by how much the integral may
    /// be off, m².
    pub(super) fn reveal(&mut self, model: &ErrorModel, line: (Plane, f64), missed: f64) {
        self.topology = None;
        self.pays = false;
        self.error = self.error.max(model.behind * missed);
        if self.line.is_none_or(|other| merit(&line) > merit(&other)) {
            self.line = Some(line);
        }
    }
}
