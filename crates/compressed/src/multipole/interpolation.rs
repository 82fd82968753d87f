//! Patterns from the directions of one level to those of the next, and back by the transpose.
//!
//! Along a circle a pattern of currents within a radius r is a sum of e^{jmα}, whose terms fall
//! beyond |m| = kr as the excess bandwidth formula says. The value at another angle is taken from
//! the p nearest ones, with the weights for which the mean square of the error over such patterns
//! is least. p is the smallest even number whose error is within the tolerance. First all rows are
//! interpolated in φ, then all great circles in θ. On the other side of a pole both vectors across
//! the direction are turned over, hence the sign there.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::grid::Grid;
use super::plan::EXCESS;
use std::f64::consts::{PI, TAU};

/// Outputs that are computed together.
const BLOCK: usize = 8;
/// Planes of a field: both components, real and imaginary.
pub(crate) const PLANES: usize = 4;
/// What is added to the matrix of the weights so that it can be solved with.
const RIDGE: f64 = 1e-13;

/// Weights of the values around a circle for one at another angle.
struct Weights {
    nodes: Vec<usize>,
    values: Vec<f64>,
    /// Square of the error.
    left: f64,
}

/// The correlation of the values of such patterns at two angles apart: Σ s_m² cos(mα)/Σ s_m², with
/// the sizes s_m of the terms.
struct Correlation(Vec<f64>);

impl Correlation {
    /// Of patterns of radius `kr`, up to the order that the directions resolve.
    fn new(kr: f64, orders: usize) -> Self {
        let size = |m: usize| -> f64 {
            let excess = (m as f64 - kr).max(0.0) / (EXCESS * kr.cbrt());
            let twice = if m == 0 { 1.0 } else { 2.0 };
            twice * 10.0_f64.powf(-2.0 * excess.powf(1.5))
        };
        let squares: Vec<f64> = (0..orders).map(size).collect();
        let all: f64 = squares.iter().sum();
        Self(squares.iter().map(|square| square / all).collect())
    }

    fn at(&self, angle: f64) -> f64 {
        // cos((m + 1)α) = 2 cos α cos(mα) − cos((m − 1)α).
        let cosine = angle.cos();
        let (mut before, mut own, mut sum) = (cosine, 1.0, 0.0);
        for square in &self.0 {
            sum += square * own;
            (before, own) = (own, 2.0 * cosine * own - before);
        }
        sum
    }
}

impl Weights {
    /// From the `count` nearest of some increasing angles.
    fn new(angles: &[f64], target: f64, count: usize, correlation: &Correlation) -> Self {
        let after = angles.partition_point(|&angle| angle <= target);
        let first = after + angles.len() - count / 2;
        let nodes: Vec<usize> = (0..count).map(|i| (first + i) % angles.len()).collect();
        let between = |i: usize, j: usize| correlation.at(angles[nodes[i]] - angles[nodes[j]]);
        // Cholesky.
        let mut lower = vec![vec![0.0; count]; count];
        for i in 0..count {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
                let ridge = if i == j { RIDGE } else { 0.0 };
                let rest = between(i, j) + ridge - known;
                lower[i][j] = if i == j { rest.max(RIDGE * RIDGE).sqrt() } else { rest / lower[j][j] };
            }
        }
        let right: Vec<f64> = nodes.iter().map(|&node| correlation.at(target - angles[node])).collect();
        let mut weights = right.clone();
        for i in 0..count {
            let known: f64 = (0..i).map(|k| lower[i][k] * weights[k]).sum();
            weights[i] = (weights[i] - known) / lower[i][i];
        }
        for i in (0..count).rev() {
            let known: f64 = (i + 1..count).map(|k| lower[k][i] * weights[k]).sum();
            weights[i] = (weights[i] - known) / lower[i][i];
        }
        let mut left = 1.0;
        for i in 0..count {
            let own: f64 = (0..count).map(|j| between(i, j) * weights[j]).sum();
            left += weights[i] * (own - 2.0 * right[i]);
        }
        Self { nodes, values: weights, left }
    }

    /// Of all targets, from as few as the tolerance allows.
    fn all(angles: &[f64], targets: &[f64], correlation: &Correlation, tolerance: f64) -> Vec<Self> {
        let mut count = 4.min(angles.len());
        loop {
            let of = |&target: &f64| Self::new(angles, target, count, correlation);
            let weights: Vec<Self> = targets.iter().map(of).collect();
            let worst = weights.iter().map(|weights| weights.left).fold(0.0, f64::max);
            if worst <= tolerance * tolerance || count == angles.len() {
                return weights;
            }
            count = (count + 2).min(angles.len());
        }
    }
}

/// A matrix with few entries a row, which are neighbours around a circle: eight rows at once.
struct Band {
    inputs: usize,
    outputs: usize,
    /// The first input of each block and the number of them.
    blocks: Vec<(usize, usize)>,
    weights: Vec<[f64; BLOCK]>,
}

