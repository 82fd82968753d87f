//! A shape whose sense has been checked: its facets, how many elements they give, and what blocks
//! the view.
//!
//! Number of elements: Σ facets × cells × flat pieces a cell × k², with k elements per side.
//! Metres.

use crate::builder::MOST_ELEMENTS;
use crate::cuboid::Cuboid;
use crate::cutting::{Form, Grid};
use crate::cylinder::Prism;
use crate::disc::Rings;
use crate::facet::{Facet, Group};
use crate::polygon::Polygon;
use crate::quad::Quad;
use crate::sphere::Geodesic;
use crate::{Cutting, Lines, MeshError, Patch, Shape, triangle};

/// A checked shape.
#[derive(Clone, Debug)]
pub(crate) enum Solid<'a> {
    Quad(Quad<'a>),
    Triangle(Patch),
    Polygon(Polygon),
    Cuboid(Cuboid),
    Geodesic(Geodesic),
    Rings(Rings),
    Prism(Prism),
}

impl<'a> Solid<'a> {
    pub fn new(shape: &'a Shape) -> Result<Self, MeshError> {
        Ok(match shape {
            Shape::Quad { corners, skip } => Self::Quad(Quad::new(*corners, skip)?),
            Shape::Triangle { corners } => Self::Triangle(Patch::triangle(*corners)?),
            Shape::Polygon { outline, holes } => Self::Polygon(Polygon::new(outline, holes)?),
            Shape::Box { min, max, .. } => Self::Cuboid(Cuboid::new(*min, *max)?),
            Shape::Sphere { centre, radius, segments, .. } => {
                Self::Geodesic(Geodesic::new(*centre, *radius, *segments)?)
            }
            Shape::Disc { centre, normal, radius, segments } => {
                Self::Rings(Rings::disc(*centre, *normal, *radius, *segments)?)
            }
            Shape::Cylinder { base, axis, radius, caps, segments, .. } => {
                Self::Prism(Prism::new(*base, *axis, *radius, *segments, *caps)?)
            }
        })
    }

    /// Number of elements.
    pub fn count(&self, cutting: &Cutting) -> Result<u128, MeshError> {
        let per_side = cutting.elements_per_side as u128;
        if per_side == 0 {
            return Err(MeshError::NoPieces { quantity: "the number of elements per side" });
        }
        let mut total = 0_u128;
        for group in self.groups() {
            let grid = cutting.lines.grid(group.form)?;
            let faces = grid.cells() - self.skipped(grid)?.len() as u128;
            let pieces = faces.checked_mul(group.number * group.form.pieces());
            let elements = pieces.and_then(|pieces| pieces.checked_mul(per_side * per_side));
            total = elements
                .and_then(|e| total.checked_add(e))
                .ok_or(MeshError::TooLarge { limit: MOST_ELEMENTS })?;
        }
        Ok(total)
    }

    /// Facets by form, in the order of [`Self::facets`].
    pub fn groups(&self) -> Vec<Group> {
        match self {
            Self::Quad(quad) => vec![quad.group()],
            Self::Triangle(patch) => {
                let [a, b, c] = [0, 1, 2].map(|i| patch.corner(i));
                vec![Group { form: Form::Triangle { longest: triangle::longest([a, b, c]) }, number: 1 }]
            }
            Self::Polygon(polygon) => vec![polygon.group()],
            Self::Cuboid(cuboid) => cuboid.groups(),
            Self::Geodesic(geodesic) => vec![geodesic.group()],
            Self::Rings(rings) => vec![rings.group()],
            Self::Prism(prism) => prism.groups(),
        }
    }

    /// What the shape consists of, lit on the front of flat shapes and outside closed ones.
    pub fn facets(&self) -> Result<Vec<Facet>, MeshError> {
        match self {
            Self::Quad(quad) => Ok(vec![quad.facet().clone()]),
            Self::Triangle(patch) => Ok(vec![Facet::Flat(*patch)]),
            Self::Polygon(polygon) => polygon.facets(),
            Self::Cuboid(cuboid) => cuboid.facets(),
            Self::Geodesic(geodesic) => geodesic.facets(),
            Self::Rings(rings) => rings.facets(),
            Self::Prism(prism) => prism.facets(),
        }
    }

    /// What blocks the view, as few pieces as possible.
    pub fn blockers(&self, facets: &[Facet], lines: &Lines) -> Result<Vec<Patch>, MeshError> {
        match self {
            Self::Quad(quad) => quad.blockers(lines.grid(quad.group().form)?),
            Self::Rings(rings) => rings.blockers(),
            Self::Prism(prism) => prism.blockers(),
            _ => Ok(facets.iter().filter_map(Facet::flat).copied().collect()),
        }
    }

    /// Cells of a quad to be left out, sorted; none for the other shapes.
    pub fn skipped(&self, grid: Grid) -> Result<Vec<[usize; 2]>, MeshError> {
        match self {
            Self::Quad(quad) => quad.skipped(grid),
            _ => Ok(Vec::new()),
        }
    }

    /// Whether all facets together are one face.
    pub fn is_one_face(&self, lines: &Lines) -> bool {
        matches!((self, lines), (Self::Polygon(_), Lines::Whole))
    }
}
