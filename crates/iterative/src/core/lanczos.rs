//! The Lanczos process for A in the inner product of a [`Metric`]: A V = V T, T real, symmetric and
//! tridiagonal.
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, § 10.1; eigenvalues of T by bisection with Sturm sequences, § 8.4.1. The extreme
//! eigenvalues of T come near to those of A first.

use super::{Metric, minus, reals};
use fredholm_linop::{Context, Halt, MultiVector, Scalar, SecondKind};

/// T of one right-hand side: α on the diagonal, β beside it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tridiagonal {
    pub diagonal: Vec<f64>,
    pub beside: Vec<f64>,
}

/// T per right-hand side after at most `steps` steps from a start without a pattern. With `whole`,
/// every new vector is made orthogonal to all before it, so that no eigenvalue comes twice.
pub(crate) fn lanczos<T: Scalar>(
    a: &SecondKind<'_, T>,
    metric: &Metric<T>,
    steps: usize,
    whole: bool,
    context: &mut Context<'_>,
) -> Result<Vec<Tridiagonal>, Halt> {
    let (dim, rhs_count) = (a.factor().dim(), a.factor().rhs_count());
    let mut found = vec![Tridiagonal::default(); rhs_count];
    let mut basis = vec![start(metric)];
    let mut image = MultiVector::zeros(dim, rhs_count);
    for step in 0..steps.min(dim) {
        let v = &basis[basis.len() - 1];
        context.apply(a, v, &mut image)?;
        let alpha = metric.real_dots(v, &image);
        image.add_scaled(&minus(&reals(&alpha)), v);
        if let Some(before) = basis.len().checked_sub(2) {
            let beta: Vec<f64> = found.iter().map(|t| t.beside[step - 1]).collect();
            image.add_scaled(&minus(&reals(&beta)), &basis[before]);
        }
        if whole {
            clear(metric, &basis, &mut image);
        }
        let beta = normalise(metric, &mut image);
        for (l, t) in found.iter_mut().enumerate() {
            t.diagonal.push(alpha[l]);
            t.beside.push(beta[l]);
        }
        if !whole && basis.len() == 2 {
            basis.remove(0);
        }
        basis.push(image.clone());
    }
    Ok(found.into_iter().map(Tridiagonal::cut).collect())
}

/// A unit vector in which every unknown that is not black has a part.
fn start<T: Scalar>(metric: &Metric<T>) -> MultiVector<T> {
    let weights = metric.weights();
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut v = MultiVector::from_fn(weights.dim(), weights.rhs_count(), |i, l| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let value = 0.5 + (state >> 11) as f64 / (1_u64 << 53) as f64;
        let weight = weights.row(i)[l].re();
        T::from_real(if weight > 0.0 { value / weight.sqrt() } else { 0.0 })
    });
    normalise(metric, &mut v);
    v
}

/// Takes from v what lies along the basis, twice.
fn clear<T: Scalar>(metric: &Metric<T>, basis: &[MultiVector<T>], v: &mut MultiVector<T>) {
    for _ in 0..2 {
        for known in basis {
            let along = metric.dots(known, v);
            v.add_scaled(&minus(&along), known);
        }
    }
}

/// Makes a unit vector of v, or 0 where it is lost in rounding; returns its length, or 0.
fn normalise<T: Scalar>(metric: &Metric<T>, v: &mut MultiVector<T>) -> Vec<f64> {
    let lengths = metric.real_dots(v, v).into_iter().map(f64::sqrt);
    let lengths: Vec<f64> = lengths.map(|length| if length > 1e-13 { length } else { 0.0 }).collect();
    let zeros = MultiVector::zeros(v.dim(), v.rhs_count());
    let inverse = lengths.iter().map(|&length| if length > 0.0 { length.recip() } else { 0.0 });
    v.scale_and_add(&reals(&inverse.collect::<Vec<_>>()), &zeros);
    lengths
}

impl Tridiagonal {
    /// What comes before the first β that is 0: the rest belongs to no new vector.
    fn cut(mut self) -> Self {
        let count = self.beside.iter().position(|&beta| beta == 0.0).map_or(self.diagonal.len(), |at| at + 1);
        self.diagonal.truncate(count);
        self.beside.truncate(count.saturating_sub(1));
        self
    }

    /// Eigenvalue k from below, k from 0.
    pub fn eigenvalue(&self, k: usize) -> f64 {
        let (mut low, mut high) = self.bounds();
        while high - low > 2.0 * f64::EPSILON * (low.abs() + high.abs()) {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.below(middle) > k { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    }

    /// Gershgorin's interval.
    fn bounds(&self) -> (f64, f64) {
        let beside = |at: usize| self.beside.get(at).map_or(0.0, |beta| beta.abs());
        let radius = |i: usize| beside(i) + i.checked_sub(1).map_or(0.0, beside);
        let all = || self.diagonal.iter().enumerate();
        let low = all().map(|(i, &alpha)| alpha - radius(i)).fold(f64::INFINITY, f64::min);
        let high = all().map(|(i, &alpha)| alpha + radius(i)).fold(f64::NEG_INFINITY, f64::max);
        (low, high)
    }

    /// How many eigenvalues are below x: the negative pivots of T − x I.
    fn below(&self, x: f64) -> usize {
        let (mut count, mut pivot) = (0, 1.0);
        for (i, alpha) in self.diagonal.iter().enumerate() {
            let beta = i.checked_sub(1).map_or(0.0, |at| self.beside[at]);
            pivot = alpha - x - beta * beta / pivot;
            if pivot == 0.0 {
                pivot = f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_linop::{PackedSymmetric, Work};
    use std::ops::ControlFlow;

    #[test]
    fn eigenvalues_of_the_second_difference_are_its_cosines() {
        let t = Tridiagonal { diagonal: vec![2.0; 9], beside: vec![-1.0; 8] };
        for k in 0..9 {
            let exact = 2.0 - 2.0 * (std::f64::consts::PI * (k + 1) as f64 / 10.0).cos();
            assert!((t.eigenvalue(k) - exact).abs() < 1e-14);
        }
    }

    #[test]
    fn all_steps_give_all_eigenvalues() {
        // K of ones without the diagonal: I − d K has 1 − d (n − 1) once and 1 + d otherwise.
        let n = 6;
        let packed = (0..n).flat_map(|i| (0..=i).map(move |j| f64::from(u8::from(i != j)))).collect();
        let coupling: PackedSymmetric<f64> = PackedSymmetric::new(n, packed).unwrap();
        let a = SecondKind::new(&coupling, MultiVector::from_fn(n, 1, |_, _| 0.1)).unwrap();
        let metric = Metric::new("test", &a).unwrap();
        let (mut work, mut poll) = (Work::default(), || ControlFlow::Continue(()));
        let found = lanczos(&a, &metric, n, true, &mut Context::new(&mut work, &mut poll)).unwrap();
        // Two different eigenvalues: the process ends after two steps.
        assert_eq!(found[0].diagonal.len(), 2);
        assert!((found[0].eigenvalue(0) - 0.5).abs() < 1e-14 && (found[0].eigenvalue(1) - 1.1).abs() < 1e-14);
    }
}
