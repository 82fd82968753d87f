//! Relaxation of every unknown in order, by sweeps that give the residual for nothing.

use fredholm_linop::{
    Context, Halt, Iteration, LinearOperator, MultiVector, Relax, Scalar, SecondKind, Sweep, Visit,
};
use std::ops::ControlFlow;

/// Forward sweeps, each after a backward one where asked for.
pub(crate) struct Sweeping<'a, T, R> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    pub sweep: Sweep<T>,
    relax: R,
    back: bool,
}

impl<'a, T: Scalar, R: Fn(&MultiVector<T>, Visit<'_, T>)> Sweeping<'a, T, R> {
    pub fn forward(a: &'a SecondKind<'a, T>, b: &'a MultiVector<T>, relax: R) -> Self {
        Self { a, b, sweep: Sweep::new(b.dim(), b.rhs_count()), relax, back: false }
    }

    pub fn back_and_forth(a: &'a SecondKind<'a, T>, b: &'a MultiVector<T>, relax: R) -> Self {
        Self { back: true, ..Self::forward(a, b, relax) }
    }
}

impl<T: Scalar, R: Fn(&MultiVector<T>, Visit<'_, T>)> Iteration<T> for Sweeping<'_, T, R> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        if x.is_zero() {
            self.sweep = Sweep::new(x.dim(), x.rhs_count());
            return Ok(());
        }
        // Nothing changes: this gives the product of the starting guess.
        visit_all(self.a, context, |_| (), |relax| self.a.sweep(x, &mut self.sweep, relax))
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        let rule = |visit: Visit<'_, T>| (self.relax)(self.b, visit);
        if self.back {
            visit_all(self.a, context, rule, |relax| self.a.sweep_back(x, &mut self.sweep, relax))?;
        }
        visit_all(self.a, context, rule, |relax| self.a.sweep(x, &mut self.sweep, relax))
    }

    fn product(&self) -> &MultiVector<T> {
        self.sweep.product()
    }
}

/// One counted sweep, which the observer can break off.
pub(crate) fn visit_all<T: Scalar>(
    a: &SecondKind<'_, T>,
    context: &mut Context<'_>,
    rule: impl Fn(Visit<'_, T>),
    sweep: impl FnOnce(&mut Relax<'_, T>) -> ControlFlow<()>,
) -> Result<(), Halt> {
    context.work.row_visits += a.dim() as u64;
    context.work.entries_touched += a.entries();
    let flow = sweep(&mut |visit| {
        if context.poll().is_err() {
            return ControlFlow::Break(());
        }
        rule(visit);
        ControlFlow::Continue(())
    });
    if flow.is_break() { Err(Halt::Interrupted) } else { Ok(()) }
}

/// x_i = (b_i − Σ_{j≠i} a_ij x_j)/a_ii in all right-hand sides.
pub(crate) fn relax_fully<T: Scalar>(b: &MultiVector<T>, visit: Visit<'_, T>) {
    let Visit { index, off_diagonal, diagonal, x } = visit;
    let known = b.row(index).iter().zip(off_diagonal).zip(diagonal);
    for (x, ((&b, &sum), &diagonal)) in x.iter_mut().zip(known) {
        *x = (b - sum) / diagonal;
    }
}

/// x_i += ω ((b_i − Σ_{j≠i} a_ij x_j)/a_ii − x_i), with an ω for each right-hand side.
pub(crate) fn relax_by<T: Scalar>(omega: &[f64], b: &MultiVector<T>, visit: Visit<'_, T>) {
    let Visit { index, off_diagonal, diagonal, x } = visit;
    let known = b.row(index).iter().zip(off_diagonal).zip(diagonal);
    for ((x, ((&b, &sum), &diagonal)), &omega) in x.iter_mut().zip(known).zip(omega) {
        *x += ((b - sum) / diagonal - *x).scale(omega);
    }
}
