//! Adaptive cross approximation: a block of low rank from few of its rows and columns.
//!
//! M. Bebendorf, Approximation of boundary element matrices, Numer. Math. 86 (2000) 565,
//! doi:10.1007/PL00005410, with partial pivoting. The row and the column through the largest entry
//! of what is left are taken until their product is small against the sum. That alone may stop too
//! early where a block falls apart into blocks that do not couple: all rows of some groups spread
//! over the block are then compared with the sum, and the worst of them goes on.

use crate::Entries;
use crate::low_rank::{LowRank, inner, square};
use fredholm_linop::Scalar;

/// Blocks up to this many groups high and wide are computed whole before they are compressed.
const MOST_WHOLE_GROUPS: usize = 128;
/// Groups of which all rows are compared in the end.
const GROUPS_COMPARED: usize = 6;
/// Share of the block from one of them to the next; multiples of the golden ratio meet no pattern
/// of the rows.
const SHARE_BETWEEN_GROUPS: f64 = 0.618_033_988_749_895;
/// What is asked of the crosses, over the tolerance of the block: the rest is left to the
/// truncation.
const CROSS_SHARE_OF_TOLERANCE: f64 = 0.3;

/// The unknowns of some groups on one side of a block.
struct Lines<'a> {
    groups: &'a [usize],
    /// The first line of every group, and their number.
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new<T: Scalar, E: Entries<T>>(entries: &E, groups: &'a [usize]) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        starts.extend(groups.iter().map(|&group| {
            end += entries.width(group);
            end
        }));
        Self { groups, starts }
    }

    fn len(&self) -> usize {
        self.starts[self.groups.len()]
    }

    /// The group of a line, as a slice, which of its lines it is, and how many there are.
    fn find(&self, line: usize) -> (&'a [usize], usize, usize) {
        let at = self.starts.partition_point(|&start| start <= line) - 1;
        (&self.groups[at..=at], line - self.starts[at], self.starts[at + 1] - self.starts[at])
    }
}

/// Rows and columns of a block on demand.
pub(crate) struct Block<'a, T: Scalar, E: Entries<T>> {
    entries: &'a E,
    rows: Lines<'a>,
    columns: Lines<'a>,
    row_set: &'a E::Set,
    column_set: &'a E::Set,
    /// All entries, row by row, where that costs less than the rows and columns of the crosses one
    /// by one.
    whole: Option<Vec<T>>,
}

impl<'a, T: Scalar, E: Entries<T>> Block<'a, T, E> {
    /// The block of some groups, which the sets hold.
    pub(crate) fn new(
        entries: &'a E,
        [rows, columns]: [&'a [usize]; 2],
        [row_set, column_set]: [&'a E::Set; 2],
    ) -> Self {
        let few = rows.len() * columns.len() <= MOST_WHOLE_GROUPS * MOST_WHOLE_GROUPS;
        let (rows, columns) = (Lines::new(entries, rows), Lines::new(entries, columns));
        let mut block = Self { entries, rows, columns, row_set, column_set, whole: None };
        if few {
            block.whole = Some(block.computed());
        }
        block
    }

    /// All entries, row by row.
    pub(crate) fn into_whole(mut self) -> Vec<T> {
        self.whole.take().unwrap_or_else(|| self.computed())
    }

    fn computed(&self) -> Vec<T> {
        let mut whole = vec![T::zero(); self.height() * self.breadth()];
        self.entries.fill(self.row_set, self.column_set, &mut whole);
        whole
    }

    fn height(&self) -> usize {
        self.rows.len()
    }

    fn breadth(&self) -> usize {
        self.columns.len()
    }

    fn row(&self, i: usize) -> Vec<T> {
        if let Some(whole) = &self.whole {
            return whole[i * self.breadth()..(i + 1) * self.breadth()].to_vec();
        }
        let (group, kind, width) = self.rows.find(i);
        let mut out = vec![T::zero(); width * self.breadth()];
        self.entries.fill(&self.entries.prepare(group), self.column_set, &mut out);
        out.chunks_exact(self.breadth()).nth(kind).map(<[T]>::to_vec).unwrap_or_default()
    }

    fn column(&self, j: usize) -> Vec<T> {
        if let Some(whole) = &self.whole {
            return whole.iter().skip(j).step_by(self.breadth()).copied().collect();
        }
        let (group, kind, width) = self.columns.find(j);
        let mut out = vec![T::zero(); width * self.height()];
        self.entries.fill(self.row_set, &self.entries.prepare(group), &mut out);
        out.iter().skip(kind).step_by(width).copied().collect()
    }

    /// The block to a relative tolerance in the Frobenius norm; none where that takes as much as
    /// storing it whole.
    pub(crate) fn compressed(&self, tolerance: f64) -> Option<LowRank<T>> {
        let most = self.height() * self.breadth() / (self.height() + self.breadth());
        let mut crosses = Crosses {
            block: self,
            u: Vec::new(),
            v: Vec::new(),
            square: 0.0,
            used: vec![false; self.height()],
        };
        let mut next = Some(0);
        while let Some(row) = next {
            if crosses.u.len() > most {
                return None;
            }
            next = crosses.step(row, CROSS_SHARE_OF_TOLERANCE * tolerance);
        }
        let low = LowRank::truncated(crosses.u, crosses.v, tolerance);
        (low.rank <= most).then_some(low)
    }
}

/// The crosses taken so far.
struct Crosses<'a, T: Scalar, E: Entries<T>> {
    block: &'a Block<'a, T, E>,
    u: Vec<Vec<T>>,
    v: Vec<Vec<T>>,
    /// ‖U Vᵀ‖².
    square: f64,
    used: Vec<bool>,
}

impl<T: Scalar, E: Entries<T>> Crosses<'_, T, E> {
    /// Takes the cross through the largest entry of a row; returns the next row, none at the end.
    fn step(&mut self, row: usize, tolerance: f64) -> Option<usize> {
        self.used[row] = true;
        let rest = self.rest_of_row(row);
        let pivot = largest(&rest, |_| true)?;
        if rest[pivot] == T::zero() {
            return if self.u.is_empty() { self.unused() } else { self.worst(tolerance) };
        }
        let scale = T::one() / rest[pivot];
        let v: Vec<T> = rest.into_iter().map(|x| x * scale).collect();
        let mut u = self.block.column(pivot);
        for (left, right) in self.u.iter().zip(&self.v) {
            let factor = right[pivot];
            u.iter_mut().zip(left).for_each(|(x, &y)| *x -= y * factor);
        }
        let size = square(&u) * square(&v);
        let mixed: f64 = self
            .u
            .iter()
            .zip(&self.v)
            .map(|(left, right)| 2.0 * (inner(left, &u) * inner(right, &v)).re())
            .sum();
        self.square = (self.square + mixed).max(0.0) + size;
        let next = largest(&u, |i| !self.used[i]);
        self.u.push(u);
        self.v.push(v);
        if size > tolerance * tolerance * self.square { next } else { self.worst(tolerance) }
    }

