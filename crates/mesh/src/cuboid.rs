//! Boxes with their sides along the axes.
//!
//! Axes a, b, c in cyclic order make a right-handed frame, so that the side whose outward normal is
//! +a has u along b and v along c; on the opposite side u and v change places. Metres.

use crate::cutting::Form;
use crate::facet::{Facet, Group};
use crate::{MeshError, Patch, Vec3};

/// A box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cuboid {
    min: Vec3,
    max: Vec3,
}

impl Cuboid {
    pub fn new(min: Vec3, max: Vec3) -> Result<Self, MeshError> {
        if let Some(corner) = [min, max].iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NotFinite { corner });
        }
        let names = ["the box's extent along x", "the box's extent along y", "the box's extent along z"];
        let size = max - min;
        match (0..3).find(|&axis| size[axis] <= 0.0) {
            Some(axis) => Err(MeshError::Length { quantity: names[axis], value: size[axis] }),
            None => Ok(Self { min, max }),
        }
    }

    /// One group for each side: −x, +x, −y, +y, −z, +z.
    pub fn groups(&self) -> Vec<Group> {
        let size = self.max - self.min;
        let group = |(axis, upper)| {
            let [u, v] = directions(axis, upper).map(|direction| size[direction]);
            Group { form: Form::Quad { u, v, flat: true }, number: 1 }
        };
        sides().map(group).collect()
    }

    /// The six sides, lit outside.
    pub fn facets(&self) -> Result<Vec<Facet>, MeshError> {
        sides().map(|(axis, upper)| self.side(axis, upper).map(Facet::Flat)).collect()
    }

    fn side(&self, axis: usize, upper: bool) -> Result<Patch, MeshError> {
        let [u, v] = directions(axis, upper);
        let corners = [[false, false], [true, false], [true, true], [false, true]].map(|[far_u, far_v]| {
            let mut corner = if upper { self.max } else { self.min };
            corner[u] = if far_u { self.max[u] } else { self.min[u] };
            corner[v] = if far_v { self.max[v] } else { self.min[v] };
            corner
        });
        let mut normal = Vec3::ZERO;
        normal[axis] = if upper { 1.0 } else { -1.0 };
        Patch::piece(corners, 4, normal)
    }
}

fn sides() -> impl Iterator<Item = (usize, bool)> {
    (0..3).flat_map(|axis| [(axis, false), (axis, true)])
}

/// The axes along which u and v run.
fn directions(axis: usize, upper: bool) -> [usize; 2] {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    if upper { [b, c] } else { [c, b] }
}
