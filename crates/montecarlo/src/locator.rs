//! Which patch of a fine mesh lies at a point of a coarse one.
//!
//! Rays are traced against the undivided pieces of the geometry, which are few; each piece has a
//! grid of the patches in its plane. At a border the patch is taken that the point is deepest
//! inside of.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use fredholm_mesh::{Patch, Vec3};
use rustc_hash::FxHashMap;

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
    /// What is met on each side of every piece, the lit one first, where that is the same anywhere on
    /// it. Most pieces of furniture are one patch, and few lines of memory hold them all.
    alone: Vec<[Alone; 2]>,
    /// Where the candidates of the cells of all pieces begin, and where those of the last end. In one
    /// list, since each ray looks at other pieces, and waits for every place in memory.
    starts: Vec<u32>,
    candidates: Vec<Candidate>,
    /// Length up to which two places count as one, m.
    near: f64,
}

/// Patches of one plane, in cells of equal size.
#[derive(Clone, Debug)]
struct Grid {
    normal: Vec3,
    corner: Vec3,
    /// Scalar products of an offset from the corner with them are its place in rows and columns.
    axes: [Vec3; 2],
    /// Number of rows, and of cells in a row.
    sides: [u32; 2],
    /// Its first cell among those of all pieces.
    first: u32,
    cells: Cells,
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cells {
    /// Patches that reach into a rectangle.
    Any,
    /// One patch of each side, which fills a rectangle.
    Filled,
    /// One patch of each side, which fills half a parallelogram: two cells each, the first for the
    /// half with the corner of the piece. Rows and columns count from a corner of a triangle along
    /// its sides.
    Halved,
}

/// What is met on one side of a piece.
#[derive(Clone, Copy, Debug)]
enum Alone {
    Patch(u32),
    Nothing,
    /// That depends on the point.
    Many,
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
        let mut locator = Self {
            pieces: Vec::with_capacity(pieces.len()),
            alone: Vec::with_capacity(pieces.len()),
            starts: vec![0],
            candidates: Vec::new(),
            near,
        };
        for piece in pieces {
            let on_it = on(piece, &sorted, patches, near);
            let grid = Grid::new(piece, &on_it, patches, near);
            locator.add(grid, &on_it, patches);
        }
        locator
    }

    /// Takes a grid, and writes every patch down in the cells that it may reach into.
    fn add(&mut self, mut grid: Grid, on_it: &[u32], patches: &[Patch]) {
        grid.first = self.starts.len() as u32 - 1;
        let ranges: Vec<_> = on_it.iter().map(|&i| grid.range(&patches[i as usize], self.near)).collect();
        let [rows, columns] = grid.sides.map(|side| side as usize);
        let count = rows * columns * grid.cells.of_a_place();
        let begin = self.candidates.len();
        let mut next = vec![0; count + 1];
        ranges.iter().flat_map(|range| grid.of(range)).for_each(|cell| next[cell + 1] += 1);
        (0..count).for_each(|cell| next[cell + 1] += next[cell]);
        self.starts.extend(next[1..].iter().map(|&end| (begin + end) as u32));
        self.candidates.resize(begin + next[count], Candidate(0));
        for (&patch, range) in on_it.iter().zip(&ranges) {
            let candidate = Candidate::new(patch, patches[patch as usize].normal().dot(grid.normal) > 0.0);
            for cell in grid.of(range) {
                self.candidates[begin + next[cell]] = candidate;
                next[cell] += 1;
            }
        }
        let first = &self.candidates[begin..begin + next[0]];
        let is_alone = grid.sides == [1, 1] && (grid.cells != Cells::Any || first.len() == 1);
        let alone = |along| match first.iter().find(|candidate| candidate.along() == along) {
            _ if !is_alone => Alone::Many,
            Some(candidate) => Alone::Patch(candidate.patch() as u32),
            None => Alone::Nothing,
        };
        self.alone.push([true, false].map(alone));
        self.pieces.push(grid);
    }

