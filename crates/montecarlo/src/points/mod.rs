//! Point sets: how the random numbers of the samples of one batch share out the unit square.
//!
//! Sample s of n draws its numbers one pair after the other, by a [`Draw`] of their [`Samples`]. In
//! every set each number of each sample is even in [0, 1) by itself, so that means stay unbiased;
//! the sets differ in how the samples of a batch go together. Every pair is a pattern of its own,
//! and the batches are independent of each other: errors are estimated between batches.
//!
//! | set | pair d of the n samples |
//! |---|---|
//! | independent | independent |
//! | jittered | one in each cell of a grid |
//! | N-rooks | one in each of n rows and n columns (P. Shirley, Eurographics 1991, doi:10.2312/egtp.19911013) |
//! | multi-jittered | both at once (K. Chiu, P. Shirley, C. Wang, Graphics Gems IV, 1994; A. Kensler, Pixar TM 13-01, 2013) |
//! | Sobol | Owen-scrambled Sobol, all pairs together up to its dimensions (A. B. Owen, 1995, doi:10.1007/978-1-4612-2552-2_19) |

mod permutation;
mod strata;

use crate::philox::{philox, unit_pair};
use fredholm_quadrature::sobol::{self, DIMENSIONS};
use serde::{Deserialize, Serialize};

/// A way to place the samples of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointSet {
    /// No order at all.
    Independent,
    /// A grid, one sample a cell.
    Jittered,
    /// One sample in each row and each column.
    NRooks,
    /// Both.
    MultiJittered,
    /// Owen-scrambled Sobol points.
    #[default]
    Sobol,
}

impl PointSet {
    /// All sets.
    pub const ALL: [Self; 5] =
        [Self::Independent, Self::Jittered, Self::NRooks, Self::MultiJittered, Self::Sobol];

    /// The name it is asked for by.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Jittered => "jittered",
            Self::NRooks => "n-rooks",
            Self::MultiJittered => "multi-jittered",
            Self::Sobol => "sobol",
        }
    }
}

/// What the numbers of a batch depend on: nothing else does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Key {
    /// The seed of the run.
    pub seed: u64,
    /// The batch.
    pub batch: u32,
    /// What is sampled in it, such as a patch: streams are independent.
    pub stream: u32,
}

impl Key {
    /// Four random words of a sample (or of the batch as a whole) and a dimension.
    fn words(self, sample: u32, dimension: u32) -> [u32; 4] {
        philox([sample, dimension, self.batch, self.stream], [self.seed as u32, (self.seed >> 32) as u32])
    }
}

/// Dimensions from here on seed the patterns of a batch, so that they share no number with the
/// samples.
const PATTERN_DIMENSIONS: u32 = 1 << 31;

/// The samples of one key. What they have in common is computed once, when it is first asked for.
#[derive(Clone, Debug)]
pub struct Samples {
    set: PointSet,
    key: Key,
    size: u32,
    /// The words that make the pattern of each pair of dimensions.
    patterns: Vec<[u32; 4]>,
    /// The words that shuffle the points of each block of dimensions.
    shuffles: Vec<u32>,
}

impl Samples {
    /// So many samples of a batch.
    #[must_use]
    pub fn new(set: PointSet, key: Key, size: u32) -> Self {
        Self { set, key, size, patterns: Vec::new(), shuffles: Vec::new() }
    }

    /// Goes on to another batch of as many.
    pub fn restart(&mut self, key: Key) {
        self.key = key;
        self.patterns.clear();
        self.shuffles.clear();
    }

    /// The numbers of one of the samples.
    pub fn draw(&mut self, sample: u32) -> Draw<'_> {
        let mut draw = Draw { samples: self, sample, dimension: 0, index: 0 };
        draw.enter();
        draw
    }

    /// The words that make the pattern of a pair, of which all before it were asked for.
    fn pattern(&mut self, dimension: u32) -> [u32; 4] {
        let pair = dimension as usize / 2;
        if let Some(&words) = self.patterns.get(pair) {
            return words;
        }
        let role = if self.set == PointSet::Sobol { 2 } else { 0 };
        let words = self.key.words(role, PATTERN_DIMENSIONS + dimension);
        self.patterns.push(words);
        words
    }

    /// The word that shuffles the points of a block, of which all before it were asked for.
    fn shuffle(&mut self, block: u32) -> u32 {
        if let Some(&word) = self.shuffles.get(block as usize) {
            return word;
        }
        let [word, ..] = self.key.words(1, PATTERN_DIMENSIONS + block);
        self.shuffles.push(word);
        word
    }
}

/// The random numbers of one sample, drawn one after the other.
#[derive(Debug)]
pub struct Draw<'a> {
    samples: &'a mut Samples,
    sample: u32,
    dimension: u32,
    /// Number of the Sobol point in this block of dimensions.
    index: u32,
}

