//! Regular subdivision of a triangle into n² congruent ones.
//!
//! Corner s of row r is a (n − r)/n + b (r − s)/n + c s/n, 0 ≤ s ≤ r ≤ n. Row r holds 2 r + 1
//! triangles, so that triangle t lies in row ⌊√t⌋. Any units of length.

use crate::Vec3;

/// Triangle `index` of the n² that corners a, b, c are divided into, in the orientation of the
/// whole. On a side one weight vanishes, and the neighbour that shares the side finds the same
/// bits.
pub(crate) fn piece([a, b, c]: [Vec3; 3], n: usize, index: usize) -> [Vec3; 3] {
    weights(n, index).map(|w| a * w[0] + b * w[1] + c * w[2])
}

/// Weights of a, b, c in the corners of triangle `index` of n².
pub(crate) fn weights(n: usize, index: usize) -> [[f64; 3]; 3] {
    let row = index.isqrt();
    let place = index - row * row;
    let s = place / 2;
    let corners = if place.is_multiple_of(2) {
        [(row, s), (row + 1, s), (row + 1, s + 1)]
    } else {
        [(row + 1, s + 1), (row, s + 1), (row, s)]
    };
    corners.map(|(r, s)| [n - r, r - s, s].map(|count| count as f64 / n as f64))
}

/// Longest side, m.
pub(crate) fn longest([a, b, c]: [Vec3; 3]) -> f64 {
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}
