//! One unknown after the other, the one with the largest weighted residual first: x_i += s, r −= A
//! e_i s.

use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, SecondKind};

/// The step s of an unknown i, per right-hand side: of the residual r and diag(A).
pub(crate) trait Step<T> {
    /// Before the shots of an iteration.
    fn prepare(&mut self, residual: &MultiVector<T>);
    /// s for all right-hand sides.
    fn step(&self, i: usize, residual: &[T], diagonal: &[T]) -> Vec<T>;
}

/// An iteration is a number of shots.
pub(crate) struct Shooting<'a, T, S> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    diagonal: MultiVector<T>,
    /// What |r_i| is weighed with.
    weights: Vec<f64>,
    step: S,
    shots: usize,
    /// Whether A x is computed anew at the end of every iteration.
    anew: bool,
    scales: Vec<f64>,
    residual: MultiVector<T>,
    product: MultiVector<T>,
    column: Vec<T>,
}

impl<'a, T: Scalar, S: Step<T>> Shooting<'a, T, S> {
    pub fn new(
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        (diagonal, weights): (MultiVector<T>, Vec<f64>),
        step: S,
    ) -> Self {
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        let scale = |norm: f64| if norm > 0.0 { norm.recip() } else { 0.0 };
        Self {
            a,
            b,
            diagonal,
            weights,
            step,
            shots: b.dim(),
            anew: false,
            scales: b.norms().into_iter().map(scale).collect(),
            residual: zeros.clone(),
            product: zeros,
            column: vec![T::zero(); b.dim()],
        }
    }

    /// With this many shots an iteration.
    pub fn with_shots(self, shots: usize) -> Self {
        Self { shots, ..self }
    }

    /// With A x computed anew at the end of every iteration.
    pub fn with_anew_products(self) -> Self {
        Self { anew: true, ..self }
    }

    /// The unknown with the largest weighted residual, if any is above 0; the first one of equals.
    fn largest(&self) -> Option<usize> {
        let (mut found, mut largest) = (None, 0.0);
        for (i, (row, &weight)) in self.residual.rows().zip(&self.weights).enumerate() {
            let sizes = row.iter().zip(&self.scales).map(|(r, &scale)| r.scale(scale * weight).abs2());
            let size = sizes.fold(0.0, f64::max);
            if size > largest {
                (found, largest) = (Some(i), size);
            }
        }
        found
    }

    fn shoot(&mut self, i: usize, x: &mut MultiVector<T>, context: &mut Context<'_>) {
        let step = self.step.step(i, self.residual.row(i), self.diagonal.row(i));
        x.row_mut(i).iter_mut().zip(&step).for_each(|(x, &step)| *x += step);
        context.work.column_visits += 1;
        context.work.entries_touched +=
            self.a.subtract_column(i, &step, &mut self.residual, &mut self.column);
    }
}

impl<T: Scalar, S: Step<T>> Iteration<T> for Shooting<'_, T, S> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)?;
        self.residual.set_difference(self.b, &self.product);
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        for _ in 0..self.shots {
            context.poll()?;
            self.step.prepare(&self.residual);
            let Some(i) = self.largest() else { break };
            self.shoot(i, x, context);
        }
        if self.anew {
            return self.restart(x, context);
        }
        self.product.set_difference(self.b, &self.residual);
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        !self.anew
    }
}
