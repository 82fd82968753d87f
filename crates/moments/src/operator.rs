//! The matrix of an equation, entry by entry or block by block.
//!
//! With the integrals T and K of the kernel, every equation here is a sum over media
//!
//! ```text
//! Z_(m,α)(n,β) = s_mα s_nβ Σ_regions (t_αβ T_mn + κ_αβ K_mn)  +  ∫ δ_αβ f_m·f_n dA
//! T_mn = jk ∫∫ G [f_m·f_n′ − div f_m div f_n′/k²],   K_mn = ∫∫ f_m·(∇G × f_n′)  or  ∫∫ (f_m × n)·(∇G × f_n′)
//! ```
//!
//! where α and β number the kinds of unknowns of a function (electric and magnetic currents), one
//! or two, δ may differ from triangle to triangle, and s, the unit of an unknown, is 1 but where
//! said. T and K of a region are those of the halves that the functions have in it, in its medium.
//! Above a ground plane region 0, that around the bodies, has the integrals of all functions with
//! the images of all others in. The unknowns of a function follow each other. T and the first form
//! of K are symmetric.

use crate::dual::{PARTS, turned_gram};
use crate::element_kernel::Tests;
use crate::element_pairs::ElementIntegrator;
use crate::kernel::{Medium, Wanted};
use crate::pairs::Integrator;
use crate::rules::Rules;
use crate::set::{Entry, Halves, Set};
use crate::{Basis, MomentsError, Order};
use fredholm_compressed::{Entries, Hierarchical, Settings};
use fredholm_linop::{Dense, LinopError, Symmetry, Watch};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use pulp::Arch;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// Functions of a tile: triangles on the border of two tiles are integrated for both.
const TILE: usize = 192;

/// Functions whose rows are integrated at once for the time that the matrix takes.
const SAMPLED: usize = 16;

/// Factors of kinds of unknowns on kinds of tests.
pub(crate) type Factors = [[Complex64; 2]; 2];

/// The unknowns of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kinds {
    /// One, or two with a magnetic current.
    pub(crate) count: usize,
    /// The unit of the second.
    pub(crate) unit: f64,
}

impl Kinds {
    /// An electric current alone.
    pub(crate) const ELECTRIC: Self = Self { count: 1, unit: 1.0 };
    /// Both, in the same unit.
    pub(crate) const BOTH: Self = Self { count: 2, unit: 1.0 };
}

/// What integrates pairs of triangles, with functions of either order.
#[derive(Clone, Debug)]
pub(crate) enum Integrals {
    Lowest(Integrator),
    First(ElementIntegrator),
}

impl Integrals {
    /// To a relative `tolerance` of a pair, in a medium with the wavenumber k (1/m).
    pub(crate) fn new(
        order: Order,
        k: Complex64,
        (wanted, tests): (Wanted, Tests),
        tolerance: f64,
    ) -> Result<Self, MomentsError> {
        let (medium, arch) = (Medium::new(k), Arch::new());
        Ok(match order {
            Order::Lowest => {
                let rules = Rules::new(tolerance, k, wanted.magnetic)?;
                Self::Lowest(Integrator { medium, wanted, rules, arch, observers_cut: false })
            }
            Order::First => {
                let rules = Rules::of_first_order(tolerance, k, wanted.magnetic)?;
                Self::First(ElementIntegrator { medium, wanted, tests, rules, arch })
            }
        })
    }
}

/// What one region adds.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub(crate) integrals: Integrals,
    pub(crate) electric: Factors,
    pub(crate) magnetic: Factors,
}

/// What the products of functions are multiplied by.
#[derive(Clone, Debug)]
pub(crate) enum Products {
    /// The same everywhere.
    Everywhere(Factors),
    /// Triangle by triangle.
    OnTriangles(Vec<Factors>),
}

impl Products {
    fn on(&self, triangle: u32) -> &Factors {
        match self {
            Self::Everywhere(factors) => factors,
            Self::OnTriangles(factors) => &factors[triangle as usize],
        }
    }
}

