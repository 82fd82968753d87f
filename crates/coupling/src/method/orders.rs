//! Points of a Gauss rule on the parts of a patch, and the error that successive orders tell.
//!
//! With d_n = |Q_n − Q_{n−1}| and q = d_n/d_{n−1}, the steps still to come add up to d_n q/(1 − q)
//! where they fall geometrically. Where the error falls as n^(−p) they add up to d_n n/p, and q/(1
//! − q) is n/(p + 1): twice as much covers p ≥ 2 from n = 4. The larger of that and d_n is the
//! stated error. Next to a much larger patch the steps change sign, so that a small ratio may be an
//! accident: q counts as 0.06 at least. Where the integrand jumps (something is between) the values
//! scatter about the limit, and the root of d_n² + d_{n−1}² measures how far.

use crate::form_factor::jacobian;
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{Estimate, PlanePoint, collapsed_triangle, tensor_quad};

/// Smallest and largest ratio of two steps that is believed.
const CREDIBLE_RATIOS: (f64, f64) = (0.06, 0.98);
/// Stated error over the sum of a geometric series.
const SERIES_SAFETY: f64 = 2.0;
/// Stated error over the root of the summed squares of two steps, where the integrand jumps.
const JUMP_SAFETY: f64 = 2.0;
/// Rounding of a sum of positive terms, relative.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Points and weights (m²) of n × n points on each cell.
pub(super) fn placed(cells: &[Patch], n: usize) -> Vec<(Vec3, f64)> {
    let (quad, triangle) = (tensor_quad(n), collapsed_triangle(n));
    let on = |cell: &Patch| {
        let rule = if cell.sides() == 3 { &triangle } else { &quad };
        let put = |p: &PlanePoint| (cell.point(p.u, p.v), p.weight * jacobian(cell, p.u, p.v));
        rule.iter().map(put).collect::<Vec<_>>()
    };
    cells.iter().flat_map(on).collect()
}

/// The value of order `n` with its error from the two orders below; order 0 is the value 0. Behind
/// occluders (`jumps`) values scatter.
pub(super) fn settled(n: usize, jumps: bool, at: impl Fn(usize) -> f64) -> Estimate {
    let below = |k: usize| if n > k { at(n - k) } else { 0.0 };
    let (value, lower, lowest) = (at(n), below(1), below(2));
    let (step, before) = ((value - lower).abs(), (lower - lowest).abs());
    let error = if jumps { JUMP_SAFETY * step.hypot(before) } else { series(step, before) };
    Estimate { value, error: error.max(ROUNDING * value.abs()) }
}

/// What is still to come after a step and the one before it.
fn series(step: f64, before: f64) -> f64 {
    let ratio = if before > 0.0 { (step / before).min(CREDIBLE_RATIOS.1) } else { 0.0 };
    (step * (SERIES_SAFETY * ratio / (1.0 - ratio)).max(1.0)).max(CREDIBLE_RATIOS.0 * before)
}

/// Points that [`settled`] evaluates for a rule of n^`power` points.
pub(super) fn cost(n: usize, power: u32) -> u64 {
    (n.saturating_sub(2)..=n).map(|k| (k as u64).pow(power)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_the_area() {
        let quad =
            Patch::quad([Vec3::ZERO, Vec3::X * 2.0, Vec3::new(1.5, 1.0, 0.0), Vec3::Y]).unwrap().unwrap();
        let triangle = Patch::triangle([Vec3::ZERO, Vec3::X, Vec3::new(0.2, 0.0, 0.9)]).unwrap();
        for n in [1, 2, 7, 30] {
            let sum: f64 = placed(&[quad, triangle], n).iter().map(|p| p.1).sum();
            assert!((sum - quad.area() - triangle.area()).abs() < 1e-14);
        }
    }

    #[test]
    fn both_kinds_of_series_are_covered() {
        for (name, error) in
            [("geometric", (|n| 0.7f64.powi(n)) as fn(i32) -> f64), ("algebraic", |n| f64::from(n).powi(-3))]
        {
            for n in [4usize, 8, 16] {
                let got = settled(n, false, |n| 1.0 + error(n as i32));
                let truth = (got.value - 1.0).abs();
                assert!(truth <= 1.001 * got.error && got.error < 5.0 * truth, "{name} {n}: {got:?}");
            }
        }
    }
}
