//! A few equally long rows of a real matrix against all lanes of a vector: s_rl += Σ_j g_rj x_jl and
//! u_jl += Σ_r g_rj f_rl.
//!
//! Taking several rows at a time divides the traffic of x and u, which do not fit the innermost cache, by their
//! number; more than [`LANES`] lanes are taken in turns, from entries that are then in the cache. The loops are
//! compiled for the widest registers of the machine. Every sum runs in [`WIDTH`] parts that are added in a fixed
//! order, without fused operations: the bits depend on the code alone, not on the machine.

use super::Storage;
use super::planar::Planar;
use pulp::NullaryFnOnce;

/// Entries of a row taken at a time.
const WIDTH: usize = 4;
/// Most lanes at a time: with four rows, their sums fill the registers.
const LANES: usize = 3;

/// R rows whose first entry stands in column `from`.
#[derive(Clone, Copy)]
pub(super) struct Strip<'a, S, const R: usize> {
    pub rows: [&'a [S]; R],
    pub from: usize,
}

/// s_rl += Σ_j g_rj x_jl, s_rl at r · lanes + l.
pub(super) struct Dot<'a, S, const R: usize> {
    pub strip: Strip<'a, S, R>,
    pub x: &'a Planar,
    pub sums: &'a mut [f64],
}

/// u_jl += Σ_r g_rj f_rl, f_rl at r · lanes + l.
pub(super) struct Add<'a, S, const R: usize> {
    pub strip: Strip<'a, S, R>,
    pub factors: &'a [f64],
    pub u: &'a mut Planar,
}

impl<S: Storage, const R: usize> NullaryFnOnce for Dot<'_, S, R> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let lanes = self.sums.len() / R;
        let mut first = 0;
        while first < lanes {
            match lanes - first {
                1 => self.strip.dot::<1>(self.x, (first, lanes), self.sums),
                2 => self.strip.dot::<2>(self.x, (first, lanes), self.sums),
                _ => self.strip.dot::<LANES>(self.x, (first, lanes), self.sums),
            }
            first += LANES;
        }
    }
}

impl<S: Storage, const R: usize> NullaryFnOnce for Add<'_, S, R> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let lanes = self.factors.len() / R;
        let mut first = 0;
        while first < lanes {
            match lanes - first {
                1 => self.strip.add::<1>(self.factors, (first, lanes), self.u),
                2 => self.strip.add::<2>(self.factors, (first, lanes), self.u),
                _ => self.strip.add::<LANES>(self.factors, (first, lanes), self.u),
            }
            first += LANES;
        }
    }
}

impl<S: Storage, const R: usize> Strip<'_, S, R> {
    fn len(&self) -> usize {
        self.rows.first().map_or(0, |row| row.len())
    }

    /// The rows in pieces of [`WIDTH`] entries, and what remains of them.
    #[inline(always)]
    fn cut(&self) -> ([&[[S; WIDTH]]; R], [&[S]; R]) {
        let count = self.len() / WIDTH;
        let pieces = self.rows.map(|row| &row.as_chunks::<WIDTH>().0[..count]);
        (pieces, self.rows.map(|row| &row[count * WIDTH..]))
    }

    #[inline(always)]
    fn dot<const L: usize>(&self, x: &Planar, (first, lanes): (usize, usize), sums: &mut [f64]) {
        let (pieces, ends) = self.cut();
        let count = self.len() / WIDTH;
        let xs = x.lanes::<L>(first).map(|x| &x[self.from..self.from + self.len()]);
        let x_pieces = xs.map(|x| &x.as_chunks::<WIDTH>().0[..count]);
        let mut parts = [[[0.0; WIDTH]; L]; R];
        for at in 0..count {
            for r in 0..R {
                let entries = pieces[r][at].map(Storage::to_f64);
                for l in 0..L {
                    for k in 0..WIDTH {
                        parts[r][l][k] += entries[k] * x_pieces[l][at][k];
                    }
                }
            }
        }
        for r in 0..R {
            for l in 0..L {
                for (k, entry) in ends[r].iter().enumerate() {
                    parts[r][l][k] += entry.to_f64() * xs[l][count * WIDTH + k];
                }
                let [a, b, c, d] = parts[r][l];
                sums[r * lanes + first + l] += (a + b) + (c + d);
            }
        }
    }

    #[inline(always)]
    fn add<const L: usize>(&self, factors: &[f64], (first, lanes): (usize, usize), u: &mut Planar) {
        let (pieces, ends) = self.cut();
        let count = self.len() / WIDTH;
        let factors: [[f64; L]; R] =
            std::array::from_fn(|r| std::array::from_fn(|l| factors[r * lanes + first + l]));
        let (from, to) = (self.from, self.from + self.len());
        let us = u.lanes_mut::<L>(first).map(|u| &mut u[from..to]);
        let mut us = us.map(|u| {
            let (pieces, end) = u.split_at_mut(count * WIDTH);
            (pieces.as_chunks_mut::<WIDTH>().0, end)
        });
        for at in 0..count {
            for l in 0..L {
                let u = &mut us[l].0[at];
                let mut sum = *u;
                for r in 0..R {
                    let entries = pieces[r][at].map(Storage::to_f64);
                    for k in 0..WIDTH {
                        sum[k] += entries[k] * factors[r][l];
                    }
                }
                *u = sum;
            }
        }
        for (l, (_, end)) in us.iter_mut().enumerate() {
            for (k, u) in end.iter_mut().enumerate() {
                (0..R).for_each(|r| *u += ends[r][k].to_f64() * factors[r][l]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MultiVector;

    /// Small integers, so that sums in any order are exact.
    fn integers(count: usize, period: usize) -> Vec<f64> {
        (0..count).map(|at| (at * at % period) as f64 - 3.0).collect()
    }

    fn check<const R: usize>(n: usize, lanes: usize) {
        let (from, dim) = (2, n + 5);
        let entries = integers(R * n, 11);
        let x = MultiVector::from_vec(dim, lanes, integers(dim * lanes, 7)).unwrap();
        let factors = integers(R * lanes, 5);
        let rows: [&[f64]; R] = std::array::from_fn(|r| &entries[r * n..(r + 1) * n]);
        let strip = Strip { rows, from };
        let dot = |r: usize, l: usize| (0..n).map(|j| rows[r][j] * x.row(from + j)[l]).sum::<f64>();
        let inside = |i: usize| i >= from && i < from + n;
        let add = |i: usize, l: usize| {
            let terms =
                (0..R).map(|r| if inside(i) { rows[r][i - from] * factors[r * lanes + l] } else { 0.0 });
            x.row(i)[l] + terms.sum::<f64>()
        };
        let expected: Vec<f64> = (0..R * lanes).map(|at| 9.0 + dot(at / lanes, at % lanes)).collect();
        let added: Vec<f64> = (0..dim * lanes).map(|at| add(at / lanes, at % lanes)).collect();

        let (mut sums, mut u) = (vec![9.0; R * lanes], Planar::copied(&x));
        Dot { strip, x: &Planar::copied(&x), sums: &mut sums }.call();
        Add { strip, factors: &factors, u: &mut u }.call();
        let u: Vec<f64> = (0..dim).flat_map(|i| u.row(i).collect::<Vec<_>>()).collect();
        assert_eq!((&sums, &u), (&expected, &added), "{R} × {n}, {lanes} lanes");
    }

    #[test]
    fn every_lane_count_and_remainder_gives_the_plain_sums() {
        for lanes in 0..9 {
            for n in 0..20 {
                check::<1>(n, lanes);
                check::<4>(n, lanes);
            }
        }
    }
}
