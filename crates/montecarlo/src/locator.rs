//! Which patch of a fine mesh lies at a point of a coarse one.
//!
//! Rays are traced against the undivided pieces of the geometry, which are few; each piece has a
//! grid of the patches in its plane. At a border the patch is taken that the point is deepest
//! inside of.

use fredholm_mesh::{Patch, Vec3};

/// Lengths, over the longest of the scene, up to which two places count as one.
const SAME_PLACE_DISTANCE: f64 = 1e-7;

/// The patches of every piece.
#[derive(Clone, Debug)]
pub(crate) struct Locator {
    pieces: Vec<Grid>,
}

/// Patches of one plane, in cells of equal size.
#[derive(Clone, Debug)]
struct Grid {
    corner: Vec3,
    axes: [Vec3; 2],
    /// Cells per metre.
    scale: [f64; 2],
    side: usize,
    cells: Vec<Vec<u32>>,
}

impl Locator {
    pub(crate) fn new(pieces: &[Patch], patches: &[Patch]) -> Self {
        let corners = || pieces.iter().chain(patches).flat_map(Patch::corners);
        let size = corners().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
        let grid = |piece: &Patch| Grid::new(piece, patches, SAME_PLACE_DISTANCE * size);
        Self { pieces: pieces.iter().map(grid).collect() }
    }

    /// The patch at a point of a piece that turns its lit side to a ray of this direction.
    pub(crate) fn lit(&self, piece: usize, point: Vec3, direction: Vec3, patches: &[Patch]) -> Option<usize> {
        let lit = |&&patch: &&u32| patches[patch as usize].normal().dot(direction) < 0.0;
        let depth = |patch: u32| depth(&patches[patch as usize], point);
        let cell = self.pieces[piece].cell(point);
        if let [only] = cell {
            return lit(&only).then_some(*only as usize);
        }
        if let Some(&found) = cell.iter().filter(lit).find(|&&patch| holds(&patches[patch as usize], point)) {
            return Some(found as usize);
        }
        let candidates = cell.iter().filter(lit).copied();
        candidates.max_by(|&a, &b| depth(a).total_cmp(&depth(b)).then(b.cmp(&a))).map(|patch| patch as usize)
    }
}

impl Grid {
    fn new(piece: &Patch, patches: &[Patch], near: f64) -> Self {
        let x = (piece.corner(1) - piece.corner(0)).normalize_or_zero();
        let axes = [x, piece.normal().cross(x)];
        let origin = piece.corner(0);
        let inside: Vec<u32> = (0..patches.len())
            .filter(|&i| coplanar(piece, &patches[i], near) && overlap(piece, &patches[i], axes, near))
            .map(|i| i as u32)
            .collect();
        let side = (inside.len() as f64).sqrt().ceil().max(1.0) as usize;
        let spans = axes.map(|axis| span(piece, axis));
        let corner = origin
            + axes[0] * (spans[0].0 - axes[0].dot(origin))
            + axes[1] * (spans[1].0 - axes[1].dot(origin));
        let scale = spans.map(|(low, high)| side as f64 / (high - low));
        let mut grid = Self { corner, axes, scale, side, cells: vec![Vec::new(); side * side] };
        for &patch in &inside {
            grid.insert(patch, &patches[patch as usize], near);
        }
        grid
    }

    fn insert(&mut self, number: u32, patch: &Patch, near: f64) {
        let range = |axis: usize| {
            let (low, high) = span(patch, self.axes[axis]);
            let start = self.axes[axis].dot(self.corner);
            [low - near, high + near].map(|x| self.index(axis, x - start))
        };
        let ([i, k], [j, l]) = (range(0), range(1));
        for row in i..=k {
            for column in j..=l {
                self.cells[row * self.side + column].push(number);
            }
        }
    }

    fn index(&self, axis: usize, offset: f64) -> usize {
        ((offset * self.scale[axis]).max(0.0) as usize).min(self.side - 1)
    }

    fn cell(&self, point: Vec3) -> &[u32] {
        let offset = point - self.corner;
        let [row, column] = [0, 1].map(|axis| self.index(axis, offset.dot(self.axes[axis])));
        &self.cells[row * self.side + column]
    }
}

fn coplanar(piece: &Patch, patch: &Patch, near: f64) -> bool {
    patch.corners().iter().all(|p| (*p - piece.corner(0)).dot(piece.normal()).abs() <= near)
}

fn overlap(piece: &Patch, patch: &Patch, axes: [Vec3; 2], near: f64) -> bool {
    axes.iter().all(|&axis| {
        let ((a, b), (c, d)) = (span(piece, axis), span(patch, axis));
        c <= b + near && d >= a - near
    })
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
}
