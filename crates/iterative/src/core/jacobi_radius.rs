//! ρ(J), the spectral radius of J = I − diag(A)⁻¹ A, by the power method from (1, …, 1).
//!
//! Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., Johns Hopkins University
//! Press 2013, § 7.3. For J ≥ 0, as light has it, the start is near the Perron vector, and a few
//! steps are enough.

use fredholm_linop::{Context, Halt, MultiVector, Scalar, SecondKind};

/// Most steps.
const MOST_STEPS: usize = 30;
/// Relative change of the estimate that ends it.
const SETTLED_CHANGE: f64 = 1e-3;

/// The estimate per right-hand side. One application of A a step.
pub(crate) fn jacobi_radius<T: Scalar>(
    a: &SecondKind<'_, T>,
    divisors: &MultiVector<T>,
    context: &mut Context<'_>,
) -> Result<Vec<f64>, Halt> {
    let (dim, rhs_count) = (divisors.dim(), divisors.rhs_count());
    let mut v = MultiVector::from_fn(dim, rhs_count, |_, _| T::one());
    let mut image = v.clone();
    let mut radius = vec![0.0; rhs_count];
    for _ in 0..MOST_STEPS {
        normalise(&mut v);
        context.apply(a, &v, &mut image)?;
        let terms = image.as_slice().iter().zip(divisors.as_slice());
        v.as_mut_slice().iter_mut().zip(terms).for_each(|(v, (&av, &divisor))| *v -= av / divisor);
        let found = v.norms();
        let settled = found.iter().zip(&radius).all(|(new, old)| (new - old).abs() <= SETTLED_CHANGE * new);
        radius = found;
        if settled {
            break;
        }
    }
    Ok(radius)
}

fn normalise<T: Scalar>(v: &mut MultiVector<T>) {
    let scales: Vec<f64> =
        v.norms().iter().map(|&norm| if norm > 0.0 { norm.recip() } else { 0.0 }).collect();
    let rhs_count = v.rhs_count().max(1);
    for row in v.as_mut_slice().chunks_exact_mut(rhs_count) {
        row.iter_mut().zip(&scales).for_each(|(value, &scale)| *value = value.scale(scale));
    }
}
