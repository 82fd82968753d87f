//! GMRES(m): of all iterates in the Krylov space, the one with the smallest ‖b − A x‖₂, by the
//! Arnoldi process, begun anew after m steps.
//!
//! Source: Y. Saad, M. H. Schultz, GMRES, SIAM Journal on Scientific and Statistical Computing 7,
//! 1986, DOI 10.1137/0907058; modified Gram–Schmidt done twice, rotations after Y. Saad, Iterative
//! Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, § 6.5.3, DOI 10.1137/1.9780898718003. The
//! iterate of every step is formed, which costs as much as the orthogonalisation.
//!
//! Requires nothing; A not singular. Converges where the field of values keeps away from 0, after
//! at most n steps if m ≥ n.
//!
//! Cost of an iteration: one application, and 6 j vector operations at step j. Memory: m + 4
//! vectors.
//!
//! ```
//! use fredholm_iterative::Gmres;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Gmres::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{minus, reals, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind};

const NAME: &str = "gmres";

/// Restarted GMRES.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gmres {
    /// Steps before it begins anew, m.
    pub restart: usize,
}

impl Default for Gmres {
    fn default() -> Self {
        Self { restart: 30 }
    }
}

struct Arnoldi<'a, T> {
    a: &'a SecondKind<'a, T>,
    b: &'a MultiVector<T>,
    steps: usize,
    basis: Vec<MultiVector<T>>,
    fits: Vec<Fit<T>>,
    /// x and A x where the basis began.
    origin: [MultiVector<T>; 2],
    product: MultiVector<T>,
}

/// The least-squares problem of a right-hand side: the columns of the Hessenberg matrix, and
/// rotated to a triangle.
struct Fit<T> {
    columns: Vec<Vec<T>>,
    triangle: Vec<Vec<T>>,
    rotations: Vec<(f64, T)>,
    right: Vec<T>,
}

solve_by_steps!(Gmres);

impl<T: Scalar> Scheme<T> for Gmres {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "GMRES: smallest residual over the Krylov space, for any matrix; restarted"
    }

    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let vectors = (self.restart as u64).saturating_add(6).saturating_mul(size_of::<T>() as u64);
        vectors.saturating_mul(dim as u64).saturating_mul(rhs_count as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        _: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let zeros = MultiVector::zeros(b.dim(), b.rhs_count());
        Ok(Box::new(Arnoldi {
            a,
            b,
            steps: self.restart.max(1),
            basis: Vec::new(),
            fits: Vec::new(),
            origin: [zeros.clone(), zeros.clone()],
            product: zeros,
        }))
    }
}

impl<T: Scalar> Arnoldi<'_, T> {
    /// The basis of the residual alone.
    fn begin(&mut self, x: &MultiVector<T>) {
        self.origin = [x.clone(), self.product.clone()];
        let mut residual = self.b.clone();
        residual.set_difference(self.b, &self.product);
        let lengths = normalise(&mut residual);
        self.basis = vec![residual];
        self.fits = lengths.into_iter().map(Fit::new).collect();
    }

    /// A v_j made orthogonal to the basis, twice; a column of the Hessenberg matrix per right-hand
    /// side.
    fn extend(&mut self, context: &mut Context<'_>) -> Result<(), Halt> {
        let last = &self.basis[self.basis.len() - 1];
        let mut next = last.clone();
        context.apply(self.a, last, &mut next)?;
        let scale = next.norms();
        let mut columns = vec![vec![T::zero(); self.basis.len()]; self.fits.len()];
        for _ in 0..2 {
            for (j, v) in self.basis.iter().enumerate() {
                let along = v.dots(&next);
                next.add_scaled(&minus(&along), v);
                columns.iter_mut().zip(&along).for_each(|(column, &part)| column[j] += part);
            }
        }
        clear_lost(&mut next, &scale);
        let lengths = normalise(&mut next);
        for ((fit, mut column), &length) in self.fits.iter_mut().zip(columns).zip(&lengths) {
            column.push(T::from_real(length));
            fit.take(column);
        }
        self.basis.push(next);
        Ok(())
    }

    /// x = x_0 + V y, A x = A x_0 + V H y.
    fn form(&mut self, x: &mut MultiVector<T>) {
        let (y, images): (Vec<Vec<T>>, Vec<Vec<T>>) = self.fits.iter().map(Fit::solve).unzip();
        x.copy_from(&self.origin[0]);
        self.product.copy_from(&self.origin[1]);
        for (j, v) in self.basis.iter().enumerate() {
            let part = |all: &[Vec<T>]| -> Vec<T> {
                all.iter().map(|steps| steps.get(j).copied().unwrap_or(T::zero())).collect()
            };
            x.add_scaled(&part(&y), v);
            self.product.add_scaled(&part(&images), v);
        }
    }
}

