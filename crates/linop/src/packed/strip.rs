//! A few equally long rows of a real matrix against all right-hand sides of a vector: s_rl += Σ_j
//! g_rj x_jl and u_jl += Σ_r g_rj f_rl.
//!
//! Taking several rows at a time divides the traffic of x and u, which do not fit the innermost
//! cache, by their number. At most [`RHS_AT_ONCE`] right-hand sides and [`ROWS_OF_A_PAIR`] rows are
//! taken at a time by the innermost loops, so that everything that is summed stays in registers,
//! the widest ones of the machine; a strip is short enough for the innermost cache to serve the
//! repetitions. Every sum runs in [`WIDTH`] parts that are added in a fixed order, by fused
//! operations that a machine without them emulates: the bits depend on the code alone, not on the
//! machine.

use super::planar::{Planar, PlanarMut};
use super::{ROWS_TOGETHER, Storage};
use pulp::{Simd, WithSimd};

/// Parts of a sum: no register holds more numbers.
const WIDTH: usize = 8;
/// Most right-hand sides at a time.
const RHS_AT_ONCE: usize = 3;
/// Rows at a time, where there are several right-hand sides.
const ROWS_OF_A_PAIR: usize = 2;
/// Pieces that a row is read ahead of its products, where there are several right-hand sides:
/// products that wait for an entry fill up the machine, and it asks for the next entries too late.
const PIECES_READ_AHEAD: usize = 8;

/// Up to [`ROWS_TOGETHER`] rows whose first entry stands in column `from`.
#[derive(Clone, Copy)]
pub(super) struct Strip<'a, S> {
    pub rows: &'a [&'a [S]],
    pub from: usize,
}

/// s_rl += Σ_j g_rj x_jl, s_rl at r · count + l.
pub(super) struct Dot<'a, S> {
    pub strip: Strip<'a, S>,
    pub x: &'a Planar,
    pub sums: &'a mut [f64],
}

/// u_jl += Σ_r g_rj f_rl, f_rl at r · count + l.
pub(super) struct Add<'a, S> {
    pub strip: Strip<'a, S>,
    pub factors: &'a [f64],
    pub u: PlanarMut<'a>,
}

/// Both at once, where the factors are known before: while one entry is used for both, the next
/// ones come from memory.
pub(super) struct Both<'a, S> {
    pub strip: Strip<'a, S>,
    pub x: &'a Planar,
    pub sums: &'a mut [f64],
    pub factors: &'a [f64],
    pub u: PlanarMut<'a>,
    /// Columns to be taken. The rows may go on behind them: those entries are fetched, not used.
    pub columns: usize,
}

/// Some rows, and the right-hand sides from one on.
#[derive(Clone, Copy)]
struct Place {
    row: usize,
    rhs: usize,
    rhs_count: usize,
}

impl<S: Storage> WithSimd for Dot<'_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        match registers::<V>() {
            1 => self.all::<V, 1>(simd),
            2 => self.all::<V, 2>(simd),
            4 => self.all::<V, 4>(simd),
            _ => self.all::<V, WIDTH>(simd),
        }
    }
}

impl<S: Storage> Dot<'_, S> {
    /// All right-hand sides, with K registers to a sum.
    #[inline(always)]
    fn all<V: Simd, const K: usize>(self, simd: V) {
        let Self { strip, x, sums } = self;
        let rhs_count = sums.len() / strip.rows.len().max(1);
        for rhs in (0..rhs_count).step_by(RHS_AT_ONCE) {
            let at = Place { row: 0, rhs, rhs_count };
            match rhs_count - rhs {
                1 => strip.dots::<V, ROWS_TOGETHER, 1, K>(simd, at, x, sums),
                2 => strip.dots::<V, ROWS_OF_A_PAIR, 2, K>(simd, at, x, sums),
                _ => strip.dots::<V, ROWS_OF_A_PAIR, RHS_AT_ONCE, K>(simd, at, x, sums),
            }
        }
    }
}

