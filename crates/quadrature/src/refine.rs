//! Global adaptive integration: the cell with the largest error is cut, until Σ errors ≤ tolerance.
//!
//! R. Piessens et al., *QUADPACK*, Springer 1983, section 2.2.3, doi:10.1007/978-3-642-61786-7, for
//! the strategy. The value of a cell is that of its parts, and its step d = |Q(cell) − Σ Q(parts)|.
//! Steps that fall by q from one cut to the next leave d q/(1 − q) to come, more than d where a
//! singularity makes q > ½; the error taken is the larger of the two. Ties go to the older cell, so
//! that the result never depends on chance. A peak that falls between all points of the first rule
//! is not seen: start from a composed rule that is fine enough. A value that is not a number ends
//! the work with an error of NaN, and so does an infinite one that the cell and its parts both
//! have; the cell is cut on where only one of them meets the pole.

use crate::{Estimate, IntervalRule, PlanePoint};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// When to stop refining.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Absolute error to reach, in the unit of the integral.
    pub tolerance: f64,
    /// Most cells to cut; where they do not suffice, the error of the result stays above the
    /// tolerance.
    pub cuts: usize,
}

/// ∫ₐᵇ f by `rule`. For integrands with end-point singularities;
/// [`integrate_adaptive`](crate::integrate_adaptive) is cheaper to run for smooth ones.
///
/// ```
/// use fredholm_quadrature::{Goal, adaptive_interval, gauss_legendre};
/// let goal = Goal { tolerance: 1e-10, cuts: 500 };
/// let got = adaptive_interval(&gauss_legendre(8), 0.0, 1.0, goal, |x| 1.0 / x.sqrt());
/// assert!((got.value - 2.0).abs() < 1e-10);
/// ```
pub fn adaptive_interval(
    rule: &IntervalRule,
    a: f64,
    b: f64,
    goal: Goal,
    mut f: impl FnMut(f64) -> f64,
) -> Estimate {
    let halves = |&(a, b): &(f64, f64)| {
        let middle = 0.5 * (a + b);
        vec![(a, middle), (middle, b)]
    };
    refine(&(a, b), goal, halves, |&(a, b)| rule.integrate(a, b, &mut f))
}

/// ∫₀¹∫₀¹ f(u, v) du dv by a rule for the unit square.
///
/// ```
/// use fredholm_quadrature::{Goal, adaptive_quad, tensor_quad};
/// let goal = Goal { tolerance: 1e-10, cuts: 1000 };
/// let got = adaptive_quad(&tensor_quad(6), goal, |u, v| 1.0 / u.hypot(v));
/// assert!((got.value - 2.0 * 1f64.asinh()).abs() < 1e-10);
/// ```
pub fn adaptive_quad(rule: &[PlanePoint], goal: Goal, mut f: impl FnMut(f64, f64) -> f64) -> Estimate {
    let quarters = |&(u, v, side): &(f64, f64, f64)| {
        let h = 0.5 * side;
        vec![(u, v, h), (u + h, v, h), (u, v + h, h), (u + h, v + h, h)]
    };
    refine(&(0.0, 0.0, 1.0), goal, quarters, |&(u, v, side)| {
        let sum: f64 = rule.iter().map(|p| p.weight * f(u + side * p.u, v + side * p.v)).sum();
        side * side * sum
    })
}

/// ∫∫ f(u, v) du dv over u, v ≥ 0, u + v ≤ 1 by a rule for the unit triangle.
///
/// ```
/// use fredholm_quadrature::{Goal, adaptive_triangle, symmetric_triangle};
/// let goal = Goal { tolerance: 1e-10, cuts: 1000 };
/// let got = adaptive_triangle(&symmetric_triangle(12)?, goal, |u, v| (u + v).ln());
/// assert!((got.value + 0.25).abs() < 1e-10);
/// # Ok::<(), fredholm_quadrature::RuleError>(())
/// ```
pub fn adaptive_triangle(rule: &[PlanePoint], goal: Goal, mut f: impl FnMut(f64, f64) -> f64) -> Estimate {
    // A negative size is the triangle turned by 180°.
    let quarters = |&(u, v, size): &(f64, f64, f64)| {
        let h = 0.5 * size;
        vec![(u, v, h), (u + h, v, h), (u, v + h, h), (u + h, v + h, -h)]
    };
    refine(&(0.0, 0.0, 1.0), goal, quarters, |&(u, v, size)| {
        let sum: f64 = rule.iter().map(|p| p.weight * f(u + size * p.u, v + size * p.v)).sum();
        size * size * sum
    })
}

/// Largest ratio of successive steps that is believed; a larger one is not yet a trend.
const LARGEST_STEP_RATIO: f64 = 0.98;

/// A cell that has been cut once to learn its error.
struct Region<C> {
    parts: Vec<(C, f64)>,
    value: f64,
    step: f64,
    error: f64,
    birth: usize,
}

