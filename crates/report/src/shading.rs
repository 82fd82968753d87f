//! Values at the points of the surfaces, smoothly interpolated between the corners of elements:
//! radiosity of each band, or as linear sRGB.

use fredholm_mesh::{Anchored, Vec3, Welded};

use crate::Field;
use crate::colour::{Colouring, Rgb};
use crate::interpolate::corner_weights;
use crate::nodal::{SMOOTH_WELD, close, vertex_values};

/// Values at the vertices of the leaves.
pub(crate) struct Shading<'a> {
    field: Field<'a>,
    welded: Welded,
    /// Number of values of a vertex.
    width: usize,
    vertices: Vec<f64>,
}

impl<'a> Shading<'a> {
    /// The radiosity as linear sRGB, without a part, W/m² of a leaf and a band.
    pub(crate) fn of_rest(field: Field<'a>, passes: usize, part: impl Fn(usize, usize) -> f64) -> Self {
        let colouring = Colouring::new(field.bands());
        let colour = |leaf: usize| {
            let reflected_by = field.over_exposed(leaf);
            let mut rest = field.exposed_radiosity(leaf);
            rest.iter_mut().enumerate().for_each(|(band, b)| *b -= part(leaf, band) * reflected_by);
            colouring.colour(&rest)
        };
        Self::of_values(field, passes, (3, (0..field.mesh().len()).flat_map(colour).collect()))
    }

    /// The same of any values of the leaves, so many of each.
    ///
    /// What is smooth is interpolated so that the mean over an element is about that of the
    /// element: so many times the corners are moved by what the elements around them lack (the
    /// iteration of P. van Cittert, Zeitschrift für Physik 69, 1931, doi:10.1007/BF01391351). Else
    /// dark corners of rooms would be too bright by what the light changes within half an element.
    /// Corners are not moved below 0, nor below the least of the elements around them if that is
    /// less.
    pub(crate) fn of_values(field: Field<'a>, passes: usize, (width, leaves): (usize, Vec<f64>)) -> Self {
        let mesh = field.mesh();
        let Anchored { leaves: welded, hanging, .. } = mesh.anchored(SMOOTH_WELD);
        let at_vertices = |leaves: &[f64]| {
            let mut vertices = vertex_values(mesh, &welded, (leaves, width), |leaf| field.exposed(leaf));
            close(&hanging, &mut vertices, width);
            vertices
        };
        let mut vertices = at_vertices(&leaves);
        for _ in 0..passes {
            let mut lacking = leaves.clone();
            for (leaf, lacking) in lacking.chunks_exact_mut(width).enumerate() {
                let corners = welded.patch(leaf);
                for &vertex in corners {
                    let values = &vertices[vertex * width..(vertex + 1) * width];
                    let part = |(lacking, value): (&mut f64, &f64)| *lacking -= value / corners.len() as f64;
                    lacking.iter_mut().zip(values).for_each(part);
                }
            }
            vertices.iter_mut().zip(at_vertices(&lacking)).for_each(|(vertex, by)| *vertex += by);
            close(&hanging, &mut vertices, width);
        }
        if passes > 0 {
            let least = least_around(&welded, (&leaves, width), vertices.len());
            vertices.iter_mut().zip(least).for_each(|(vertex, least)| *vertex = vertex.max(least));
        }
        Self { field, welded, width, vertices }
    }