impl<S: Storage> WithSimd for Add<'_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        let Self { strip, factors, mut u } = self;
        let rhs_count = factors.len() / strip.rows.len().max(1);
        for rhs in (0..rhs_count).step_by(RHS_AT_ONCE) {
            let at = Place { row: 0, rhs, rhs_count };
            match rhs_count - rhs {
                1 => strip.adds::<V, ROWS_TOGETHER, 1>(simd, at, factors, &mut u),
                2 => strip.adds::<V, ROWS_OF_A_PAIR, 2>(simd, at, factors, &mut u),
                _ => strip.adds::<V, ROWS_OF_A_PAIR, RHS_AT_ONCE>(simd, at, factors, &mut u),
            }
        }
    }
}

impl<S: Storage> WithSimd for Both<'_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        match registers::<V>() {
            1 => self.all::<V, 1>(simd),
            2 => self.all::<V, 2>(simd),
            4 => self.all::<V, 4>(simd),
            _ => self.all::<V, WIDTH>(simd),
        }
    }
}

impl<S: Storage> Both<'_, S> {
    /// All right-hand sides, with K registers to a sum.
    #[inline(always)]
    fn all<V: Simd, const K: usize>(mut self, simd: V) {
        let rhs_count = self.sums.len() / self.strip.rows.len().max(1);
        for rhs in (0..rhs_count).step_by(RHS_AT_ONCE) {
            let at = Place { row: 0, rhs, rhs_count };
            match rhs_count - rhs {
                1 => self.vectors::<V, ROWS_TOGETHER, 1, K>(simd, at),
                2 if K == 1 => self.vectors::<V, ROWS_TOGETHER, 2, K>(simd, at),
                2 => self.vectors::<V, ROWS_OF_A_PAIR, 2, K>(simd, at),
                _ if K == 1 => self.vectors::<V, ROWS_TOGETHER, RHS_AT_ONCE, K>(simd, at),
                // Machines of narrow registers have few of them, too: no more sums than fit.
                _ => self.vectors::<V, 1, RHS_AT_ONCE, K>(simd, at),
            }
        }
    }

    /// L right-hand sides: R rows at a time, then those that are left one by one.
    #[inline(always)]
    fn vectors<V: Simd, const R: usize, const L: usize, const K: usize>(&mut self, simd: V, at: Place) {
        let (groups, rest) = self.strip.rows.as_chunks::<R>();
        for (group, rows) in groups.iter().enumerate() {
            self.rows::<V, R, L, K>(simd, *rows, Place { row: group * R, ..at });
        }
        for (k, row) in rest.iter().enumerate() {
            self.rows::<V, 1, L, K>(simd, [row], Place { row: groups.len() * R + k, ..at });
        }
    }

    #[inline(always)]
    fn rows<V: Simd, const R: usize, const L: usize, const K: usize>(
        &mut self,
        simd: V,
        rows: [&[S]; R],
        at: Place,
    ) {
        let columns = self.strip.from..self.strip.from + self.columns;
        let xs = self.x.vectors::<L>(at.rhs).map(|x| &x[columns.clone()]);
        let us = self.u.vectors_mut::<L>(at.rhs).map(|u| &mut u[columns.clone()]);
        both::<V, S, R, L, K>(simd, rows, xs, us, (self.factors, self.sums), at);
    }
}

impl<S: Storage> Strip<'_, S> {
    fn len(&self) -> usize {
        self.rows.first().map_or(0, |row| row.len())
    }

    /// L right-hand sides: R rows at a time, then those that are left one by one.
    #[inline(always)]
    fn dots<V: Simd, const R: usize, const L: usize, const K: usize>(
        &self,
        simd: V,
        at: Place,
        x: &Planar,
        sums: &mut [f64],
    ) {
        let xs = x.vectors::<L>(at.rhs).map(|x| &x[self.from..self.from + self.len()]);
        let (groups, rest) = self.rows.as_chunks::<R>();
        for (group, rows) in groups.iter().enumerate() {
            dot::<V, S, R, L, K>(simd, *rows, xs, Place { row: group * R, ..at }, sums);
        }
        for (k, row) in rest.iter().enumerate() {
            dot::<V, S, 1, L, K>(simd, [row], xs, Place { row: groups.len() * R + k, ..at }, sums);
        }
    }

    /// L right-hand sides: R rows at a time, then those that are left one by one.
    #[inline(always)]
    fn adds<V: Simd, const R: usize, const L: usize>(
        &self,
        simd: V,
        at: Place,
        factors: &[f64],
        u: &mut PlanarMut<'_>,
    ) {
        let mut us = u.vectors_mut::<L>(at.rhs).map(|u| &mut u[self.from..self.from + self.rows[0].len()]);
        let (groups, rest) = self.rows.as_chunks::<R>();
        for (group, rows) in groups.iter().enumerate() {
            add::<V, S, R, L>(simd, *rows, factors, Place { row: group * R, ..at }, &mut us);
        }
        for (k, row) in rest.iter().enumerate() {
            add::<V, S, 1, L>(simd, [row], factors, Place { row: groups.len() * R + k, ..at }, &mut us);
        }
    }
}

