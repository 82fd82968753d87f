//! The colour of a point of the surfaces: radiosity as linear sRGB, smoothly interpolated.

use fredholm_mesh::{Anchored, Vec3, Welded};

use crate::Field;
use crate::colour::{Colouring, Rgb};
use crate::interpolate::corner_weights;
use crate::nodal::{SMOOTH, close, vertex_colours};

/// Colours at the vertices of the leaves.
pub(crate) struct Shading<'a> {
    field: Field<'a>,
    welded: Welded,
    vertices: Vec<Rgb>,
}

impl<'a> Shading<'a> {
    pub(crate) fn new(field: Field<'a>) -> Self {
        let (mesh, colouring) = (field.mesh(), Colouring::new(field.bands()));
        let colour = |leaf| colouring.colour(&field.exposed_radiosity(leaf));
        let leaves: Vec<Rgb> = (0..mesh.len()).map(colour).collect();
        let Anchored { leaves: welded, hanging, .. } = mesh.anchored(SMOOTH);
        let mut vertices = vertex_colours(mesh, &welded, &leaves, |leaf| field.exposed(leaf));
        close(&hanging, &mut vertices);
        Self { field, welded, vertices }
    }

    /// Linear sRGB of the radiosity at a point of a leaf, W/m².
    pub(crate) fn colour(&self, leaf: usize, point: Vec3) -> Rgb {
        let weights = corner_weights(self.field.mesh().patch(leaf), point);
        let corners = self.welded.patch(leaf).iter().map(|&vertex| self.vertices[vertex]);
        corners.zip(weights).fold([0.0; 3], |sum, (colour, weight)| {
            [0, 1, 2].map(|channel| sum[channel] + weight * colour[channel])
        })
    }
}