impl Band {
    /// From (output, input, weight).
    fn new(inputs: usize, outputs: usize, entries: &[(usize, usize, f64)]) -> Self {
        let (mut blocks, mut weights) = (Vec::new(), Vec::new());
        for first in (0..outputs).step_by(BLOCK) {
            let own: Vec<_> = entries.iter().filter(|entry| entry.0 / BLOCK == first / BLOCK).collect();
            let mut used = vec![false; inputs];
            for entry in &own {
                used[entry.1] = true;
            }
            // From the end of the longest gap on.
            let gap = |start: usize| (0..inputs).take_while(|i| !used[(start + i) % inputs]).count();
            let start = (0..inputs).max_by_key(|&start| (gap(start), inputs - start)).unwrap_or(0);
            let (from, span) = ((start + gap(start)) % inputs, inputs - gap(start));
            let base = weights.len();
            weights.resize(base + span, [0.0; BLOCK]);
            for &&(output, input, weight) in &own {
                weights[base + (input + inputs - from) % inputs][output % BLOCK] += weight;
            }
            blocks.push((from, span));
        }
        Self { inputs, outputs, blocks, weights }
    }

    fn bytes(&self) -> u64 {
        size_of_val(self.weights.as_slice()) as u64
    }

    /// One row; `twice` holds the inputs two times.
    #[inline(always)]
    fn row(&self, twice: &[f64], out: &mut [f64]) {
        let mut base = 0;
        for (block, &(from, span)) in self.blocks.iter().enumerate() {
            let mut sums = [0.0; BLOCK];
            for (&x, weights) in twice[from..from + span].iter().zip(&self.weights[base..base + span]) {
                for lane in 0..BLOCK {
                    sums[lane] += x * weights[lane];
                }
            }
            base += span;
            let out = &mut out[block * BLOCK..];
            let count = out.len().min(BLOCK);
            out[..count].copy_from_slice(&sums[..count]);
        }
    }
}

/// A row of one grid for a row of the other: its number, whether it is taken from beyond the pole,
/// and the weight.
type Meridian = (usize, bool, f64);

/// From the directions of a level to those of the next.
pub(crate) struct Interpolation {
    fine: [usize; 2],
    coarse: [usize; 2],
    columns: Band,
    turned_columns: Band,
    rows: Vec<Vec<Meridian>>,
    turned_rows: Vec<Vec<Meridian>>,
}

/// What interpolations work in.
#[derive(Default)]
pub(crate) struct Scratch {
    middle: Vec<f64>,
    twice: Vec<f64>,
}

impl Interpolation {
    /// For patterns of currents within a radius r, `kr` of the phase.
    pub(crate) fn new(coarse: &Grid, fine: &Grid, kr: f64, tolerance: f64) -> Self {
        let correlation = Correlation::new(kr, coarse.rows);
        let even = |count: usize| -> Vec<f64> { (0..count).map(|i| TAU * i as f64 / count as f64).collect() };
        let (from, to) = (even(coarse.columns), even(fine.columns));
        let mut entries = Vec::new();
        for (output, weights) in Weights::all(&from, &to, &correlation, tolerance).iter().enumerate() {
            entries.extend(weights.nodes.iter().zip(&weights.values).map(|(&input, &w)| (output, input, w)));
        }
        let turned: Vec<_> = entries.iter().map(|&(output, input, weight)| (input, output, weight)).collect();
        let n = coarse.rows;
        let beyond = coarse.angles.iter().rev().map(|angle| 2.0 * PI - angle);
        let circle: Vec<f64> = coarse.angles.iter().copied().chain(beyond).collect();
        let mut rows = Vec::with_capacity(fine.rows);
        let mut turned_rows = vec![Vec::new(); n];
        for (output, weights) in
            Weights::all(&circle, &fine.angles, &correlation, tolerance).iter().enumerate()
        {
            let row = |(&node, &weight): (&usize, &f64)| {
                if node < n { (node, false, weight) } else { (2 * n - 1 - node, true, -weight) }
            };
            let row: Vec<Meridian> = weights.nodes.iter().zip(&weights.values).map(row).collect();
            for &(input, crosses, weight) in &row {
                turned_rows[input].push((output, crosses, weight));
            }
            rows.push(row);
        }
        Self {
            fine: [fine.rows, fine.columns],
            coarse: [coarse.rows, coarse.columns],
            columns: Band::new(coarse.columns, fine.columns, &entries),
            turned_columns: Band::new(fine.columns, coarse.columns, &turned),
            rows,
            turned_rows,
        }
    }

    /// Bytes of the tables.
    pub(crate) fn bytes(&self) -> u64 {
        let rows: usize = self.rows.iter().chain(&self.turned_rows).map(Vec::len).sum();
        self.columns.bytes() + self.turned_columns.bytes() + (rows * size_of::<Meridian>()) as u64
    }