/// Registers that hold the parts of a sum.
const fn registers<V: Simd>() -> usize {
    WIDTH / V::F64_LANES
}

#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "r, l and k index several arrays")]
fn dot<V: Simd, S: Storage, const R: usize, const L: usize, const K: usize>(
    simd: V,
    rows: [&[S]; R],
    xs: [&[f64]; L],
    at: Place,
    sums: &mut [f64],
) {
    let blocks = rows[0].len() / WIDTH;
    // Slices of one length, which the compiler need not check again.
    let pieces = rows.map(|row| &row.as_chunks::<WIDTH>().0[..blocks]);
    let x_pieces = xs.map(|x| &V::as_simd_f64s(x).0[..blocks * K]);
    let mut parts = [[[simd.splat_f64s(0.0); K]; L]; R];
    for block in 0..blocks {
        for k in 0..K {
            for r in 0..R {
                let entry = load::<V, S>(&pieces[r][block], k);
                for l in 0..L {
                    let x = x_pieces[l][block * K + k];
                    parts[r][l][k] = simd.mul_add_f64s(entry, x, parts[r][l][k]);
                }
            }
        }
    }
    finish(&mut numbers(simd, &parts), rows, xs, at, sums);
}

/// All parts as numbers: in a small loop of its own, which is unrolled, so that the parts can stay
/// in registers.
#[inline(always)]
fn numbers<V: Simd, const R: usize, const L: usize, const K: usize>(
    simd: V,
    parts: &[[[V::f64s; K]; L]; R],
) -> [[[f64; WIDTH]; L]; R] {
    let mut numbers = [[[0.0; WIDTH]; L]; R];
    for r in 0..R {
        for l in 0..L {
            numbers[r][l] = spread(simd, &parts[r][l]);
        }
    }
    numbers
}

/// Adds the columns that fill no register, and the parts to the sums.
#[inline(always)]
fn finish<S: Storage, const R: usize, const L: usize>(
    numbers: &mut [[[f64; WIDTH]; L]; R],
    rows: [&[S]; R],
    xs: [&[f64]; L],
    at: Place,
    sums: &mut [f64],
) {
    for (r, row) in rows.iter().enumerate() {
        for (l, x) in xs.iter().enumerate() {
            let (part, whole) = (&mut numbers[r][l], x.len() / WIDTH * WIDTH);
            for ((part, entry), x) in part.iter_mut().zip(&row[whole..]).zip(&x[whole..]) {
                *part += entry.to_f64() * x;
            }
            sums[(at.row + r) * at.rhs_count + at.rhs + l] += folded(part);
        }
    }
}

/// The k-th register of a piece of a row.
#[inline(always)]
fn load<V: Simd, S: Storage>(piece: &[S; WIDTH], k: usize) -> V::f64s {
    V::as_simd_f64s(&piece.map(Storage::to_f64)).0[k]
}

