//! The numbers of a matrix by multipoles, and its products.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::grid::Direction;
use super::interpolation::{PLANES, Scratch};
use super::plan::{MultipoleSettings, MultipoleSummary, Plan, Stage};
use super::series::Series;
use super::{NUMBERS, Patterns};
use crate::CompressionError;
use crate::block_diagonal::Diagonal;
use fredholm_linop::{LinearOperator, MultiVector, Steps, Watch};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use pulp::Arch;
use rayon::prelude::*;

/// Numbers that dot products sum side by side.
const LANES: usize = 8;

/// A square matrix: near blocks whole, and all others by multipoles.
pub struct Multipole {
    plan: Plan,
    summary: MultipoleSummary,
    arch: Arch,
    share: f64,
    leaves: Vec<Leaf>,
    tables: Vec<Tables>,
}

/// What a leaf holds.
struct Leaf {
    /// Its rows of the unknowns of all near leaves, row by row: real parts, then imaginary ones.
    near: Vec<f32>,
    /// The patterns of its unknowns.
    patterns: Vec<f32>,
}

/// What a level holds.
struct Tables {
    /// c w T of every offset: real parts, then imaginary ones.
    translations: Vec<f32>,
    /// e^{jk k̂·(c − c′)} from each of the eight parts of a box: real parts, then imaginary ones.
    shifts: Vec<f64>,
}

impl Multipole {
    /// Computes the near blocks, in parallel over the leaves, and the patterns of a matrix whose
    /// groups of unknowns are at these places (m).
    ///
    /// # Errors
    /// [`CompressionError::Places`], [`CompressionError::NotFinite`] and
    /// [`CompressionError::Setting`] for what does not fit, [`CompressionError::Small`] where
    /// everything is near, [`CompressionError::Memory`] where it takes more than the limit,
    /// [`CompressionError::Interrupted`] where `watch` no longer wants it.
    pub fn new<P: Patterns>(
        patterns: &P,
        places: &[Vec3],
        settings: MultipoleSettings,
        watch: &dyn Watch,
    ) -> Result<Self, CompressionError> {
        let plan = Plan::new(patterns, places, settings)?;
        let summary = plan.summary();
        if summary.bytes > settings.limit {
            return Err(CompressionError::Memory { needed: summary.bytes, limit: settings.limit });
        }
        let directions: Vec<Direction> =
            (0..plan.stages[0].grid.half()).map(|at| plan.stages[0].grid.direction(at)).collect();
        let steps = Steps::new(watch, plan.rows.len() as u64, "boxes");
        let leaf = |at: usize| {
            if steps.begin().is_break() {
                return Err(CompressionError::Interrupted);
            }
            Ok(Leaf::new(patterns, &plan, at, &directions))
        };
        let leaves: Vec<Leaf> =
            (0..plan.rows.len()).into_par_iter().with_max_len(1).map(leaf).collect::<Result<_, _>>()?;
        let mut tables = Vec::with_capacity(plan.stages.len());
        for stage in &plan.stages {
            if watch.go_on().is_break() {
                return Err(CompressionError::Interrupted);
            }
            tables.push(Tables::new(stage, plan.wavenumber, patterns.factor()));
        }
        Ok(Self { plan, summary, arch: Arch::new(), share: patterns.share(), leaves, tables })
    }

    /// What it will be made of, counted.
    ///
    /// # Errors
    /// Those of [`new`](Self::new) for what does not fit.
    pub fn predicted<P: Patterns>(
        patterns: &P,
        places: &[Vec3],
        settings: MultipoleSettings,
    ) -> Result<MultipoleSummary, CompressionError> {
        Ok(Plan::new(patterns, places, settings)?.summary())
    }

    /// What it is made of.
    #[must_use]
    pub fn summary(&self) -> MultipoleSummary {
        self.summary
    }