impl<C> Region<C> {
    fn new(
        cell: &C,
        coarse: f64,
        birth: usize,
        cut: &impl Fn(&C) -> Vec<C>,
        q: &mut impl FnMut(&C) -> f64,
    ) -> Self {
        let measured = |part: C| {
            let value = q(&part);
            (part, value)
        };
        let parts: Vec<_> = cut(cell).into_iter().map(measured).collect();
        let value = parts.iter().map(|part| part.1).sum::<f64>();
        let step = (value - coarse).abs();
        Self { parts, value, step, error: step, birth }
    }
}

/// Sets the errors of the parts of a cell whose own step was `step`, 0 where there was none.
fn weigh<C>(parts: &mut [Region<C>], step: f64) {
    let ratio = (parts.iter().map(|part| part.step).sum::<f64>() / step).min(LARGEST_STEP_RATIO);
    for part in parts {
        part.error = part.step * (ratio / (1.0 - ratio)).max(1.0);
    }
}

impl<C> PartialEq for Region<C> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<C> Eq for Region<C> {}

impl<C> PartialOrd for Region<C> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<C> Ord for Region<C> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error).then(other.birth.cmp(&self.birth))
    }
}

/// The parts of a region as regions, numbered from `born`.
fn children<C>(
    region: &Region<C>,
    born: usize,
    cut: &impl Fn(&C) -> Vec<C>,
    q: &mut impl FnMut(&C) -> f64,
) -> Vec<Region<C>> {
    let mut parts = Vec::with_capacity(region.parts.len());
    for (part, value) in &region.parts {
        parts.push(Region::new(part, *value, born + parts.len(), cut, q));
    }
    weigh(&mut parts, region.step);
    parts
}

/// Cuts the worst cell again and again. `q` is the rule on one cell.
fn refine<C>(whole: &C, goal: Goal, cut: impl Fn(&C) -> Vec<C>, mut q: impl FnMut(&C) -> f64) -> Estimate {
    let coarse = q(whole);
    let mut first = [Region::new(whole, coarse, 0, &cut, &mut q)];
    weigh(&mut first, 0.0);
    let (mut error, mut born) = (first[0].error, 1);
    let mut heap = BinaryHeap::from(first);
    for _ in 0..goal.cuts {
        // The running sum drifts by rounding and loses all in ∞ − ∞, so that only a fresh one may
        // end the work.
        if error <= goal.tolerance || error.is_nan() {
            error = heap.iter().map(|region| region.error).sum();
        }
        if error <= goal.tolerance || error.is_nan() {
            break;
        }
        let Some(worst) = heap.pop() else { break };
        let parts = children(&worst, born, &cut, &mut q);
        born += parts.len();
        error += parts.iter().map(|part| part.error).sum::<f64>() - worst.error;
        heap.extend(parts);
    }
    total(heap)
}

