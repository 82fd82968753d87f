//! Flat polygons with holes, as triangles.
//!
//! The triangles have the area |outline| − Σ |holes| to 1e-9, or the polygon is refused. Metres.

use glam::DVec2;

use crate::border::{Corner, area, contains, refuse_contact};
use crate::cutting::Form;
use crate::error::Ring;
use crate::facet::{Facet, Group};
use crate::plane::{Plane, TOUCH_DISTANCE};
use crate::triangulation::triangulate;
use crate::{MeshError, Patch, Vec3, triangle};

/// Relative defect of area up to which the triangles fill the polygon.
const AREA_TOLERANCE: f64 = 1e-9;

/// A polygon, triangulated.
#[derive(Clone, Debug)]
pub(crate) struct Polygon {
    triangles: Vec<[Vec3; 3]>,
}

impl Polygon {
    pub fn new(outline: &[Vec3], holes: &[Vec<Vec3>]) -> Result<Self, MeshError> {
        triangles(outline, holes).map(|triangles| Self { triangles })
    }

    pub fn group(&self) -> Group {
        let longest = self.triangles.iter().map(|corners| triangle::longest(*corners)).fold(0.0, f64::max);
        Group { form: Form::Triangle { longest }, number: self.triangles.len() as u128 }
    }

    /// The triangles, lit where the outline runs counter-clockwise.
    pub fn facets(&self) -> Result<Vec<Facet>, MeshError> {
        self.triangles.iter().map(|corners| Patch::triangle(*corners).map(Facet::Flat)).collect()
    }
}

fn triangles(outline: &[Vec3], holes: &[Vec<Vec3>]) -> Result<Vec<[Vec3; 3]>, MeshError> {
    let input: Vec<&[Vec3]> = std::iter::once(outline).chain(holes.iter().map(Vec::as_slice)).collect();
    let rings = borders(&input)?;
    let triangles = triangulate(&rings).unwrap_or_default();
    let corners: Vec<&Corner> = rings.iter().flatten().collect();
    refuse_gaps(&rings, triangles.iter().map(|t| t.map(|corner| corners[corner].at)))?;
    let points =
        rings.iter().zip(&input).flat_map(|(ring, input)| ring.iter().map(|corner| input[corner.index]));
    let points: Vec<Vec3> = points.collect();
    Ok(triangles.into_iter().map(|t| t.map(|corner| points[corner])).collect())
}

/// The borders in their plane, outline first, none of which crosses or touches itself or another.
fn borders(input: &[&[Vec3]]) -> Result<Vec<Vec<Corner>>, MeshError> {
    if let Some(corner) = input.iter().flat_map(|ring| ring.iter()).position(|p| !p.is_finite()) {
        return Err(MeshError::NotFinite { corner });
    }
    let plane = Plane::of(input[0])?;
    let border = |(number, ring): (usize, &&[Vec3])| plane.border(Ring::numbered(number), ring);
    let rings: Vec<_> = input.iter().enumerate().map(border).collect::<Result<_, _>>()?;
    refuse_contact(&rings, TOUCH_DISTANCE)?;
    refuse_misplaced(&rings[0], &rings[1..])?;
    Ok(rings)
}

fn refuse_misplaced(outline: &[Corner], holes: &[Vec<Corner>]) -> Result<(), MeshError> {
    for (hole, ring) in holes.iter().enumerate() {
        if !contains(outline, ring[0].at) {
            return Err(MeshError::HoleOutside { hole });
        }
        let around = |other: &usize| *other != hole && contains(&holes[*other], ring[0].at);
        if let Some(other) = (0..holes.len()).find(around) {
            return Err(MeshError::HoleInHole { hole, other });
        }
    }
    Ok(())
}

fn refuse_gaps(rings: &[Vec<Corner>], triangles: impl Iterator<Item = [DVec2; 3]>) -> Result<(), MeshError> {
    let expected = area(&rings[0]).abs() - rings[1..].iter().map(|hole| area(hole).abs()).sum::<f64>();
    let found = triangles.map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a)).sum::<f64>();
    if (found - expected).abs() <= AREA_TOLERANCE * expected {
        Ok(())
    } else {
        Err(MeshError::Triangulation { expected, found })
    }
}
