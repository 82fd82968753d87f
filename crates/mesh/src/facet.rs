//! Facets: what a shape consists of before it is cut.

use crate::cutting::{Form, Grid};
use crate::{MeshError, Patch, Vec3, quad};

/// Facets of a shape that are cut alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Group {
    pub form: Form,
    pub number: u128,
}

/// A piece of a shape before it is cut.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Facet {
    Flat(Patch),
    /// Corners of a bilinear surface that is not flat, or of a quad that is not convex.
    Bilinear([Vec3; 4]),
}

impl Facet {
    /// The flat pieces of face `index` when cut by the lines of a grid.
    pub fn face(&self, grid: Grid, index: usize) -> Result<Vec<Patch>, MeshError> {
        match self {
            Self::Flat(patch) if patch.sides() == 3 => Ok(vec![patch.piece_of(grid.u.pieces(), index)?]),
            Self::Flat(patch) => Ok(vec![quad::flat_cell(patch, grid, index)?]),
            Self::Bilinear(corners) => quad::halves(quad::cell(corners, grid, index)),
        }
    }

    pub fn flipped(&self) -> Self {
        match self {
            Self::Flat(patch) => Self::Flat(patch.flipped()),
            Self::Bilinear([a, b, c, d]) => Self::Bilinear([*a, *d, *c, *b]),
        }
    }

    pub fn flat(&self) -> Option<&Patch> {
        match self {
            Self::Flat(patch) => Some(patch),
            Self::Bilinear(_) => None,
        }
    }
}
