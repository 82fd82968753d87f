//! Convergence on meshes that are each twice as fine as the one before: E_l = E + C h_l^p + …
//!
//! With steps δ_l = E_l − E_(l−1) the observed order is p = log₂(‖δ_(l−1)‖/‖δ_l‖), the limit is
//! Richardson's E ≈ E_l + δ_l/(2^p − 1), and what remains is ‖E − E_l‖ = ‖δ_l‖/(2^p − 1): L. F.
//! Richardson, J. A. Gaunt, Phil. Trans. R. Soc. A 226 (1927) 299, doi:10.1098/rsta.1927.0008. The
//! norm is ‖E‖ = √(Σ w E²) over values that exist on every mesh, such as means over faces with
//! their areas as weights. A sequence whose steps do not fall, or do not point the same way, has no
//! order. Everything stated is relative to the norm of the finest values.

use fredholm_quadrature::richardson;

/// Refinement from one mesh to the next.
const RATIO: f64 = 2.0;
/// Cosine between two steps above which they point the same way.
const ALIGNED_COSINE: f64 = 0.5;

/// What a sequence comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// It converges with this order; `remaining` is the relative error of the finest values.
    Order {
        /// p of the last three meshes.
        order: f64,
        /// ‖E − E_L‖/‖E_L‖, by this order or the highest that lasts.
        remaining: f64,
    },
    /// The last two steps are no larger than what the values are known to. One alone may be so by
    /// symmetry.
    Settled,
    /// The last step is no larger than what the values are known to, the one before is.
    Lost,
    /// The last two steps do not fall, or point different ways.
    Irregular,
    /// An order takes three meshes.
    TooFew,
}

/// Convergence of a sequence. Vectors have one entry a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// ‖E_l − E_L‖ to the finest values.
    pub difference: Vec<f64>,
    /// Order from this mesh and the two before.
    pub order: Vec<Option<f64>>,
    /// What remains by that order, or the highest that lasts.
    pub remaining: Vec<Option<f64>>,
    /// ‖E_l − E‖ to Richardson's limit, where the sequence has an order.
    pub error: Vec<Option<f64>>,
    /// What it comes to.
    pub verdict: Verdict,
}

/// Follows values on successive meshes, meshes × values, with their weights. Steps up to `noise`,
/// relative to the norm, are taken for rounding. An order above `highest`, the method's own on
/// smooth fields, is stated but does not last: what remains follows from `highest` then.
///
/// ```
/// use fredholm_discretisation::{Verdict, convergence};
///
/// let levels: Vec<Vec<f64>> = [1.0, 0.25, 0.0625].map(|h2| vec![3.0 + h2, 2.0 - h2]).to_vec();
/// let found = convergence(&levels, &[1.0, 1.0], 1e-12, 2.0);
/// let Verdict::Order { order, .. } = found.verdict else { panic!("the steps fall by four") };
/// assert!((order - 2.0).abs() < 1e-12);
/// ```
#[must_use]
pub fn convergence(levels: &[Vec<f64>], weights: &[f64], noise: f64, highest: f64) -> Convergence {
    let Some(finest) = levels.last() else { return nothing() };
    let norm = Norm { weights, unit: norm(weights, finest) };
    let order: Vec<_> = (0..levels.len()).map(|l| order(levels, l, &norm, noise)).collect();
    let remains = |l: usize| {
        order[l].map(|p| norm.distance(&levels[l], &levels[l - 1]) / (RATIO.powf(p.min(highest)) - 1.0))
    };
    let remaining: Vec<_> = (0..levels.len()).map(remains).collect();
    let limit = order[levels.len() - 1].map(|p| limit(levels, p.min(highest)));
    let error = |values: &Vec<f64>| limit.as_ref().map(|limit| norm.distance(values, limit));
    Convergence {
        difference: levels.iter().map(|values| norm.distance(values, finest)).collect(),
        error: levels.iter().map(error).collect(),
        verdict: verdict(levels, last(&order).zip(last(&remaining)), &norm, noise),
        order,
        remaining,
    }
}

fn nothing() -> Convergence {
    let [order, remaining, error] = [const { Vec::new() }; 3];
    Convergence { difference: Vec::new(), order, remaining, error, verdict: Verdict::TooFew }
}

fn last(values: &[Option<f64>]) -> Option<f64> {
    values.last().copied().flatten()
}

fn verdict(levels: &[Vec<f64>], found: Option<(f64, f64)>, norm: &Norm, noise: f64) -> Verdict {
    if let Some((order, remaining)) = found {
        return Verdict::Order { order, remaining };
    }
    let [.., first, second, third] = levels else { return Verdict::TooFew };
    let lost = |a: &[f64], b: &[f64]| norm.distance(a, b) <= noise;
    match (lost(first, second), lost(second, third)) {
        (true, true) => Verdict::Settled,
        (false, true) => Verdict::Lost,
        _ => Verdict::Irregular,
    }
}

