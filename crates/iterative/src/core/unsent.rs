//! How much of what an unknown holds is sent to the others: w_j = Σ_i |k_ij|. For light it is A_j
//! Σ_i F_ji, m².

use fredholm_linop::{Context, Halt, MultiVector, Scalar, SecondKind, Symmetry};

/// w of the first right-hand side. One application of K where it is symmetric and without signs to
/// cancel, else all columns.
pub(crate) fn sent_shares<T: Scalar>(
    a: &SecondKind<'_, T>,
    context: &mut Context<'_>,
) -> Result<Vec<f64>, Halt> {
    let coupling = a.coupling();
    let dim = coupling.dim();
    context.work.entries_touched += coupling.entries();
    if coupling.symmetry() != Symmetry::General {
        context.poll()?;
        let rhs_count = coupling.rhs_count().unwrap_or(1);
        let mut sums = MultiVector::zeros(dim, rhs_count);
        coupling.apply(&MultiVector::from_fn(dim, rhs_count, |_, _| T::one()), &mut sums);
        context.work.operator_applications += 1;
        return Ok(sums.rows().map(|row| row[0].abs()).collect());
    }
    let mut column = vec![T::zero(); dim];
    let mut shares = Vec::with_capacity(dim);
    for j in 0..dim {
        context.poll()?;
        coupling.column(j, 0, &mut column);
        shares.push(column.iter().map(|entry| entry.abs()).sum());
    }
    context.work.column_visits += dim as u64;
    Ok(shares)
}
