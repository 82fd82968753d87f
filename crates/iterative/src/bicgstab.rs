//! BiCGSTAB: biconjugate gradients with a step of smallest residual after each.
//!
//! Source: H. A. van der Vorst, SIAM Journal on Scientific and Statistical Computing 13, 1992, DOI
//! 10.1137/0913035. The shadow residual is the first residual.
//!
//! Requires nothing; A not singular. It converges for most systems, without a guarantee; a
//! right-hand side that breaks down stands still, and ends above the tolerance.
//!
//! Cost of an iteration: two applications.
//!
//! ```
//! use fredholm_iterative::Bicgstab;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Bicgstab.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{minus, quotients, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "bicgstab";

/// BiCGSTAB.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bicgstab;

struct Biconjugate<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    residual: MultiVector<T>,
    shadow: MultiVector<T>,
    direction: MultiVector<T>,
    /// A p and A s.
    images: [MultiVector<T>; 2],
    product: MultiVector<T>,
    /// (shadow, r), α and ω per right-hand side; empty before the first step from a new start.
    power: Vec<T>,
    alpha: Vec<T>,
    omega: Vec<T>,
}

solve_by_steps!(Bicgstab);

impl<T: Scalar> Scheme<T> for Bicgstab {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "BiCGSTAB: short recurrences for any matrix; two applications an iteration"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (6 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        Ok(Box::new(Biconjugate {
            a,
            b,
            residual: zeros.clone(),
            shadow: zeros.clone(),
            direction: zeros.clone(),
            images: [zeros.clone(), zeros.clone()],
            product: zeros,
            power: Vec::new(),
            alpha: Vec::new(),
            omega: Vec::new(),
        }))
    }
}

impl<T: Scalar> Biconjugate<'_, T> {
    /// p = r + β (p − ω A p).
    fn turn(&mut self) {
        let power = self.shadow.dots(&self.residual);
        if self.power.is_empty() {
            self.direction.copy_from(&self.residual);
        } else {
            let (grown, shortened) = (quotients(&power, &self.power), quotients(&self.alpha, &self.omega));
            let beta: Vec<T> = grown.iter().zip(&shortened).map(|(&g, &s)| g * s).collect();
            self.direction.add_scaled(&minus(&self.omega), &self.images[0]);
            self.direction.scale_and_add(&beta, &self.residual);
        }
        self.power = power;
    }

    /// x += f v and what follows from it, A v being one of the images.
    fn go(&mut self, x: &mut MultiVector<T>, factors: &[T], image: usize) {
        let along = if image == 0 { &self.direction } else { &self.residual };
        x.add_scaled(factors, along);
        self.product.add_scaled(factors, &self.images[image]);
        self.residual.add_scaled(&minus(factors), &self.images[image]);
    }
}

impl<T: Scalar> Iteration<T> for Biconjugate<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)?;
        self.residual.set_difference(self.b, &self.product);
        self.shadow.copy_from(&self.residual);
        self.power.clear();
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        self.turn();
        context.apply(self.a, &self.direction, &mut self.images[0])?;
        self.alpha = quotients(&self.power, &self.shadow.dots(&self.images[0]));
        self.go(x, &self.alpha.clone(), 0);
        context.apply(self.a, &self.residual, &mut self.images[1])?;
        let across = self.images[1].dots(&self.residual);
        self.omega = quotients(&across, &self.images[1].dots(&self.images[1]));
        self.go(x, &self.omega.clone(), 1);
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}
