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
//! with m parts (from the derivative of Σ w v_1 n^{−a} + Σ m n/λ′). A large face that is dark
//! counts little in this sum; it gets the rays that its own error needs. Where its error turns out
//! to be larger than expected in the end, it gets more.

/// Exponent a with which the variance falls: measured on furnished rooms and cities, where it is 1.4
/// to 1.5 (docs/rays.md).
const EXPONENT: f64 = 1.3;
/// Rays of a part and replicate at most.
const MOST_RAYS: u32 = 1 << 20;
/// Rays with those for the errors of large faces, over those without or those of the first step, at
/// most; and how many more they may be in a replicate, since memory is predicted for usual ones.
const FOR_LARGE_FACES: f64 = 8.0;
const MOST_FOR_LARGE_FACES: f64 = 1e6;
/// Rays with those for large faces that are uncertain in the end, over the most without them; and
/// the step by which fewer faces are taken for uncertain.
const FOR_UNCERTAIN: f64 = 1.5;
const STEP_OF_LIMIT: f64 = 1.2;
/// Rays after a prolongation over those before, at least: each has its price in products.
const LEAST_GROWTH: f64 = 1.15;
/// By which the square aimed at is lowered until there are so many.
const STEP_OF_TARGET: f64 = 0.95;

/// A family: w v_1, the most that w v_n may be whatever the others are, and its number of parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub(super) weighed: f64,
    pub(super) most: f64,
    pub(super) parts: usize,
}

/// What the families need, as rays of a first step have it, and the square of the error that is
/// aimed at.
///
/// Rows that have turned out not to be exact enough are prolonged by the same shares: chosen by
/// what the rows themselves vary, those which found too little light would get few rays more.
#[derive(Clone, Debug)]
pub(super) struct Budget {
    shares: Vec<Share>,
    target: f64,
    /// Rays of the first step.
    first: f64,
}

impl Budget {
    /// `known` are the rays of the first step, from which each v_1 was found, as v n.
    pub(super) fn new(mut shares: Vec<Share>, known: &[u32], target: f64) -> Self {
        // v n of `known` rays stands for v_1 = v n^a.
        for (share, &known) in shares.iter_mut().zip(known) {
            share.weighed *= f64::from(known.max(1)).powf(EXPONENT - 1.0);
        }
        let mut budget = Self { shares, target, first: 0.0 };
        budget.first = budget.rays(known);
        budget
    }

    /// Four times the rays of families whose large faces are uncertain, which is where these ratios
    /// are above 1; where that is too many, of those only that are above a higher limit.
    ///
    /// That lets rows decide by what they vary themselves. It is done once the error over all faces
    /// is small: what too few rays found too dark stays, and what they found too bright is mended.
    pub(super) fn of_uncertain(&self, counts: &[u32], uncertainties: &[f64]) -> Vec<u32> {
        let most = FOR_UNCERTAIN * self.most();
        let above = |limit: f64| -> Vec<u32> {
            let of = |(&n, &ratio): (&u32, &f64)| if ratio > limit { (4 * n).min(MOST_RAYS) } else { n };
            counts.iter().zip(uncertainties).map(of).collect()
        };
        let mut limit = 1.0;
        loop {
            let more = above(limit);
            if more == counts || self.rays(&more) <= most {
                return more;
            }
            limit *= STEP_OF_LIMIT;
        }
    }

    /// Rays at most, with those for the errors of large faces.
    fn most(&self) -> f64 {
        let without = self.rays(&self.best()).max(self.first);
        without + ((FOR_LARGE_FACES - 1.0) * without).min(MOST_FOR_LARGE_FACES)
    }

    /// Which families have fewer rays than their own errors need.
    pub(super) fn short(&self, counts: &[u32]) -> Vec<bool> {
        self.alone().zip(counts).map(|(alone, &count)| alone > count).collect()
    }

    /// Which families are of faces so dark that their own errors need more rays than the sum does.
    pub(super) fn dark(&self) -> Vec<bool> {
        self.short(&self.best())
    }

    /// Rays of a part and replicate for each family, powers of two.
    pub(super) fn counts(&self) -> Vec<u32> {
        let (best, alone) = (self.best(), self.alone().collect::<Vec<_>>());
        let most = self.most();
        let mut bound = MOST_RAYS;
        loop {
            let counts: Vec<u32> =
                best.iter().zip(&alone).map(|(&best, &alone)| best.max(alone.min(bound))).collect();
            if self.rays(&counts) <= most {
                return counts;
            }
            bound /= 2;
        }
    }

    /// The rays that the sum needs.
    fn best(&self) -> Vec<u32> {
        let power = EXPONENT / (1.0 + EXPONENT);
        let term = |share: &Share| share.weighed * (share.weighed / share.parts as f64).powf(-power);
        let sum: f64 = self.shares.iter().filter(|share| share.weighed > 0.0).map(term).sum();
        let lambda = (sum / self.target).powf(1.0 / power);
        let best = |share: &Share| {
            rounded((lambda * share.weighed / share.parts as f64).powf(1.0 / (1.0 + EXPONENT)))
        };
        self.shares.iter().map(best).collect()
    }

