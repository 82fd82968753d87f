//! cos x and sin x of many x at once.
//!
//! x = q π/2 + r with q = round(2x/π) and |r| ≤ π/4, the product q π/2 in two parts (W. J. Cody, W.
//! Waite, Software Manual for the Elementary Functions, Prentice-Hall 1980); cos r and sin r by the
//! minimax polynomials of fdlibm (Sun Microsystems 1993, `k_cos.c`, `k_sin.c`). The quarter turns
//! are undone without a branch: with h = q mod 4 in −2 … 2, cos(hπ/2) = 1 − |h| and sin(hπ/2) = h
//! (2 − |h|).
//!
//! The error is below 4e-16 for |x| ≤ 1e6, and grows as 1e-22 |x| beyond.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::Lanes;
use pulp::Simd;

/// 1.5 · 2⁵²: adding and subtracting it rounds to an integer.
const ROUNDING_SHIFT: f64 = 6_755_399_441_055_744.0;
/// π/2 and what it lacks of it.
const HALF_PI: [f64; 2] = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17];
const SIN_SERIES: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_4e-8,
    1.589_690_995_211_55e-10,
];
const COS_SERIES: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Rounds to the nearest integer, for |x| < 2⁵¹.
#[inline(always)]
fn round<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let big = x.constant(ROUNDING_SHIFT);
    (x + big) - big
}

/// Σ aᵢ zⁱ.
#[inline(always)]
fn polynomial<S: Simd>(z: Lanes<S>, [a, b, c, d, e, f]: [f64; 6]) -> Lanes<S> {
    let tail = z.constant(f).mul_add(z, z.constant(e)).mul_add(z, z.constant(d)).mul_add(z, z.constant(c));
    tail.mul_add(z, z.constant(b)).mul_add(z, z.constant(a))
}

/// (cos x, sin x) for |x| < 2⁵¹.
#[inline(always)]
#[must_use]
pub fn cos_sin<S: Simd>(x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let one = x.constant(1.0);
    let turns = round(x * x.constant(std::f64::consts::FRAC_2_PI));
    let r = (-turns).mul_add(x.constant(HALF_PI[0]), x);
    let r = (-turns).mul_add(x.constant(HALF_PI[1]), r);
    let z = r * r;
    let sin = (z * r).mul_add(polynomial(z, SIN_SERIES), r);
    let cos = (z * z).mul_add(polynomial(z, COS_SERIES), z.mul_add(x.constant(-0.5), one));
    let quarter = round(turns * x.constant(0.25)).mul_add(x.constant(-4.0), turns);
    let size = quarter.abs();
    let (turn_cos, turn_sin) = (one - size, quarter * (x.constant(2.0) - size));
    (turn_cos * cos - turn_sin * sin, turn_sin.mul_add(cos, turn_cos * sin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};

    struct All<'a> {
        x: &'a [f64],
        cos: &'a mut [f64],
        sin: &'a mut [f64],
    }

    impl WithSimd for All<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let outs = self.cos.chunks_mut(S::F64_LANES).zip(self.sin.chunks_mut(S::F64_LANES));
            for (x, (cos, sin)) in self.x.chunks(S::F64_LANES).zip(outs) {
                let (c, s) = cos_sin(Lanes::load(simd, x));
                c.store(cos);
                s.store(sin);
            }
        }
    }

    #[test]
    fn agrees_with_the_library_and_with_every_width() {
        let golden = 0.618_033_988_749_894_9;
        let point = |i: u32| f64::from(i) * golden * 10f64.powi((i % 13) as i32 - 8);
        let mut x: Vec<f64> = (0..20_000).flat_map(|i| [point(i), -point(i)]).collect();
        x.extend((0..64).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_4));
        let mut results = [Arch::new(), Arch::Scalar].map(|arch| {
            let (mut cos, mut sin) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            arch.dispatch(All { x: &x, cos: &mut cos, sin: &mut sin });
            (cos, sin)
        });
        assert_eq!(results[0], results[1]);
        let (cos, sin) = std::mem::take(&mut results[0]);
        let worst = x.iter().zip(cos.iter().zip(&sin)).map(|(x, (c, s))| {
            assert!(x.abs() < 2e8);
            (c - x.cos()).abs().max((s - x.sin()).abs())
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(worst > 0.0 && worst < 1e-13, "{worst:e}");
        let small = x.iter().zip(cos.iter().zip(&sin)).filter(|(x, _)| x.abs() <= 1e6);
        let worst = small.map(|(x, (c, s))| (c - x.cos()).abs().max((s - x.sin()).abs())).fold(0.0, f64::max);
        assert!(worst < 4e-16, "{worst:e}");
    }
}
