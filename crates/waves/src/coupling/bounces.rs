//! The Neumann series x_n = b + K b + … + K^{n−1} b, one bounce a term, and how fast it converges.
//!
//! The residual of x_n is b − x_n + K x_n = Kⁿ b, so that every bounce tells the error in the
//! equation of the sum before it. The growth of a term tends to the spectral radius ϱ(K) (I.
//! Gelfand, Mat. Sb. 9 (1941) 3; as the power method J. H. Wilkinson, The Algebraic Eigenvalue
//! Problem, Oxford 1965, ch. 9): above 1 the series diverges. The power method carries on from an
//! arbitrary start, since the incident wave may miss what grows.

use fredholm_linop::{LinearOperator, MultiVector, Watch};
use num_complex::Complex64;

type Vectors = MultiVector<Complex64>;

/// A sum of bounces.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounces {
    /// x_n.
    pub x: Vectors,
    /// ‖Kᵐ b‖₂/‖b‖₂ for m = 0 … n, each right-hand side: the residuals after so many bounces. 0
    /// where b is.
    pub residuals: Vec<Vec<f64>>,
}

impl Bounces {
    /// x after `count` bounces (at least one is summed), or `None` where `watch` breaks.
    #[must_use]
    pub fn sum(
        coupling: &dyn LinearOperator<Complex64>,
        b: &Vectors,
        count: usize,
        watch: &dyn Watch,
    ) -> Option<Self> {
        let scale = b.norms();
        let relative = |term: &Vectors| {
            let shares = term.norms().into_iter().zip(&scale);
            shares.map(|(norm, &scale)| if scale > 0.0 { norm / scale } else { 0.0 }).collect()
        };
        let mut bounces = Self { x: b.clone(), residuals: vec![relative(b)] };
        let one = vec![Complex64::ONE; b.rhs_count()];
        let mut term = b.clone();
        for bounce in 1..=count.max(1) {
            if watch.go_on().is_break() {
                return None;
            }
            term = product(coupling, &term);
            bounces.residuals.push(relative(&term));
            if bounce < count {
                bounces.x.add_scaled(&one, &term);
            }
        }
        Some(bounces)
    }
}

/// ϱ(K) as the mean growth of a vector over the later half of `steps` applications, or `None` where
/// `watch` breaks.
#[must_use]
pub fn spectral_radius(
    coupling: &dyn LinearOperator<Complex64>,
    steps: usize,
    watch: &dyn Watch,
) -> Option<f64> {
    let mut x = Vectors::from_fn(coupling.dim(), 1, |i, _| Complex64::new((1.7 * i as f64).cos(), 0.3));
    let mut growth = 0.0;
    for step in 0..steps {
        if watch.go_on().is_break() {
            return None;
        }
        let y = product(coupling, &x);
        let norm = y.norms().first().copied().unwrap_or(0.0);
        if norm == 0.0 {
            return Some(0.0);
        }
        growth += if step < steps / 2 { 0.0 } else { norm.ln() };
        x = Vectors::from_fn(x.dim(), 1, |i, _| y.row(i)[0] / norm);
    }
    Some((growth / (steps - steps / 2).max(1) as f64).exp())
}

fn product(coupling: &dyn LinearOperator<Complex64>, x: &Vectors) -> Vectors {
    let mut y = Vectors::zeros(x.dim(), x.rhs_count());
    coupling.apply(x, &mut y);
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_linop::Dense;
    use fredholm_linop::Quiet;
    use std::ops::ControlFlow;

    /// Whoever wants nothing.
    struct Cancelled;

    impl Watch for Cancelled {
        fn go_on(&self) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }

    fn dense(dim: usize, entries: &[[f64; 2]]) -> Dense<Complex64> {
        Dense::new(dim, entries.iter().map(|&[re, im]| Complex64::new(re, im)).collect()).unwrap()
    }

    /// K = (j/2, 1; 0, −1/4) has the eigenvalues j/2 and −1/4.
    #[test]
    fn the_radius_is_that_of_the_largest_eigenvalue() {
        let triangular = dense(2, &[[0.0, 0.5], [1.0, 0.0], [0.0, 0.0], [-0.25, 0.0]]);
        assert!((spectral_radius(&triangular, 200, &Quiet).unwrap() - 0.5).abs() < 1e-9);
        let nothing = dense(2, &[[0.0, 0.0]; 4]);
        assert_eq!(spectral_radius(&nothing, 10, &Quiet), Some(0.0));
        assert_eq!(spectral_radius(&triangular, 10, &Cancelled), None);
    }

    /// With K = ½ the sum of n bounces is 2 − 2^{1−n}, its residual 2^{−n}.
    #[test]
    fn the_sum_of_a_geometric_series_and_its_residuals() {
        let half = dense(1, &[[0.5, 0.0]]);
        let b = Vectors::from_fn(1, 1, |_, _| Complex64::ONE);
        for count in 1..6 {
            let sum = Bounces::sum(&half, &b, count, &Quiet).unwrap();
            let tail = 0.5_f64.powi(count as i32);
            assert!((sum.x.row(0)[0].re - 2.0 * (1.0 - tail)).abs() < 1e-15);
            assert_eq!(sum.residuals.len(), count + 1);
            assert!((sum.residuals[count][0] - tail).abs() < 1e-15);
        }
    }
}
