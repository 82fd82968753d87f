//! What a matrix by multipoles is made of, and how much memory that takes, before any of it is
//! computed.

use super::boxes::{Far, Octree};
use super::grid::Grid;
use super::interpolation::{Interpolation, PLANES};
use super::series::Series;
use super::{NUMBERS, Patterns};
use crate::CompressionError;
use crate::matrix::starts;
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::Range;

/// Tolerances that can be asked for: single precision and the digits that translations lose leave
/// no finer one.
const TOLERANCES: [f64; 2] = [1e-5, 0.1];
/// Sides of leaves in wavelengths: below, translations lose all digits, and above, nearly
/// everything is near.
const SIDES: [f64; 2] = [0.15, 2.0];
/// Distance of typical pairs of points of two boxes from the middles of these, over that of the two
/// that are farthest from them on the line between both. The error falls as a high power of it, so
/// that few pairs matter (docs/notes/moments.md).
const TYPICAL_DISTANCE: f64 = 0.45;
/// The tolerance that degrees are chosen for over that of products: excess bandwidths are those of
/// the largest boxes that could be, with supports all around.
const DEGREE_SHARE: f64 = 10.0;
/// Rounding of what translations lose over the tolerance: errors of some hundred directions largely
/// cancel.
const ROUNDING_SHARE: f64 = 10.0;
/// The number in the excess bandwidth formula.
pub(crate) const EXCESS: f64 = 1.8;
/// Rounding of what is stored.
const ROUNDING: f64 = 6e-8;
/// Error of interpolations over the tolerance.
const INTERPOLATION_SHARE: f64 = 0.03;

/// The highest degree: beyond it, the tables of a level alone take gigabytes.
const MOST_DEGREE: usize = 1200;
/// Most leaves along an axis: their numbers have 21 bits.
const MOST_LEAVES: f64 = 1e6;

/// How a matrix is taken to multipoles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultipoleSettings {
    /// Relative error of products, between 1e-5 and 0.1.
    pub tolerance: f64,
    /// Side of the smallest boxes in wavelengths, between 0.15 and 2.
    pub leaf: f64,
    /// Most bytes.
    pub limit: u64,
}

impl Default for MultipoleSettings {
    fn default() -> Self {
        Self { tolerance: 1e-3, leaf: 0.3, limit: u64::MAX }
    }
}

/// What a matrix by multipoles is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultipoleSummary {
    /// Levels with translations.
    pub levels: usize,
    /// Boxes of the finest.
    pub leaves: usize,
    /// Directions of the finest and of the coarsest level.
    pub directions: [usize; 2],
    /// Bytes of the near blocks.
    pub near: u64,
    /// Bytes of the patterns of all unknowns.
    pub patterns: u64,
    /// Bytes of translations, interpolations and shifts.
    pub tables: u64,
    /// Bytes of the fields of all boxes during a product with one vector.
    pub fields: u64,
    /// All of them together.
    pub bytes: u64,
    /// Bytes of the inverses of the blocks on the diagonal, where these precondition.
    pub diagonal: u64,
    /// Bytes over those of the matrix stored whole in double precision.
    pub share: f64,
}

/// A level with translations.
pub(crate) struct Stage {
    pub(crate) grid: Grid,
    pub(crate) degree: usize,
    /// Parts of the boxes: boxes of the level before, or leaves.
    pub(crate) parts: Vec<Range<usize>>,
    /// For every box the boxes that are far and the number of the offset to each.
    pub(crate) far: Vec<Vec<(u32, u32)>>,
    /// From the source to the target, in boxes.
    pub(crate) offsets: Vec<[i32; 3]>,
    /// m.
    pub(crate) side: f64,
    /// From the level before.
    pub(crate) interpolation: Option<Interpolation>,
    /// Which of the eight parts of its parent every box of the level is.
    pub(crate) octants: Vec<usize>,
    /// Of every box, its parent; 0 at the last level.
    pub(crate) parents: Vec<usize>,
}

/// Everything but the numbers.
pub(crate) struct Plan {
    pub(crate) tree: Octree,
    /// Near leaves of every leaf.
    pub(crate) near: Vec<Vec<usize>>,
    pub(crate) stages: Vec<Stage>,
    /// Unknowns of each leaf, in the order of the tree.
    pub(crate) rows: Vec<Range<usize>>,
    /// Unknowns in the order of the tree.
    pub(crate) order: Vec<usize>,
    /// Planes of numbers of an unknown over those of half a pattern.
    pub(crate) numbers: usize,
    pub(crate) wavenumber: f64,
}