    /// The patch at a point of a piece that turns its lit side to a ray which meets the lit side of
    /// the piece (`along`), or its back.
    pub(crate) fn lit(&self, piece: usize, point: Vec3, along: bool, patches: &[Patch]) -> Option<usize> {
        match self.alone[piece][usize::from(!along)] {
            Alone::Patch(patch) => return Some(patch as usize),
            Alone::Nothing => return None,
            Alone::Many => {}
        }
        let grid = &self.pieces[piece];
        let lit = |&&candidate: &&Candidate| candidate.along() == along;
        let cell = grid.first as usize + grid.cell(point);
        let cell = &self.candidates[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        if let [only] = cell {
            return lit(&only).then_some(only.patch());
        }
        let candidates = || cell.iter().filter(lit).map(|candidate| candidate.patch());
        if grid.cells != Cells::Any {
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

/// The patches that lie in the plane of a piece and may overlap it, or touch it, in order.
fn on(piece: &Patch, sorted: &Sorted, patches: &[Patch], near: f64) -> Vec<u32> {
    let axes = axes(piece);
    let mut found = sorted.near(piece);
    found.retain(|&i| {
        let patch = &patches[i as usize];
        coplanar(piece, patch, near) && overlap(piece, patch, axes, near)
    });
    found.sort_unstable();
    found
}

/// Patches in the cells of grids, each in that whose cells are about as wide as it is long, so that
/// those near a piece are found without a look at all.
struct Sorted {
    near: f64,
    grids: Vec<Class>,
}

/// Cells of equal width, with the patches that begin in each.
struct Class {
    /// Width, m.
    width: f64,
    members: FxHashMap<[i64; 3], Vec<u32>>,
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
            let mut cells: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
            for &number in &members {
                cells.entry(cell(bounds(&patches[number as usize]).0, width)).or_default().push(number);
            }
            Class { width, members: cells, count: members.len() }
        };
        Self { near, grids: classes.into_iter().map(grid).collect() }
    }

    /// The patches that may lie on a piece.
    fn near(&self, piece: &Patch) -> Vec<u32> {
        let (low, high) = bounds(piece);
        let mut found = Vec::new();
        for Class { width, members: cells, count } in &self.grids {
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

impl Cells {
    /// Cells at each row and column.
    fn of_a_place(self) -> usize {
        1 + usize::from(self == Self::Halved)
    }
}

/// Rows, columns and halves that a patch may reach into.
type Range = [RangeInclusive<usize>; 3];

impl Grid {
    fn new(piece: &Patch, on_it: &[u32], patches: &[Patch], near: f64) -> Self {
        let here = || on_it.iter().map(|&i| &patches[i as usize]);
        if let Some(grid) = Self::halved(piece, here, near) {
            return grid;
        }
        let axes = axes(piece);
        let spans = axes.map(|axis| span(piece, axis));
        let lengths = spans.map(|(low, high)| high - low);
        let of = |sides: [u32; 2], cells| {
            let axes = [0, 1].map(|i| axes[i] * (f64::from(sides[i]) / lengths[i]));
            Self { normal: piece.normal(), corner: corner_of(piece), axes, sides, first: 0, cells }
        };
        let fits = |sides: &[u32; 2]| of(*sides, Cells::Filled).is_filled(here(), near);
        if let Some(sides) = here().next().map(|patch| cells_of(patch, axes, lengths)).filter(fits) {
            return of(sides, Cells::Filled);
        }
        // Borders of other meshes are to fall within cells and not between them.
        let along = (on_it.len() as f64).sqrt().ceil() as usize;
        let side = if along > 1 { CELLS_OF_A_PATCH * along + 1 } else { 1 };
        of([side as u32; 2], Cells::Any)
    }

    /// The grid of a triangle that is divided evenly, as a mesh divides it.
    fn halved<'a, I: Iterator<Item = &'a Patch>>(
        piece: &Patch,
        here: impl Fn() -> I,
        near: f64,
    ) -> Option<Self> {
        let [a, b, c] = *piece.corners() else { return None };
        let first = here().next()?;
        let side = (piece.area() / first.area()).sqrt().round().clamp(1.0, MOST_CELLS_ALONG);
        // Dual to the sides, so that a row and a column are coordinates along them.
        let (along, up, normal) = (b - a, c - a, piece.normal());
        let dual = |side_of: Vec3, other: Vec3| {
            let across = normal.cross(other);
            across * (side / across.dot(side_of))
        };
        let axes = [dual(along, up), dual(up, along)];
        let grid = Self { normal, corner: a, axes, sides: [side as u32; 2], first: 0, cells: Cells::Halved };
        here().all(|patch| grid.is_beside(patch, near) || grid.is_half(patch, near)).then_some(grid)
    }

    /// Rows and columns at a point.
    fn place(&self, point: Vec3) -> [f64; 2] {
        self.axes.map(|axis| axis.dot(point - self.corner))
    }

    /// Whether a patch only touches the triangle that this grid is of.
    fn is_beside(&self, patch: &Patch, near: f64) -> bool {
        let slack = near * self.axes[0].length().max(self.axes[1].length());
        let places = || patch.corners().iter().map(|&corner| self.place(corner));
        places().all(|[row, _]| row <= slack)
            || places().all(|[_, column]| column <= slack)
            || places().all(|[row, column]| row + column >= f64::from(self.sides[0]) - 2.0 * slack)
    }

    /// Whether a patch is half a parallelogram of the grid.
    fn is_half(&self, patch: &Patch, near: f64) -> bool {
        let even = |&corner: &Vec3| {
            let place = self.place(corner);
            (0..2).all(|i| (place[i] - place[i].round()).abs() <= near * self.axes[i].length())
        };
        let unit = |axis| {
            let (low, high) = span(patch, axis);
            (high - low - 1.0).abs() <= 2.0 * near * axis.length()
        };
        // Of the two diagonals only that along the third side is one of these halves.
        let sums = patch.corners().iter().map(|&corner| self.place(corner).iter().sum::<f64>().round());
        let (low, high) = sums.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        patch.sides() == 3
            && patch.corners().iter().all(even)
            && self.axes.into_iter().all(unit)
            && (high - low - 1.0).abs() < 0.5
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

    /// What a patch may reach into: one cell, or none, where every patch fills one.
    fn range(&self, patch: &Patch, near: f64) -> Range {
        if self.cells == Cells::Halved {
            let middle = self.place(patch.centroid());
            let whole = f64::from(self.sides[0]);
            // A patch that only touches the triangle has its middle outside.
            let is_outside = middle[0] < 0.0 || middle[1] < 0.0 || middle[0] + middle[1] > whole;
            let [row, column] = middle.map(|place| place as usize);
            let half = usize::from(middle[0].fract() + middle[1].fract() > 1.0);
            return [row + usize::from(is_outside)..=row, column..=column, half..=half];
        }
        let [rows, columns] = [0, 1].map(|i| {
            let axis = self.axes[i];
            let ((low, high), start) = (span(patch, axis), axis.dot(self.corner));
            if self.cells == Cells::Filled {
                let middle = 0.5 * (low + high) - start;
                let cell = self.index(i, middle);
                let outside = middle < 0.0 || middle > f64::from(self.sides[i]);
                return cell + usize::from(outside)..=cell;
            }
            let near = near * axis.length();
            self.index(i, low - near - start)..=self.index(i, high + near - start)
        });
        [rows, columns, 0..=0]
    }

    /// The cells of a range.
    fn of(&self, [rows, columns, halves]: &Range) -> impl Iterator<Item = usize> + use<> {
        let (of_row, of_place) = (self.sides[1] as usize, self.cells.of_a_place());
        let (columns, halves) = (columns.clone(), halves.clone());
        rows.clone().flat_map(move |row| {
            let halves = halves.clone();
            let of_column =
                move |column| halves.clone().map(move |half| (row * of_row + column) * of_place + half);
            columns.clone().flat_map(of_column)
        })
    }

    fn index(&self, axis: usize, cells: f64) -> usize {
        (cells.max(0.0) as usize).min(self.sides[axis] as usize - 1)
    }

    /// The cell of a point.
    fn cell(&self, point: Vec3) -> usize {
        let place = self.place(point);
        let of_row = self.sides[1] as usize;
        let [row, column] = [0, 1].map(|i| self.index(i, place[i]));
        if self.cells != Cells::Halved {
            return row * of_row + column;
        }
        // Beyond the third side, by rounding, lies nothing.
        let column = column.min(of_row - 1 - row);
        let is_second = place[0] - row as f64 + (place[1] - column as f64) > 1.0 && row + column + 1 < of_row;
        2 * (row * of_row + column) + usize::from(is_second)
    }
}

/// The corner of the rectangle about a piece.
fn corner_of(piece: &Patch) -> Vec3 {
    let origin = piece.corner(0);
    let to_border = |axis: Vec3| axis * (span(piece, axis).0 - axis.dot(origin));
    axes(piece).into_iter().map(to_border).fold(origin, |corner, step| corner + step)
}

/// How many patches of this size lie along each side of a piece.
fn cells_of(patch: &Patch, axes: [Vec3; 2], lengths: [f64; 2]) -> [u32; 2] {
    [0, 1].map(|i| {
        let (low, high) = span(patch, axes[i]);
        (lengths[i] / (high - low)).round().clamp(1.0, MOST_CELLS_ALONG) as u32
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
                assert_eq!(locator.lit(piece, corner(x, y), true, &patches), Some(expected));
                assert_eq!(locator.lit(piece, corner(x, y), false, &patches), Some(expected + 16));
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
        assert!(locator.pieces.iter().all(|grid| grid.cells == Cells::Filled));
        for number in 0..2000 {
            let [x, y] = unit_pair(philox([number, 0, 0, 0], [5, 5])).map(|u| 0.8 * u);
            let piece = if x < at(3) { 0 } else { 1 + usize::from(y > at(2)) };
            let expected = 8 * (x / 0.1) as usize + (y / 0.1) as usize;
            let point = Vec3::new(x, y, 0.5);
            let from = |direction| pieces[piece].normal().dot(direction) < 0.0;
            assert_eq!(locator.lit(piece, point, from(-Vec3::Z), &patches), Some(expected));
            assert_eq!(locator.lit(piece, point, from(Vec3::Z), &patches), Some(expected + 64));
        }
    }

    /// Triangles divided evenly, on their two sides, with their neighbour across the diagonal: a point
    /// finds the part that holds it.
    #[test]
    fn parts_of_triangles_are_found_without_a_look_at_each() {
        let corners = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.3, 0.1, 0.8), Vec3::new(0.4, 1.1, 0.1)];
        let [a, b, c] = corners;
        let pieces = [Patch::triangle([a, b, c]).unwrap(), Patch::triangle([c, b, b + c - a]).unwrap()];
        for levels in 0..3 {
            let mut patches = pieces.to_vec();
            for _ in 0..levels {
                let quarters = |patch: &Patch| patch.split().unwrap();
                patches = patches.iter().flat_map(quarters).collect();
            }
            patches.extend(patches.clone().iter().map(Patch::flipped));
            let locator = Locator::new(&pieces, &patches);
            assert!(locator.pieces.iter().all(|grid| grid.cells == Cells::Halved), "{levels}");
            for number in 0..2000 {
                let [u, v] = unit_pair(philox([number, 0, 0, 0], [5, 5]));
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                for (piece, patch) in pieces.iter().enumerate() {
                    let point = patch.corner(0)
                        + u * (patch.corner(1) - patch.corner(0))
                        + v * (patch.corner(2) - patch.corner(0));
                    for side in [-1.0, 1.0] {
                        let found = locator.lit(piece, point, side < 0.0, &patches).unwrap();
                        assert!(
                            holds(&patches[found], point)
                                && patches[found].normal().dot(patch.normal()) * side < 0.0
                        );
                    }
                }
            }
            // Corners and sides belong to one of the parts there.
            for (piece, patch) in pieces.iter().enumerate() {
                for (k, t) in (0..3).flat_map(|k| [0.0, 0.25, 0.5, 0.7].map(|t| (k, t))) {
                    let point = patch.corner(k).lerp(patch.corner(k + 1), t);
                    let found = locator.lit(piece, point, true, &patches).unwrap();
                    assert!(depth(&patches[found], point) > -1e-9);
                }
            }
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
                locator.lit(piece, point, side * pieces[piece].normal().z < 0.0, &patches)
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