/// The parts of a sum, added in pairs.
#[inline(always)]
fn folded(part: &[f64; WIDTH]) -> f64 {
    let [a, b, c, d, e, f, g, h] = *part;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// The parts of a sum as numbers.
#[inline(always)]
fn spread<V: Simd, const K: usize>(_: V, parts: &[V::f64s; K]) -> [f64; WIDTH] {
    let mut numbers = [0.0; WIDTH];
    V::as_mut_simd_f64s(&mut numbers).0.copy_from_slice(parts);
    numbers
}

#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "r, l and k index several arrays")]
fn add<V: Simd, S: Storage, const R: usize, const L: usize>(
    simd: V,
    rows: [&[S]; R],
    factors: &[f64],
    at: Place,
    us: &mut [&mut [f64]; L],
) {
    let factor = |r: usize, l: usize| factors[(at.row + r) * at.rhs_count + at.rhs + l];
    let blocks = rows[0].len() / WIDTH;
    let (whole, count) = (blocks * WIDTH, blocks * registers::<V>());
    let pieces = rows.map(|row| &row.as_chunks::<WIDTH>().0[..blocks]);
    let splat: [[V::f64s; L]; R] =
        std::array::from_fn(|r| std::array::from_fn(|l| simd.splat_f64s(factor(r, l))));
    for (l, u) in us.iter_mut().enumerate() {
        for (k, u) in u[whole..].iter_mut().enumerate() {
            (0..R).for_each(|r| *u += rows[r][whole + k].to_f64() * factor(r, l));
        }
    }
    let u_pieces = us.each_mut().map(|u| &mut V::as_mut_simd_f64s(u).0[..count]);
    for block in 0..blocks {
        for k in 0..registers::<V>() {
            let entries: [V::f64s; R] = std::array::from_fn(|r| load::<V, S>(&pieces[r][block], k));
            for l in 0..L {
                let u = &mut u_pieces[l][block * registers::<V>() + k];
                let mut sum = *u;
                for r in 0..R {
                    sum = simd.mul_add_f64s(entries[r], splat[r][l], sum);
                }
                *u = sum;
            }
        }
    }
}

#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "r, l and k index several arrays")]
fn both<V: Simd, S: Storage, const R: usize, const L: usize, const K: usize>(
    simd: V,
    rows: [&[S]; R],
    xs: [&[f64]; L],
    mut us: [&mut [f64]; L],
    (factors, sums): (&[f64], &mut [f64]),
    at: Place,
) {
    let factor = |r: usize, l: usize| factors[(at.row + r) * at.rhs_count + at.rhs + l];
    let blocks = xs[0].len() / WIDTH;
    for (l, u) in us.iter_mut().enumerate() {
        for (k, u) in u.iter_mut().enumerate().skip(blocks * WIDTH) {
            (0..R).for_each(|r| *u += rows[r][k].to_f64() * factor(r, l));
        }
    }
    let pieces = rows.map(|row| &row.as_chunks::<WIDTH>().0[..blocks]);
    let ahead = rows.map(|row| {
        let all = row.as_chunks::<WIDTH>().0;
        &all[PIECES_READ_AHEAD.min(all.len() - blocks)..][..blocks]
    });
    let x_pieces = xs.map(|x| &V::as_simd_f64s(x).0[..blocks * K]);
    let u_pieces = us.each_mut().map(|u| &mut V::as_mut_simd_f64s(u).0[..blocks * K]);
    let splat: [[V::f64s; L]; R] =
        std::array::from_fn(|r| std::array::from_fn(|l| simd.splat_f64s(factor(r, l))));
    let mut parts = [[[simd.splat_f64s(0.0); K]; L]; R];
    let mut touched = [0.0; R];
    for block in 0..blocks {
        for r in 0..if L > 1 { R } else { 0 } {
            touched[r] += ahead[r][block][0].to_f64();
        }
        for k in 0..K {
            let entries: [V::f64s; R] = std::array::from_fn(|r| load::<V, S>(&pieces[r][block], k));
            for l in 0..L {
                let (x, u) = (x_pieces[l][block * K + k], &mut u_pieces[l][block * K + k]);
                let mut sum = *u;
                for r in 0..R {
                    parts[r][l][k] = simd.mul_add_f64s(entries[r], x, parts[r][l][k]);
                    sum = simd.mul_add_f64s(entries[r], splat[r][l], sum);
                }
                *u = sum;
            }
        }
    }
    std::hint::black_box(touched);
    finish(&mut numbers(simd, &parts), rows, xs, at, sums);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MultiVector;
    use pulp::Arch;

    /// Small integers, so that sums in any order are exact.
    fn integers(count: usize, period: usize) -> Vec<f64> {
        (0..count).map(|at| (at * at % period) as f64 - 3.0).collect()
    }

    fn check(count: usize, n: usize, rhs_count: usize) {
        let (from, dim) = (2, n + 5);
        let entries = integers(count * n, 11);
        let x = MultiVector::from_vec(dim, rhs_count, integers(dim * rhs_count, 7)).unwrap();
        let factors = integers(count * rhs_count, 5);
        let rows: Vec<&[f64]> = (0..count).map(|r| &entries[r * n..(r + 1) * n]).collect();
        let strip = Strip { rows: &rows, from };
        let dot = |r: usize, l: usize| (0..n).map(|j| rows[r][j] * x.row(from + j)[l]).sum::<f64>();
        let inside = |i: usize| i >= from && i < from + n;
        let add = |i: usize, l: usize| {
            let term =
                |r: usize| if inside(i) { rows[r][i - from] * factors[r * rhs_count + l] } else { 0.0 };
            x.row(i)[l] + (0..count).map(term).sum::<f64>()
        };
        let expected: Vec<f64> =
            (0..count * rhs_count).map(|at| 9.0 + dot(at / rhs_count, at % rhs_count)).collect();
        let added: Vec<f64> = (0..dim * rhs_count).map(|at| add(at / rhs_count, at % rhs_count)).collect();

        for arch in [Arch::new(), Arch::Scalar] {
            let (mut sums, mut u) = (vec![9.0; count * rhs_count], Planar::copied(&x));
            arch.dispatch(Dot { strip, x: &Planar::copied(&x), sums: &mut sums });
            arch.dispatch(Add { strip, factors: &factors, u: u.view_mut() });
            let (mut sums_too, mut u_too) = (vec![9.0; count * rhs_count], Planar::copied(&x));
            let both = Both {
                strip,
                x: &Planar::copied(&x),
                sums: &mut sums_too,
                factors: &factors,
                u: u_too.view_mut(),
                columns: n,
            };
            arch.dispatch(both);
            let rows_of =
                |u: &Planar| (0..dim).flat_map(|i| u.row(i).collect::<Vec<_>>()).collect::<Vec<_>>();
            assert_eq!(
                (&sums_too, &rows_of(&u_too)),
                (&expected, &added),
                "{count} × {n}, {rhs_count} right-hand sides at once"
            );
            let u: Vec<f64> = (0..dim).flat_map(|i| u.row(i).collect::<Vec<_>>()).collect();
            assert_eq!((&sums, &u), (&expected, &added), "{count} × {n}, {rhs_count} right-hand sides");
        }
    }

    #[test]
    fn every_right_hand_side_count_and_remainder_gives_the_plain_sums() {
        for rhs_count in 0..9 {
            for n in 0..20 {
                (1..=ROWS_TOGETHER).for_each(|rows| check(rows, n, rhs_count));
            }
        }
    }

    #[test]
    fn the_width_of_the_registers_changes_no_bit() {
        let (n, rhs_count) = (77, 4);
        let values = |seed: usize, count: usize| -> Vec<f64> {
            (0..count).map(|at| ((at * seed + 1) as f64 * 0.618_033_988_749_895).fract()).collect()
        };
        let entries = values(3, 4 * n);
        let rows: Vec<&[f64]> = entries.chunks_exact(n).collect();
        let x = Planar::copied(&MultiVector::from_vec(n, rhs_count, values(7, n * rhs_count)).unwrap());
        let on = |arch: Arch| {
            let mut sums = vec![0.0; 4 * rhs_count];
            arch.dispatch(Dot { strip: Strip { rows: &rows, from: 0 }, x: &x, sums: &mut sums });
            sums.iter().map(|sum| sum.to_bits()).collect::<Vec<u64>>()
        };
        assert_eq!(on(Arch::new()), on(Arch::Scalar));
    }
}
