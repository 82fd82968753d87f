//! The matrix of an equation, entry by entry or block by block.
//!
//! With the integrals T and K of the kernel, every equation here is a sum over media
//!
//! ```text
//! Z_(m,α)(n,β) = s_mα s_nβ Σ_media (t_αβ T_mn + κ_αβ K_mn)  +  ∫ δ_αβ f_m·f_n dA
//! T_mn = jk ∫∫ G [f_m·f_n′ − div f_m div f_n′/k²],   K_mn = ∫∫ f_m·(∇G × f_n′)  or  ∫∫ (f_m × n)·(∇G × f_n′)
//! ```
//!
//! where α and β number the kinds of unknowns of a function (electric and magnetic currents), one
//! or two, δ may differ from triangle to triangle, and s, the unit of an unknown, is 1 but where
//! said. Above a ground plane the first medium, that around the bodies, has the integrals of all
//! functions with the images of all others in. Unknown (n, β) stands at n · kinds + β. T and the first form of K are symmetric.

use crate::pairs::Integrator;
use crate::set::Set;
use crate::{Basis, MomentsError};
use fredholm_compressed::{Entries, Hierarchical, Settings};
use fredholm_linop::{Dense, LinopError, Symmetry, Watch};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Functions of a tile: triangles on the border of two tiles are integrated for both.
const TILE: usize = 192;

/// Functions whose rows are integrated at once for the time that the matrix takes.
const SAMPLED: usize = 16;

/// Factors of kinds of unknowns on kinds of tests.
pub(crate) type Kinds = [[Complex64; 2]; 2];

/// What one medium adds.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub(crate) integrator: Integrator,
    pub(crate) electric: Kinds,
    pub(crate) magnetic: Kinds,
}

/// What the products of functions are multiplied by.
#[derive(Clone, Debug)]
pub(crate) enum Products {
    /// The same everywhere.
    Everywhere(Kinds),
    /// Triangle by triangle.
    OnTriangles(Vec<Kinds>),
}

impl Products {
    fn on(&self, triangle: u32) -> &Kinds {
        match self {
            Self::Everywhere(factors) => factors,
            Self::OnTriangles(factors) => &factors[triangle as usize],
        }
    }
}

/// The entries of an equation on demand.
#[derive(Clone, Debug)]
pub struct Operator<'a> {
    basis: &'a Basis,
    kinds: usize,
    terms: Vec<Term>,
    products: Products,
    symmetry: Symmetry,
    /// Units of the unknowns of the second kind, of every function; all 1 where there are none.
    units: Vec<f64>,
}

impl<'a> Operator<'a> {
    pub(crate) fn new(
        basis: &'a Basis,
        kinds: usize,
        terms: Vec<Term>,
        products: Products,
        symmetry: Symmetry,
    ) -> Self {
        Self { basis, kinds, terms, products, symmetry, units: Vec::new() }
    }

    /// The same with units of the unknowns of the second kind, and of their equations.
    pub(crate) fn with_units(self, units: Vec<f64>) -> Self {
        Self { units, ..self }
    }

