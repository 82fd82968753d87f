//! Which patch of a fine mesh lies at a point of a coarse one.
//!
//! Rays are traced against the undivided pieces of the geometry, which are few; each piece has a
//! grid of the patches in its plane. At a border the patch is taken that the point is deepest
//! inside of.

use std::collections::{BTreeMap, HashMap};
use std::ops::RangeInclusive;

use fredholm_mesh::{Patch, Vec3};

/// Lengths, over the longest of the scene, up to which two places count as one.
const SAME_PLACE_DISTANCE: f64 = 1e-7;
/// Cells of a grid along the side of a patch: so many that most cells lie within one patch.
const CELLS_OF_A_PATCH: usize = 4;
/// Cells along the side of a regular grid, at most.
const MOST_CELLS_ALONG: f64 = 4096.0;

/// The patches of every piece.
#[derive(Clone, Debug)]
pub(crate) struct Locator {
    pieces: Vec<Grid>,
    /// Length up to which two places count as one, m.
    near: f64,
}

/// Patches of one plane, in cells of equal size.
#[derive(Clone, Debug)]
struct Grid {
    normal: Vec3,
    corner: Vec3,
    /// Along the sides of the grid, and as long as it has cells a metre.
    axes: [Vec3; 2],
    /// Number of rows, and of cells in a row.
    sides: [usize; 2],
    /// Whether every patch fills one cell, so that none need be asked whether it holds a point.
    regular: bool,
    /// Where the candidates of each cell begin, and where those of the last end.
    starts: Vec<u32>,
    candidates: Vec<Candidate>,
}

/// A patch, and whether it is lit from the side of the piece.
#[derive(Clone, Copy, Debug)]
struct Candidate(u32);

impl Candidate {
    fn new(patch: u32, along: bool) -> Self {
        Self(patch << 1 | u32::from(along))
    }

    fn patch(self) -> usize {
        (self.0 >> 1) as usize
    }

    fn along(self) -> bool {
        self.0 & 1 == 1
    }
}

impl Locator {
    /// For fewer than 2³¹ patches.
    pub(crate) fn new(pieces: &[Patch], patches: &[Patch]) -> Self {
        let near = same_place(pieces.iter().chain(patches));
        let sorted = Sorted::new(patches, near);
        let grid = |piece: &Patch| Grid::new(piece, &sorted, patches, near);
        Self { pieces: pieces.iter().map(grid).collect(), near }
    }

    /// The patch at a point of a piece that turns its lit side to a ray of this direction.
    pub(crate) fn lit(&self, piece: usize, point: Vec3, direction: Vec3, patches: &[Patch]) -> Option<usize> {
        let grid = &self.pieces[piece];
        let along = grid.normal.dot(direction) < 0.0;
        let lit = |&&candidate: &&Candidate| candidate.along() == along;
        let cell = grid.cell(point);
        if let [only] = cell {
            return lit(&only).then_some(only.patch());
        }
        let candidates = || cell.iter().filter(lit).map(|candidate| candidate.patch());
        if grid.regular {
            return candidates().next();
        }
        if let Some(found) = candidates().find(|&patch| holds(&patches[patch], point)) {
            return Some(found);
        }
        // On a border; or on the back of a patch beside which another one is lit from here.
        let deep = candidates().map(|patch| (depth(&patches[patch], point), patch));
        let deepest = deep.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        deepest.filter(|(depth, _)| *depth >= -self.near).map(|(_, patch)| patch)
    }
}

/// Patches in the cells of grids, each in that whose cells are about as wide as it is long, so that
/// those near a piece are found without a look at all.
struct Sorted {
    near: f64,
    grids: Vec<Cells>,
}

/// Cells of equal width, with the patches that begin in each.
struct Cells {
    /// Width, m.
    width: f64,
    members: HashMap<[i64; 3], Vec<u32>>,
    /// How many patches there are.
    count: usize,
}

