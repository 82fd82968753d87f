//! Closed forms that the tests compare with.
//!
//! A. E. Ruehli, P. A. Brennan, IEEE Trans. Microw. Theory Tech. 21 (1973) 76,
//! doi:10.1109/TMTT.1973.1127927: ∫∫∫∫ 1/r over two parallel rectangles is Σ ± f over the 16
//! differences of their sides.

/// ∫∫∫∫ 1/r over the rectangles [x₀, x₁, y₀, y₁] `a` and `b`, a distance `z` apart.
pub fn coplanar(a: [f64; 4], b: [f64; 4], z: f64) -> f64 {
    let mut sum = 0.0;
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let x = a[i / 2] - b[i % 2];
        let y = a[2 + j / 2] - b[2 + j % 2];
        // −∂²/∂x² as a difference: minus where both are left ends or both right ends.
        let sign = |k: usize| if k / 2 == k % 2 { -1.0 } else { 1.0 };
        sum += sign(i) * sign(j) * primitive(x, y, z);
    }
    sum
}

/// f with ∂⁴f/∂x²∂y² = 1/r.
fn primitive(x: f64, y: f64, z: f64) -> f64 {
    let r = (x * x + y * y + z * z).sqrt();
    // asinh in place of the published logarithm drops a part linear in p, which the differences
    // cancel, and needs no care where p + r cancels.
    let log = |p: f64, q: f64| {
        if q.hypot(z) == 0.0 { 0.0 } else { 0.5 * p * (q * q - z * z) * (p / q.hypot(z)).asinh() }
    };
    let angle = if z == 0.0 { 0.0 } else { x * y * z * (x * y / (z * r)).atan() };
    log(x, y) + log(y, x) - r / 6.0 * (x * x + y * y - 2.0 * z * z) - angle
}

/// ∫∫ 1/r over the rectangle [0, 1]², seen from (x, y, z).
pub fn square_potential(x: f64, y: f64, z: f64) -> f64 {
    let corner = |p: f64, q: f64| {
        let r = (p * p + q * q + z * z).sqrt();
        let log = |p: f64, q: f64| if p.hypot(z) == 0.0 { 0.0 } else { p * (q / p.hypot(z)).asinh() };
        let angle = if z == 0.0 { 0.0 } else { z * (p * q / (z * r)).atan() };
        log(p, q) + log(q, p) - angle
    };
    corner(1.0 - x, 1.0 - y) - corner(-x, 1.0 - y) - corner(1.0 - x, -y) + corner(-x, -y)
}
