//! A fixed sequence of pairs that spreads evenly over all pairs of n elements.
//!
//! The additive recurrence with the fractional parts of the powers of 1/φ, φ³ = φ + 1 (M. Roberts,
//! *The Unreasonable Effectiveness of Quasirandom Sequences*, 2018).

const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Endless pairs of indices below `n`, the same for every run.
///
/// ```
/// let pairs: Vec<_> = fredholm_coupling::sample_pairs(10).take(1000).collect();
/// assert!(pairs.iter().flatten().all(|&i| i < 10));
/// assert!((0..10).all(|i| pairs.iter().filter(|pair| pair[0] == i).count().abs_diff(100) < 5));
/// ```
pub fn sample_pairs(n: usize) -> impl Iterator<Item = [usize; 2]> {
    let place = move |k: u64, step: f64| ((k as f64 * step).fract() * n as f64) as usize;
    (1u64..).map(move |k| STEPS.map(|step| place(k, step)))
}

/// All indices below `n`, each once, so that any first few of them are spread evenly: multiples of
/// a step near n/φ that has no divisor in common with n.
pub(crate) fn scattered(n: usize) -> impl Iterator<Item = usize> {
    let near = (n as f64 * 0.618_033_988_749_895) as usize;
    let step = (near..near + n.max(1)).find(|&step| divisor(step, n) == 1).unwrap_or(1);
    (0..n).map(move |k| ((k as u128 * step as u128) % n as u128) as usize)
}

/// Greatest common divisor.
fn divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_comes_once_and_few_are_spread() {
        for n in [0, 1, 2, 3, 12, 60, 97, 1000] {
            let mut all: Vec<usize> = scattered(n).collect();
            all.sort_unstable();
            assert_eq!(all, (0..n).collect::<Vec<_>>());
        }
        // Independent random indices would stray by 3 in the mean.
        for tenth in 0..10 {
            let inside = scattered(1000).take(100).filter(|i| i / 100 == tenth).count();
            assert!((7..=13).contains(&inside), "{tenth}: {inside}");
        }
    }
}
