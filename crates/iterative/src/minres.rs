//! MINRES: of all iterates in the Krylov space, the one with the smallest residual of Θ, by the
//! Lanczos process.
//!
//! Source: C. C. Paige, M. A. Saunders, Solution of sparse indefinite systems of linear equations,
//! SIAM Journal on Numerical Analysis 12, 1975, DOI 10.1137/0712047; the recurrences as in A.
//! Greenbaum, Iterative Methods for Solving Linear Systems, SIAM 1997, § 2.4, DOI
//! 10.1137/1.9781611970937. It is applied to A in the inner product of H = D⁻¹, as Θ z = H^½ b is;
//! what it makes smaller at every step is ‖r‖_H.
//!
//! Requires a coupling that is known to be symmetric (Hermitian, for complex unknowns), D real and
//! ≥ 0; A may be indefinite, but not singular. Unknowns with d_i = 0 are set to b_i before the
//! first step.
//!
//! Cost of an iteration: one application.
//!
//! ```
//! use fredholm_iterative::Minres;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Minres.solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Metric, minus, reals, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "minres";

/// MINRES on the symmetrised system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Minres;

struct Lanczos<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    metric: Metric<T>,
    residual: MultiVector<T>,
    product: MultiVector<T>,
    /// Lanczos vectors: the one before, the newest, and the next one in the making.
    v: [MultiVector<T>; 3],
    /// Directions w_(k−2), w_(k−1) and their images A w.
    w: [MultiVector<T>; 2],
    image: [MultiVector<T>; 2],
    rotations: Vec<Rotations>,
}

/// The last two rotations for a right-hand side, β, and what they have left of ‖r₀‖ e₁.
#[derive(Clone, Copy, Debug)]
struct Rotations {
    cosines: [f64; 2],
    sines: [f64; 2],
    beta: f64,
    eta: f64,
}

/// What a step takes of the known directions, per right-hand side. The new direction is (v − third
/// w_(k−2) − second w_(k−1)) scale.
#[derive(Default)]
struct Parts<T> {
    third: Vec<T>,
    second: Vec<T>,
    scale: Vec<T>,
    length: Vec<T>,
}

solve_by_steps!(Minres);

impl<T: Scalar> Scheme<T> for Minres {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "MINRES on the symmetrised system: smallest residual over the Krylov space; takes indefinite systems"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        (11 * size_of::<T>() as u64).saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        let pair = || [zeros.clone(), zeros.clone()];
        Ok(Box::new(Lanczos {
            a,
            b,
            metric: Metric::new(NAME, a)?,
            residual: zeros.clone(),
            product: zeros.clone(),
            v: [zeros.clone(), zeros.clone(), zeros.clone()],
            w: pair(),
            image: pair(),
            rotations: Vec::new(),
        }))
    }
}

impl<T: Scalar> Lanczos<'_, T> {
    /// v = r/‖r‖.
    fn begin(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        let state = (&mut self.product, &mut self.residual);
        self.metric.eliminate(self.a, self.b, x, state, context)?;
        let lengths: Vec<f64> =
            self.metric.real_dots(&self.residual, &self.residual).into_iter().map(f64::sqrt).collect();
        let empty = MultiVector::zeros(x.dim(), x.rhs_count());
        self.v[1] = self.residual.clone();
        self.v[1].scale_and_add(&inverses(&lengths), &empty);
        self.v[0] = empty.clone();
        self.w = [empty.clone(), empty.clone()];
        self.image = [empty.clone(), empty];
        let rotations = |&eta: &f64| Rotations { cosines: [1.0; 2], sines: [0.0; 2], beta: 0.0, eta };
        self.rotations = lengths.iter().map(rotations).collect();
        Ok(())
    }

    /// A v, and the next vector of the process. Returns α and the new β.
    fn extend(
        &mut self,
        image: &mut MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<(Vec<f64>, Vec<f64>), Halt> {
        let [before, newest, next] = &mut self.v;
        context.apply(self.a, newest, image)?;
        let alpha = self.metric.real_dots(newest, image);
        let beta: Vec<f64> = self.rotations.iter().map(|rotations| rotations.beta).collect();
        next.copy_from(image);
        next.add_scaled(&minus(&reals(&alpha)), newest);
        next.add_scaled(&minus(&reals(&beta)), before);
        let lengths: Vec<f64> = self.metric.real_dots(next, next).into_iter().map(f64::sqrt).collect();
        next.scale_and_add(&inverses(&lengths), &MultiVector::zeros(image.dim(), image.rhs_count()));
        Ok((alpha, lengths))
    }

    /// Rotates the new column of T of every right-hand side.
    fn rotate(&mut self, alpha: &[f64], beta: &[f64]) -> Parts<T> {
        let mut parts = Parts::default();
        for (rhs, rotations) in self.rotations.iter_mut().enumerate() {
            let ([third, second, scale], length) = rotations.take(alpha[rhs], beta[rhs]);
            parts.third.push(T::from_real(-third));
            parts.second.push(T::from_real(-second));
            parts.scale.push(T::from_real(scale));
            parts.length.push(T::from_real(length));
        }
        parts
    }
}

impl Rotations {
    /// Takes in α and the new β; returns the parts of the new direction and the length to go along
    /// it.
    fn take(&mut self, alpha: f64, beta: f64) -> ([f64; 3], f64) {
        let ([c0, c1], [s0, s1]) = (self.cosines, self.sines);
        let delta = c1 * alpha - c0 * s1 * self.beta;
        let rho = delta.hypot(beta);
        let second = s1 * alpha + c0 * c1 * self.beta;
        let third = s0 * self.beta;
        let scale = if rho > 0.0 { rho.recip() } else { 0.0 };
        let (cosine, sine) = (delta * scale, beta * scale);
        let length = cosine * self.eta;
        *self = Self { cosines: [c1, cosine], sines: [s1, sine], beta, eta: -sine * self.eta };
        ([third, second, scale], length)
    }
}

fn inverses<T: Scalar>(lengths: &[f64]) -> Vec<T> {
    let inverse = |&length: &f64| if length > 0.0 { length.recip() } else { 0.0 };
    reals(&lengths.iter().map(inverse).collect::<Vec<_>>())
}

/// The newest of two directions becomes the older one; its place takes (start − third older −
/// second newer) scale.
fn replace<T: Scalar>(pair: &mut [MultiVector<T>; 2], start: &MultiVector<T>, parts: &Parts<T>) {
    let zeros = MultiVector::zeros(start.dim(), start.rhs_count());
    let [older, newer] = pair;
    older.scale_and_add(&parts.third, start);
    older.add_scaled(&parts.second, newer);
    older.scale_and_add(&parts.scale, &zeros);
    pair.swap(0, 1);
}

impl<T: Scalar> Iteration<T> for Lanczos<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)?;
        self.residual.set_difference(self.b, &self.product);
        self.rotations.clear();
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        if self.rotations.is_empty() {
            self.begin(x, context)?;
        }
        let mut image = MultiVector::zeros(x.dim(), x.rhs_count());
        let (alpha, beta) = self.extend(&mut image, context)?;
        let parts = self.rotate(&alpha, &beta);
        replace(&mut self.w, &self.v[1], &parts);
        replace(&mut self.image, &image, &parts);
        x.add_scaled(&parts.length, &self.w[1]);
        self.product.add_scaled(&parts.length, &self.image[1]);
        self.v.rotate_left(1);
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}
