//! A fixed sequence of pairs that spreads evenly over all pairs of n elements.
//!
//! The additive recurrence with the fractional parts of the powers of 1/φ, φ³ = φ + 1 (M. Roberts, *The Unreasonable Effectiveness of
//! Quasirandom Sequences*, 2018).

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