    /// Bytes that are held between products, counted one by one.
    #[must_use]
    pub fn held_bytes(&self) -> u64 {
        let leaf = |leaf: &Leaf| size_of_val(&leaf.near[..]) + size_of_val(&leaf.patterns[..]);
        let table = |table: &Tables| size_of_val(&table.translations[..]) + size_of_val(&table.shifts[..]);
        let numbers =
            self.leaves.iter().map(leaf).sum::<usize>() + self.tables.iter().map(table).sum::<usize>();
        let interpolations = self.plan.stages.iter().filter_map(|stage| stage.interpolation.as_ref());
        numbers as u64 + interpolations.map(super::interpolation::Interpolation::bytes).sum::<u64>()
    }

    /// What every leaf receives: the fields of all levels, finest last to go.
    fn far(&self, x: &[Complex64]) -> Vec<f64> {
        let stages = &self.plan.stages;
        let mut sent = vec![self.radiated(x)];
        for level in 1..stages.len() {
            sent.push(self.gathered(level, &sent[level - 1]));
        }
        let mut received = Vec::new();
        for level in (0..stages.len()).rev() {
            let own = sent.pop().unwrap_or_default();
            received = self.received(level, &own, &received);
        }
        received
    }

    /// The fields of all leaves.
    fn radiated(&self, x: &[Complex64]) -> Vec<f64> {
        let stage = &self.plan.stages[0];
        let grid = &stage.grid;
        let mut fields = vec![0.0; self.leaves.len() * PLANES * grid.len()];
        fields.par_chunks_mut(PLANES * grid.len()).enumerate().for_each(|(at, field)| {
            let x = &x[self.plan.rows[at].clone()];
            let half = grid.half();
            let mut sums = vec![0.0; 2 * NUMBERS * half];
            self.arch
                .dispatch(|| sum_patterns(&self.leaves[at].patterns, self.plan.numbers * half, x, &mut sums));
            let (re, im) = sums.split_at(NUMBERS * half);
            for k in 0..half {
                let opposite = grid.opposite(k);
                for component in 0..2 {
                    // F = P + jQ in a direction, and P − jQ in the opposite one, where the unit
                    // vector along φ is turned over.
                    let (p, q) = (2 * component * half + k, (2 * component + 1) * half + k);
                    let sign = if component == 0 { 1.0 } else { -1.0 };
                    let plane = 2 * component * grid.len();
                    field[plane + k] = re[p] - im[q];
                    field[plane + grid.len() + k] = im[p] + re[q];
                    field[plane + opposite] = sign * (re[p] + im[q]);
                    field[plane + grid.len() + opposite] = sign * (im[p] - re[q]);
                }
            }
        });
        fields
    }

    /// The fields of the boxes of a level from those of their parts.
    fn gathered(&self, level: usize, parts: &[f64]) -> Vec<f64> {
        let (before, stage) = (&self.plan.stages[level - 1], &self.plan.stages[level]);
        let (size, count) = (PLANES * before.grid.len(), stage.grid.len());
        let mut fields = vec![0.0; stage.parts.len() * PLANES * count];
        let Some(interpolation) = &stage.interpolation else { return fields };
        fields.par_chunks_mut(PLANES * count).enumerate().for_each_init(
            || (Scratch::default(), vec![0.0; PLANES * count]),
            |(scratch, fine), (at, field)| {
                for part in stage.parts[at].clone() {
                    let own = &parts[part * size..(part + 1) * size];
                    let shift = self.tables[level].shift(before.octants[part], count);
                    self.arch.dispatch(|| {
                        interpolation.up(own, scratch, fine);
                        add_product(shift, 1.0, fine, field);
                    });
                }
            },
        );
        fields
    }

