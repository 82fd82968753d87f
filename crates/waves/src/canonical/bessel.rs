//! Bessel functions of cylinders: J_n and H_n⁽²⁾ of complex argument, and J_ν of any order.
//!
//! D. E. Amos, Algorithm 644, ACM Trans. Math. Softw. 12 (1986) 265, doi:10.1145/7921.214331, gives
//! single values. Of whole order, the other H follow from H_{n+1} = (2n/z) H_n − H_{n−1}, which is
//! stable upwards where Im z ≤ 0, and the other J from the same downwards. The exponential is taken
//! out: J e^{−|Im z|} and H e^{jz}.

use crate::WaveError;
use complex_bessel::{Error, besselj, besselj_scaled, hankel2_scaled};
use num_complex::Complex64;

/// A number whose square overflows soon, and its inverse underflows.
const LARGE: f64 = 1e150;
/// Most orders that are computed at once.
const MOST: usize = 10_000_000;

/// J_n(z) e^{−|Im z|} for n = 0 … last; 0 where it is too small for a number.
pub(super) fn regular(z: Complex64, last: usize) -> Result<Vec<Complex64>, WaveError> {
    if z == Complex64::ZERO {
        return Ok((0..=last).map(|n| if n == 0 { Complex64::ONE } else { Complex64::ZERO }).collect());
    }
    if last.max(terms(z.norm())) > MOST {
        return Err(none(Error::TotalPrecisionLoss));
    }
    let [zero, one] = [0.0, 1.0].map(|order| besselj_scaled(order, z));
    let (zero, one) = (zero.map_err(none)?, one.map_err(none)?);
    // From far above the turning point (J. C. P. Miller).
    let start = last.max(terms(z.norm())) + 30;
    let mut values = vec![Complex64::ZERO; start + 2];
    values[start] = (1.0 / LARGE).into();
    for n in (1..=start).rev() {
        values[n - 1] = values[n] * (2 * n) as f64 / z - values[n + 1];
        if values[n - 1].norm() > LARGE {
            let scale = values[n - 1].norm().recip();
            let kept = (n + 1).max(last);
            values[n - 1..=kept].iter_mut().for_each(|value| *value *= scale);
        }
    }
    let scale = if zero.norm() > one.norm() { zero / values[0] } else { one / values[1] };
    values.truncate(last + 1);
    Ok(values.into_iter().map(|value| value * scale).collect())
}

/// H_n⁽²⁾(z) e^{jz} for n = 0 … last ≥ 1 and Im z ≤ 0; infinite where it is too large for a number.
pub(super) fn outgoing(z: Complex64, last: usize) -> Result<Vec<Complex64>, WaveError> {
    let mut values = vec![hankel2_scaled(0.0, z).map_err(none)?, hankel2_scaled(1.0, z).map_err(none)?];
    for n in 1..last {
        let next = values[n] * (2 * n) as f64 / z - values[n - 1];
        values.push(if next.is_finite() { next } else { Complex64::new(f64::INFINITY, 0.0) });
    }
    Ok(values)
}

/// J_ν(z) and J_{ν+1}(z).
pub(super) fn pair(order: f64, z: Complex64) -> Result<[Complex64; 2], WaveError> {
    Ok([besselj(order, z).map_err(none)?, besselj(order + 1.0, z).map_err(none)?])
}

fn none(_: Error) -> WaveError {
    WaveError::NotFinite { what: "a Bessel function of this wave and place" }
}