    /// The pattern at the directions of the next level.
    #[inline(always)]
    pub(crate) fn up(&self, field: &[f64], scratch: &mut Scratch, out: &mut [f64]) {
        let ([rows, columns], [fine_rows, fine_columns]) = (self.coarse, self.fine);
        scratch.middle.resize(rows * fine_columns, 0.0);
        for plane in 0..PLANES {
            let field = &field[plane * rows * columns..][..rows * columns];
            let out = &mut out[plane * fine_rows * fine_columns..][..fine_rows * fine_columns];
            along(&self.columns, field, &mut scratch.twice, &mut scratch.middle);
            out.fill(0.0);
            across(&self.rows, fine_columns, &scratch.middle, out);
        }
    }

    /// Adds the transpose of [`up`](Self::up).
    #[inline(always)]
    pub(crate) fn add_down(&self, field: &[f64], scratch: &mut Scratch, sum: &mut [f64]) {
        let ([rows, columns], [fine_rows, fine_columns]) = (self.coarse, self.fine);
        let mut narrow = vec![0.0; rows * columns];
        scratch.middle.resize(rows * fine_columns, 0.0);
        for plane in 0..PLANES {
            let field = &field[plane * fine_rows * fine_columns..][..fine_rows * fine_columns];
            let sum = &mut sum[plane * rows * columns..][..rows * columns];
            scratch.middle.fill(0.0);
            across(&self.turned_rows, fine_columns, field, &mut scratch.middle);
            along(&self.turned_columns, &scratch.middle, &mut scratch.twice, &mut narrow);
            sum.iter_mut().zip(&narrow).for_each(|(sum, part)| *sum += part);
        }
    }
}

/// Every row by a band.
#[inline(always)]
fn along(band: &Band, field: &[f64], twice: &mut Vec<f64>, out: &mut [f64]) {
    for (row, out) in field.chunks_exact(band.inputs).zip(out.chunks_exact_mut(band.outputs)) {
        twice.clear();
        twice.extend_from_slice(row);
        twice.extend_from_slice(row);
        band.row(twice, out);
    }
}

/// Adds every great circle through the poles.
#[inline(always)]
fn across(rows: &[Vec<Meridian>], columns: usize, field: &[f64], out: &mut [f64]) {
    let half = columns / 2;
    for (row, out) in rows.iter().zip(out.chunks_exact_mut(columns)) {
        for &(input, crosses, weight) in row {
            let field = &field[input * columns..(input + 1) * columns];
            if crosses {
                let ([west, east], (one, other)) = ([&field[half..], &field[..half]], out.split_at_mut(half));
                one.iter_mut().zip(west).for_each(|(sum, x)| *sum += weight * x);
                other.iter_mut().zip(east).for_each(|(sum, x)| *sum += weight * x);
            } else {
                out.iter_mut().zip(field).for_each(|(sum, x)| *sum += weight * x);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_mesh::Vec3;

    /// A pattern of currents within a ball of radius 4/k.
    fn pattern(grid: &Grid) -> Vec<f64> {
        let mut planes = vec![0.0; PLANES * grid.len()];
        for at in 0..grid.len() {
            let direction = grid.direction(at);
            for i in 0..7 {
                let i = f64::from(i);
                let place = Vec3::new((3.0 * i).sin(), (5.0 * i).cos(), (7.0 * i).sin()).normalize() * 4.0;
                let current = Vec3::new((2.0 * i).cos(), i.sin(), 1.0);
                let (im, re) = direction.along.dot(place).sin_cos();
                for (c, across) in [direction.theta, direction.phi].into_iter().enumerate() {
                    planes[2 * c * grid.len() + at] += current.dot(across) * re;
                    planes[(2 * c + 1) * grid.len() + at] += current.dot(across) * im;
                }
            }
        }
        planes
    }

    #[test]
    fn patterns_are_interpolated_within_the_tolerance_and_back_by_the_transpose() {
        let (coarse, fine) = (Grid::new(21), Grid::new(37));
        let (given, expected) = (pattern(&coarse), pattern(&fine));
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let interpolation = Interpolation::new(&coarse, &fine, 4.0, tolerance);
            let mut found = vec![0.0; expected.len()];
            interpolation.up(&given, &mut Scratch::default(), &mut found);
            let difference: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
            let error = norm(&difference) / norm(&expected);
            assert!(error < tolerance, "{tolerance:e}: {error:e}");
            // ⟨y, A x⟩ = ⟨Aᵀ y, x⟩.
            let y: Vec<f64> = (0..expected.len()).map(|i| ((i * i) as f64).sin()).collect();
            let mut back = vec![0.0; given.len()];
            interpolation.add_down(&y, &mut Scratch::default(), &mut back);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let [one, other] = [dot(&y, &found), dot(&back, &given)];
            assert!((one - other).abs() < 1e-10 * norm(&y) * norm(&found), "{one} {other}");
        }
    }
}