    /// What the boxes of a level receive from far ones, and from their parents.
    fn received(&self, level: usize, sent: &[f64], above: &[f64]) -> Vec<f64> {
        let stage = &self.plan.stages[level];
        let count = stage.grid.len();
        let size = PLANES * count;
        let next = self.plan.stages.get(level + 1);
        let wide = next.map_or(0, |next| PLANES * next.grid.len());
        let translations = &self.tables[level].translations;
        let mut fields = vec![0.0; stage.parts.len() * size];
        fields.par_chunks_mut(size).enumerate().for_each_init(
            || (Scratch::default(), vec![0.0; wide]),
            |(scratch, shifted), (at, field)| {
                self.arch.dispatch(|| {
                    for &(source, offset) in &stage.far[at] {
                        let (source, offset) = (source as usize, offset as usize);
                        let table = &translations[2 * offset * count..2 * (offset + 1) * count];
                        translate(table, &sent[source * size..(source + 1) * size], field);
                    }
                });
                if let Some(next) = next
                    && let Some(interpolation) = &next.interpolation
                {
                    let parent = stage.parents[at];
                    let from = &above[parent * wide..(parent + 1) * wide];
                    let shift = self.tables[level + 1].shift(stage.octants[at], next.grid.len());
                    self.arch.dispatch(|| {
                        shifted.fill(0.0);
                        add_product(shift, -1.0, from, shifted);
                        interpolation.add_down(shifted, scratch, field);
                    });
                }
            },
        );
        fields
    }

    /// What the unknowns of a leaf are tested with, from what it receives: factors of the real
    /// numbers of their patterns, real parts, then imaginary ones.
    fn tests(&self, field: &[f64]) -> Vec<f64> {
        let grid = &self.plan.stages[0].grid;
        let (half, count) = (grid.half(), grid.len());
        let numbers = self.plan.numbers * half;
        let mut tests = vec![0.0; 2 * numbers];
        let mut set = |at: usize, value: Complex64| {
            tests[at] = value.re;
            tests[numbers + at] = value.im;
        };
        let j = Complex64::I;
        for k in 0..half {
            let opposite = grid.opposite(k);
            for component in 0..2 {
                let plane = 2 * component * count;
                let sign = if component == 0 { 1.0 } else { -1.0 };
                let value = |at: usize| Complex64::new(field[plane + at], field[plane + count + at]);
                let (here, there) = (value(k), sign * value(opposite));
                let (sum, difference) = (here + there, here - there);
                let at = 2 * component * half + k;
                set(at, self.share * sum);
                set(at + half, -j * self.share * difference);
                if self.plan.numbers > NUMBERS {
                    set(NUMBERS * half + at, difference);
                    set(NUMBERS * half + at + half, j * sum);
                }
            }
        }
        tests
    }

    /// The rows of a leaf, in the order of the tree, as x is.
    fn rows(&self, at: usize, x: &[Complex64], field: &[f64]) -> Vec<Complex64> {
        let leaf = &self.leaves[at];
        let (rows, width) = (self.plan.rows[at].len(), self.plan.width(at));
        let mut near = Vec::with_capacity(2 * width);
        for part in [|x: &Complex64| x.re, |x: &Complex64| x.im] {
            for &source in &self.plan.near[at] {
                near.extend(x[self.plan.rows[source].clone()].iter().map(part));
            }
        }
        let tests = self.tests(field);
        let mut y = vec![Complex64::ZERO; rows];
        let (real, imaginary) = leaf.near.split_at(rows * width);
        let ((near_re, near_im), numbers) = (near.split_at(width), tests.len() / 2);
        let (tests_re, tests_im) = tests.split_at(numbers);
        self.arch.dispatch(|| {
            for (row, y) in y.iter_mut().enumerate() {
                let entries = row * width..(row + 1) * width;
                let [rr, ri] = dots(&real[entries.clone()], near_re, near_im);
                let [ir, ii] = dots(&imaginary[entries], near_re, near_im);
                let pattern = &leaf.patterns[row * numbers..(row + 1) * numbers];
                let [re, im] = dots(pattern, tests_re, tests_im);
                *y = Complex64::new(rr - ii + re, ri + ir + im);
            }
        });
        y
    }
}