    /// What is left of a row.
    fn rest_of_row(&self, row: usize) -> Vec<T> {
        let mut rest = self.block.row(row);
        for (left, right) in self.u.iter().zip(&self.v) {
            let factor = left[row];
            rest.iter_mut().zip(right).for_each(|(x, &y)| *x -= y * factor);
        }
        rest
    }

    /// The first row that was not taken.
    fn unused(&self) -> Option<usize> {
        self.used.iter().position(|used| !used)
    }

    /// Of rows spread over the block the one that is worst, if they say that the block is not met.
    fn worst(&self, tolerance: f64) -> Option<usize> {
        let (height, lines) = (self.block.height(), &self.block.rows);
        let groups = lines.groups.len();
        let group =
            move |i: usize| (((i + 1) as f64 * SHARE_BETWEEN_GROUPS).fract() * groups as f64) as usize;
        let of_group = |at: usize| lines.starts[at]..lines.starts[at + 1];
        let all = (0..GROUPS_COMPARED).flat_map(|i| of_group(group(i)));
        let rows: Vec<usize> = all.filter(|&row| !self.used[row]).collect();
        let sizes: Vec<f64> = rows.iter().map(|&row| square(&self.rest_of_row(row))).collect();
        let mean = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64;
        if mean * height as f64 <= tolerance * tolerance * self.square {
            return None;
        }
        let worst = (0..rows.len()).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b]).then(b.cmp(&a)))?;
        Some(rows[worst])
    }
}

/// The largest entry of those allowed, the first of equals.
fn largest<T: Scalar>(x: &[T], allowed: impl Fn(usize) -> bool) -> Option<usize> {
    let candidates = (0..x.len()).filter(|&i| allowed(i));
    candidates.fold(None, |best, i| match best {
        Some(b) if x[i].abs2() <= x[b].abs2() => best,
        _ => Some(i),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_linop::Symmetry;

    /// 1/(1 + distance) between two rows of points, in two kinds that couple by a factor.
    struct Rows {
        coupling: f64,
    }

    impl Rows {
        fn entry(&self, i: usize, j: usize) -> f64 {
            let kind = if i % 2 == j % 2 { 1.0 } else { self.coupling };
            kind / (1.0 + (i / 2).abs_diff(j / 2) as f64)
        }
    }

    impl Entries<f64> for Rows {
        type Set = Vec<usize>;

        fn groups(&self) -> usize {
            60
        }

        fn width(&self, _group: usize) -> usize {
            2
        }

        fn symmetry(&self) -> Symmetry {
            Symmetry::General
        }

        fn prepare(&self, groups: &[usize]) -> Vec<usize> {
            groups.to_vec()
        }

        fn fill(&self, rows: &Vec<usize>, columns: &Vec<usize>, out: &mut [f64]) {
            let unknowns = |set: &[usize]| set.iter().flat_map(|&g| [2 * g, 2 * g + 1]).collect::<Vec<_>>();
            let columns = unknowns(columns);
            for (row, out) in unknowns(rows).into_iter().zip(out.chunks_exact_mut(columns.len())) {
                out.iter_mut().zip(&columns).for_each(|(out, &column)| *out = self.entry(row, column));
            }
        }
    }

    #[test]
    fn blocks_are_met_also_where_kinds_do_not_couple() {
        let groups: Vec<usize> = (0..60).collect();
        for coupling in [0.0, 0.5, 1.0] {
            let entries = Rows { coupling };
            let (rows, columns) = (&groups[..25], &groups[35..]);
            let (row_set, column_set) = (entries.prepare(rows), entries.prepare(columns));
            let block = Block::new(&entries, [rows, columns], [&row_set, &column_set]);
            for tolerance in [1e-2, 1e-4, 1e-8] {
                let low = block.compressed(tolerance).unwrap();
                let (mut difference, mut size) = (0.0, 0.0);
                for i in 0..50 {
                    for j in 0..50 {
                        let exact = entries.entry(2 * rows[0] + i, 2 * columns[0] + j);
                        let found: f64 = (0..low.rank).map(|k| low.u[50 * k + i] * low.v[50 * k + j]).sum();
                        difference += (found - exact).powi(2);
                        size += exact * exact;
                    }
                }
                let error = (difference / size).sqrt();
                assert!(
                    error < tolerance && low.rank < 20,
                    "{coupling} {tolerance}: {error:e}, rank {}",
                    low.rank
                );
            }
        }
    }
}