/// Order from level `l` and the two before, where the steps fall and point the same way.
fn order(levels: &[Vec<f64>], l: usize, norm: &Norm, noise: f64) -> Option<f64> {
    let [first, second, third] = levels.get(l.checked_sub(2)?..=l)? else { return None };
    let (before, step) = (norm.distance(second, first), norm.distance(third, second));
    let aligned =
        norm.product(&difference(second, first), &difference(third, second)) > ALIGNED_COSINE * before * step;
    (step > noise && step < before && aligned).then(|| (before / step).log2())
}

/// Richardson's limit of the last two levels for an order.
fn limit(levels: &[Vec<f64>], order: f64) -> Vec<f64> {
    let [.., before, last] = levels else { return Vec::new() };
    before.iter().zip(last).map(|(&a, &b)| richardson(&[a, b], RATIO, &[order]).value).collect()
}

/// Norms and products relative to `unit`.
struct Norm<'a> {
    weights: &'a [f64],
    unit: f64,
}

impl Norm<'_> {
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.scaled(norm(self.weights, &difference(a, b)), self.unit)
    }

    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        self.scaled(product(self.weights, a, b), self.unit * self.unit)
    }

    /// Values that are 0 everywhere have no size to be relative to.
    fn scaled(&self, value: f64, unit: f64) -> f64 {
        if self.unit > 0.0 { value / unit } else { value }
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn norm(weights: &[f64], values: &[f64]) -> f64 {
    product(weights, values, values).sqrt()
}

fn product(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    weights.iter().zip(a.iter().zip(b)).map(|(w, (a, b))| w * a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values 3 + h^p and 5 − 2 h^p for h = 1, ½, ¼, …
    fn series(p: f64, levels: i32) -> Vec<Vec<f64>> {
        let power = |l: i32| 0.5_f64.powf(p * f64::from(l));
        (0..levels).map(|l| vec![3.0 + power(l), 5.0 - 2.0 * power(l)]).collect()
    }

    #[test]
    fn power_laws_have_their_order_limit_and_error() {
        let weights = [2.0, 0.5];
        for p in [0.5, 1.0, 2.0, 4.0] {
            let levels = series(p, 4);
            let found = convergence(&levels, &weights, 1e-14, 4.0);
            let Verdict::Order { order, remaining } = found.verdict else { panic!("{found:?}") };
            assert!((order - p).abs() < 1e-9, "{order}");
            // √(2 + ½ 4) h^p over the norm of the finest values.
            let h = 0.5_f64.powf(3.0 * p);
            let exact = 2.0 * h / (2.0 * (3.0 + h).powi(2) + 0.5 * (5.0 - 2.0 * h).powi(2)).sqrt();
            assert!((remaining / exact - 1.0).abs() < 1e-8, "{remaining} {exact}");
            assert!((found.error[3].unwrap() / exact - 1.0).abs() < 1e-8);
            assert_eq!((found.order[0], found.order[1], found.difference[3]), (None, None, 0.0));
        }
    }

    #[test]
    fn what_swings_or_grows_has_no_order() {
        let swinging: Vec<_> = (0..4).map(|l| vec![1.0 + (-0.5_f64).powi(l)]).collect();
        let growing: Vec<_> = (0..4).map(|l| vec![2.0_f64.powi(l)]).collect();
        let turning = vec![vec![1.0, 1.0], vec![1.4, 1.0], vec![1.4, 1.2]];
        for levels in [swinging, growing, turning] {
            let found = convergence(&levels, &[1.0, 1.0], 1e-14, 4.0);
            assert_eq!(found.verdict, Verdict::Irregular, "{levels:?}");
            assert!(found.error.iter().all(Option::is_none));
        }
    }

    #[test]
    fn an_order_above_that_of_the_method_does_not_make_what_remains_less() {
        let (steep, weights) = (series(6.0, 3), [1.0, 1.0]);
        let found = convergence(&steep, &weights, 1e-14, 2.0);
        let Verdict::Order { order, remaining } = found.verdict else { panic!("{found:?}") };
        assert!((order - 6.0).abs() < 1e-9, "{order}");
        assert!((remaining - found.difference[1] / 3.0).abs() < 1e-15, "{remaining}");
        assert!((found.error[2].unwrap() / remaining - 1.0).abs() < 1e-9);
    }

    #[test]
    fn rounding_is_told_from_convergence_and_two_meshes_are_too_few() {
        let rounding = [1.0, 1.0 + 4e-16, 1.0 - 2e-16].map(|x| vec![x]);
        assert_eq!(convergence(&rounding, &[1.0], 1e-14, 4.0).verdict, Verdict::Settled);
        assert_eq!(convergence(&series(2.0, 2), &[1.0, 1.0], 1e-14, 4.0).verdict, Verdict::TooFew);
        assert_eq!(convergence(&[], &[], 1e-14, 4.0).verdict, Verdict::TooFew);
        let alike = [1.5, 1.5, 1.1, 1.02, 1.02].map(|x| vec![x]);
        for (levels, verdict) in [(2, Verdict::TooFew), (3, Verdict::Irregular), (5, Verdict::Lost)] {
            assert_eq!(
                convergence(&alike[..levels], &[1.0], 1e-14, 4.0).verdict,
                verdict,
                "by accident alike"
            );
        }
        assert_eq!(convergence(&vec![vec![0.0]; 3], &[1.0], 1e-14, 4.0).verdict, Verdict::Settled);
    }
}