/// The excess bandwidth formula: the degree up to which e^{jkd…} is expanded (Song, Lu, Chew 1997;
/// Chew et al. 2001, eq. 3.47).
fn degree(kd: f64, tolerance: f64) -> f64 {
    let digits = -tolerance.log10();
    kd + EXCESS * digits.powf(2.0 / 3.0) * kd.cbrt()
}

fn check<P: Patterns>(
    patterns: &P,
    places: &[Vec3],
    settings: MultipoleSettings,
) -> Result<(), CompressionError> {
    if places.len() != patterns.groups() {
        return Err(CompressionError::Places { expected: patterns.groups(), found: places.len() });
    }
    if let Some(group) = places.iter().position(|place| !place.is_finite()) {
        return Err(CompressionError::NotFinite { group });
    }
    let within = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
    let refuse = |what, value, expected| Err(CompressionError::Setting { what, value, expected });
    if !within(TOLERANCES, settings.tolerance) {
        return refuse("the tolerance of the multipoles", settings.tolerance, "between 1e-5 and 0.1");
    }
    if !within(SIDES, settings.leaf) {
        return refuse("the side of the smallest boxes in wavelengths", settings.leaf, "between 0.15 and 2");
    }
    Ok(())
}

impl Plan {
    pub(crate) fn new<P: Patterns>(
        patterns: &P,
        places: &[Vec3],
        settings: MultipoleSettings,
    ) -> Result<Self, CompressionError> {
        check(patterns, places, settings)?;
        let (k, tolerance) = (patterns.wavenumber(), settings.tolerance);
        let side = settings.leaf * TAU / k;
        let low = places.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = places.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let across = (high - low).max_element() / side;
        if across > MOST_LEAVES {
            return Err(CompressionError::Large { across });
        }
        let radii: Vec<f64> = (0..places.len()).map(|group| patterns.radius(group)).collect();
        let tree = Octree::new(places, &radii, side);
        let largest =
            |level: usize| tree.levels[level].cubes.iter().map(|cube| cube.radius).fold(0.0, f64::max);
        let degrees: Vec<usize> = (0..tree.levels.len())
            .map(|level| {
                degree(2.0 * k * largest(level), (DEGREE_SHARE * tolerance).min(0.5)).ceil() as usize
            })
            .collect();
        let reach = |level: usize, square: u32| {
            let distance = k * tree.levels[level].side * f64::from(square).sqrt();
            if square == 0 {
                return -1.0;
            }
            let series = Series::new(degrees[level], distance);
            if series.growth() * ROUNDING > ROUNDING_SHARE * tolerance {
                return -1.0;
            }
            (series.reach(tolerance) / TYPICAL_DISTANCE).min(distance) / k
        };
        let (far, near) = tree.pairs(reach);
        let Some(last) = far.iter().rposition(|far| far.sources.iter().any(|list| !list.is_empty())) else {
            return Err(CompressionError::Small { boxes: tree.levels[0].cubes.len() });
        };
        if degrees[last] > MOST_DEGREE {
            return Err(CompressionError::Large { across });
        }
        let mut stages: Vec<Stage> = Vec::with_capacity(last + 1);
        for (level, far) in far.iter().enumerate().take(last + 1) {
            let grid = Grid::new(degrees[level]);
            let interpolation = stages.last().map(|coarse: &Stage| {
                let kr = k * largest(level - 1);
                Interpolation::new(&coarse.grid, &grid, kr, INTERPOLATION_SHARE * tolerance)
            });
            stages.push(Stage::new(
                &tree,
                (level, level == last),
                far,
                (grid, degrees[level]),
                interpolation,
            ));
        }
        let starts_of = starts(patterns, tree.order.iter().copied());
        let rows: Vec<Range<usize>> = tree.levels[0]
            .cubes
            .iter()
            .map(|cube| starts_of[cube.parts.start]..starts_of[cube.parts.end])
            .collect();
        let given = starts(patterns, 0..patterns.groups());
        let order = tree.order.iter().flat_map(|&group| given[group]..given[group + 1]).collect();
        let numbers = NUMBERS * if patterns.has_magnetic() { 2 } else { 1 };
        Ok(Self { tree, near, stages, rows, order, numbers, wavenumber: k })
    }