    /// Adds the values at a point of a leaf.
    pub(crate) fn add(&self, leaf: usize, point: Vec3, sum: &mut [f64]) {
        let weights = corner_weights(self.field.mesh().patch(leaf), point);
        for (&vertex, weight) in self.welded.patch(leaf).iter().zip(weights) {
            let values = &self.vertices[vertex * self.width..(vertex + 1) * self.width];
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
    }

    /// By how much the leaves around each bend: those that share a corner with it, and itself. A
    /// leaf bends by the difference of its value from the mean over its corners, of which each has
    /// the mean of the leaves around it.
    pub(crate) fn bends(&self, values: &[f64]) -> Vec<f64> {
        let mesh = self.field.mesh();
        let corners = vertex_values(mesh, &self.welded, (values, 1), |leaf| self.field.exposed(leaf));
        let mut around = vec![0.0_f64; corners.len()];
        for (own, value) in self.welded.patches().zip(values) {
            let mean = own.iter().map(|&vertex| corners[vertex]).sum::<f64>() / own.len() as f64;
            for &vertex in own {
                around[vertex] = around[vertex].max((value - mean).abs());
            }
        }
        let most = |own: &[usize]| own.iter().map(|&vertex| around[vertex]).fold(0.0, f64::max);
        self.welded.patches().map(most).collect()
    }

    /// The three values at a point of a leaf: linear sRGB, W/m².
    pub(crate) fn colour(&self, leaf: usize, point: Vec3) -> Rgb {
        let mut colour = [0.0; 3];
        self.add(leaf, point, &mut colour);
        colour
    }
}

/// The least value of the leaves around each vertex, or 0 where all are above.
fn least_around(welded: &Welded, (leaves, width): (&[f64], usize), count: usize) -> Vec<f64> {
    let mut least = vec![0.0_f64; count];
    for (corners, values) in welded.patches().zip(leaves.chunks_exact(width)) {
        for &vertex in corners {
            let own = &mut least[vertex * width..(vertex + 1) * width];
            own.iter_mut().zip(values).for_each(|(least, value)| *least = least.min(*value));
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{grid, names};
    use fredholm_mesh::{Mesh, MeshBuilder};

    /// A strip of leaves along x.
    fn strip(count: usize) -> Mesh {
        let lines: Vec<f64> = (0..=count).map(|k| k as f64).collect();
        let mut builder = MeshBuilder::default();
        builder.surface("strip", 0);
        grid(&mut builder, &lines, &[0.0, 1.0]);
        builder.build()
    }

    #[test]
    fn corners_beside_a_step_stay_above_nothing() {
        let (mesh, bands) = (strip(8), names(&["grey"]));
        let values = [5.0, 5.0, 5.0, 5.0, 0.0, 0.0, 0.0, 0.0];
        let field = Field::new(&mesh, &bands, &values, &values).unwrap();
        let shading = Shading::of_values(field, 3, (1, values.to_vec()));
        assert!(shading.vertices.iter().all(|v| *v >= 0.0) && shading.vertices.contains(&0.0));
        let signed = values.map(|v| v - 1.0);
        let shading = Shading::of_values(field, 3, (1, signed.to_vec()));
        assert!(shading.vertices.iter().all(|v| *v >= -1.0) && shading.vertices.contains(&-1.0));
    }

    #[test]
    fn leaves_beside_a_step_bend_and_those_on_a_slope_do_not() {
        let (mesh, bands) = (strip(10), names(&["grey"]));
        let slope: Vec<f64> = (0..10).map(f64::from).collect();
        let field = Field::new(&mesh, &bands, &slope, &slope).unwrap();
        let shading = Shading::of_values(field, 0, (1, slope.clone()));
        // At the ends of the strip there is nothing beyond: a quarter of a step is missing.
        let bends = shading.bends(&slope);
        assert!(bends[2..8].iter().all(|bend| *bend < 1e-12) && bends[0] > 0.2 && bends[9] > 0.2);
        let step: Vec<f64> = (0..10).map(|k| if k < 5 { 1.0 } else { 3.0 }).collect();
        let bends = shading.bends(&step);
        // Half a step at the one corner, a quarter in the mean, and one leaf farther on either
        // side.
        assert!((3..7).all(|k| (bends[k] - 0.5).abs() < 1e-12), "{bends:?}");
        assert!(bends[..3].iter().chain(&bends[7..]).all(|bend| *bend < 1e-12), "{bends:?}");
    }
}
