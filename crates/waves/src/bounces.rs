//! Bounce by bounce: x_{n+1} = b + K x_n, block Jacobi with the zero blocks of flat facets on the diagonal.
//!
//! It is the Neumann series of the currents: started from 0, iterate n is n bounces. It converges where the spectral
//! radius of K is below 1, slowly where it is close (facing plates: 0.97), and diverges else (a closed cube of 2.1λ:
//! 1.12), which the monitor reports. Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003,
//! § 4.1, DOI 10.1137/1.9780898718003.

use fredholm_linop::{
    LinearOperator, Monitor, MultiVector, Observer, Report, Scalar, SecondKind, SolveError, Solver, Stop,
    Work,
};
use std::ops::ControlFlow;

/// One bounce an iteration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bounces;

impl<T: Scalar> Solver<T> for Bounces {
    fn name(&self) -> &'static str {
        "bounces"
    }

    fn description(&self) -> &'static str {
        "Bounce by bounce (Neumann series): every current from all old ones; iterate n is n bounces"
    }

    // The product A x.
    fn bytes(&self, dim: usize, lanes: usize) -> u64 {
        (size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(lanes as u64)
    }

    fn solve(
        &self,
        a: &SecondKind<'_, T>,
        b: &MultiVector<T>,
        x: &mut MultiVector<T>,
        stop: &Stop,
        observer: &mut dyn Observer<T>,
    ) -> Result<Report, SolveError> {
        let mut monitor = Monitor::start(a, b, x, stop, observer)?;
        let mut product = MultiVector::zeros(x.dim(), x.lanes());
        let mut work = Work::default();
        loop {
            a.apply(x, &mut product);
            work.operator_applications += 1;
            work.entries_touched += a.entries();
            if let ControlFlow::Break(reason) = monitor.record(x, &product) {
                return Ok(monitor.finish(reason, work));
            }
            let residuals = b.as_slice().iter().zip(product.as_slice());
            x.as_mut_slice().iter_mut().zip(residuals).for_each(|(x, (&b, &ax))| *x += b - ax);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_linop::{Dense, Quiet, StopReason};
    use num_complex::Complex64;

    fn solve(entry: Complex64) -> (MultiVector<Complex64>, Report) {
        let zero = Complex64::ZERO;
        let coupling = Dense::new(2, vec![zero, entry, entry, zero]).unwrap();
        let one = MultiVector::from_vec(2, 1, vec![Complex64::ONE; 2]).unwrap();
        let a = SecondKind::new(&coupling, one.clone()).unwrap();
        let mut x = MultiVector::zeros(2, 1);
        let stop = Stop { tolerance: 1e-12, max_iterations: 200 };
        let report = Bounces.solve(&a, &one, &mut x, &stop, &mut Quiet).unwrap();
        (x, report)
    }

    #[test]
    fn the_series_of_two_plates_is_geometric() {
        let q = Complex64::new(0.3, -0.4);
        let (x, report) = solve(q);
        assert_eq!(report.reason, StopReason::Converged);
        assert!((x.row(0)[0] - 1.0 / (1.0 - q)).norm() < 1e-11);
        // |q| = ½: every bounce halves the residual.
        let ratio = report.history[9].residuals[0] / report.history[8].residuals[0];
        assert!((ratio - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_series_that_grows_is_reported() {
        assert_eq!(solve(Complex64::new(0.0, 1.5)).1.reason, StopReason::Diverged);
    }
}