impl Leaf {
    fn new<P: Patterns>(patterns: &P, plan: &Plan, at: usize, directions: &[Direction]) -> Self {
        let groups = |leaf: usize| &plan.tree.order[plan.tree.levels[0].cubes[leaf].parts.clone()];
        let others: Vec<usize> = plan.near[at].iter().flat_map(|&source| groups(source)).copied().collect();
        let (rows, width) = (plan.rows[at].len(), plan.width(at));
        let mut entries = vec![Complex64::ZERO; rows * width];
        patterns.fill(&patterns.prepare(groups(at)), &patterns.prepare(&others), &mut entries);
        let real = entries.iter().map(|entry| entry.re as f32);
        let near = real.chain(entries.iter().map(|entry| entry.im as f32)).collect();
        let mut all = vec![0.0; rows * plan.numbers * directions.len()];
        patterns.write(groups(at), plan.tree.centre(0, at), directions, &mut all);
        Self { near, patterns: all }
    }
}

impl Tables {
    fn new(stage: &Stage, k: f64, factor: Complex64) -> Self {
        let count = stage.grid.len();
        let directions: Vec<Vec3> = (0..count).map(|at| stage.grid.direction(at).along).collect();
        let mut translations = vec![0.0; 2 * count * stage.offsets.len()];
        translations.par_chunks_mut(2 * count).zip(&stage.offsets).for_each(|(table, offset)| {
            let shift = Vec3::from_array(offset.map(f64::from)) * stage.side;
            let series = Series::new(stage.degree, k * shift.length());
            let along = shift.normalize();
            for (at, direction) in directions.iter().enumerate() {
                let value = factor * stage.grid.weight(at) * series.at(direction.dot(along));
                (table[at], table[count + at]) = (value.re as f32, value.im as f32);
            }
        });
        let octants = if stage.interpolation.is_some() { 8 } else { 0 };
        let mut shifts = vec![0.0; 2 * count * octants];
        for (octant, table) in shifts.chunks_exact_mut(2 * count).enumerate() {
            // From the middle of the box to that of its part.
            let sign = |axis: usize| if octant >> axis & 1 == 1 { 0.25 } else { -0.25 };
            let shift = Vec3::new(sign(0), sign(1), sign(2)) * stage.side;
            for (at, direction) in directions.iter().enumerate() {
                let (im, re) = (k * direction.dot(shift)).sin_cos();
                (table[at], table[count + at]) = (re, im);
            }
        }
        Self { translations, shifts }
    }

    fn shift(&self, octant: usize, count: usize) -> &[f64] {
        &self.shifts[2 * octant * count..2 * (octant + 1) * count]
    }
}

/// Σ x F of half the directions, of the first numbers of each pattern: real parts, then imaginary
/// ones.
#[inline(always)]
fn sum_patterns(patterns: &[f32], numbers: usize, x: &[Complex64], sums: &mut [f64]) {
    let (re, im) = sums.split_at_mut(sums.len() / 2);
    for (pattern, x) in patterns.chunks_exact(numbers).zip(x) {
        for ((re, im), &value) in re.iter_mut().zip(im.iter_mut()).zip(pattern) {
            *re += x.re * f64::from(value);
            *im += x.im * f64::from(value);
        }
    }
}

/// Adds T S of both components.
#[inline(always)]
fn translate(table: &[f32], sent: &[f64], sum: &mut [f64]) {
    let count = table.len() / 2;
    let (table_re, table_im) = table.split_at(count);
    for (sent, sum) in sent.chunks_exact(2 * count).zip(sum.chunks_exact_mut(2 * count)) {
        let ((sent_re, sent_im), (re, im)) = (sent.split_at(count), sum.split_at_mut(count));
        for k in 0..count {
            let (c, s) = (f64::from(table_re[k]), f64::from(table_im[k]));
            re[k] += c * sent_re[k] - s * sent_im[k];
            im[k] += c * sent_im[k] + s * sent_re[k];
        }
    }
}