/// What dual functions (`dual`) test: the magnetic part of electric currents, and products.
#[derive(Clone, Debug)]
pub(crate) struct DualPart {
    /// In the order of the functions.
    pub(crate) basis: Arc<Basis>,
    pub(crate) integrator: Integrator,
    /// Of ∫∫ g·(∇G × f′).
    pub(crate) magnetic: f64,
    /// Of ∫ (n × g)·f dA.
    pub(crate) product: f64,
}

/// The entries of an equation on demand.
#[derive(Clone, Debug)]
pub struct Operator<'a> {
    basis: &'a Basis,
    /// What dual functions test besides.
    dual: Option<DualPart>,
    /// Of every function.
    kinds: Vec<Kinds>,
    /// The first unknown of every function, and their number.
    starts: Vec<usize>,
    /// Of every region.
    terms: Vec<Term>,
    products: Products,
    symmetry: Symmetry,
}

impl<'a> Operator<'a> {
    pub(crate) fn new(
        basis: &'a Basis,
        kinds: Vec<Kinds>,
        terms: Vec<Term>,
        products: Products,
        symmetry: Symmetry,
    ) -> Self {
        let mut end = 0;
        let ends = kinds.iter().map(|kinds| {
            end += kinds.count;
            end
        });
        let starts = std::iter::once(0).chain(ends).collect();
        Self { basis, dual: None, kinds, starts, terms, products, symmetry }
    }

    /// The same with what dual functions test in the region around the bodies, where all currents
    /// are electric.
    pub(crate) fn with_dual(self, dual: DualPart) -> Self {
        Self { dual: Some(dual), ..self }
    }

    /// What dual functions test besides.
    pub(crate) fn dual(&self) -> Option<&DualPart> {
        self.dual.as_ref()
    }

