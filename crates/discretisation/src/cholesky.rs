//! Cholesky factorisation A = L Lᵀ of a small symmetric positive definite matrix, and solution of A
//! x = b.
//!
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., Johns Hopkins University Press
//! 2013, section 4.2. For mass matrices, whose blocks have a few to some hundred rows. One thread,
//! so the bits never depend on their number.

/// The lower triangle L, row by row in full storage.
#[derive(Clone, Debug)]
pub(crate) struct Cholesky {
    dim: usize,
    lower: Vec<f64>,
}

impl Cholesky {
    /// Factorises the matrix, of which the lower triangle is read; `None` where it is not positive
    /// definite to working precision.
    pub(crate) fn new(dim: usize, mut a: Vec<f64>) -> Option<Self> {
        for i in 0..dim {
            for j in 0..=i {
                let dot: f64 = (0..j).map(|k| a[i * dim + k] * a[j * dim + k]).sum();
                let rest = a[i * dim + j] - dot;
                if i > j {
                    a[i * dim + j] = rest / a[j * dim + j];
                } else if rest > f64::EPSILON * a[i * dim + i] {
                    a[i * dim + i] = rest.sqrt();
                } else {
                    return None;
                }
            }
        }
        Some(Self { dim, lower: a })
    }

    /// Solves A X = B for right-hand sides that are the columns of `b`, `width` of them, stored row
    /// by row.
    pub(crate) fn solve(&self, b: &mut [f64], width: usize) {
        for i in 0..self.dim {
            let (before, after) = b.split_at_mut(i * width);
            let row = &mut after[..width];
            (0..i).for_each(|k| subtract(row, self.at(i, k), &before[k * width..(k + 1) * width]));
            divide(row, self.at(i, i));
        }
        for i in (0..self.dim).rev() {
            let (before, after) = b.split_at_mut((i + 1) * width);
            let row = &mut before[i * width..];
            for k in i + 1..self.dim {
                subtract(row, self.at(k, i), &after[(k - i - 1) * width..(k - i) * width]);
            }
            divide(row, self.at(i, i));
        }
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.lower[i * self.dim + j]
    }
}

/// row −= factor × other.
fn subtract(row: &mut [f64], factor: f64, other: &[f64]) {
    if factor != 0.0 {
        row.iter_mut().zip(other).for_each(|(x, y)| *x -= factor * y);
    }
}

fn divide(row: &mut [f64], divisor: f64) {
    for x in row {
        *x /= divisor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_was_multiplied_by_hand() {
        // A = [4 2 0; 2 5 3; 0 3 6], X = [1 0; 2 1; 3 -1].
        let factors = Cholesky::new(3, vec![4., 2., 0., 2., 5., 3., 0., 3., 6.]).unwrap();
        let mut b = vec![8., 2., 21., 2., 24., -3.];
        factors.solve(&mut b, 2);
        let exact = [1., 0., 2., 1., 3., -1.];
        assert!(b.iter().zip(exact).all(|(x, y)| (x - y).abs() < 1e-14), "{b:?}");
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        assert!(Cholesky::new(2, vec![1., 2., 2., 1.]).is_none());
        assert!(Cholesky::new(1, vec![f64::NAN]).is_none());
    }
}