/// Adds a field times a shift, or its conjugate with `turn` −1.
#[inline(always)]
fn add_product(shift: &[f64], turn: f64, field: &[f64], sum: &mut [f64]) {
    let count = shift.len() / 2;
    let (shift_re, shift_im) = shift.split_at(count);
    for (field, sum) in field.chunks_exact(2 * count).zip(sum.chunks_exact_mut(2 * count)) {
        let ((field_re, field_im), (re, im)) = (field.split_at(count), sum.split_at_mut(count));
        for k in 0..count {
            let (c, s) = (shift_re[k], turn * shift_im[k]);
            re[k] += c * field_re[k] - s * field_im[k];
            im[k] += c * field_im[k] + s * field_re[k];
        }
    }
}

/// Two dot products with one row.
#[inline(always)]
fn dots(row: &[f32], one: &[f64], other: &[f64]) -> [f64; 2] {
    let mut sums = [[0.0; LANES]; 2];
    let whole = row.len() / LANES * LANES;
    for at in (0..whole).step_by(LANES) {
        let (row, one, other) = (&row[at..at + LANES], &one[at..at + LANES], &other[at..at + LANES]);
        for lane in 0..LANES {
            sums[0][lane] += f64::from(row[lane]) * one[lane];
            sums[1][lane] += f64::from(row[lane]) * other[lane];
        }
    }
    let mut totals = sums.map(|sums| sums.iter().sum::<f64>());
    for at in whole..row.len() {
        totals[0] += f64::from(row[at]) * one[at];
        totals[1] += f64::from(row[at]) * other[at];
    }
    totals
}

impl Diagonal<Complex64> for Multipole {
    fn diagonal_blocks(&self) -> Vec<(Vec<usize>, Vec<Complex64>)> {
        let block = |(at, leaf): (usize, &Leaf)| {
            let (rows, width) = (&self.plan.rows[at], self.plan.width(at));
            let before = self.plan.near[at].iter().take_while(|&&source| source != at);
            let first: usize = before.map(|&source| self.plan.rows[source].len()).sum();
            let (re, im) = leaf.near.split_at(rows.len() * width);
            let entry = |row: usize, column: usize| {
                let at = row * width + first + column;
                Complex64::new(re[at].into(), im[at].into())
            };
            let entries = (0..rows.len()).flat_map(|row| (0..rows.len()).map(move |column| (row, column)));
            (
                self.plan.order[rows.clone()].to_vec(),
                entries.map(|(row, column)| entry(row, column)).collect(),
            )
        };
        self.leaves.iter().enumerate().map(block).collect()
    }
}

impl LinearOperator<Complex64> for Multipole {
    fn dim(&self) -> usize {
        self.plan.order.len()
    }

    fn apply(&self, x: &MultiVector<Complex64>, y: &mut MultiVector<Complex64>) {
        // One after the other, so that the fields of one are held at a time.
        for rhs in 0..x.rhs_count() {
            let sorted: Vec<Complex64> = self.plan.order.iter().map(|&at| x.row(at)[rhs]).collect();
            let fields = self.far(&sorted);
            let size = PLANES * self.plan.stages[0].grid.len();
            let rows = |at: usize| self.rows(at, &sorted, &fields[at * size..(at + 1) * size]);
            let parts: Vec<Vec<Complex64>> = (0..self.leaves.len()).into_par_iter().map(rows).collect();
            for (&at, &value) in self.plan.order.iter().zip(parts.iter().flatten()) {
                y.row_mut(at)[rhs] = value;
            }
        }
    }

    fn entries(&self) -> u64 {
        (self.summary.near + self.summary.patterns) / size_of::<[f32; 2]>() as u64
    }
}