    /// The functions.
    #[must_use]
    pub fn basis(&self) -> &'a Basis {
        self.basis
    }

    /// Number of unknowns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.starts[self.basis.len()]
    }

    /// The unknowns of every function: one of the electric and, where there is one, one of the
    /// magnetic current.
    pub(crate) fn unknowns(&self) -> impl Iterator<Item = (usize, Option<(usize, f64)>)> {
        let of = |(kinds, &first): (&Kinds, &usize)| {
            (first, (kinds.count == 2).then_some((first + 1, kinds.unit)))
        };
        self.kinds.iter().zip(&self.starts).map(of)
    }

    /// What is known of the symmetry of the matrix.
    #[must_use]
    pub fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// Prepares functions for [`Operator::fill`].
    #[must_use]
    pub fn prepare(&self, functions: impl Iterator<Item = usize> + Clone) -> Set {
        // Dual functions are in the region around the bodies.
        let regions = self.terms.len().max(1);
        let dual = self.dual().map(|dual| Set::new(&dual.basis, &self.kinds, regions, functions.clone()));
        Set { dual: dual.map(Box::new), ..Set::new(self.basis, &self.kinds, regions, functions) }
    }

    /// Writes the entries of all unknowns of some functions, row by row.
    ///
    /// # Panics
    /// Like a slice, where `out` is shorter.
    pub fn fill(&self, rows: &Set, columns: &Set, out: &mut [Complex64]) {
        let stride = columns.len;
        out[..rows.len * stride].fill(Complex64::ZERO);
        for (term, (rows, columns)) in self.terms.iter().zip(rows.regions.iter().zip(&columns.regions)) {
            add_term(term, [rows, columns], out, stride);
            if let Some(images) = &columns.image {
                add_term(term, [rows, images], out, stride);
            }
        }
        let Some(outer) = columns.regions.first() else { return };
        if let Some(rows) = rows.regions.first() {
            self.add_products(rows, outer, out, stride);
        }
        let filled = &mut out[..rows.len * stride];
        let tests = rows.dual.as_ref().and_then(|tests| tests.regions.first());
        if let (Some(dual), Some(rows)) = (&self.dual, tests) {
            self.add_dual(dual, rows, outer, filled, stride);
        }
    }

    /// Adds what dual functions test. Every small triangle has halves of a dozen of them, so that
    /// what its three corners see of every function is summed first.
    fn add_dual(
        &self,
        dual: &DualPart,
        rows: &Halves,
        columns: &Halves,
        out: &mut [Complex64],
        stride: usize,
    ) {
        // One line for every unknown, three corners a triangle.
        let line = 3 * rows.triangles.len();
        let mut seen = vec![Complex64::ZERO; line * stride];
        let mut add = |columns: &Halves| {
            let factor = dual.magnetic / (4.0 * PI);
            dual.integrator.each(rows, columns, |row, column, pair| {
                for n in columns.entries(column) {
                    let weight = factor * n.weight * n.units[0];
                    let seen = &mut seen[n.at * line + 3 * row..][..3];
                    for (corner, seen) in seen.iter_mut().enumerate() {
                        *seen += pair.magnetic[3 * corner + n.number] * weight;
                    }
                }
            });
        };
        add(columns);
        if let Some(images) = &columns.image {
            add(images);
        }
        let ranked = |&triangle: &u32| self.basis.rank(triangle);
        let [cut, whole] = [&*dual.basis, self.basis].map(Basis::surface);
        for (row, &part) in rows.triangles.iter().enumerate() {
            let rank = self.basis.rank(part / PARTS as u32);
            let Ok(column) = columns.triangles.binary_search_by_key(&rank, ranked) else { continue };
            for n in columns.entries(column) {
                for corner in 0..3 {
                    let gram = turned_gram(cut, part, whole, [corner, n.number]);
                    seen[n.at * line + 3 * row + corner] += dual.product * n.weight * gram;
                }
            }
        }
        let mut tested = vec![Complex64::ZERO; out.len() / stride.max(1)];
        for (n, seen) in seen.chunks_exact(line.max(1)).enumerate() {
            tested.fill(Complex64::ZERO);
            for (row, seen) in seen.chunks_exact(3).enumerate() {
                for m in rows.entries(row) {
                    tested[m.at] += seen[m.number] * m.weight;
                }
            }
            out.iter_mut().skip(n).step_by(stride).zip(&tested).for_each(|(sum, tested)| *sum += tested);
        }
    }

    /// Adds the products of functions on common triangles.
    fn add_products(&self, rows: &Halves, columns: &Halves, out: &mut [Complex64], stride: usize) {
        let ranked = |&triangle: &u32| self.basis.rank(triangle);
        for (row, &triangle) in rows.triangles.iter().enumerate() {
            let factors = self.products.on(triangle);
            if *factors == Factors::default() {
                continue;
            }
            let found = columns.triangles.binary_search_by_key(&self.basis.rank(triangle), ranked);
            let Ok(column) = found else { continue };
            let products = self.basis.surface().element(triangle as usize).products();
            for m in rows.entries(row) {
                for n in columns.entries(column) {
                    let product = m.weight * n.weight * products[m.number][n.number];
                    let at = m.at * stride + n.at;
                    for a in 0..m.kinds {
                        for b in 0..n.kinds {
                            out[at + a * stride + b] += factors[a][b] * product;
                        }
                    }
                }
            }
        }
    }

    /// Bytes of the stored matrix.
    #[must_use]
    pub fn dense_bytes(&self) -> u64 {
        Dense::<Complex64>::bytes(self.dim())
    }

    /// The matrix Z, in parallel over fixed tiles; of a symmetric one only half is integrated.
    ///
    /// # Errors
    /// [`MomentsError::Linop`] where it does not fit in memory.
    pub fn dense(&self) -> Result<Dense<Complex64>, MomentsError> {
        Ok(Dense::new(self.dim(), self.entries()?)?.with_symmetry(self.symmetry)?)
    }

    /// K = 1 − Z, so that [`SecondKind`](fredholm_linop::SecondKind) with the factor 1 is Z.
    ///
    /// # Errors
    /// [`MomentsError::Linop`] where it does not fit in memory.
    pub fn coupling(&self) -> Result<Dense<Complex64>, MomentsError> {
        let mut entries = self.entries()?;
        for entry in &mut entries {
            *entry = -*entry;
        }
        for diagonal in entries.iter_mut().step_by(self.dim() + 1) {
            *diagonal += 1.0;
        }
        Ok(Dense::new(self.dim(), entries)?.with_symmetry(self.symmetry)?)
    }

    /// Integrates the entries of some rows at a time, spread evenly, and forgets them: returns the
    /// share of the work of [`dense`](Self::dense) that this was, so that its time can be told
    /// before it is spent.
    #[must_use]
    pub fn sample(&self, samples: usize) -> f64 {
        let tiles = self.tiles();
        let all: usize =
            tiles.iter().map(|row| tiles.iter().map(|tile| pairs(row, tile)).sum::<usize>()).sum();
        let functions = self.basis.len();
        let mut done = 0;
        for sample in 0..samples {
            let first = (2 * sample + 1) * functions / (2 * samples);
            let rows = self.prepare(first..(first + SAMPLED).min(functions));
            let mut block = vec![Complex64::ZERO; rows.len * widest(&tiles)];
            for tile in &tiles {
                self.fill(&rows, tile, &mut block);
                done += pairs(&rows, tile);
            }
        }
        let (count, symmetric) = (tiles.len() as f64, self.symmetry == Symmetry::Symmetric);
        let part = if symmetric { (count + 1.0) / (2.0 * count) } else { 1.0 };
        done as f64 / (part * all as f64)
    }

    /// The functions in the tiles that the matrix is integrated by.
    fn tiles(&self) -> Vec<Set> {
        let tile = |first: usize| self.prepare(first..(first + TILE).min(self.basis.len()));
        (0..self.basis.len()).step_by(TILE).map(tile).collect()
    }

    /// The matrix Z compressed, block by block.
    ///
    /// # Errors
    /// [`MomentsError::Compression`] for settings out of range, where it is predicted to take more
    /// than the limit, and where `watch` no longer wants it.
    pub fn compressed(
        &self,
        settings: Settings,
        watch: &dyn Watch,
    ) -> Result<Hierarchical<Complex64>, MomentsError> {
        Ok(Hierarchical::new(self, &self.places(), settings, watch)?)
    }

    /// Bytes that the compressed matrix will take, from some of its blocks.
    ///
    /// # Errors
    /// [`MomentsError::Compression`] for settings out of range.
    pub fn compressed_bytes(&self, settings: Settings) -> Result<u64, MomentsError> {
        Ok(Hierarchical::predicted_bytes(self, &self.places(), settings)?)
    }

    /// The rules of what the functions themselves test around the bodies.
    pub(crate) fn rules(&self) -> Option<&Rules> {
        self.terms.first().map(|term| match &term.integrals {
            Integrals::Lowest(integrator) => &integrator.rules,
            Integrals::First(integrator) => &integrator.rules,
        })
    }

    pub(crate) fn places(&self) -> Vec<Vec3> {
        (0..self.basis.len()).map(|function| self.basis.centre(function)).collect()
    }

    /// The entries of Z, row by row.
    fn entries(&self) -> Result<Vec<Complex64>, MomentsError> {
        let dim = self.dim();
        let refused = LinopError::Memory { what: "the matrix of the currents", bytes: self.dense_bytes() };
        let length = dim.checked_mul(dim).ok_or_else(|| refused.clone())?;
        let mut entries = Vec::new();
        entries.try_reserve_exact(length).map_err(|_| refused)?;
        entries.resize(length, Complex64::ZERO);
        let tiles = self.tiles();
        let symmetric = self.symmetry == Symmetry::Symmetric;
        let mut strips = Vec::with_capacity(tiles.len());
        let mut rest = &mut entries[..];
        for tile in &tiles {
            let (strip, others) = rest.split_at_mut(tile.len * dim);
            strips.push(strip);
            rest = others;
        }
        strips.into_par_iter().enumerate().with_max_len(1).for_each(|(row, strip)| {
            let last = if symmetric { row + 1 } else { tiles.len() };
            self.fill_strip(&tiles[row], &tiles[..last], strip);
        });
        if symmetric {
            mirror(&mut entries, dim);
        }
        Ok(entries)
    }

    /// Writes the first tiles of some rows.
    fn fill_strip(&self, rows: &Set, tiles: &[Set], strip: &mut [Complex64]) {
        let mut block = vec![Complex64::ZERO; rows.len * widest(tiles)];
        let mut first = 0;
        for tile in tiles {
            self.fill(rows, tile, &mut block);
            for (strip, block) in strip.chunks_exact_mut(self.dim()).zip(block.chunks_exact(tile.len)) {
                strip[first..first + tile.len].copy_from_slice(block);
            }
            first += tile.len;
        }
    }
}

