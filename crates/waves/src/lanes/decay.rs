//! e^{−x} of many small x at once: what a lossy medium takes from a wave over the size of a patch.
//!
//! e^{−x} = (e^{−x/2^m})^{2^m}, where m halvings bring |x| below 1/8 and Taylor's series to the
//! tenth power leaves an error of 3e-18. Squaring m times multiplies the rounding by 2^m, so that
//! the relative error stays below 2^{m+2} · 1.1e-16.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::Lanes;
use pulp::Simd;

/// Largest argument of the series.
const SERIES_UP_TO: f64 = 0.125;
/// (−1)ⁿ/n!, from n = 10 down to 1.
const SERIES: [f64; 10] = [
    1.0 / 3_628_800.0,
    -1.0 / 362_880.0,
    1.0 / 40_320.0,
    -1.0 / 5040.0,
    1.0 / 720.0,
    -1.0 / 120.0,
    1.0 / 24.0,
    -1.0 / 6.0,
    0.5,
    -1.0,
];

/// Halvings that arguments up to `largest` need in [`decay`].
#[must_use]
pub fn halvings(largest: f64) -> u32 {
    (largest.abs() / SERIES_UP_TO).log2().ceil().clamp(0.0, 64.0) as u32
}

/// e^{−x} for |x| up to 2^`halvings`/8.
#[inline(always)]
#[must_use]
pub fn decay<S: Simd>(x: Lanes<S>, halvings: u32) -> Lanes<S> {
    let small = x * x.constant((-f64::from(halvings)).exp2());
    let mut sum = x.constant(SERIES[0]);
    for &term in &SERIES[1..] {
        sum = sum.mul_add(small, x.constant(term));
    }
    let mut value = sum.mul_add(small, x.constant(1.0));
    for _ in 0..halvings {
        value = value * value;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};

    struct All<'a>(&'a [f64], u32, &'a mut [f64]);

    impl WithSimd for All<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            for (x, out) in self.0.chunks(S::F64_LANES).zip(self.2.chunks_mut(S::F64_LANES)) {
                decay(Lanes::load(simd, x), self.1).store(out);
            }
        }
    }

    #[test]
    fn agrees_with_the_library_and_with_every_width() {
        for largest in [0.1, 0.25, 1.0, 3.0, 20.0] {
            let x: Vec<f64> = (-200..=200).map(|i| largest * f64::from(i) / 200.0).collect();
            let halvings = halvings(largest);
            let results = [Arch::new(), Arch::Scalar].map(|arch| {
                let mut out = vec![0.0; x.len()];
                arch.dispatch(All(&x, halvings, &mut out));
                out
            });
            assert_eq!(results[0], results[1]);
            let error = |(x, out): (&f64, &f64)| (out / (-x).exp() - 1.0).abs();
            let worst = x.iter().zip(&results[0]).map(error).fold(0.0, f64::max);
            assert!(worst < f64::from(1 << (halvings + 2)) * 1.2e-16, "{largest}: {worst:e}");
        }
    }
}