/// The sum over all regions in the order of their birth.
fn total<C>(heap: BinaryHeap<Region<C>>) -> Estimate {
    let mut regions = heap.into_vec();
    regions.sort_by_key(|region| region.birth);
    regions
        .iter()
        .map(|r| Estimate { value: r.value, error: r.error })
        .fold(Estimate::default(), |a, b| a + b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exactness::{interval_degree_of, square_degree_of, triangle_degree_of};
    use crate::{gauss_legendre, symmetric_triangle, tensor_quad};
    use std::f64::consts::{LN_2, PI, SQRT_2};

    type Curve = fn(f64) -> f64;
    type Surface = fn(f64, f64) -> f64;

    /// Meets the tolerance, says so, and the estimate bounds the error.
    fn met(got: Estimate, exact: f64, tolerance: f64, name: &str) {
        let error = (got.value - exact).abs();
        assert!(got.error <= tolerance, "{name} at {tolerance:e}: estimated {:e}", got.error);
        assert!(
            error <= got.error + 1e-14 * exact.abs(),
            "{name} at {tolerance:e}: {error:e} against {:e}",
            got.error
        );
    }

    #[test]
    fn meets_its_tolerance_on_the_interval() {
        let cases: [(&str, Curve, f64); 7] = [
            ("x^-1/2", |x| 1.0 / x.sqrt(), 2.0),
            ("x^-0.9", |x| x.powf(-0.9), 10.0),
            ("ln x", f64::ln, -1.0),
            ("ln² x", |x| x.ln().powi(2), 2.0),
            ("|x - 1/3|", |x| (x - 1.0 / 3.0).abs(), 5.0 / 18.0),
            ("step", |x| f64::from(u8::from(x > 0.3)), 0.7),
            ("peak", |x| 1e-4 / (1e-8 + (x - 0.4).powi(2)), 6000f64.atan() + 4000f64.atan()),
        ];
        for (name, f, exact) in cases {
            for tolerance in [1e-3, 1e-7, 1e-11] {
                met(
                    adaptive_interval(&gauss_legendre(10), 0.0, 1.0, Goal { tolerance, cuts: 2000 }, f),
                    exact,
                    tolerance,
                    name,
                );
            }
        }
    }

    #[test]
    fn meets_its_tolerance_on_the_square() {
        let lorentz = |x: f64| 0.01 / (1e-4 + (x - 0.4).powi(2));
        let cases: [(&str, Surface, f64, f64); 6] = [
            ("1/r at a corner", |u, v| 1.0 / u.hypot(v), 2.0 * 1f64.asinh(), 1e-11),
            ("1/(1 - uv)", |u, v| 1.0 / (1.0 - u * v), PI * PI / 6.0, 1e-9),
            ("ln(u + v)", |u, v| (u + v).ln(), 2.0 * LN_2 - 1.5, 1e-11),
            ("sqrt(uv)", |u, v| (u * v).sqrt(), 4.0 / 9.0, 1e-6),
            ("|u - v|", |u, v| (u - v).abs(), 1.0 / 3.0, 1e-6),
            ("1/r inside", |u, v| 1.0 / (u - 0.5).hypot(v - 0.5), 4.0 * 1f64.asinh(), 1e-10),
        ];
        for (name, f, exact, finest) in cases {
            for tolerance in [1e-3, finest] {
                met(
                    adaptive_quad(&tensor_quad(6), Goal { tolerance, cuts: 20_000 }, f),
                    exact,
                    tolerance,
                    name,
                );
            }
        }
        let goal = Goal { tolerance: 1e-8, cuts: 20_000 };
        let exact = (60f64.atan() + 40f64.atan()).powi(2);
        met(adaptive_quad(&tensor_quad(6), goal, |u, v| lorentz(u) * lorentz(v)), exact, 1e-8, "peak");
    }

    #[test]
    fn meets_its_tolerance_on_the_triangle() {
        let rule = symmetric_triangle(12).unwrap();
        let cases: [(&str, Surface, f64, f64); 5] = [
            ("1/r at a corner", |u, v| 1.0 / u.hypot(v), SQRT_2 * 1f64.asinh(), 1e-10),
            ("ln(u + v)", |u, v| (u + v).ln(), -0.25, 1e-10),
            ("u^-1/2", |u, _| 1.0 / u.sqrt(), 4.0 / 3.0, 1e-2),
            ("sqrt(u)", |u, _| u.sqrt(), 4.0 / 15.0, 1e-7),
            ("ridge", |u, v| 1.0 / (1e-4 + (u + v - 0.5).powi(2)), 100.0 * 50f64.atan(), 1e-6),
        ];
        for (name, f, exact, finest) in cases {
            for tolerance in [1e-1, finest] {
                met(adaptive_triangle(&rule, Goal { tolerance, cuts: 20_000 }, f), exact, tolerance, name);
            }
        }
    }

    #[test]
    fn says_so_when_it_runs_out_of_cuts() {
        let goal = Goal { tolerance: 1e-12, cuts: 3 };
        assert!(adaptive_quad(&tensor_quad(2), goal, |u, v| 1.0 / u.hypot(v)).error > 1e-3);
    }

    #[test]
    fn a_value_that_is_no_number_stays_visible() {
        let goal = Goal { tolerance: 1e-12, cuts: 50 };
        assert!(adaptive_interval(&gauss_legendre(3), 0.0, 1.0, goal, |_| f64::NAN).error.is_nan());
        let beyond = |x: f64| if x > 0.6 { f64::INFINITY } else { x };
        assert!(adaptive_interval(&gauss_legendre(3), 0.0, 1.0, goal, beyond).error.is_nan());
        assert!(adaptive_quad(&tensor_quad(3), goal, |u, _| (u - 0.3).sqrt()).error.is_nan());
        assert!(adaptive_triangle(&tensor_quad(3), goal, |u, _| (u - 0.3).ln()).error.is_nan());
    }

    #[test]
    fn a_pole_at_a_point_of_the_first_rule_alone_is_cut_away() {
        let goal = Goal { tolerance: 1e-5, cuts: 500 };
        let got = adaptive_interval(&gauss_legendre(3), 0.0, 1.0, goal, |x| 1.0 / (x - 0.5).abs().sqrt());
        met(got, 8f64.sqrt(), 1e-5, "pole in the middle");
    }

    #[test]
    fn a_single_cut_has_the_degree_of_the_rule() {
        let goal = Goal { tolerance: 0.0, cuts: 0 };
        for n in 1..=10 {
            let (line, plane) = (gauss_legendre(n), tensor_quad(n));
            let triangle = symmetric_triangle(2 * n).unwrap();
            let label = format!("n = {n}");
            interval_degree_of(&label, 2 * n - 1, |f| adaptive_interval(&line, 0.0, 1.0, goal, f).value);
            square_degree_of(&label, 2 * n - 1, |f| adaptive_quad(&plane, goal, f).value);
            triangle_degree_of(&label, 2 * n, |f| adaptive_triangle(&triangle, goal, f).value);
        }
    }
}