impl Entries<Complex64> for Operator<'_> {
    type Set = Set;

    fn groups(&self) -> usize {
        self.basis.len()
    }

    fn width(&self, group: usize) -> usize {
        self.kinds[group].count
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    fn prepare(&self, groups: &[usize]) -> Set {
        Operator::prepare(self, groups.iter().copied())
    }

    fn fill(&self, rows: &Set, columns: &Set, out: &mut [Complex64]) {
        Operator::fill(self, rows, columns, out);
    }
}

/// Adds the integrals of all pairs of halves of functions in one region.
fn add_term(term: &Term, [rows, columns]: [&Halves; 2], out: &mut [Complex64], stride: usize) {
    match &term.integrals {
        Integrals::Lowest(integrator) => integrator.each(rows, columns, |row, column, pair| {
            let halves = [rows.entries(row), columns.entries(column)];
            add_pair(term, halves, |a, b| pair.at(a, b), out, stride);
        }),
        Integrals::First(integrator) => integrator.each(rows, columns, |row, column, pair| {
            let halves = [rows.entries(row), columns.entries(column)];
            add_pair(term, halves, |a, b| pair.at(a, b), out, stride);
        }),
    }
}

/// Adds the integrals of all halves on a pair of triangles.
fn add_pair(
    term: &Term,
    [rows, columns]: [&[Entry]; 2],
    pair: impl Fn(usize, usize) -> [Complex64; 2],
    out: &mut [Complex64],
    stride: usize,
) {
    for m in rows {
        for n in columns {
            let weight = m.weight * n.weight / (4.0 * PI);
            let [electric, magnetic] = pair(m.number, n.number).map(|part| part * weight);
            let out = &mut out[m.at * stride + n.at..];
            for a in 0..m.kinds {
                for b in 0..n.kinds {
                    let value = term.electric[a][b] * electric + term.magnetic[a][b] * magnetic;
                    out[a * stride + b] += value * (m.units[a] * n.units[b]);
                }
            }
        }
    }
}

/// Pairs of triangles of two sets in all regions.
fn pairs(rows: &Set, columns: &Set) -> usize {
    let count = |(a, b): (&Halves, &Halves)| a.triangles.len() * b.triangles.len();
    let of = |rows: &Set| rows.regions.iter().zip(&columns.regions).map(count).sum::<usize>();
    of(rows) + rows.dual.as_deref().map_or(0, of)
}

/// The largest number of unknowns of a tile.
fn widest(tiles: &[Set]) -> usize {
    tiles.iter().map(|tile| tile.len).max().unwrap_or(0)
}

/// Copies the lower triangle to the upper one.
fn mirror(entries: &mut [Complex64], dim: usize) {
    for i in 0..dim {
        let (above, row) = entries.split_at_mut(i * dim);
        for (j, above) in above.chunks_exact_mut(dim).enumerate() {
            above[i] = row[j];
        }
    }
}
