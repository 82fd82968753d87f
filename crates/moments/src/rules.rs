//! Which rule suits which pair of triangles.
//!
//! Pairs that do not touch are integrated by products of symmetric rules. With the distance D of
//! their centres and radii a and b around them, a rule of degree d leaves an error that falls with
//! ((a + b)/D)^{d + 1} for the static part and with (k (a + b)/2)^{d + 1}/(d + 1)! for the phase;
//! the constants before both were measured over pairs of all kinds (see the tests). Pairs that no
//! rule suits are halved; pairs that touch have the rules of Sauter and Schwab, in which the
//! singularity is gone.

use crate::MomentsError;
use crate::kernel::{PairPoints, WIDTH};
use fredholm_quadrature::{PairPoint, symmetric_triangle, triangle_pair};
use num_complex::Complex64;

/// Degrees of the rules.
const DEGREES: [usize; CLASSES] = [2, 5, 8, 12];
/// Number of rules.
pub(crate) const CLASSES: usize = 4;
/// Measured errors of a rule of degree d without and with the magnetic part: this times ((a +
/// b)/D)^{d + 1}.
const STATIC_ERRORS: [[f64; CLASSES]; 2] = [[2.4e-3, 7e-5, 5e-6, 8e-9], [9e-2, 5e-3, 3e-4, 1e-6]];
/// Measured error of the phase: this times (|k| (a + b)/2)^{d + 1}.
const PHASE_ERRORS: [[f64; CLASSES]; 2] = [[3e-3, 1e-5, 5e-10, 1e-14], [1e-2, 4e-5, 1e-9, 1e-14]];
/// Tolerances that can be asked for.
pub(crate) const TOLERANCES: [f64; 2] = [1e-8, 0.1];

/// A rule on the triangle with weights that sum to ½, and from which distance on it is good enough.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    /// Weights of corners 1 and 2.
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) weights: Vec<f64>,
    /// Least D/(a + b).
    reach: f64,
    /// Largest a + b, m.
    largest: f64,
}

/// The rules for one tolerance and wavenumber.
#[derive(Clone, Debug)]
pub(crate) struct Rules {
    pub(crate) classes: Vec<Rule>,
    /// By the number of common corners less one, the common ones first on both.
    pub(crate) touching: [Vec<PairPoints>; 3],
}

impl Rules {
    /// For a relative error of `tolerance` of a pair, the magnetic part included or not, and waves
    /// up to |k| (1/m).
    pub(crate) fn new(tolerance: f64, k: Complex64, magnetic: bool) -> Result<Self, MomentsError> {
        let [low, high] = TOLERANCES;
        if !(low..=high).contains(&tolerance) {
            let expected = "between 1e-8 and 0.1";
            return Err(MomentsError::Parameter {
                what: "the tolerance of the integrals",
                value: tolerance,
                expected,
            });
        }
        let classes =
            (0..CLASSES).map(|class| Rule::new(class, tolerance, k.norm(), usize::from(magnetic))).collect();
        Ok(Self { classes, touching: touching(directions(tolerance, magnetic)) })
    }

    /// The first rule that suits triangles with radii that sum to `radii` at a distance of `ratio`
    /// times that; none where they have to be halved.
    pub(crate) fn class(&self, ratio: f64, radii: f64) -> Option<usize> {
        self.classes.iter().position(|rule| ratio >= rule.reach && radii <= rule.largest)
    }

    /// The rule for what a triangle with this radius radiates to the far.
    pub(crate) fn of_far(&self, radius: f64) -> &Rule {
        &self.classes[self.class(f64::INFINITY, 2.0 * radius).unwrap_or(CLASSES - 1)]
    }
}

impl Rule {
    fn new(class: usize, tolerance: f64, k: f64, part: usize) -> Self {
        let order = (DEGREES[class] + 1) as f64;
        // The degrees are those of the table.
        let rule = symmetric_triangle(DEGREES[class]).unwrap_or_default();
        Self {
            points: rule.iter().map(|p| [p.u, p.v]).collect(),
            weights: rule.iter().map(|p| p.weight).collect(),
            reach: (2.0 * STATIC_ERRORS[part][class] / tolerance).powf(order.recip()).max(1.05),
            largest: 2.0 * (0.5 * tolerance / PHASE_ERRORS[part][class]).powf(order.recip()) / k,
        }
    }
}

/// Gauss points a direction for pairs that touch. With five the measured error is 3e-5 without and
/// 1e-3 with the magnetic part, and it falls by about a factor of five with each more (see the
/// tests).
fn directions(tolerance: f64, magnetic: bool) -> usize {
    let with_five: f64 = if magnetic { 1e-3 } else { 3e-5 };
    (5.0 + (with_five / tolerance).log(5.0)).ceil().clamp(2.0, 14.0) as usize
}

/// The rules for one, two and three common corners.
fn touching(n: usize) -> [Vec<PairPoints>; 3] {
    [[0, 3, 4], [0, 1, 3], [0, 1, 2]].map(|labels| packed(&triangle_pair([0, 1, 2], labels, n)))
}

/// Pairs of points in eights; the last is repeated with weight 0.
fn packed(points: &[PairPoint]) -> Vec<PairPoints> {
    let pack = |chunk: &[PairPoint]| {
        let mut eight = PairPoints::default();
        for lane in 0..WIDTH {
            let point = chunk[lane.min(chunk.len() - 1)];
            for c in 0..2 {
                eight.observer[c][lane] = point.x[c];
                eight.source[c][lane] = point.y[c];
            }
            eight.weight[lane] = if lane < chunk.len() { point.weight } else { 0.0 };
        }
        eight
    };
    points.chunks(WIDTH).map(pack).collect()
}
