//! Quads: what makes sense of four corners, and how lines cut them.
//!
//! Bilinear surface: p(u, v) = (1 − u)(1 − v) a + u (1 − v) b + u v c + (1 − u) v d. Its cells are
//! flat everywhere or nowhere, because the determinant of ∂p/∂u, ∂p/∂v and ∂²p/∂u∂v is constant.
//! Metres.

use crate::cutting::{Form, Grid};
use crate::facet::{Facet, Group};
use crate::{MeshError, Patch, Vec3};

/// Distance of two corners, relative to the longest side, up to which they are one.
const SAME_CORNER_DISTANCE: f64 = 1e-12;
/// Twice a corner's area, relative to the squared longest side, up to which the corner is straight.
const STRAIGHT_CORNER_AREA: f64 = 1e-13;
/// Relative gain of area that makes the second diagonal the better one.
const LEAST_AREA_GAIN: f64 = 1e-9;

/// Four corners that make sense, and the cells to leave out.
#[derive(Clone, Debug)]
pub(crate) struct Quad<'a> {
    corners: [Vec3; 4],
    skip: &'a [[usize; 2]],
    facet: Facet,
    reflex: Option<usize>,
}

impl<'a> Quad<'a> {
    pub fn new(corners: [Vec3; 4], skip: &'a [[usize; 2]]) -> Result<Self, MeshError> {
        if let Some(corner) = corners.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NotFinite { corner });
        }
        refuse_repeated(&corners)?;
        let reflex = reflex(&corners)?;
        let facet = Patch::quad(corners)?.map_or(Facet::Bilinear(corners), Facet::Flat);
        Ok(Self { corners, skip, facet, reflex })
    }

    pub fn facet(&self) -> &Facet {
        &self.facet
    }

    pub fn group(&self) -> Group {
        let [a, b, c, d] = self.corners;
        let (u, v) = (a.distance(b).max(c.distance(d)), a.distance(d).max(b.distance(c)));
        Group { form: Form::Quad { u, v, flat: self.facet.flat().is_some() }, number: 1 }
    }

    /// The cells to leave out when a grid cuts, sorted and without repetition.
    pub fn skipped(&self, grid: Grid) -> Result<Vec<[usize; 2]>, MeshError> {
        if let (Some(corner), true) = (self.reflex, grid.cells() > 1) {
            return Err(MeshError::NotConvex { corner });
        }
        let (u, v) = (grid.u.pieces(), grid.v.pieces());
        if let Some(&[i, j]) = self.skip.iter().find(|[i, j]| *i >= u || *j >= v) {
            return Err(MeshError::NoSuchCell { i, j, u, v });
        }
        let mut cells = self.skip.to_vec();
        cells.sort_unstable();
        cells.dedup();
        if cells.len() as u128 == grid.cells() { Err(MeshError::NothingLeft) } else { Ok(cells) }
    }

    /// The undivided quad, or the flat pieces of its cells where some are left out or it is not
    /// flat.
    pub fn blockers(&self, grid: Grid) -> Result<Vec<Patch>, MeshError> {
        let skipped = self.skipped(grid)?;
        if let (Some(patch), true) = (self.facet.flat(), skipped.is_empty()) {
            return Ok(vec![*patch]);
        }
        let mut pieces = Vec::new();
        for index in grid.kept(&skipped) {
            pieces.extend(self.facet.face(grid, index)?);
        }
        Ok(pieces)
    }
}

/// Corners of cell `index` of the bilinear surface.
pub(crate) fn cell(corners: &[Vec3; 4], grid: Grid, index: usize) -> [Vec3; 4] {
    let [i, j] = grid.cell(index);
    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        .map(|(i, j)| point(corners, grid.u.weights(i), grid.v.weights(j)))
}

/// Cell `index` of a flat quad.
pub(crate) fn flat_cell(patch: &Patch, grid: Grid, index: usize) -> Result<Patch, MeshError> {
    let corners = [0, 1, 2, 3].map(|i| patch.corner(i));
    Patch::piece(cell(&corners, grid, index), 4, patch.normal())
}

/// Bilinear mean of the corners. On a side two terms vanish, and the neighbour that shares it finds
/// the same bits.
fn point(&[a, b, c, d]: &[Vec3; 4], u: [f64; 2], v: [f64; 2]) -> Vec3 {
    a * (u[0] * v[0]) + b * (u[1] * v[0]) + c * (u[1] * v[1]) + d * (u[0] * v[1])
}

/// The two triangles of a quad, halved by the diagonal that makes the smaller one larger.
pub(crate) fn halves([a, b, c, d]: [Vec3; 4]) -> Result<Vec<Patch>, MeshError> {
    let normal = (c - a).cross(d - b);
    let area = |p: Vec3, q: Vec3, r: Vec3| (q - p).cross(r - p).dot(normal);
    let first = area(a, b, c).min(area(a, c, d));
    let second = area(b, c, d).min(area(b, d, a));
    let [p, q] = if second > first + LEAST_AREA_GAIN * first.abs() {
        [[b, c, d], [b, d, a]]
    } else {
        [[a, b, c], [a, c, d]]
    };
    Ok(vec![Patch::triangle(p)?, Patch::triangle(q)?])
}

fn refuse_repeated(corners: &[Vec3; 4]) -> Result<(), MeshError> {
    let tolerance = SAME_CORNER_DISTANCE * longest(corners);
    for second in 1..4 {
        for first in 0..second {
            if corners[first].distance(corners[second]) <= tolerance {
                return Err(MeshError::RepeatedCorner { first, second });
            }
        }
    }
    Ok(())
}

/// The reflex corner, where there is one. Sides that cross are refused.
///
/// The turn at a corner is twice the area of its triangle over the squared longest side, about the
/// normal of the quad. A simple quad turns right at one corner at most, one whose sides cross at
/// two.
fn reflex(corners: &[Vec3; 4]) -> Result<Option<usize>, MeshError> {
    let scale = longest(corners).powi(2);
    let at = |i: usize| corners[i % 4];
    let crosses = [0, 1, 2, 3].map(|i| (at(i) - at(i + 3)).cross(at(i + 1) - at(i)) / scale);
    let area = (at(2) - at(0)).cross(at(3) - at(1)) / scale;
    // The two halves of a bow-tie may cancel: then any corner that is not straight tells the plane.
    let normal =
        if area.length() > STRAIGHT_CORNER_AREA { area } else { crosses.into_iter().fold(area, longer) };
    let normal = normal.normalize_or_zero();
    let mut right = (0..4).filter(|&i| crosses[i].dot(normal) < -STRAIGHT_CORNER_AREA);
    let first = right.next();
    if right.next().is_some() { Err(MeshError::BowTie) } else { Ok(first) }
}

fn longer(a: Vec3, b: Vec3) -> Vec3 {
    if b.length_squared() > a.length_squared() { b } else { a }
}

fn longest(corners: &[Vec3; 4]) -> f64 {
    (0..4).map(|i| corners[i].distance(corners[(i + 1) % 4])).fold(0.0, f64::max)
}
