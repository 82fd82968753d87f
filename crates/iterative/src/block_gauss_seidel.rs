//! Block Gauss–Seidel: x_S += A_SS⁻¹ r_S for one block S of neighbouring unknowns after the other,
//! r −= A_·S of the step.
//!
//! Source: Y. Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 4.1.1,
//! DOI 10.1137/1.9780898718003. Blocks of 2 or 3 are the components of a vector unknown.
//!
//! Requires that no A_SS is singular. Converges for M-matrices and for Hermitian positive definite
//! ones.
//!
//! Cost of an iteration: n columns, twice the stored entries where the matrix is packed; the blocks
//! take one reading of the matrix.
//!
//! ```
//! use fredholm_iterative::BlockGaussSeidel;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = BlockGaussSeidel::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::Blocks;
use crate::core::solve_by_steps;
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "block-gauss-seidel";

/// Relaxes every block in order, over and over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockGaussSeidel {
    /// Unknowns of a block; the last one is shorter where this does not divide their number.
    pub size: usize,
}

impl Default for BlockGaussSeidel {
    fn default() -> Self {
        Self { size: 3 }
    }
}

struct InOrder<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    blocks: Blocks<T>,
    residual: MultiVector<T>,
    product: MultiVector<T>,
    column: Vec<T>,
}

solve_by_steps!(BlockGaussSeidel);

impl<T: Scalar> Scheme<T> for BlockGaussSeidel {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Block Gauss–Seidel: every block of unknowns in order from the newest values; for vector unknowns"
    }

    // The factors of the blocks with their orders, the residual, the product and a column.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let vectors =
            (rhs_count as u64).saturating_mul((self.size as u64).saturating_add(3)).saturating_add(1);
        vectors.saturating_mul(dim as u64).saturating_mul(size_of::<T>() as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let blocks = Blocks::new(NAME, a, self.size.max(1), context)?;
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        let column = vec![T::zero(); b.dim()];
        Ok(Box::new(InOrder { a, b, blocks, residual: zeros.clone(), product: zeros, column }))
    }
}

impl<T: Scalar> InOrder<'_, T> {
    fn relax(&mut self, k: usize, x: &mut MultiVector<T>, context: &mut Context<'_>) {
        let steps = self.blocks.steps(k, &self.residual);
        for (j, step) in self.blocks.range(k, x.dim()).zip(steps.rows()) {
            x.row_mut(j).iter_mut().zip(step).for_each(|(x, &step)| *x += step);
            context.work.column_visits += 1;
            context.work.entries_touched +=
                self.a.subtract_column(j, step, &mut self.residual, &mut self.column);
        }
    }
}

impl<T: Scalar> Iteration<T> for InOrder<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)?;
        self.residual.set_difference(self.b, &self.product);
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        for k in 0..self.blocks.count() {
            context.poll()?;
            self.relax(k, x, context);
        }
        self.product.set_difference(self.b, &self.residual);
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}
