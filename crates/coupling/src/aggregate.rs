//! The matrix of coarser patches: G_IJ = Σ_{i∈I} Σ_{j∈J} G_ij.
//!
//! Exchanges add up exactly (A_i F_ij is an integral over both patches), so the matrix of the faces
//! follows from that of their elements. Solving both shows how far the field still moves with the
//! mesh: an estimate of the discretisation error without a second assembly.

use fredholm_linop::{LinopError, PackedSymmetric, Storage};

/// Sums the entries of `fine` (m²) by group: `group[i]`, below `count`, is the coarse index of
/// element i.
///
/// # Errors
/// A matrix that cannot be built.
///
/// # Panics
/// A group of `count` or above.
pub fn aggregate<S: Storage>(
    fine: &PackedSymmetric<S>,
    group: &[usize],
    count: usize,
) -> Result<PackedSymmetric<f64>, LinopError> {
    let mut packed = vec![0.0; count * (count + 1) / 2];
    for (i, &a) in group.iter().enumerate() {
        for (j, (&entry, &b)) in fine.packed_row(i).iter().zip(group).enumerate() {
            // Within one group the pair (i, j) counts for both orders.
            let times = if a == b && j < i { 2.0 } else { 1.0 };
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            packed[high * (high + 1) / 2 + low] += times * entry.to_f64();
        }
    }
    PackedSymmetric::new(count, packed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_blocks_and_keeps_the_total() {
        // Elements 0 and 2 form group 0, element 1 group 1.
        let fine = PackedSymmetric::new(3, vec![0.0, 1.0, 0.0, 2.0, 4.0, 0.0]).unwrap();
        let coarse = aggregate(&fine, &[0, 1, 0], 2).unwrap();
        assert_eq!((coarse.get(0, 0), coarse.get(0, 1), coarse.get(1, 1)), (4.0, 5.0, 0.0));
    }
}
