//! Philox4x32-10: random numbers by key and counter, with no state to carry along.
//!
//! Ten rounds of (c₀, c₁, c₂, c₃) → (hi(M₁ c₂) ⊕ c₁ ⊕ k₀, lo(M₁ c₂), hi(M₀ c₀) ⊕ c₃ ⊕ k₁, lo(M₀
//! c₀)); the key grows by Weyl constants. J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, SC
//! 2011, doi:10.1145/2063384.2063405.

/// M₀, M₁.
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// What the parts of the key grow by in a round.
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

/// The four random words of a counter under a key.
#[must_use]
pub fn philox(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let ([mut a, mut b, mut c, mut d], [mut k, mut l]) = (counter, key);
    for _ in 0..ROUNDS {
        let (first, second) = (product(MULTIPLIERS[0], a), product(MULTIPLIERS[1], c));
        (a, b, c, d) = (second.0 ^ b ^ k, second.1, first.0 ^ d ^ l, first.1);
        (k, l) = (k.wrapping_add(WEYL[0]), l.wrapping_add(WEYL[1]));
    }
    [a, b, c, d]
}

/// High and low word of a product.
fn product(a: u32, b: u32) -> (u32, u32) {
    let wide = u64::from(a) * u64::from(b);
    ((wide >> 32) as u32, wide as u32)
}

/// Two numbers in [0, 1), 53 bits each, of four random words.
#[must_use]
pub(crate) fn unit_pair([a, b, c, d]: [u32; 4]) -> [f64; 2] {
    let number = |high: u32, low: u32| {
        (((u64::from(high) << 32) | u64::from(low)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    [number(a, b), number(c, d)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The known answers that the authors publish with their library, Random123.
    #[test]
    fn the_published_answers_come_out() {
        let (ones, pi) = (u32::MAX, [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344]);
        let cases = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([ones; 4], [ones; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (pi, [0xa409_3822, 0x299f_31d0], [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox(counter, key), expected);
        }
    }

    #[test]
    fn numbers_fill_the_unit_interval_evenly() {
        assert!(unit_pair([0; 4])[0] == 0.0);
        assert!(unit_pair([u32::MAX; 4])[0] < 1.0);
        // χ² of 64 bins: mean 63, variance 126.
        let mut bins = [0.0; 64];
        for i in 0..32_000 {
            for u in unit_pair(philox([i, 0, 0, 0], [1, 0])) {
                bins[(u * 64.0) as usize] += 1.0;
            }
        }
        let chi: f64 = bins.iter().map(|n: &f64| (n - 1000.0).powi(2) / 1000.0).sum();
        assert!((chi - 63.0).abs() < 4.0 * 126_f64.sqrt(), "{chi}");
    }
}