impl<T: Scalar> Fit<T> {
    fn new(length: f64) -> Self {
        let right = vec![T::from_real(length)];
        Self { columns: Vec::new(), triangle: Vec::new(), rotations: Vec::new(), right }
    }

    /// Takes in a column and rotates what is below its diagonal away.
    fn take(&mut self, column: Vec<T>) {
        let mut rotated = column.clone();
        for (i, &(cosine, sine)) in self.rotations.iter().enumerate() {
            (rotated[i], rotated[i + 1]) = rotate(cosine, sine, rotated[i], rotated[i + 1]);
        }
        let last = rotated.len() - 2;
        let (cosine, sine) = rotation(rotated[last], rotated[last + 1]);
        (rotated[last], _) = rotate(cosine, sine, rotated[last], rotated[last + 1]);
        rotated.truncate(last + 1);
        let (upper, lower) = rotate(cosine, sine, self.right[last], T::zero());
        self.right[last] = upper;
        self.right.push(lower);
        self.rotations.push((cosine, sine));
        self.triangle.push(rotated);
        self.columns.push(column);
    }

    /// y with the smallest ‖β e₁ − H y‖, and H y. A direction without length has no part.
    fn solve(&self) -> (Vec<T>, Vec<T>) {
        let count = self.triangle.len();
        let mut y = vec![T::zero(); count];
        for i in (0..count).rev() {
            let rest = (i + 1..count).fold(self.right[i], |sum, j| sum - self.triangle[j][i] * y[j]);
            let pivot = self.triangle[i][i];
            y[i] = if pivot == T::zero() { T::zero() } else { rest / pivot };
        }
        let mut image = vec![T::zero(); count + 1];
        for (column, &y) in self.columns.iter().zip(&y) {
            column.iter().zip(&mut image).for_each(|(&entry, image)| *image += entry * y);
        }
        (y, image)
    }
}

/// (c, s), c real, that turn (u, v) to (·, 0).
fn rotation<T: Scalar>(u: T, v: T) -> (f64, T) {
    let length = u.abs().hypot(v.abs());
    if v == T::zero() || length == 0.0 {
        (1.0, T::zero())
    } else if u == T::zero() {
        (0.0, v.conj().scale(v.abs().recip()))
    } else {
        (u.abs() / length, (u * v.conj()).scale((u.abs() * length).recip()))
    }
}

fn rotate<T: Scalar>(cosine: f64, sine: T, u: T, v: T) -> (T, T) {
    (u.scale(cosine) + sine * v, v.scale(cosine) - sine.conj() * u)
}

/// Sets the vectors to 0 of which orthogonalisation has left nothing but rounding.
fn clear_lost<T: Scalar>(v: &mut MultiVector<T>, before: &[f64]) {
    let kept = |(after, before): (f64, &f64)| f64::from(u8::from(after > 1e-14 * before));
    let factors: Vec<f64> = v.norms().into_iter().zip(before).map(kept).collect();
    let zeros = MultiVector::zeros(v.dim(), v.rhs_count());
    v.scale_and_add(&reals(&factors), &zeros);
}

/// Makes unit vectors of the vectors that are not 0; returns their lengths.
fn normalise<T: Scalar>(v: &mut MultiVector<T>) -> Vec<f64> {
    let lengths = v.norms();
    let inverse = |&length: &f64| if length > 0.0 { length.recip() } else { 0.0 };
    let zeros = MultiVector::zeros(v.dim(), v.rhs_count());
    v.scale_and_add(&reals(&lengths.iter().map(inverse).collect::<Vec<_>>()), &zeros);
    lengths
}

impl<T: Scalar> Iteration<T> for Arnoldi<'_, T> {
    fn restart(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        context.start(self.a, x, &mut self.product)?;
        self.basis.clear();
        Ok(())
    }

    fn advance(&mut self, x: &mut MultiVector<T>, context: &mut Context<'_>) -> Result<(), Halt> {
        if self.basis.is_empty() || self.basis.len() > self.steps {
            self.begin(x);
        }
        self.extend(context)?;
        self.form(x);
        Ok(())
    }

    fn product(&self) -> &MultiVector<T> {
        &self.product
    }

    fn drifts(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;

    #[test]
    fn rotations_leave_nothing_below() {
        let pairs = [(3.0, 4.0, -1.0, 2.0), (0.0, 0.0, 1.0, 1.0), (2.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)];
        for (a, b, c, d) in pairs {
            let (u, v) = (Complex64::new(a, b), Complex64::new(c, d));
            let (cosine, sine) = rotation(u, v);
            let (upper, lower) = rotate(cosine, sine, u, v);
            assert!(lower.norm() < 1e-15 && (upper.norm() - u.norm().hypot(v.norm())).abs() < 1e-15);
        }
    }
}
