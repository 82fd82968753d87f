//! The colour of a point of the surfaces: radiosity as linear sRGB, smoothly interpolated.

use fredholm_mesh::{Anchored, Vec3, Welded};

use crate::Field;
use crate::colour::{Colouring, Rgb};
use crate::interpolate::corner_weights;
use crate::nodal::{SMOOTH_WELD, close, vertex_colours};

/// Colours at the vertices of the leaves.
pub(crate) struct Shading<'a> {
    field: Field<'a>,
    welded: Welded,
    vertices: Vec<Rgb>,
}

impl<'a> Shading<'a> {
    pub(crate) fn new(field: Field<'a>) -> Self {
        let colouring = Colouring::new(field.bands());
        Self::of_values(field, 0, |leaf| colouring.colour(&field.exposed_radiosity(leaf)))
    }

    /// The same of what is left of the radiosity without a part, W/m² of a leaf and a band.
    ///
    /// A rest that is smooth is interpolated so that the mean over an element is about that of the
    /// element: so many times the corners are moved by what the elements around them lack (the
    /// iteration of P. van Cittert, Zeitschrift für Physik 69, 1931, doi:10.1007/BF01391351). Else
    /// dark corners of rooms would be too bright by what the light changes within half an element.
    pub(crate) fn of_rest(field: Field<'a>, passes: usize, part: impl Fn(usize, usize) -> f64) -> Self {
        let colouring = Colouring::new(field.bands());
        Self::of_values(field, passes, |leaf| {
            let share = field.exposed(leaf);
            let reflected_by = if share > 0.0 { 1.0 / share } else { 1.0 };
            let mut rest = field.exposed_radiosity(leaf);
            rest.iter_mut().enumerate().for_each(|(band, b)| *b -= part(leaf, band) * reflected_by);
            colouring.colour(&rest)
        })
    }

    /// The same of any colours of the leaves.
    pub(crate) fn of_values(field: Field<'a>, passes: usize, colour: impl Fn(usize) -> Rgb) -> Self {
        let mesh = field.mesh();
        let leaves: Vec<Rgb> = (0..mesh.len()).map(colour).collect();
        let Anchored { leaves: welded, hanging, .. } = mesh.anchored(SMOOTH_WELD);
        let mut vertices = vertex_colours(mesh, &welded, &leaves, |leaf| field.exposed(leaf));
        close(&hanging, &mut vertices);
        for _ in 0..passes {
            let lacking: Vec<Rgb> = (0..mesh.len())
                .map(|leaf| {
                    let corners = welded.patch(leaf);
                    let mean = corners.iter().fold([0.0; 3], |sum: Rgb, &vertex| {
                        [0, 1, 2].map(|i| sum[i] + vertices[vertex][i] / corners.len() as f64)
                    });
                    [0, 1, 2].map(|i| leaves[leaf][i] - mean[i])
                })
                .collect();
            let moved = vertex_colours(mesh, &welded, &lacking, |leaf| field.exposed(leaf));
            for (vertex, by) in vertices.iter_mut().zip(moved) {
                *vertex = [0, 1, 2].map(|i| vertex[i] + by[i]);
            }
            close(&hanging, &mut vertices);
        }
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