impl Draw<'_> {
    /// The next pair, each even in [0, 1).
    pub fn pair(&mut self) -> [f64; 2] {
        let dimension = self.advance();
        let Samples { set, key, size, .. } = *self.samples;
        match set {
            PointSet::Independent => unit_pair(key.words(self.sample, dimension)),
            PointSet::Sobol => {
                let (scramble, first) = (self.samples.pattern(dimension), dimension % DIMENSIONS);
                [0, 1].map(|i| sobol::point(self.index, first + i as u32, scramble[i]))
            }
            set => {
                let jitter = unit_pair(key.words(self.sample, dimension));
                strata::place(set, self.sample, size, self.samples.pattern(dimension), jitter)
            }
        }
    }

    /// The next single number: of a pair, so that the pairs that follow keep their pattern.
    pub fn single(&mut self) -> f64 {
        if self.samples.set != PointSet::Sobol {
            return self.pair()[0];
        }
        let dimension = self.advance();
        let scramble = self.samples.pattern(dimension);
        sobol::point(self.index, dimension % DIMENSIONS, scramble[0])
    }

    /// The dimension of the next pair.
    fn advance(&mut self) -> u32 {
        let dimension = self.dimension;
        if dimension > 0 && dimension.is_multiple_of(DIMENSIONS) {
            self.enter();
        }
        self.dimension += 2;
        dimension
    }

    /// Shuffles the points for a new block of dimensions: met in the same order they would be the
    /// same ones.
    fn enter(&mut self) {
        if self.samples.set == PointSet::Sobol {
            let shuffle = self.samples.shuffle(self.dimension / DIMENSIONS);
            self.index = sobol::scrambled(self.sample.reverse_bits(), shuffle);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(set: PointSet, size: u32, pair: usize, seed: u64) -> Vec<[f64; 2]> {
        let key = Key { seed, batch: 3, stream: 5 };
        let mut samples = Samples::new(set, key, size);
        let point = |sample| {
            let mut draw = samples.draw(sample);
            for _ in 0..pair {
                draw.pair();
            }
            draw.pair()
        };
        (0..size).map(point).collect()
    }

    /// Counts in a grid of columns × rows.
    fn counts(points: &[[f64; 2]], columns: usize, rows: usize) -> Vec<usize> {
        let mut counts = vec![0; columns * rows];
        for [x, y] in points {
            counts[(x * columns as f64) as usize * rows + (y * rows as f64) as usize] += 1;
        }
        counts
    }

    #[test]
    fn each_set_has_its_strata() {
        for (seed, pair) in [(1, 0), (2, 1), (77, 4)] {
            let has = |set, columns, rows| {
                counts(&points(set, 64, pair, seed), columns, rows).iter().all(|&n| n * columns * rows == 64)
            };
            assert!(has(PointSet::Jittered, 8, 8) && !has(PointSet::Jittered, 64, 1));
            assert!(
                has(PointSet::NRooks, 64, 1) && has(PointSet::NRooks, 1, 64) && !has(PointSet::NRooks, 8, 8)
            );
            let multi = PointSet::MultiJittered;
            assert!(has(multi, 8, 8) && has(multi, 64, 1) && has(multi, 1, 64));
            assert!(has(PointSet::Sobol, 64, 1) && has(PointSet::Sobol, 1, 64));
            assert!(!has(PointSet::Independent, 8, 8));
        }
    }

    /// The first two dimensions of Sobol's sequence are a (0, m, 2)-net: one point in every
    /// elementary interval of area 1/n.
    #[test]
    fn the_first_pair_of_sobol_is_a_net() {
        let set = points(PointSet::Sobol, 256, 0, 9);
        for log in 0..=8 {
            assert!(counts(&set, 1 << log, 256 >> log).iter().all(|&n| n == 1), "{log}");
        }
    }

    /// Sizes that are no square, or prime, are filled too.
    #[test]
    fn any_size_has_one_sample_a_cell() {
        for (size, columns, rows) in [(12, 3, 4), (7, 1, 7), (1, 1, 1), (30, 5, 6)] {
            let set = points(PointSet::Jittered, size, 0, 4);
            assert!(counts(&set, columns, rows).iter().all(|&n| n == 1), "{size}");
            let set = points(PointSet::MultiJittered, size, 0, 4);
            assert!(counts(&set, size as usize, 1).iter().all(|&n| n == 1), "{size}");
        }
    }

    /// Means of f = x y and of x₀ x₁ of two pairs: unbiased over batches, and ordered sets have
    /// less variance.
    #[test]
    fn means_are_unbiased_and_strata_reduce_the_variance() {
        let (size, batches) = (16, 2000);
        let spread = |set| {
            let (mut sum, mut squares, mut crossed) = (0.0, 0.0, 0.0);
            for batch in 0..batches {
                let key = Key { seed: 5, batch, stream: 0 };
                let (mut mean, mut samples) = (0.0, Samples::new(set, key, size));
                for sample in 0..size {
                    let mut draw = samples.draw(sample);
                    let (a, b) = (draw.pair(), draw.pair());
                    mean += a[0] * a[1] / f64::from(size);
                    crossed += (a[0] - 0.5) * (b[0] - 0.5);
                }
                sum += mean;
                squares += (mean - 0.25).powi(2);
            }
            let n = f64::from(batches);
            let error = (squares / n / n).sqrt();
            assert!((sum / n - 0.25).abs() < 4.0 * error, "{set:?}: {} ± {error}", sum / n);
            // The mean product of independent centred numbers has the deviation 1/(12 √N).
            let pairs = n * f64::from(size);
            assert!((crossed / pairs).abs() < 4.0 / 12.0 / pairs.sqrt(), "{set:?}: {}", crossed / pairs);
            squares / n
        };
        let plain = spread(PointSet::Independent);
        // Var(x y) = 1/9 − 1/16 for a sample.
        assert!((plain * 16.0 / (1.0 / 9.0 - 1.0 / 16.0) - 1.0).abs() < 0.15, "{plain:e}");
        for set in [PointSet::Jittered, PointSet::NRooks, PointSet::MultiJittered, PointSet::Sobol] {
            assert!(spread(set) < 0.5 * plain, "{set:?}");
        }
    }
}