impl Sorted {
    fn new(patches: &[Patch], near: f64) -> Self {
        let mut classes: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
        for (patch, number) in patches.iter().zip(0..) {
            let (low, high) = bounds(patch);
            let longest = (high - low).max_element().max(near).max(f64::MIN_POSITIVE);
            classes.entry(longest.log2().ceil() as i32).or_default().push(number);
        }
        let grid = |(class, members): (i32, Vec<u32>)| {
            let width = f64::from(class).exp2();
            let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
            for &number in &members {
                cells.entry(cell(bounds(&patches[number as usize]).0, width)).or_default().push(number);
            }
            Cells { width, members: cells, count: members.len() }
        };
        Self { near, grids: classes.into_iter().map(grid).collect() }
    }

    /// The patches that may lie on a piece.
    fn near(&self, piece: &Patch) -> Vec<u32> {
        let (low, high) = bounds(piece);
        let mut found = Vec::new();
        for Cells { width, members: cells, count } in &self.grids {
            // A patch begins in a cell and ends in this or the next one.
            let first = cell(low - Vec3::splat(self.near + width), *width);
            let last = cell(high + Vec3::splat(self.near), *width);
            let many = (0..3).map(|i| (last[i] - first[i] + 1) as f64).product::<f64>() > *count as f64;
            if many {
                let inside = |at: &[i64; 3]| (0..3).all(|i| (first[i]..=last[i]).contains(&at[i]));
                found.extend(cells.iter().filter(|(at, _)| inside(at)).flat_map(|(_, members)| members));
            } else {
                for x in first[0]..=last[0] {
                    for y in first[1]..=last[1] {
                        let column = (first[2]..=last[2]).filter_map(|z| cells.get(&[x, y, z]));
                        found.extend(column.flatten());
                    }
                }
            }
        }
        found
    }
}

/// The smallest box along the axes.
fn bounds(patch: &Patch) -> (Vec3, Vec3) {
    let corners = patch.corners().iter();
    corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}

fn cell(place: Vec3, width: f64) -> [i64; 3] {
    (place / width).floor().to_array().map(|place| place as i64)
}

impl Grid {
    fn new(piece: &Patch, sorted: &Sorted, patches: &[Patch], near: f64) -> Self {
        let axes = axes(piece);
        let origin = piece.corner(0);
        let on = |patch: &Patch| coplanar(piece, patch, near) && overlap(piece, patch, axes, near);
        let mut inside = sorted.near(piece);
        inside.retain(|&i| on(&patches[i as usize]));
        inside.sort_unstable();
        let spans = axes.map(|axis| span(piece, axis));
        let corner = origin
            + axes[0] * (spans[0].0 - axes[0].dot(origin))
            + axes[1] * (spans[1].0 - axes[1].dot(origin));
        let (normal, lengths) = (piece.normal(), spans.map(|(low, high)| high - low));
        let of = |sides: [usize; 2], regular| Self {
            normal,
            corner,
            axes: [0, 1].map(|i| axes[i] * (sides[i] as f64 / lengths[i])),
            sides,
            regular,
            starts: Vec::new(),
            candidates: Vec::new(),
        };
        let here = || inside.iter().map(|&i| &patches[i as usize]);
        let fits = |sides: [usize; 2]| of(sides, true).is_filled(here(), near);
        let regular = here().next().map(|patch| cells_of(patch, axes, lengths)).filter(|&sides| fits(sides));
        // Borders of other meshes are to fall within cells and not between them.
        let along = (inside.len() as f64).sqrt().ceil() as usize;
        let side = if along > 1 { CELLS_OF_A_PATCH * along + 1 } else { 1 };
        let mut grid = of(regular.unwrap_or([side; 2]), regular.is_some());
        grid.fill(&inside, patches, near);
        grid
    }

