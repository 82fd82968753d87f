//! Conjugate gradients on Θ = I − D^½ K D^½, preconditioned by an incomplete Cholesky factor with
//! threshold: Θ ≈ L Lᴴ.
//!
//! Source: J. A. Meijerink, H. A. van der Vorst, Mathematics of Computation 31, 1977, DOI
//! 10.1090/S0025-5718-1977-0438681-4 (it exists for M-matrices, whatever is left out); Y. Saad,
//! Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 10.4, DOI
//! 10.1137/1.9780898718003. Row i of L is computed from row i of Θ; entries below τ times the mean
//! size of an entry of that row are left out before and while that is done.
//!
//! Requires a coupling that is known to be symmetric (Hermitian, for complex unknowns), D real and
//! ≥ 0, and Ψ positive definite, which light has with ρ < 1. Unknowns with d_i = 0, black patches,
//! are set to b_i before the first step.
//!
//! Cost of an iteration: one application and two substitutions with the entries that are left; the
//! factors, one for each right-hand side, take one reading of the lower triangle each. Memory: at
//! most n²/2 entries a right-hand side, as the threshold leaves.
//!
//! ```
//! use fredholm_iterative::PcgCholesky;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = PcgCholesky::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Conjugate, Metric, Precondition, solve_by_steps};
use fredholm_linop::{
    Context, Halt, Iteration, LinearOperator, MultiVector, Scalar, Scheme, SecondKind, SolveError,
};

const NAME: &str = "pcg-ic";

/// Conjugate gradients preconditioned by an incomplete Cholesky factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PcgCholesky {
    /// τ, at least 0: what is left out, relative to the mean entry of a row. 0 leaves nothing out.
    pub threshold: f64,
}

impl Default for PcgCholesky {
    fn default() -> Self {
        Self { threshold: 10.0 }
    }
}

/// L of a right-hand side, column by column: (row, entry) below the diagonal, and the diagonal.
struct Factor<T> {
    columns: Vec<Vec<(u32, T)>>,
    diagonal: Vec<T>,
}

/// The factors of all right-hand sides.
struct Factors<'a, T> {
    a: &'a SecondKind<'a, T>,
    factors: Vec<Factor<T>>,
}

solve_by_steps!(PcgCholesky);

impl<T: Scalar> Scheme<T> for PcgCholesky {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Conjugate gradients preconditioned by an incomplete Cholesky factor with threshold"
    }

    // Of a row no more than 1/τ of the entries can be τ times their mean; the lists of columns grow
    // by doubling.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let (n, entry) = (dim as u64, size_of::<T>() as u64);
        let kept = (n as f64 * n as f64 / self.threshold.max(1.0)) as u64;
        let factor = kept.saturating_mul(size_of::<(u32, T)>() as u64);
        let vectors = n.saturating_mul(7).saturating_mul(entry);
        factor.saturating_add(vectors).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let metric = Metric::new(NAME, a)?;
        let factor = |rhs| Factor::new(a, rhs, self.threshold, context);
        let factors: Vec<_> = (0..b.rhs_count()).map(factor).collect::<Result<_, _>>()?;
        Ok(Box::new(Conjugate::new(NAME, (a, b), metric, Factors { a, factors })))
    }
}

impl<T: Scalar> Factor<T> {
    fn new(
        a: &SecondKind<'_, T>,
        rhs: usize,
        threshold: f64,
        context: &mut Context<'_>,
    ) -> Result<Self, Halt> {
        let dim = a.factor().dim();
        let mut factor = Self { columns: vec![Vec::new(); dim], diagonal: Vec::with_capacity(dim) };
        let mut row = vec![T::zero(); dim];
        for i in 0..dim {
            context.poll()?;
            read_theta(a, i, rhs, &mut row[..=i]);
            let pivot = factor.add_row(&mut row[..=i], threshold);
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(SolveError::Indefinite { solver: NAME, rhs }.into());
            }
        }
        context.work.row_visits += dim as u64;
        context.work.entries_touched += a.entries();
        Ok(factor)
    }

    /// Appends row i, which is that of Θ, to L. Returns the square of its diagonal entry.
    fn add_row(&mut self, row: &mut [T], threshold: f64) -> f64 {
        let i = row.len() - 1;
        let least = threshold * row[..i].iter().map(|entry| entry.abs()).sum::<f64>() / i.max(1) as f64;
        row[..i].iter_mut().filter(|entry| entry.abs() < least).for_each(|entry| *entry = T::zero());
        for j in 0..i {
            let entry = row[j] / self.diagonal[j];
            if entry == T::zero() || entry.abs() < least {
                continue;
            }
            for &(k, below) in &self.columns[j] {
                row[k as usize] -= entry * below.conj();
            }
            row[i] -= entry * entry.conj();
            self.columns[j].push((i as u32, entry));
        }
        let square = row[i].re();
        self.diagonal.push(T::from_real(square.sqrt()));
        square
    }

    /// v = L⁻ᴴ L⁻¹ v.
    fn solve(&self, v: &mut [T]) {
        for (j, column) in self.columns.iter().enumerate() {
            v[j] = v[j] / self.diagonal[j];
            let known = v[j];
            for &(i, entry) in column {
                v[i as usize] -= entry * known;
            }
        }
        for (j, column) in self.columns.iter().enumerate().rev() {
            let sum = column.iter().fold(v[j], |sum, &(i, entry)| sum - entry.conj() * v[i as usize]);
            v[j] = sum / self.diagonal[j];
        }
    }
}

/// Row i of Θ up to the diagonal: θ_ij = δ_ij − √d_i k_ij √d_j.
fn read_theta<T: Scalar>(a: &SecondKind<'_, T>, i: usize, rhs: usize, row: &mut [T]) {
    let root = |j: usize| a.factor().row(j)[rhs].re().sqrt();
    a.coupling().lower_row(i, rhs, row);
    row.iter_mut().enumerate().for_each(|(j, entry)| *entry = -entry.scale(root(i) * root(j)));
    row[i] += T::one();
}

impl<T: Scalar> Precondition<T> for Factors<'_, T> {
    /// z = D^½ (L Lᴴ)⁻¹ D^(−½) r.
    fn apply(&mut self, r: &MultiVector<T>, z: &mut MultiVector<T>, _: &mut Context<'_>) -> Result<(), Halt> {
        for (rhs, factor) in self.factors.iter().enumerate() {
            let root = |i: usize| self.a.factor().row(i)[rhs].re().sqrt();
            let scaled =
                |i: usize| if root(i) > 0.0 { r.row(i)[rhs].scale(root(i).recip()) } else { T::zero() };
            let mut v: Vec<T> = (0..r.dim()).map(scaled).collect();
            factor.solve(&mut v);
            v.iter_mut().enumerate().for_each(|(i, v)| *v = v.scale(root(i)));
            z.set_vector(rhs, &v);
        }
        Ok(())
    }
}
