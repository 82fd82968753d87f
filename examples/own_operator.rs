//! An operator of one's own in a registered solver: `cargo run --release --example own_operator`.
//!
//! Love's equation for the field between two coaxial discs of equal radius, as far apart as that
//! radius (E. R. Love, The electrostatic field of two equal circular co-axial conducting disks,
//! Quarterly Journal of Mechanics and Applied Mathematics 2, 1949):
//!
//! x(s) − (1/π) ∫₋₁¹ x(t)/(1 + (s − t)²) dt = 1.
//!
//! Gauss points turn the integral into a sum (Nyström). No matrix is stored: a solver that asks for
//! products gets them computed, and one that asks for rows or all entries gets them from products.

use std::error::Error;
use std::f64::consts::PI;

use fredholm::linop::{LinearOperator, MultiVector, Quiet, SecondKind, Stop, StopReason};
use fredholm::quadrature::gauss_legendre;
use fredholm::study::solvers;

/// The integral of Love's equation at the points of a rule on [−1, 1].
struct Love {
    points: Vec<f64>,
    weights: Vec<f64>,
}

impl LinearOperator<f64> for Love {
    fn dim(&self) -> usize {
        self.points.len()
    }

    fn apply(&self, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
        for (i, s) in self.points.iter().enumerate() {
            for rhs in 0..x.rhs_count() {
                let part = |(j, (t, weight)): (usize, (&f64, &f64))| {
                    weight * x.row(j)[rhs] / (PI * (1.0 + (s - t) * (s - t)))
                };
                let sum = self.points.iter().zip(&self.weights).enumerate().map(part).sum();
                y.row_mut(i)[rhs] = sum;
            }
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    // The rule is one of [0, 1].
    let rule = gauss_legendre(24);
    let points = rule.points.iter().map(|t| 2.0 * t - 1.0).collect();
    let weights = rule.weights.iter().map(|weight| 2.0 * weight).collect();
    let love = Love { points, weights };
    let one = MultiVector::from_fn(love.dim(), 1, |_, _| 1.0);
    let system = SecondKind::new(&love, one.clone())?;
    let stop = Stop { tolerance: 1e-12, max_iterations: 200 };
    for entry in solvers().filter(|entry| ["gmres", "gauss-seidel", "lu"].contains(&entry.solver.name())) {
        let mut x = MultiVector::zeros(love.dim(), 1);
        let report = entry.solver.solve(&system, &one, &mut x, &stop, &mut Quiet)?;
        if report.reason != StopReason::Converged {
            return Err(format!("{} did not converge", entry.solver.name()).into());
        }
        let mean: f64 = love.weights.iter().enumerate().map(|(i, w)| 0.5 * w * x.row(i)[0]).sum();
        let iterations = report.history.last().map_or(0, |record| record.iteration);
        println!("{:>14}: mean {mean:.12}, {iterations} iterations", entry.solver.name());
    }
    Ok(())
}
