//! Random numbers by key: the number of (seed, sample, dimension) never depends on which others
//! were drawn.
//!
//! The mixing function of SplitMix64, G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014,
//! doi:10.1145/2660193.2660195, once for each part of the key. Even in [0, 1), 53 bits.

const GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

/// The random number of one dimension of one sample.
pub(crate) fn keyed(seed: u64, sample: u64, dimension: u64) -> f64 {
    let step = |state: u64, part: u64| mix(state.wrapping_add(part.wrapping_add(1).wrapping_mul(GAMMA)));
    let bits = step(step(mix(seed.wrapping_add(GAMMA)), sample), dimension);
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of products of pairs of dimensions, samples and seeds: ¼ for independent numbers, with
    /// standard deviation √(7/144 N).
    #[test]
    fn neighbouring_keys_are_uncorrelated() {
        let n = 20_000u64;
        let allowed = 4.0 * (7.0 / 144.0 / n as f64).sqrt();
        let other: [fn(u64) -> f64; 3] = [|k| keyed(7, k, 1), |k| keyed(7, k + 1, 0), |k| keyed(8, k, 0)];
        for (case, other) in other.iter().enumerate() {
            let mean = (0..n).map(|k| keyed(7, k, 0) * other(k)).sum::<f64>() / n as f64;
            assert!((mean - 0.25).abs() < allowed, "{case}: {mean}");
        }
    }

    /// Pearson's χ² of 64 bins: mean 63, standard deviation √126.
    #[test]
    fn numbers_are_even() {
        let n = 64_000u64;
        let mut bins = [0f64; 64];
        (0..n).for_each(|k| bins[(keyed(1, k, 2) * 64.0) as usize] += 1.0);
        let chi: f64 = bins.iter().map(|count| (count - 1000.0).powi(2) / 1000.0).sum();
        assert!((chi - 63.0).abs() < 4.0 * 126f64.sqrt(), "{chi}");
    }
}
