//! Gauss–Legendre rules on [−½, ½] by pairs of opposite nodes ±s, which share their weight.

use fredholm_quadrature::gauss_legendre;
use std::sync::LazyLock;

/// Highest number of points along an edge.
pub(super) const MAX_POINTS: usize = 12;

static RULES: LazyLock<Vec<Vec<Node>>> = LazyLock::new(|| (0..=MAX_POINTS).map(halves).collect());

/// Two nodes ±s, or the one at s = 0.
#[derive(Clone, Copy)]
pub(super) struct Node {
    /// Place s ≥ 0; edges run from −½ to ½.
    pub place: f64,
    /// Weight of each; all weights sum to 1.
    pub weight: f64,
}

/// The rule of `points` points, at most [`MAX_POINTS`].
pub(super) fn rule(points: usize) -> &'static [Node] {
    &RULES[points]
}

fn halves(points: usize) -> Vec<Node> {
    let rule = gauss_legendre(points);
    let upper = rule.points.iter().zip(&rule.weights).skip(points / 2);
    upper.map(|(&x, &weight)| Node { place: x - 0.5, weight }).collect()
}
