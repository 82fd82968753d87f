//! The complex dilogarithm Li₂(z) = −∫₀ᶻ ln(1 − t)/t dt = Σ zᵏ/k².
//!
//! L. Lewin, *Polylogarithms and Associated Functions*, North-Holland 1981; J. Vollinga & S.
//! Weinzierl, Comput. Phys. Commun. 167 (2005) 177, doi:10.1016/j.cpc.2004.12.009, section 3.
//! Dimensionless. Inversion (|z| > 1) and reflection (Re z > ½) bring z to where u = −ln(1 − z) has
//! |u| < 1.1; there Li₂ = Σ Bₖ uᵏ⁺¹/(k + 1)!, whose terms fall by (|u|/2π)² ≤ 0.03. On the branch
//! cut, real z > 1, the sign of the imaginary zero chooses the side.

use num_complex::Complex64;
use std::f64::consts::PI;

/// B₂ₖ/(2k + 1)!, k = 1, 2, …
const SERIES: [f64; 10] = [
    2.777_777_777_777_778e-2,
    -2.777_777_777_777_778e-4,
    4.724_111_866_969_01e-6,
    -9.185_773_074_661_964e-8,
    1.897_886_998_897_1e-9,
    -4.064_761_645_144_226e-11,
    8.921_691_020_456_453e-13,
    -1.993_929_586_072_107_6e-14,
    4.518_980_029_619_918e-16,
    -1.035_651_761_218_124_7e-17,
];
const ZETA_2: f64 = PI * PI / 6.0;

/// Li₂(z), to about 1e-15 of max(1, |Li₂(z)|).
///
/// ```
/// use fredholm_coupling::method::dilogarithm;
/// use num_complex::Complex64;
/// let catalan = dilogarithm(Complex64::I).im;
/// assert!((catalan - 0.915_965_594_177_219).abs() < 1e-15);
/// ```
#[must_use]
pub fn dilogarithm(z: Complex64) -> Complex64 {
    if z.norm_sqr() <= 1.0 {
        return reflected(z);
    }
    let log = (-z).ln();
    -reflected(z.inv()) - ZETA_2 - 0.5 * log * log
}

/// |z| ≤ 1.
fn reflected(z: Complex64) -> Complex64 {
    if z.re <= 0.5 {
        return series(-(1.0 - z).ln());
    }
    let rest = 1.0 - z;
    if rest == Complex64::ZERO {
        return ZETA_2.into();
    }
    let log = z.ln();
    // −ln(1 − (1 − z)) = −ln z.
    ZETA_2 - log * rest.ln() - series(-log)
}

/// Σ Bₖ uᵏ⁺¹/(k + 1)!.
fn series(u: Complex64) -> Complex64 {
    let u2 = u * u;
    let even = SERIES.iter().rev().fold(Complex64::ZERO, |sum, &c| sum * u2 + c);
    u - 0.25 * u2 + u * u2 * even
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::LN_2;

    fn c(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    /// Points of all regions: about 0, 1 and ∞, on both sides of every line where the formula
    /// changes.
    fn points() -> impl Iterator<Item = Complex64> {
        let radii = [1e-8, 0.1, 0.499, 0.501, 0.9, 0.999_999, 1.0, 1.000_001, 1.5, 7.0, 1e6];
        let angle = |k: usize| 0.05 + 0.31 * k as f64;
        radii.into_iter().flat_map(move |r| (0..20).map(move |k| Complex64::from_polar(r, angle(k))))
    }

    fn close(a: Complex64, b: Complex64, z: Complex64) {
        assert!((a - b).norm() <= 3e-15 * a.norm().max(1.0), "{z}: {a} against {b}");
    }

    /// Values of an arbitrary-precision library, 20 digits.
    #[test]
    fn known_values() {
        let known = [
            (c(0.5, 0.5), c(0.453_985_269_150_295_6, 0.643_767_332_889_268_7)),
            (c(2.0, 1.0), c(1.186_688_537_000_057_8, 2.407_740_769_345_772)),
            (c(-1.5, 0.25), c(-1.151_761_243_474_134_2, 0.152_505_612_667_634_17)),
            (c(1.0, 0.0625), c(1.553_267_103_085_667_2, 0.238_596_585_007_637_8)),
            (c(30.0, -40.0), c(-6.857_310_657_281_217, -8.678_478_816_265_604)),
            (c(1.0, 0.0), c(ZETA_2, 0.0)),
            (c(-1.0, 0.0), c(-0.5 * ZETA_2, 0.0)),
            (c(0.5, 0.0), c(0.5 * ZETA_2 - 0.5 * LN_2 * LN_2, 0.0)),
            (c(0.0, 0.0), c(0.0, 0.0)),
        ];
        for (z, value) in known {
            close(dilogarithm(z), value, z);
        }
    }

    /// Li₂(z) + Li₂(−z) = ½ Li₂(z²) holds everywhere.
    #[test]
    fn duplication() {
        for z in points().filter(|z| z.re.abs() > 1e-3 * z.im.abs()) {
            close(dilogarithm(z) + dilogarithm(-z), 0.5 * dilogarithm(z * z), z);
        }
    }

    /// Li₂(z) + Li₂(z/(z − 1)) = −½ ln²(1 − z) for z not on the cut.
    #[test]
    fn landen() {
        for z in points() {
            let log = (1.0 - z).ln();
            let sum = dilogarithm(z) + dilogarithm(z / (z - 1.0));
            // Li₂ of the large numbers is of the size of their squared logarithm.
            assert!((sum + 0.5 * log * log).norm() <= 4e-15 * log.norm_sqr().max(1.0), "{z}: {sum}");
        }
    }

    #[test]
    fn the_power_series_inside_the_unit_circle() {
        for z in points().filter(|z| z.norm() < 0.6) {
            let mut power = z;
            let mut sum = Complex64::ZERO;
            for k in 1..100 {
                sum += power / f64::from(k * k);
                power *= z;
            }
            close(dilogarithm(z), sum, z);
        }
    }

    /// Im Li₂(x ± i0) = ± π ln x.
    #[test]
    fn both_sides_of_the_cut() {
        for zero in [0.0, -0.0] {
            let value = dilogarithm(c(2.0, zero));
            close(value, c(1.5 * ZETA_2, (PI * LN_2).copysign(zero)), c(2.0, zero));
        }
    }

    #[test]
    fn conjugate_points_have_conjugate_values() {
        for z in points() {
            close(dilogarithm(z.conj()), dilogarithm(z).conj(), z);
        }
    }
}
