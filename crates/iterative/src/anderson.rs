//! Anderson acceleration of successive approximations: x ← x + r − Σ_j γ_j (Δx_j + Δr_j) with the γ
//! that minimise ‖r − Σ_j γ_j Δr_j‖₂ over the last m differences.
//!
//! Source: H. F. Walker, P. Ni, Anderson acceleration for fixed-point iterations, SIAM Journal on
//! Numerical Analysis 49, 2011, DOI 10.1137/10078356X. The differences are made orthonormal as they
//! come, so that the γ are inner products; the oldest is forgotten when there are m.
//!
//! Requires nothing. For linear systems it is GMRES in disguise while nothing is forgotten; short
//! memories converge for light.
//!
//! Cost of an iteration: one application, and 6 m vector operations. Memory: 2 m + 6 vectors.
//!
//! ```
//! use fredholm_iterative::Anderson;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Anderson::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{minus, reals, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "anderson";

/// Anderson acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Anderson {
    /// Differences remembered, m.
    pub depth: usize,
}

impl Default for Anderson {
    fn default() -> Self {
        Self { depth: 5 }
    }
}

struct Mixing<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    depth: usize,
    /// (Δx, Δr), combined so that the Δr are orthonormal; oldest first.
    differences: Vec<[MultiVector<T>; 2]>,
    /// x and r of the iterate before, if there is one.
    before: Option<[MultiVector<T>; 2]>,
    product: MultiVector<T>,
}

solve_by_steps!(Anderson);

impl<T: Scalar> Scheme<T> for Anderson {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Anderson acceleration: successive approximations mixed with the last few for the smallest residual"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let vectors = (self.depth as u64).saturating_mul(2).saturating_add(6);
        let entries = (dim as u64).saturating_mul(rhs_count as u64);
        vectors.saturating_mul(size_of::<T>() as u64).saturating_mul(entries)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        Ok(Box::new(Mixing {
            a,
            b,
            depth: self.depth.max(1),
            differences: Vec::new(),
            before: None,
            product: MultiVector::zeros(b.dim(), b.rhs_count()),
        }))
    }
}

impl<T: Scalar> Mixing<'_, T> {
    /// Remembers the step from the iterate before to this one.
    fn remember(&mut self, x: &MultiVector<T>, residual: &MultiVector<T>) {
        let now = [x.clone(), residual.clone()];
        if let Some([x_before, r_before]) = self.before.replace(now) {
            let mut difference = [x.clone(), residual.clone()];
            difference[0].set_difference(x, &x_before);
            difference[1].set_difference(residual, &r_before);
            if self.differences.len() == self.depth {
                self.differences.remove(0);
            }
            self.orthogonalise(&mut difference);
            self.differences.push(difference);
        }
    }

    /// Makes Δr a unit vector orthogonal to the known ones, and Δx its counterpart; 0 where nothing
    /// but rounding is left.
    fn orthogonalise(&self, [dx, dr]: &mut [MultiVector<T>; 2]) {
        let before = dr.norms();
        for _ in 0..2 {
            for [known_x, known_r] in &self.differences {
                let along = minus(&known_r.dots(dr));
                dr.add_scaled(&along, known_r);
                dx.add_scaled(&along, known_x);
            }
        }
        let inverse =
            |(after, &before): (f64, &f64)| if after > 1e-12 * before { after.recip() } else { 0.0 };
        let factors: Vec<f64> = dr.norms().into_iter().zip(&before).map(inverse).collect();
        let zeros = MultiVector::zeros(dx.dim(), dx.rhs_count());
        dx.scale_and_add(&reals(&factors), &zeros);
        dr.scale_and_add(&reals(&factors), &zeros);
    }
}

impl<T: Scalar> Iteration<T> for Mixing<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        self.differences.clear();
        self.before = None;
        context.start(self.a, x, &mut self.product)
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        let mut residual = self.b.clone();
        residual.set_difference(self.b, &self.product);
        self.remember(x, &residual);
        x.add_scaled(&vec![T::one(); x.rhs_count()], &residual);
        for [dx, dr] in &self.differences {
            let gamma = minus(&dr.dots(&residual));
            x.add_scaled(&gamma, dx);
            x.add_scaled(&gamma, dr);
        }
        context.apply(self.a, x, &mut self.product)
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }
}
