//! ln(1 + x) and 2 atanh(s) by elementary operations, so that loops over them become vector code
//! with the same bits everywhere.
//!
//! ln(1 + f) = 2 atanh(f/(2 + f)) after 1 + x = 2ᵏ (1 + f), √½ < 1 + f < √2; the series of 2 atanh
//! by the minimax polynomial of fdlibm (K. C. Ng, Sun Microsystems 1993, `e_log.c`). Both are
//! accurate to about two units in the last place relative to the result: nothing cancels where x is
//! small.

/// fdlibm's polynomial for (2 atanh(s) − 2 s)/s in z = s².
const SERIES: [f64; 7] = [
    0.666_666_666_666_673_5,
    0.399_999_999_994_094_2,
    0.285_714_287_436_623_9,
    0.222_221_984_321_497_84,
    0.181_835_721_616_180_5,
    0.153_138_376_992_093_73,
    0.147_981_986_051_165_86,
];

/// Largest |s| of the series: (√2 − 1)/(√2 + 1).
pub(super) const SERIES_END: f64 = 0.171_572_875_253_809_9;

/// Bits of √½, rounded as fdlibm does.
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const BITS_OF_ONE: u64 = 0x3ff0_0000_0000_0000;
const MANTISSA_BITS: u64 = 0x000f_ffff_ffff_ffff;
/// Bits of 2⁵², to which an integer below it is added by setting low bits.
const BITS_OF_INTEGERS: u64 = 0x4330_0000_0000_0000;

/// 2 atanh(s) for |s| ≤ [`SERIES_END`].
#[inline(always)]
pub(super) fn twice_atanh(s: f64) -> f64 {
    let z = s * s;
    let [a, b, c, d, e, f, g] = SERIES;
    let tail = z * (a + z * (b + z * (c + z * (d + z * (e + z * (f + z * g))))));
    s * (2.0 + tail)
}

/// ln(1 + x) for finite x > −1 with 1 + x a normal number.
#[inline(always)]
pub(super) fn ln_1p(x: f64) -> f64 {
    let y = 1.0 + x;
    let shifted = y.to_bits().wrapping_add(BITS_OF_ONE - ROOT_HALF);
    let exponent =
        f64::from_bits((shifted >> 52) | BITS_OF_INTEGERS) - (f64::from_bits(BITS_OF_INTEGERS) + 1023.0);
    let reduced = f64::from_bits((shifted & MANTISSA_BITS) + ROOT_HALF) - 1.0;
    // Without a power of two to take out, x itself is exact and 1 + x is not.
    let f = if exponent == 0.0 { x } else { reduced };
    exponent * std::f64::consts::LN_2 + twice_atanh(f / (2.0 + f))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library_to_the_last_places() {
        for k in -400..400 {
            let x = 1.07f64.powi(k);
            for x in [x, -x] {
                if x > -1.0 {
                    assert!((ln_1p(x) - x.ln_1p()).abs() <= 8e-16 * x.ln_1p().abs(), "{x}");
                }
                if x.abs() <= SERIES_END {
                    assert!((twice_atanh(x) - 2.0 * x.atanh()).abs() <= 8e-16 * x.abs(), "{x}");
                }
            }
        }
    }
}
