//! Group accelerated shooting: the m patches with the most unshot power exchange their light until
//! it is settled among them, then send it to all others.
//!
//! Source: F. Rousselle, C. Renaud, Group accelerated shooting methods for radiosity, Eurographics
//! Workshop on Rendering
//! 1999. With S the group, A_SS s = r_S is solved, here by elimination; x_S += s,
//! r −= A_·S s. Of several right-hand sides, a patch counts with its largest A_i |r_il|/‖b_l‖₂.
//!
//! Requires that no A_SS is singular, which M-matrices and Hermitian positive definite ones assure.
//! Converges for these.
//!
//! Cost of an iteration: n columns in groups of m, and m³/3 operations a group; the weights take
//! one reading of the matrix.
//!
//! ```
//! use fredholm_iterative::GroupShooting;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = GroupShooting::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{SmallLu, sent_shares, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind, SolveError};

const NAME: &str = "group-shooting";

/// Shoots from groups of patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupShooting {
    /// Patches in a group, m.
    pub size: usize,
}

impl Default for GroupShooting {
    fn default() -> Self {
        Self { size: 16 }
    }
}

struct Groups<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    size: usize,
    weights: Vec<f64>,
    scales: Vec<f64>,
    residual: MultiVector<T>,
    product: MultiVector<T>,
    columns: Vec<Vec<T>>,
}

solve_by_steps!(GroupShooting);

impl<T: Scalar> Scheme<T> for GroupShooting {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Group accelerated shooting: groups of the brightest patches settle their light among them, then send it"
    }

    // The residual, the product, the weights, the columns of a group and its matrix.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let group = self.size as u64;
        let vectors = (rhs_count as u64).saturating_mul(2).saturating_add(1).saturating_add(group);
        vectors
            .saturating_mul(dim as u64)
            .saturating_add(group.saturating_mul(group))
            .saturating_mul(size_of::<T>() as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        let size = self.size.clamp(1, b.dim().max(1));
        let scale = |norm: f64| if norm > 0.0 { norm.recip() } else { 0.0 };
        Ok(Box::new(Groups {
            a,
            b,
            size,
            weights: sent_shares(a, context)?,
            scales: b.norms().into_iter().map(scale).collect(),
            residual: zeros.clone(),
            product: zeros,
            columns: vec![vec![T::zero(); b.dim()]; size],
        }))
    }
}

impl<T: Scalar> Groups<'_, T> {
    /// The patches with the most to send, in the order of their numbers.
    fn brightest(&self) -> Vec<usize> {
        let power = |i: usize| {
            let sizes = self.residual.row(i).iter().zip(&self.scales).map(|(r, &scale)| r.abs() * scale);
            self.weights[i] * sizes.fold(0.0, f64::max)
        };
        let mut order: Vec<(f64, usize)> = (0..self.residual.dim()).map(|i| (power(i), i)).collect();
        if self.size < order.len() {
            order.select_nth_unstable_by(self.size - 1, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        }
        let mut group: Vec<usize> = order.into_iter().take(self.size).map(|(_, i)| i).collect();
        group.sort_unstable();
        group
    }

    fn shoot(
        &mut self,
        group: &[usize],
        x: &mut MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<(), SolveError> {
        for rhs in 0..x.rhs_count() {
            self.read(group, rhs, context);
            let steps = self.settle(group, rhs)?;
            for ((&j, &step), column) in group.iter().zip(&steps).zip(&self.columns) {
                x.row_mut(j)[rhs] += step;
                self.residual.row_mut(j)[rhs] -= step;
                for (i, &entry) in column.iter().enumerate() {
                    self.residual.row_mut(i)[rhs] += self.a.factor().row(i)[rhs] * entry * step;
                }
            }
        }
        Ok(())
    }

    /// The columns of K of a group, which right-hand sides that share a coupling have in common.
    fn read(&mut self, group: &[usize], rhs: usize, context: &mut Context<'_>) {
        if rhs > 0 && self.a.coupling().rhs_count().is_none() {
            return;
        }
        for (&j, column) in group.iter().zip(&mut self.columns) {
            self.a.coupling().column(j, rhs, column);
            context.work.column_visits += 1;
            context.work.entries_touched += column.len() as u64;
        }
    }

    /// s of A_SS s = r_S.
    fn settle(&self, group: &[usize], rhs: usize) -> Result<Vec<T>, SolveError> {
        let entry = |&i: &usize, at: usize| {
            let off = -(self.a.factor().row(i)[rhs] * self.columns[at][i]);
            if group[at] == i { off + T::one() } else { off }
        };
        let count = group.len();
        let matrix = group.iter().flat_map(|i| (0..count).map(move |at| entry(i, at))).collect();
        let residual: Vec<T> = group.iter().map(|&i| self.residual.row(i)[rhs]).collect();
        let lu = SmallLu::new(count, matrix).ok_or_else(|| SolveError::Unsuitable {
            solver: NAME,
            reason: format!("the exchange among unknowns {group:?} is singular; use lu"),
        })?;
        Ok(lu.solve(&residual))
    }
}

impl<T: Scalar> Iteration<T> for Groups<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)?;
        self.residual.set_difference(self.b, &self.product);
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        for _ in 0..x.dim().div_ceil(self.size) {
            context.poll()?;
            let group = self.brightest();
            self.shoot(&group, x, context)?;
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
