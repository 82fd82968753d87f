//! How many rays each family of parts gets.
//!
//! The square of the error is Σ w v_n over the families, with w = A²/A_face and the variance v_n of
//! the mean over n rays of each part and replicate. By low-discrepancy points v_n falls faster than
//! 1/n; as v_1 n^{−a}, the fewest rays for the square T are
//!
//! ```text
//! n = (λ w v_1/m)^{1/(1 + a)},   λ = (Σ w v_1 (w v_1/m)^{−a/(1 + a)} / T)^{(1 + a)/a}
//! ```
//!
//! with m parts (from the derivative of Σ w v_1 n^{−a} + Σ m n/λ′).

/// Exponent a with which the variance falls: measured on furnished rooms and cities, where it is 1.4
/// to 1.5 (docs/rays.md).
const EXPONENT: f64 = 1.3;
/// Rays of a part and replicate at most.
const MOST_RAYS: u32 = 1 << 20;

/// A family: w v_1 and its number of parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub(super) weighed: f64,
    pub(super) parts: usize,
}

/// Rays of a part and replicate for each family, powers of two, that bring the square of the error
/// to a target. `known` are the rays from which each v_1 was found, as v n.
pub(super) fn shared_out(shares: &[Share], known: &[u32], target: f64) -> Vec<u32> {
    // v n of `known` rays stands for v_1 = v n^a.
    let one = |(share, &known): (&Share, &u32)| share.weighed * f64::from(known.max(1)).powf(EXPONENT - 1.0);
    let power = EXPONENT / (1.0 + EXPONENT);
    let terms = || shares.iter().zip(known).map(one).zip(shares);
    let sum: f64 = terms()
        .filter(|(weighed, _)| *weighed > 0.0)
        .map(|(weighed, share)| weighed * (weighed / share.parts as f64).powf(-power))
        .sum();
    let lambda = (sum / target).powf(1.0 / power);
    let rays = |(weighed, share): (f64, &Share)| {
        let rays = (lambda * weighed / share.parts as f64).powf(1.0 / (1.0 + EXPONENT)).max(1.0);
        (1_u32 << (rays.log2().round().min(f64::from(MOST_RAYS.ilog2())) as u32)).min(MOST_RAYS)
    };
    terms().map(rays).collect()
}

/// As many rays more as bring an error by chance to a target, at least twice as many.
pub(super) fn prolonged(known: &[u32], noise: f64, target: f64) -> Vec<u32> {
    let factor = (noise / target).powf(2.0 / EXPONENT).max(2.0).log2().round() as u32;
    known.iter().map(|&known| known.saturating_mul(1 << factor.min(8)).min(MOST_RAYS)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_the_target_where_the_variance_falls_as_expected() {
        let shares: Vec<Share> =
            (1..200).map(|k| Share { weighed: f64::from(k * k) * 1e-6, parts: 4 }).collect();
        let known = vec![1; shares.len()];
        for target in [1e-3, 1e-4] {
            let rays = shared_out(&shares, &known, target);
            let of = |(share, &n): (&Share, &u32)| share.weighed * f64::from(n).powf(-EXPONENT);
            let reached: f64 = shares.iter().zip(&rays).map(of).sum();
            assert!((0.6..1.6).contains(&(reached / target)), "{reached}");
            assert!(rays.windows(2).all(|pair| pair[0] <= pair[1]));
        }
    }

    #[test]
    fn more_rays_are_at_least_twice_as_many() {
        assert_eq!(prolonged(&[1, 4], 0.011, 0.01), [2, 8]);
        assert_eq!(prolonged(&[4], 0.04, 0.01), [32]);
    }
}