/// Orders from which on J_n(z) is below rounding: near the turning point it is Ai((n − z)
/// (2/z)^{1/3}) (2/z)^{1/3} (M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 1964,
/// 9.3.23), and Ai(15) is 10⁻¹⁸.
pub(super) fn terms(z: f64) -> usize {
    (z + 12.0 * z.cbrt() + 12.0).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(found: Complex64, re: f64, im: f64) {
        let expected = Complex64::new(re, im);
        let error = (found - expected).norm() / expected.norm();
        assert!(error < 1e-13, "{found} {expected}: {error:e}");
    }

    /// Values of mpmath 1.4.1, 30 digits: besselj(n, z) exp(−|Im z|), hankel2(n, z) exp(jz).
    #[test]
    fn of_whole_order() {
        let at = |n: usize, re: f64, im: f64| {
            let z = Complex64::new(re, im);
            [regular(z, n + 3).unwrap()[n], outgoing(z, n + 3).unwrap()[n]]
        };
        let [j, h] = at(0, 1.5, 0.0);
        assert_close(j, 0.511_827_671_735_918_1, 0.0);
        assert_close(h, 0.417_696_141_355_075, 0.483_492_169_911_526);
        let [j, h] = at(3, 2.0, -1.0);
        assert_close(j, 0.030_324_596_254_643_756, -0.064_508_926_990_129_88);
        assert_close(h, -0.492_977_699_338_414_1, -1.522_477_637_160_552);
        let [j, h] = at(7, 30.0, -20.0);
        assert_close(j, 0.044_488_541_643_139_06, 0.010_622_285_171_653_493);
        assert_close(h, 0.097_592_650_528_583_2, -0.168_088_270_524_465);
        let [j, h] = at(40, 5.0, -0.5);
        assert_close(j, -4.426_151_666_878_223e-33, 4.692_089_072_438_817e-33);
        assert_close(h, -5.633_410_486_129_516_2e29, -1.108_414_735_843_344_8e30);
        let [j, h] = at(12, 0.3, -40.0);
        assert_close(j, 0.009_874_020_809_889_686, 0.003_160_264_399_408_191);
        assert_close(h, 0.012_231_017_731_966_031, 0.735_111_420_383_799_1);
    }

    /// Values of mpmath 1.4.1, 30 digits: besselj(ν, z) and besselj(ν + 1, z).
    #[test]
    fn of_any_order() {
        let [low, high] = pair(2.0 / 3.0, 2.5.into()).unwrap();
        assert_close(low, 0.387_212_424_770_843_6, 0.0);
        assert_close(high, 0.506_988_453_968_479_9, 0.0);
        let [low, high] = pair(0.5, 1e-3.into()).unwrap();
        assert_close(low, 0.025_231_321_014_980_94, 0.0);
        assert_close(high, 8.410_440_899_023_056e-6, 0.0);
        let [low, high] = pair(17.0 / 1.5, Complex64::new(10.0, -2.0)).unwrap();
        assert_close(low, 0.043_435_638_933_745_271, -0.138_147_872_224_090_08);
        assert_close(high, 0.000_561_802_219_380_781, -0.071_151_420_396_962_53);
        let [low, high] = pair(0.0, 60.0.into()).unwrap();
        assert_close(low, -0.091_471_804_089_061_87, 0.0);
        assert_close(high, 0.046_598_383_758_166_318, 0.0);
    }

    /// J_{n+1} H_n − J_n H_{n+1} = −2j/(πz), here times e^{jRe z}.
    #[test]
    fn the_cross_product_is_known() {
        for size in [1e-3, 0.5, 8.0, 53.7, 200.0, 900.0] {
            for angle in [0.0, -0.03, -0.4, -1.2, -std::f64::consts::FRAC_PI_2] {
                let z = Complex64::from_polar(size, angle);
                let last = terms(size);
                let (j, h) = (regular(z, last).unwrap(), outgoing(z, last).unwrap());
                for n in 0..last {
                    if j[n + 1].norm() == 0.0 || !h[n + 1].is_finite() {
                        continue;
                    }
                    let found = (j[n + 1] * h[n] - j[n] * h[n + 1]) * Complex64::cis(-z.re);
                    let error = (found * z * Complex64::new(0.0, std::f64::consts::FRAC_PI_2) - 1.0).norm();
                    assert!(error < 1e-10, "{z} {n}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_is_refused_or_told() {
        assert!(outgoing(Complex64::ZERO, 3).is_err() && regular(f64::NAN.into(), 3).is_err());
        let far = outgoing(1e-9.into(), 60).unwrap();
        assert!(far[20].is_finite() && far[60].re.is_infinite());
    }
}
