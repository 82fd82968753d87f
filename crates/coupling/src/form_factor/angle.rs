//! The angle of a sine and a cosine by elementary operations: faster than the library's arc tangent
//! of two arguments, and loops over it become vector code with the same bits everywhere.
//!
//! θ is reduced to at most π/8 by θ = π − θ', θ = π/2 − θ' and atan u = π/4 + atan((u − 1)/(u +
//! 1)); there atan(t)/t = 1 + z P(z), z = t², P the polynomial of degree 9 of the least largest
//! relative error (Remez's exchange), which is 4e-17. The result is within two units in the last
//! place of π/4 or, below π/8, of itself.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(π/8).
const TAN_EIGHTH_TURN: f64 = 0.414_213_562_373_095_05;

/// P from its constant on.
const SERIES: [f64; 10] = [
    -0.333_333_333_333_301_5,
    0.199_999_999_990_889_43,
    -0.142_857_141_952_598_63,
    0.111_111_066_535_275_39,
    -0.090_907_824_111_610_46,
    0.076_900_682_835_728_79,
    -0.066_411_210_543_898_79,
    0.056_925_383_138_624_6,
    -0.043_590_933_834_541_97,
    0.021_259_822_311_738_253,
];

/// θ in [0, π] with the sine and the cosine given up to one positive factor; the sine must not be
/// negative, nor both 0.
#[inline(always)]
pub(super) fn angle(sine: f64, cosine: f64) -> f64 {
    let positive = cosine.abs();
    let flat = sine < positive;
    let (least, most) = if flat { (sine, positive) } else { (positive, sine) };
    let steep = least > TAN_EIGHTH_TURN * most;
    let above = if steep { least - most } else { least };
    let below = if steep { least + most } else { most };
    let start = if steep { FRAC_PI_4 } else { 0.0 };
    let octant = start + arc_tangent(above / below);
    let acute = if flat { octant } else { FRAC_PI_2 - octant };
    if cosine < 0.0 { PI - acute } else { acute }
}

/// atan t for |t| ≤ [`TAN_EIGHTH_TURN`].
#[inline(always)]
fn arc_tangent(t: f64) -> f64 {
    t + t * series(t * t)
}

/// atan(t)/t for the square of t, up to that of [`TAN_EIGHTH_TURN`].
#[inline(always)]
pub(super) fn arc_over_tangent(t2: f64) -> f64 {
    1.0 + series(t2)
}

/// z P(z). Terms with even and odd powers of z are summed apart, so that no sum waits for the other.
#[inline(always)]
fn series(z: f64) -> f64 {
    let w = z * z;
    let [a, b, c, d, e, f, g, h, i, j] = SERIES;
    let even = a + w * (c + w * (e + w * (g + w * i)));
    let odd = b + w * (d + w * (f + w * (h + w * j)));
    z * (even + z * odd)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library_to_the_last_places() {
        for k in 0..=200_000 {
            let exact = PI * f64::from(k) / 200_000.0;
            let (sine, cosine) = (3.0 * exact.sin().max(0.0), 3.0 * exact.cos());
            let expected = sine.atan2(cosine);
            let found = angle(sine, cosine);
            assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected.min(1.0), "{exact}: {found}");
        }
    }

    #[test]
    fn limits_are_exact() {
        let same =
            |sine: f64, cosine: f64, exact: f64| assert_eq!(angle(sine, cosine).to_bits(), exact.to_bits());
        same(0.0, 1.0, 0.0);
        same(0.0, -1.0, PI);
        same(1.0, 0.0, FRAC_PI_2);
        for sine in [1e-300, 1e-100, 1e-20, 1e-9] {
            same(sine, 1.0, sine);
        }
        assert!((angle(1.0, 1.0) - FRAC_PI_4).abs() <= f64::EPSILON);
    }
}