    /// The functions.
    #[must_use]
    pub fn basis(&self) -> &'a Basis {
        self.basis
    }

    /// Unknowns for each function.
    #[must_use]
    pub fn kinds(&self) -> usize {
        self.kinds
    }

    /// Number of unknowns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.basis.len() * self.kinds
    }

    /// What is known of the symmetry of the matrix.
    #[must_use]
    pub fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// Prepares functions for [`Operator::fill`].
    #[must_use]
    pub fn prepare(&self, functions: impl Iterator<Item = usize>) -> Set {
        Set::new(self.basis, &self.units, functions)
    }

    /// Writes the entries of all unknowns of some functions, row by row: (rows · kinds) × (columns
    /// · kinds).
    ///
    /// # Panics
    /// Like a slice, where `out` is shorter.
    pub fn fill(&self, rows: &Set, columns: &Set, out: &mut [Complex64]) {
        let stride = columns.len * self.kinds;
        out[..rows.len * self.kinds * stride].fill(Complex64::ZERO);
        for term in &self.terms {
            self.add_term(term, [rows, columns], out, stride);
        }
        // The first medium is that around the bodies.
        if let (Some(outside), Some(images)) = (self.terms.first(), &columns.image) {
            self.add_term(outside, [rows, images], out, stride);
        }
        self.add_products(rows, columns, out, stride);
    }

    /// Adds the integrals of all pairs of functions in one medium.
    fn add_term(&self, term: &Term, [rows, columns]: [&Set; 2], out: &mut [Complex64], stride: usize) {
        term.integrator.each(rows, columns, |row, column, pair| {
            for m in rows.entries(row) {
                for n in columns.entries(column) {
                    let weight = m.weight * n.weight / (4.0 * PI);
                    let value = pair.at(m.corner, n.corner).map(|part| part * weight);
                    let first = (m.at * stride + n.at) * self.kinds;
                    self.add(term, value, [m.units, n.units], &mut out[first..], stride);
                }
            }
        });
    }

    /// Adds the electric and magnetic part of two half functions in one medium.
    fn add(
        &self,
        term: &Term,
        [electric, magnetic]: [Complex64; 2],
        [rows, columns]: [[f64; 2]; 2],
        out: &mut [Complex64],
        stride: usize,
    ) {
        for a in 0..self.kinds {
            for b in 0..self.kinds {
                let value = term.electric[a][b] * electric + term.magnetic[a][b] * magnetic;
                out[a * stride + b] += value * (rows[a] * columns[b]);
            }
        }
    }

    /// Adds the products of functions on common triangles.
    fn add_products(&self, rows: &Set, columns: &Set, out: &mut [Complex64], stride: usize) {
        let ranked = |&triangle: &u32| self.basis.rank(triangle);
        for (row, &triangle) in rows.triangles.iter().enumerate() {
            let factors = self.products.on(triangle);
            if *factors == Kinds::default() {
                continue;
            }
            let found = columns.triangles.binary_search_by_key(&self.basis.rank(triangle), ranked);
            let Ok(column) = found else { continue };
            for m in rows.entries(row) {
                for n in columns.entries(column) {
                    let product = m.weight * n.weight * self.basis.gram(triangle, m.corner, n.corner);
                    let at = (m.at * stride + n.at) * self.kinds;
                    for a in 0..self.kinds {
                        for b in 0..self.kinds {
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
        let all: usize = tiles.iter().map(|tile| tile.triangles.len()).sum();
        let functions = self.basis.len();
        let mut done = 0;
        for sample in 0..samples {
            let first = (2 * sample + 1) * functions / (2 * samples);
            let rows = self.prepare(first..(first + SAMPLED).min(functions));
            let mut block = vec![Complex64::ZERO; rows.len * TILE * self.kinds.pow(2)];
            for tile in &tiles {
                self.fill(&rows, tile, &mut block);
            }
            done += rows.triangles.len();
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

    fn places(&self) -> Vec<Vec3> {
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
        let strips = entries.par_chunks_mut((TILE * self.kinds * dim).max(1)).enumerate().with_max_len(1);
        strips.for_each(|(row, strip)| {
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
        let mut block = vec![Complex64::ZERO; rows.len * TILE * self.kinds.pow(2)];
        for (column, tile) in tiles.iter().enumerate() {
            self.fill(rows, tile, &mut block);
            let width = tile.len * self.kinds;
            let first = column * TILE * self.kinds;
            for (strip, block) in strip.chunks_exact_mut(self.dim()).zip(block.chunks_exact(width)) {
                strip[first..first + width].copy_from_slice(block);
            }
        }
    }
}

impl Entries<Complex64> for Operator<'_> {
    type Set = Set;

    fn groups(&self) -> usize {
        self.basis.len()
    }

    fn width(&self) -> usize {
        self.kinds
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

/// Copies the lower triangle to the upper one.
fn mirror(entries: &mut [Complex64], dim: usize) {
    for i in 0..dim {
        let (above, row) = entries.split_at_mut(i * dim);
        for (j, above) in above.chunks_exact_mut(dim).enumerate() {
            above[i] = row[j];
        }
    }
}
