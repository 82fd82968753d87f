//! The Fresnel integral of diffraction, E(a) = e^{ja²} (e^{jπ/4}/√π) ∫_a^∞ e^{−jt²} dt for a ≥ 0,
//! and its divided differences.
//!
//! E(a) = ½ erfcx(e^{jπ/4} a), E(0) = ½, E → e^{−jπ/4}/(2√π a) for large a (M. Abramowitz, I. A.
//! Stegun, Handbook of Mathematical Functions, 1964, 7.1.5 for the series and 7.1.14 for the
//! continued fraction).

use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_4, PI};

/// From here on the continued fraction is taken.
const CONTINUED_FRACTION_FROM: f64 = 2.0;
/// Below this difference a divided difference is the mean slope.
const MEAN_SLOPE_BELOW: f64 = 0.5;
/// Gauss–Legendre points and weights on 0 … 1.
const GAUSS: [[f64; 2]; 6] = [
    [0.033_765_242_898_423_975, 0.085_662_246_189_585_17],
    [0.169_395_306_766_867_74, 0.180_380_786_524_069_3],
    [0.380_690_406_958_401_56, 0.233_956_967_286_345_5],
    [0.619_309_593_041_598_5, 0.233_956_967_286_345_5],
    [0.830_604_693_233_132_2, 0.180_380_786_524_069_3],
    [0.966_234_757_101_576, 0.085_662_246_189_585_17],
];

/// e^{jπ/4}/√π.
pub(super) fn factor() -> Complex64 {
    Complex64::from_polar(1.0 / PI.sqrt(), FRAC_PI_4)
}

/// E(a) for a ≥ 0.
pub(super) fn scaled(a: f64) -> Complex64 {
    half_scaled(Complex64::from_polar(a, FRAC_PI_4), a)
}

/// ½ erfcx(z) for |arg z| ≤ π/4: E of a complex a with z = e^{jπ/4} a.
pub(crate) fn of(z: Complex64) -> Complex64 {
    half_scaled(z, z.norm())
}

/// ½ erfcx(z), where `a` is |z|.
fn half_scaled(z: Complex64, a: f64) -> Complex64 {
    if a < CONTINUED_FRACTION_FROM { series(z) } else { fraction(z, a) }
}

/// ½ e^{z²} (1 − erf z), erf z = (2/√π) Σ (−1)ⁿ z^{2n+1}/(n! (2n + 1)).
fn series(z: Complex64) -> Complex64 {
    let square = z * z;
    let (mut term, mut sum) = (z, z);
    for n in 1..60 {
        term *= -square / f64::from(n);
        let next = term / f64::from(2 * n + 1);
        sum += next;
        if next.norm() < 1e-17 {
            break;
        }
    }
    square.exp() * (0.5 - sum / PI.sqrt())
}

/// (1/2√π)/(z + ½/(z + 1/(z + 3⁄2/(z + …)))): fewer steps for larger a.
fn fraction(z: Complex64, a: f64) -> Complex64 {
    let steps = (10.0 + 400.0 / (a * a)) as u32;
    let denominator = (1..=steps).rev().fold(z, |below, n| z + 0.5 * f64::from(n) / below);
    0.5 / (PI.sqrt() * denominator)
}

/// (E(a) − E(b))/(a − b), with E′ = 2ja E − e^{jπ/4}/√π where they are close.
pub(super) fn divided(a: f64, b: f64) -> Complex64 {
    if (a - b).abs() >= MEAN_SLOPE_BELOW {
        return (scaled(a) - scaled(b)) / (a - b);
    }
    let slope = |[x, weight]: &[f64; 2]| {
        let at = b + x * (a - b);
        (scaled(at) * Complex64::new(0.0, 2.0 * at) - factor()) * *weight
    };
    GAUSS.iter().map(slope).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// erfcx(e^{jπ/4} a) obeys E′ = 2ja E − e^{jπ/4}/√π; both formulas agree where they meet.
    #[test]
    fn the_integral_obeys_its_equation_and_its_limits() {
        assert!((scaled(0.0) - 0.5).norm() < 1e-16);
        for a in [1.6, 2.0, 2.4] {
            let z = Complex64::from_polar(a, FRAC_PI_4);
            assert!((series(z) - fraction(z, a)).norm() < 1e-13, "{a}");
        }
        for a in [0.1, 0.7, 1.9, 3.0, 8.0, 40.0] {
            let step = 1e-4;
            let slope = (scaled(a + step) - scaled(a - step)) / (2.0 * step);
            let expected = scaled(a) * Complex64::new(0.0, 2.0 * a) - factor();
            assert!((slope - expected).norm() < 1e-6, "{a}: {slope} {expected}");
        }
        let far = Complex64::from_polar(0.5 / (PI.sqrt() * 1e3), -FRAC_PI_4);
        assert!((scaled(1e3) / far - 1.0).norm() < 1e-6);
    }

    /// Values of mpmath 1.4.1, 30 digits: exp(z²) erfc(z)/2.
    #[test]
    fn of_complex_argument() {
        for (z, re, im) in [
            (Complex64::new(0.3, 0.2), 0.356_900_526_491_825_95, -0.067_369_297_354_147_22),
            (Complex64::new(1.99, 0.0), 0.128_233_918_359_764_95, 0.0),
            (Complex64::new(1.5, 1.2), 0.117_435_156_244_557_47, -0.075_102_342_619_743_31),
            (Complex64::new(2.01, 0.0), 0.127_165_938_280_409_13, 0.0),
            (Complex64::new(3.0, 1.0), 0.082_130_568_196_493_1, -0.025_098_567_567_624_295),
            (Complex64::new(20.0, -5.0), 0.013_263_125_384_197_794, 0.003_308_020_789_983_63),
        ] {
            let expected = Complex64::new(re, im);
            assert!((of(z) - expected).norm() < 2e-13 * expected.norm(), "{z}: {} {expected}", of(z));
        }
    }

    #[test]
    fn divided_differences_are_smooth_where_the_rule_changes() {
        for b in [0.0, 0.3, 1.8, 5.0] {
            for gap in [1e-9, 0.499_999, 0.500_001] {
                let plain = (scaled(b + 0.5) - scaled(b)) / 0.5;
                let found = divided(b + gap, b);
                if gap > 0.1 {
                    assert!((found - plain).norm() < 1e-5, "{b} {gap}");
                } else {
                    let slope = scaled(b) * Complex64::new(0.0, 2.0 * b) - factor();
                    assert!((found - slope).norm() < 1e-8, "{b} {gap}");
                }
            }
        }
    }
}