    /// Whether every patch is a rectangle that fills one cell.
    fn is_filled<'a>(&self, mut patches: impl Iterator<Item = &'a Patch>, near: f64) -> bool {
        patches.all(|patch| {
            patch.sides() == 4
                && patch.corners().iter().all(|&corner| {
                    let places = self.axes.map(|axis| ((corner - self.corner).dot(axis), axis.length()));
                    places.iter().all(|(place, scale)| (place - place.round()).abs() <= near * scale)
                })
                && self.axes.iter().all(|&axis| {
                    let (low, high) = span(patch, axis);
                    (high - low - 1.0).abs() <= 2.0 * near * axis.length()
                })
        })
    }

    /// Writes every patch down in the cells that it may reach into.
    fn fill(&mut self, inside: &[u32], patches: &[Patch], near: f64) {
        let ranges: Vec<_> = inside.iter().map(|&i| self.range(&patches[i as usize], near)).collect();
        let [rows, columns] = self.sides;
        let cells = |[rows, of_row]: &[RangeInclusive<usize>; 2]| {
            let of_row = of_row.clone();
            rows.clone().flat_map(move |row| of_row.clone().map(move |column| row * columns + column))
        };
        let mut starts = vec![0; rows * columns + 1];
        ranges.iter().flat_map(cells).for_each(|cell| starts[cell + 1] += 1);
        (0..rows * columns).for_each(|cell| starts[cell + 1] += starts[cell]);
        let mut next = starts.clone();
        let mut candidates = vec![Candidate(0); starts[rows * columns] as usize];
        for (&patch, range) in inside.iter().zip(&ranges) {
            let candidate = Candidate::new(patch, patches[patch as usize].normal().dot(self.normal) > 0.0);
            for cell in cells(range) {
                candidates[next[cell] as usize] = candidate;
                next[cell] += 1;
            }
        }
        (self.starts, self.candidates) = (starts, candidates);
    }

    /// Rows, and cells in them, that a patch may reach into: one where every patch fills a cell.
    fn range(&self, patch: &Patch, near: f64) -> [RangeInclusive<usize>; 2] {
        [0, 1].map(|i| {
            let axis = self.axes[i];
            let ((low, high), start) = (span(patch, axis), axis.dot(self.corner));
            if self.regular {
                // A patch that only touches the piece has its middle outside.
                let middle = 0.5 * (low + high) - start;
                let cell = self.index(i, middle);
                let outside = middle < 0.0 || middle > self.sides[i] as f64;
                return cell + usize::from(outside)..=cell;
            }
            let near = near * axis.length();
            self.index(i, low - near - start)..=self.index(i, high + near - start)
        })
    }

    fn index(&self, axis: usize, cells: f64) -> usize {
        (cells.max(0.0) as usize).min(self.sides[axis] - 1)
    }

    fn cell(&self, point: Vec3) -> &[Candidate] {
        let offset = point - self.corner;
        let [row, column] = [0, 1].map(|i| self.index(i, offset.dot(self.axes[i])));
        let cell = row * self.sides[1] + column;
        &self.candidates[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

/// How many patches of this size lie along each side of a piece.
fn cells_of(patch: &Patch, axes: [Vec3; 2], lengths: [f64; 2]) -> [usize; 2] {
    [0, 1].map(|i| {
        let (low, high) = span(patch, axes[i]);
        (lengths[i] / (high - low)).round().clamp(1.0, MOST_CELLS_ALONG) as usize
    })
}

fn coplanar(piece: &Patch, patch: &Patch, near: f64) -> bool {
    patch.corners().iter().all(|p| (*p - piece.corner(0)).dot(piece.normal()).abs() <= near)
}

/// Whether two patches of one plane overlap along both axes, or come as near as this; where it is
/// negative, whether they overlap by as much.
fn overlap(piece: &Patch, patch: &Patch, axes: [Vec3; 2], near: f64) -> bool {
    axes.iter().all(|&axis| {
        let ((a, b), (c, d)) = (span(piece, axis), span(patch, axis));
        c <= b + near && d >= a - near
    })
}

/// Which patches may have another one on them, turned the other way, as the floor has the bottom of
/// a box: by the rectangles about them.
pub(crate) fn overlaid(patches: &[Patch]) -> Vec<bool> {
    let near = same_place(patches.iter());
    let sorted = Sorted::new(patches, near);
    let is_overlaid = |patch: &Patch| {
        let axes = axes(patch);
        sorted.near(patch).into_iter().map(|other| &patches[other as usize]).any(|other| {
            patch.normal().dot(other.normal()) < 0.0
                && coplanar(patch, other, near)
                && overlap(patch, other, axes, -near)
        })
    };
    patches.iter().map(is_overlaid).collect()
}

/// Length up to which two places of a scene count as one, m.
fn same_place<'a>(patches: impl Iterator<Item = &'a Patch>) -> f64 {
    let corners = patches.flat_map(Patch::corners);
    SAME_PLACE_DISTANCE * corners.fold(0.0, |size: f64, p| size.max(p.abs().max_element()))
}

/// Two directions in the plane of a patch.
fn axes(patch: &Patch) -> [Vec3; 2] {
    let x = (patch.corner(1) - patch.corner(0)).normalize_or_zero();
    [x, patch.normal().cross(x)]
}

fn span(patch: &Patch, axis: Vec3) -> (f64, f64) {
    let places = patch.corners().iter().map(|p| p.dot(axis));
    places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// Whether a point lies inside, not on the border.
fn holds(patch: &Patch, point: Vec3) -> bool {
    let corners = patch.corners();
    let mut from = corners[corners.len() - 1];
    corners.iter().all(|&to| {
        let inside = (to - from).cross(point - from).dot(patch.normal()) > 0.0;
        from = to;
        inside
    })
}

/// Distance from the nearest border, m; negative outside.
fn depth(patch: &Patch, point: Vec3) -> f64 {
    let inward = |i: usize| {
        let along = patch.corner(i + 1) - patch.corner(i);
        patch.normal().cross(along).normalize_or_zero().dot(point - patch.corner(i))
    };
    (0..patch.sides()).map(inward).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::philox::{philox, unit_pair};

    fn rectangle(x: [f64; 2], y: [f64; 2]) -> Patch {
        let corner = |i: usize, j: usize| Vec3::new(x[i], y[j], 0.5);
        Patch::quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]).unwrap().unwrap()
    }

    /// An uneven grid, both sides: the patch found is the one that the coordinates say.
    #[test]
    fn the_patch_is_the_one_that_holds_the_point() {
        let lines = [0.0, 0.1, 0.15, 0.6, 1.0];
        let mut patches = Vec::new();
        for i in 0..4 {
            for j in 0..4 {
                patches.push(rectangle([lines[i], lines[i + 1]], [lines[j], lines[j + 1]]));
            }
        }
        patches.extend(patches.clone().iter().map(Patch::flipped));
        let triangle = |corners| Patch::triangle(corners).unwrap();
        let corner = |x, y| Vec3::new(x, y, 0.5);
        let halves = [
            triangle([corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0)]),
            triangle([corner(0.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]),
        ];
        for (pieces, piece_of) in [(vec![rectangle([0.0, 1.0], [0.0, 1.0])], 0), (halves.to_vec(), 1)] {
            let locator = Locator::new(&pieces, &patches);
            for number in 0..500 {
                let [x, y] = unit_pair(philox([number, 0, 0, 0], [5, 5]));
                let place = |u: f64| lines[1..].iter().filter(|&&line| line <= u).count();
                let piece = if piece_of == 1 { usize::from(y > x) } else { 0 };
                let expected = 4 * place(x) + place(y);
                assert_eq!(locator.lit(piece, corner(x, y), -Vec3::Z, &patches), Some(expected));
                assert_eq!(locator.lit(piece, corner(x, y), Vec3::Z, &patches), Some(expected + 16));
            }
        }
    }

    /// An even grid on several pieces, some of them turned, and its back: patches that only touch a
    /// piece are not found on it.
    #[test]
    fn regular_patches_are_found_without_a_look_at_each() {
        let at = |i: usize| 0.1 * i as f64;
        let mut patches = Vec::new();
        for i in 0..8 {
            for j in 0..8 {
                patches.push(rectangle([at(i), at(i + 1)], [at(j), at(j + 1)]));
            }
        }
        patches.extend(patches.clone().iter().map(Patch::flipped));
        let turned = |[x0, x1]: [f64; 2], [y0, y1]: [f64; 2]| {
            let corner = |x, y| Vec3::new(x, y, 0.5);
            Patch::quad([corner(x1, y0), corner(x1, y1), corner(x0, y1), corner(x0, y0)]).unwrap().unwrap()
        };
        let pieces = [
            rectangle([at(0), at(3)], [at(0), at(8)]),
            turned([at(3), at(8)], [at(0), at(2)]),
            rectangle([at(3), at(8)], [at(2), at(8)]).flipped(),
        ];
        let locator = Locator::new(&pieces, &patches);
        assert!(locator.pieces.iter().all(|grid| grid.regular));
        for number in 0..2000 {
            let [x, y] = unit_pair(philox([number, 0, 0, 0], [5, 5])).map(|u| 0.8 * u);
            let piece = if x < at(3) { 0 } else { 1 + usize::from(y > at(2)) };
            let expected = 8 * (x / 0.1) as usize + (y / 0.1) as usize;
            let point = Vec3::new(x, y, 0.5);
            assert_eq!(locator.lit(piece, point, -Vec3::Z, &patches), Some(expected));
            assert_eq!(locator.lit(piece, point, Vec3::Z, &patches), Some(expected + 64));
        }
    }

    /// The back of a piece beside which another surface lies in the same plane, lit from here:
    /// nothing of that surface is met on the piece.
    #[test]
    fn what_lies_beside_a_piece_is_not_met_on_its_back() {
        let pieces = [rectangle([0.0, 1.0], [0.0, 1.0]).flipped(), rectangle([1.0, 2.0], [0.0, 1.0])];
        let lines = [0.0, 0.3, 0.7, 1.0];
        let mut patches = vec![pieces[0]];
        for rows in lines.windows(2) {
            for columns in lines.windows(2) {
                patches.push(rectangle([1.0 + columns[0], 1.0 + columns[1]], [rows[0], rows[1]]));
            }
        }
        let locator = Locator::new(&pieces, &patches);
        for number in 0..1000 {
            let [x, y] = unit_pair(philox([number, 0, 0, 0], [5, 5]));
            let on = |piece: usize, side: f64| {
                let point = Vec3::new(piece as f64 + x, y, 0.5);
                locator.lit(piece, point, side * Vec3::Z, &patches)
            };
            assert_eq!((on(0, -1.0), on(0, 1.0)), (None, Some(0)));
            assert!(on(1, -1.0).is_some_and(|patch| patch > 0) && on(1, 1.0).is_none());
        }
    }

    #[test]
    fn what_has_another_patch_on_it_is_told_from_what_has_one_beside_it() {
        let floor = rectangle([0.0, 1.0], [0.0, 1.0]);
        let beside = rectangle([1.0, 2.0], [0.0, 1.0]).flipped();
        let on = rectangle([0.2, 0.3], [0.2, 0.3]).flipped();
        let alike = rectangle([0.2, 0.3], [0.2, 0.3]);
        assert_eq!(overlaid(&[floor, beside]), [false, false]);
        assert_eq!(overlaid(&[floor, alike]), [false, false]);
        assert_eq!(overlaid(&[floor, beside, on]), [true, false, true]);
    }
}
