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

/// Number of rules.
pub(crate) const CLASSES: usize = 4;

/// Degrees of the rules, and their measured errors without and with the magnetic part.
struct Calibration {
    degrees: [usize; CLASSES],
    /// Degrees that the functions take.
    lost: usize,
    /// This times ((a + b)/D)^{d + 1 − lost}.
    of_distance: [[f64; CLASSES]; 2],
    /// Of the phase: this times (|k| (a + b)/2)^{d + 1 − lost}.
    of_phase: [[f64; CLASSES]; 2],
    /// Of five Gauss points a direction for pairs with one, two and three common corners.
    of_five: [[f64; 2]; 3],
    /// What each more divides that by.
    of_one_more: f64,
}

/// Of functions of the lowest order on flat triangles.
const LOWEST: Calibration = Calibration {
    degrees: [2, 5, 8, 12],
    lost: 0,
    of_distance: [[2.4e-3, 7e-5, 5e-6, 8e-9], [9e-2, 5e-3, 3e-4, 1e-6]],
    of_phase: [[3e-3, 1e-5, 5e-10, 1e-14], [1e-2, 4e-5, 1e-9, 1e-14]],
    of_five: [[6e-6, 2.6e-4], [3e-5, 1e-3], [3e-5, 4e-4]],
    of_one_more: 5.0,
};
/// Of those of the first full order.
const FIRST: Calibration = Calibration {
    degrees: [5, 8, 10, 13],
    lost: 2,
    of_distance: [[2e-4, 9e-6, 4e-7, 4.2e-8], [6e-3, 2.6e-4, 2.1e-5, 2.5e-6]],
    of_phase: [[1.2e-4, 2.6e-8, 2e-10, 5e-14], [2.6e-4, 1.4e-7, 1.1e-9, 1e-13]],
    of_five: [[6e-6, 2.6e-4], [3e-5, 1e-3], [3e-5, 6e-4]],
    of_one_more: 5.5,
};
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
        Self::with(&LOWEST, tolerance, k, magnetic)
    }

    /// The same for functions of the first full order.
    pub(crate) fn of_first_order(tolerance: f64, k: Complex64, magnetic: bool) -> Result<Self, MomentsError> {
        Self::with(&FIRST, tolerance, k, magnetic)
    }

    fn with(
        errors: &Calibration,
        tolerance: f64,
        k: Complex64,
        magnetic: bool,
    ) -> Result<Self, MomentsError> {
        let [low, high] = TOLERANCES;
        if !(low..=high).contains(&tolerance) {
            let expected = "between 1e-8 and 0.1";
            return Err(MomentsError::Parameter {
                what: "the tolerance of the integrals",
                value: tolerance,
                expected,
            });
        }
        let part = usize::from(magnetic);
        let classes = (0..CLASSES).map(|class| Rule::new(errors, class, tolerance, k.norm(), part)).collect();
        let touching = [0, 1, 2].map(|kind| {
            let labels = [[0, 3, 4], [0, 1, 3], [0, 1, 2]][kind];
            let of_five = errors.of_five[kind][part];
            packed(&triangle_pair([0, 1, 2], labels, directions(of_five, errors.of_one_more, tolerance)))
        });
        Ok(Self { classes, touching })
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
    fn new(errors: &Calibration, class: usize, tolerance: f64, k: f64, part: usize) -> Self {
        let degree = errors.degrees[class];
        let order = (degree + 1 - errors.lost) as f64;
        // The degrees are those of the table.
        let rule = symmetric_triangle(degree).unwrap_or_default();
        Self {
            points: rule.iter().map(|p| [p.u, p.v]).collect(),
            weights: rule.iter().map(|p| p.weight).collect(),
            reach: (2.0 * errors.of_distance[part][class] / tolerance).powf(order.recip()).max(1.05),
            largest: 2.0 * (0.5 * tolerance / errors.of_phase[part][class]).powf(order.recip()) / k,
        }
    }
}

/// Gauss points a direction for pairs that touch (see the tests of `pairs` and `element_pairs` for
/// the errors).
fn directions(of_five: f64, of_one_more: f64, tolerance: f64) -> usize {
    // Up to half above the tolerance is within what the errors differ by; two points are lost.
    let more = (of_five / (1.5 * tolerance)).log(of_one_more);
    (5.0 + more).ceil().clamp(3.0, 14.0) as usize
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
