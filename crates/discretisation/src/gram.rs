//! The Gram matrix G = EᵀE of the columns of E, one half of it computed and mirrored.
//!
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., Johns Hopkins University Press
//! 2013, section 1.2.8; by faer. Cost: m n² operations for m rows of n numbers.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, MatMut, MatRef, Par};

/// The parts that faer cuts its work into. The bits of the result depend on this number, not on
/// that of the threads.
const PARTS: usize = 8;

/// Fills `product`, n × n, with EᵀE; `e` holds E row by row.
pub(crate) fn gram(e: &[f64], n: usize, product: &mut [f64]) {
    // What is stored row by row is the transposed matrix column by column.
    let transposed = MatRef::from_column_major_slice(e, n, e.len() / n.max(1));
    matmul(
        MatMut::from_column_major_slice_mut(product, n, n),
        BlockStructure::TriangularLower,
        Accum::Replace,
        transposed,
        BlockStructure::Rectangular,
        transposed.transpose(),
        BlockStructure::Rectangular,
        1.0,
        Par::rayon(PARTS),
    );
    mirror(product, n);
}

/// Copies the triangle stored column by column below the diagonal onto the other.
fn mirror(product: &mut [f64], n: usize) {
    for j in 0..n {
        for i in j + 1..n {
            product[i * n + j] = product[j * n + i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_sums_of_products() {
        let (rows, n) = (37, 21);
        let e: Vec<f64> = (0..rows * n).map(|k| (k as f64 * 0.7).sin()).collect();
        let mut product = vec![f64::NAN; n * n];
        gram(&e, n, &mut product);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let sum: f64 = (0..rows).map(|s| e[s * n + i] * e[s * n + j]).sum();
            assert!((product[i * n + j] - sum).abs() < 1e-13 * rows as f64, "{i} {j}");
        }
    }

    #[test]
    fn nothing_has_nothing() {
        gram(&[], 0, &mut []);
    }
}