    /// The rays that each needs for its own error.
    fn alone(&self) -> impl Iterator<Item = u32> {
        // Where nothing is known to arrive, nothing is known to be asked for.
        let alone = |share: &Share| (share.weighed / share.most.max(f64::MIN_POSITIVE)).powf(1.0 / EXPONENT);
        self.shares.iter().map(move |share| rounded(alone(share)))
    }

    /// More rays than `known`, where these have left an error `noise` by chance that is to be
    /// brought down to another.
    pub(super) fn prolonged(&mut self, known: &[u32], noise: f64, to: f64) -> Vec<u32> {
        let least = LEAST_GROWTH * self.rays(known);
        self.target *= (to / noise).powi(2).min(1.0);
        loop {
            let counts: Vec<u32> =
                self.counts().iter().zip(known).map(|(&wanted, &known)| wanted.max(known)).collect();
            let is_full = counts.iter().all(|&count| count == MOST_RAYS);
            if is_full || self.rays(&counts) >= least {
                return counts;
            }
            self.target *= STEP_OF_TARGET;
        }
    }

    fn rays(&self, counts: &[u32]) -> f64 {
        self.shares.iter().zip(counts).map(|(share, &count)| share.parts as f64 * f64::from(count)).sum()
    }
}

/// The nearest power of two.
fn rounded(rays: f64) -> u32 {
    1 << (rays.clamp(1.0, f64::from(MOST_RAYS)).log2().round() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_the_target_where_the_variance_falls_as_expected() {
        let shares: Vec<Share> = (1..200)
            .map(|k| Share { weighed: f64::from(k * k) * 1e-6, most: f64::INFINITY, parts: 4 })
            .collect();
        let known = vec![1; shares.len()];
        let reached = |rays: &[u32]| -> f64 {
            let of = |(share, &n): (&Share, &u32)| share.weighed * f64::from(n).powf(-EXPONENT);
            shares.iter().zip(rays).map(of).sum()
        };
        for target in [1e-3, 1e-4] {
            let mut budget = Budget::new(shares.clone(), &known, target);
            let rays = budget.counts();
            assert!((0.6..1.6).contains(&(reached(&rays) / target)), "{}", reached(&rays));
            assert!(rays.windows(2).all(|pair| pair[0] <= pair[1]));
            // A third less error by chance: some rows are prolonged, and none is cut.
            let more = budget.prolonged(&rays, 0.03, 0.02);
            assert!(rays.iter().zip(&more).all(|(before, after)| before <= after));
            let ratio = reached(&more) / reached(&rays);
            assert!((0.33..0.6).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn what_a_family_may_have_at_most_is_kept_whatever_the_sum() {
        let mut shares = vec![Share { weighed: 1.0, most: f64::INFINITY, parts: 4 }; 50];
        shares[7].most = 0.02;
        let rays = Budget::new(shares, &[1; 50], 3.0).counts();
        let left = f64::from(rays[7]).powf(-EXPONENT);
        assert!((0.01..0.04).contains(&left) && rays[8] < rays[7], "{left} {rays:?}");
    }

    #[test]
    fn uncertain_families_get_more_rays_the_worst_first() {
        let shares = vec![Share { weighed: 1.0, most: f64::INFINITY, parts: 4 }; 50];
        let budget = Budget::new(shares, &[1; 50], 1.0);
        let counts = budget.counts();
        let mut ratios = vec![0.5; 50];
        assert_eq!(budget.of_uncertain(&counts, &ratios), counts);
        (ratios[3], ratios[7]) = (1.1, 3.0);
        let more = budget.of_uncertain(&counts, &ratios);
        assert!((0..50).all(|k| (more[k] == 4 * counts[k]) == (k == 3 || k == 7)), "{more:?}");
        // Where all are uncertain the worst get more, as many as may.
        let ratios: Vec<f64> = (0..50).map(|k| 1.5 + f64::from(k)).collect();
        let counts = vec![(0.8 * budget.most() / 200.0) as u32; 50];
        let more = budget.of_uncertain(&counts, &ratios);
        let first = (0..50).find(|&k| more[k] > counts[k]).unwrap();
        assert!((first..50).all(|k| more[k] == 4 * counts[k]), "{more:?}");
        assert!((1..49).contains(&first), "some get more, and some do not: {first}");
        assert!(budget.rays(&more) <= FOR_UNCERTAIN * budget.most());
    }

    #[test]
    fn a_prolongation_has_more_rays_even_where_none_are_wanted() {
        let shares = vec![Share { weighed: 1.0, most: f64::INFINITY, parts: 4 }; 50];
        let mut budget = Budget::new(shares, &[1; 50], 1.0);
        let rays = budget.counts();
        let more = budget.prolonged(&rays, 0.01, 0.01);
        assert!(budget.rays(&more) >= LEAST_GROWTH * budget.rays(&rays));
    }
}