    /// The unknowns of the near leaves of a leaf.
    pub(crate) fn width(&self, leaf: usize) -> usize {
        self.near[leaf].iter().map(|&source| self.rows[source].len()).sum()
    }

    pub(crate) fn summary(&self) -> MultipoleSummary {
        let near: usize = (0..self.rows.len()).map(|leaf| self.rows[leaf].len() * self.width(leaf)).sum();
        let dim = self.order.len();
        let patterns = dim * self.numbers * self.stages[0].grid.half();
        let of = |stage: &Stage| (stage.grid.len() * PLANES * stage.parts.len() * size_of::<f64>()) as u64;
        // All that is sent, and what is received at a level and the next.
        let sent: u64 = self.stages.iter().map(of).sum();
        let received = (0..self.stages.len())
            .map(|at| of(&self.stages[at]) + self.stages.get(at + 1).map_or(0, of))
            .max()
            .unwrap_or(0);
        let [near, patterns] =
            [near * size_of::<[f32; 2]>(), patterns * size_of::<f32>()].map(|bytes| bytes as u64);
        let tables = self.stages.iter().map(Stage::bytes).sum();
        let fields = sent + received;
        let bytes = near + patterns + tables + fields;
        MultipoleSummary {
            levels: self.stages.len(),
            leaves: self.rows.len(),
            directions: [0, self.stages.len() - 1].map(|at| self.stages[at].grid.len()),
            near,
            patterns,
            tables,
            fields,
            bytes,
            diagonal: self.rows.iter().map(|rows| (rows.len().pow(2) * size_of::<Complex64>()) as u64).sum(),
            share: bytes as f64 / (dim as f64).powi(2) / size_of::<Complex64>() as f64,
        }
    }
}

impl Stage {
    fn new(
        tree: &Octree,
        (level, is_last): (usize, bool),
        far: &Far,
        (grid, degree): (Grid, usize),
        interpolation: Option<Interpolation>,
    ) -> Self {
        let cubes = &tree.levels[level].cubes;
        let mut numbers: BTreeMap<[i32; 3], u32> = BTreeMap::new();
        let offset = |target: usize, source: usize| -> [i32; 3] {
            let [a, b] = [target, source].map(|at| cubes[at].cell.map(|c| c as i32));
            std::array::from_fn(|axis| a[axis] - b[axis])
        };
        for (target, sources) in far.sources.iter().enumerate() {
            for &source in sources {
                numbers.insert(offset(target, source), 0);
            }
        }
        numbers.values_mut().zip(0..).for_each(|(number, at)| *number = at);
        let with_numbers = |(target, sources): (usize, &Vec<usize>)| -> Vec<(u32, u32)> {
            sources.iter().map(|&source| (source as u32, numbers[&offset(target, source)])).collect()
        };
        let mut parents = vec![0; cubes.len()];
        if !is_last {
            for (parent, cube) in tree.levels[level + 1].cubes.iter().enumerate() {
                parents[cube.parts.clone()].fill(parent);
            }
        }
        let octant = |cell: [u32; 3]| (0..3).map(|axis| ((cell[axis] & 1) << axis) as usize).sum();
        Self {
            degree,
            parts: cubes.iter().map(|cube| cube.parts.clone()).collect(),
            far: far.sources.iter().enumerate().map(with_numbers).collect(),
            offsets: numbers.keys().copied().collect(),
            side: tree.levels[level].side,
            interpolation,
            octants: cubes.iter().map(|cube| octant(cube.cell)).collect(),
            parents,
            grid,
        }
    }

    /// Bytes of its tables: translations in single precision, shifts of eight parts in double.
    fn bytes(&self) -> u64 {
        let translations = self.offsets.len() * self.grid.len() * size_of::<[f32; 2]>();
        let shifts = self.interpolation.as_ref().map_or(0, |_| 8 * self.grid.len() * size_of::<[f64; 2]>());
        (translations + shifts) as u64 + self.interpolation.as_ref().map_or(0, Interpolation::bytes)
    }
}
