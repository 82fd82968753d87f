//! Rules on the unit interval: ∫₀¹ f(x) dx ≈ Σ wᵢ f(xᵢ).

/// Points and weights on [0, 1], with the degree up to which the rule is exact.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalRule {
    /// Points, increasing.
    pub points: Vec<f64>,
    /// Weights, summing to 1, or to the integral of the weight function where the rule has one.
    pub weights: Vec<f64>,
    /// Largest degree of the polynomials that are integrated exactly.
    pub degree: usize,
}

impl IntervalRule {
    /// Σ wᵢ f(a + (b − a) xᵢ) (b − a), the integral of f over [a, b].
    pub fn integrate(&self, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let nodes = self.points.iter().zip(&self.weights);
        (b - a) * nodes.map(|(&x, &w)| w * f(a + (b - a) * x)).sum::<f64>()
    }
}
