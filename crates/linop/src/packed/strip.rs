//! A few equally long rows of a real matrix against all lanes of a vector: s_rl += Σ_j g_rj x_jl and
//! u_jl += Σ_r g_rj f_rl.
//!
//! Taking several rows at a time divides the traffic of x and u, which do not fit the innermost cache, by their
//! number. Vectors are stored unknown-major, so a lane count known to the compiler turns the lanes of one unknown
//! into one array. Every sum runs in [`WIDTH`] parts that are added in a fixed order: the bits depend on the code
//! alone, not on the width of the machine's registers.

use super::Storage;

/// Entries of a row taken at a time. More of them would not fit the registers with four rows and three lanes.
const WIDTH: usize = 2;

/// R rows, and how many lanes the vectors have. Values per row and lane are stored row by row.
pub(super) struct Strip<'a, S, const R: usize> {
    pub rows: [&'a [S]; R],
    pub lanes: usize,
}

impl<S: Storage, const R: usize> Strip<'_, S, R> {
    /// s_rl += Σ_j g_rj x_jl.
    pub fn dot(&self, x: &[f64], sums: &mut [f64]) {
        match self.lanes {
            1 => self.dot_fixed::<1>(x, sums),
            2 => self.dot_fixed::<2>(x, sums),
            3 => self.dot_fixed::<3>(x, sums),
            _ => self.dot_any(x, sums),
        }
    }

    /// u_jl += Σ_r g_rj f_rl.
    pub fn add(&self, factors: &[f64], u: &mut [f64]) {
        match self.lanes {
            1 => self.add_fixed::<1>(factors, u),
            2 => self.add_fixed::<2>(factors, u),
            3 => self.add_fixed::<3>(factors, u),
            _ => self.add_any(factors, u),
        }
    }

    fn dot_fixed<const L: usize>(&self, x: &[f64], sums: &mut [f64]) {
        let mut parts = [[[0.0; L]; WIDTH]; R];
        let (xs, x_end) = x.as_chunks::<L>().0.as_chunks::<WIDTH>();
        let (rows, ends) = self.cut(xs.len());
        for (at, x) in xs.iter().enumerate() {
            for r in 0..R {
                for k in 0..WIDTH {
                    add_scaled(&mut parts[r][k], rows[r][at][k].to_f64(), &x[k]);
                }
            }
        }
        for (k, x) in x_end.iter().enumerate() {
            (0..R).for_each(|r| add_scaled(&mut parts[r][k], ends[r][k].to_f64(), x));
        }
        add_parts(&parts, sums);
    }

    fn add_fixed<const L: usize>(&self, factors: &[f64], u: &mut [f64]) {
        let us = u.as_chunks_mut::<L>().0;
        let factors: [[f64; L]; R] = gathered(factors);
        let rows = self.rows.map(|row| &row[..us.len()]);
        for (j, u) in us.iter_mut().enumerate() {
            (0..R).for_each(|r| add_scaled(u, rows[r][j].to_f64(), &factors[r]));
        }
    }

    /// The rows in `count` pieces of [`WIDTH`] entries, and what remains of them.
    fn cut(&self, count: usize) -> ([&[[S; WIDTH]]; R], [&[S]; R]) {
        let pieces = self.rows.map(|row| &row.as_chunks::<WIDTH>().0[..count]);
        (pieces, self.rows.map(|row| &row[count * WIDTH..]))
    }

    fn dot_any(&self, x: &[f64], sums: &mut [f64]) {
        let lanes = self.lanes.max(1);
        for (j, x) in x.chunks_exact(lanes).enumerate() {
            for (row, sum) in self.rows.iter().zip(sums.chunks_exact_mut(lanes)) {
                let entry = row[j].to_f64();
                sum.iter_mut().zip(x).for_each(|(sum, x)| *sum += entry * x);
            }
        }
    }

    fn add_any(&self, factors: &[f64], u: &mut [f64]) {
        let lanes = self.lanes.max(1);
        for (j, u) in u.chunks_exact_mut(lanes).enumerate() {
            for (row, factor) in self.rows.iter().zip(factors.chunks_exact(lanes)) {
                let entry = row[j].to_f64();
                u.iter_mut().zip(factor).for_each(|(u, factor)| *u += entry * factor);
            }
        }
    }
}

/// The lanes of R rows as values, so that the compiler may keep them in registers.
fn gathered<const R: usize, const L: usize>(values: &[f64]) -> [[f64; L]; R] {
    let rows = values.as_chunks::<L>().0;
    std::array::from_fn(|r| rows[r])
}

fn add_scaled<const L: usize>(sum: &mut [f64; L], entry: f64, values: &[f64; L]) {
    for l in 0..L {
        sum[l] += entry * values[l];
    }
}

fn add_parts<const R: usize, const L: usize>(parts: &[[[f64; L]; WIDTH]; R], sums: &mut [f64]) {
    for (sum, parts) in sums.as_chunks_mut::<L>().0.iter_mut().zip(parts) {
        let mut total = [0.0; L];
        for part in parts {
            add_scaled(&mut total, 1.0, part);
        }
        add_scaled(sum, 1.0, &total);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small integers, so that sums in any order are exact.
    fn integers(count: usize, period: usize) -> Vec<f64> {
        (0..count).map(|at| (at * at % period) as f64 - 3.0).collect()
    }

    fn check<const R: usize>(n: usize, lanes: usize) {
        let entries = integers(R * n, 11);
        let (x, factors) = (integers(n * lanes, 7), integers(R * lanes, 5));
        let rows: [&[f64]; R] = std::array::from_fn(|r| &entries[r * n..(r + 1) * n]);
        let strip = Strip { rows, lanes };
        let dot = |r: usize, l: usize| (0..n).map(|j| rows[r][j] * x[j * lanes + l]).sum::<f64>();
        let add = |j: usize, l: usize| (0..R).map(|r| rows[r][j] * factors[r * lanes + l]).sum::<f64>();
        let sums: Vec<f64> = (0..R * lanes).map(|at| 9.0 + dot(at / lanes, at % lanes)).collect();
        let added: Vec<f64> = (0..n * lanes).map(|at| 1.0 + add(at / lanes, at % lanes)).collect();

        let (mut sum, mut u) = (vec![9.0; R * lanes], vec![1.0; n * lanes]);
        strip.dot(&x, &mut sum);
        strip.add(&factors, &mut u);
        assert_eq!((&sum, &u), (&sums, &added), "{R} × {n}, {lanes} lanes");
    }

    #[test]
    fn every_lane_count_and_remainder_gives_the_plain_sums() {
        for lanes in 0..6 {
            for n in 0..20 {
                check::<1>(n, lanes);
                check::<4>(n, lanes);
            }
        }
    }
}
