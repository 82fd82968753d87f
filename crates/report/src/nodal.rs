//! Values at the corners of elements, from the constant values of the elements around them.
//!
//! The value at a corner is the mean of the elements that meet there, belong to the same surface
//! and have a similar normal, with weights 1/Aᵢ. The nearer, that is smaller, elements count more:
//! on a grid of rectangles with any spacing, the four weights 1/(hᵢ kⱼ) are products of the exact
//! weights in each direction, so that a bilinear function is reproduced. A corner on a side of a
//! larger element takes the colour of that side: else the two would differ along it. The weight of
//! a partly buried element is its exposed share of that.

use fredholm_mesh::{Hanging, Mesh, Weld, Welded};

/// Elements of a surface shade smoothly into each other where their normals are at most 40° apart.
pub(crate) const SMOOTH_WELD: Weld = Weld::Smooth { degrees: 40.0 };

/// Share given to buried elements, so that a vertex among nothing else has a value.
const BURIED_SHARE: f64 = 1e-9;

/// The values at each vertex, so many of each, from those of each leaf and its exposed share.
pub(crate) fn vertex_values(
    mesh: &Mesh,
    welded: &Welded,
    (leaves, width): (&[f64], usize),
    exposed: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let mut sums = vec![0.0; welded.vertices.len() * width];
    let mut totals = vec![0.0; welded.vertices.len()];
    for ((leaf, patch), values) in mesh.patches().enumerate().zip(leaves.chunks_exact(width)) {
        let weight = exposed(leaf).max(BURIED_SHARE) / patch.area();
        for &vertex in welded.patch(leaf) {
            totals[vertex] += weight;
            let sums = &mut sums[vertex * width..(vertex + 1) * width];
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    for (sums, total) in sums.chunks_exact_mut(width).zip(totals) {
        for sum in sums {
            *sum /= total;
        }
    }
    sums
}

/// Gives vertices on the sides of larger elements the values that these have there, so that there
/// is no crack in them: the means of the ends.
pub(crate) fn close(hanging: &[Hanging], vertices: &mut [f64], width: usize) {
    for Hanging { vertex, ends: [a, b] } in hanging {
        for i in 0..width {
            vertices[vertex * width + i] = 0.5 * (vertices[a * width + i] + vertices[b * width + i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Rgb;
    use crate::field::tests::grid;
    use crate::interpolate::corner_weights;
    use fredholm_mesh::{MeshBuilder, Patch, Vec3};

    fn bilinear(p: Vec3) -> Rgb {
        [1.0 + 2.0 * p.x, 3.0 - p.y, 2.0 + p.x - 0.5 * p.x * p.y]
    }

    /// The colour at each vertex.
    fn vertex_colours(
        mesh: &Mesh,
        welded: &Welded,
        leaves: &[Rgb],
        exposed: impl Fn(usize) -> f64,
    ) -> Vec<Rgb> {
        vertex_values(mesh, welded, (leaves.as_flattened(), 3), exposed).as_chunks().0.to_vec()
    }

    /// The colours at the corners of each leaf.
    fn corner_colours(mesh: &Mesh, leaves: &[Rgb]) -> Vec<Vec<Rgb>> {
        let welded = mesh.welded(SMOOTH_WELD);
        let colours = vertex_colours(mesh, &welded, leaves, |_| 1.0);
        welded.patches().map(|patch| patch.iter().map(|&vertex| colours[vertex]).collect()).collect()
    }

    fn at(mesh: &Mesh, colours: &[Vec<Rgb>], leaf: usize, p: Vec3) -> Rgb {
        let weights = corner_weights(mesh.patch(leaf), p);
        [0, 1, 2].map(|c| (0..4).map(|k| weights[k] * colours[leaf][k][c]).sum())
    }

    #[test]
    fn a_bilinear_field_is_exact_inside_an_uneven_grid() {
        let lines = [0.0, 0.1, 0.15, 0.4, 0.6, 1.0];
        let mut builder = MeshBuilder::default();
        builder.surface("wall", 0);
        grid(&mut builder, &lines, &lines);
        let mesh = builder.build();
        let leaves: Vec<Rgb> = mesh.patches().map(|patch| bilinear(patch.centroid())).collect();
        let colours = corner_colours(&mesh, &leaves);
        let inner = |leaf: &usize| (1..4).contains(&(leaf % 5)) && (1..4).contains(&(leaf / 5));
        assert_eq!((0..mesh.len()).filter(inner).count(), 9);
        for leaf in (0..mesh.len()).filter(inner) {
            for (u, v) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5), (0.77, 0.21)] {
                let p = mesh.patch(leaf).point(u, v);
                for (found, expected) in at(&mesh, &colours, leaf, p).iter().zip(bilinear(p)) {
                    assert!((found - expected).abs() < 1e-13, "{found} {expected}");
                }
            }
        }
    }

    #[test]
    fn a_buried_element_does_not_darken_its_neighbours() {
        let lines = [0.0, 1.0, 2.0];
        let mut builder = MeshBuilder::default();
        builder.surface("floor", 0);
        grid(&mut builder, &lines, &[0.0, 1.0]);
        let mesh = builder.build();
        let welded = mesh.welded(SMOOTH_WELD);
        let leaves = [[0.0; 3], [4.0; 3]];
        let colours = vertex_colours(&mesh, &welded, &leaves, |leaf| leaf as f64);
        let shared: Vec<_> = welded.patch(0).iter().filter(|v| welded.patch(1).contains(v)).collect();
        assert_eq!(shared.len(), 2);
        assert!(shared.iter().all(|&&v| (colours[v][0] - 4.0).abs() < 1e-8));
    }

    #[test]
    fn elements_of_different_size_have_one_colour_along_their_sides() {
        let v = Vec3::new;
        let square = |x: f64| {
            let corners = [v(x, 0., 0.), v(x + 1., 0., 0.), v(x + 1., 1., 0.), v(x, 1., 0.)];
            Patch::quad(corners).unwrap().unwrap()
        };
        let fine: Vec<Patch> =
            square(1.0).split().unwrap().iter().flat_map(|part| part.split().unwrap()).collect();
        let mut builder = MeshBuilder::default();
        builder.surface("wall", 0);
        builder.face(&[square(0.0)]).unwrap();
        builder.face(&fine).unwrap();
        let mesh = builder.build();
        let leaves: Vec<Rgb> = (0..mesh.len()).map(|leaf| [(leaf * leaf) as f64; 3]).collect();
        let welded = mesh.welded(SMOOTH_WELD);
        let mut colours = vertex_colours(&mesh, &welded, &leaves, |_| 1.0);
        close(&mesh.anchored(SMOOTH_WELD).hanging, colours.as_flattened_mut(), 3);
        let on_side = |leaf: usize, p: Vec3| {
            let weights = corner_weights(mesh.patch(leaf), p);
            let corners = welded.patch(leaf).iter().zip(weights);
            corners.map(|(&vertex, weight)| weight * colours[vertex][0]).sum::<f64>()
        };
        let beside = |y: f64| {
            (1..mesh.len()).find(|&k| {
                let low = mesh.patch(k).corner(0);
                low.x > 0.999 && low.x < 1.001 && low.y <= y && y <= low.y + 0.25
            })
        };
        for y in [0.05, 0.25, 0.3, 0.5, 0.6, 0.75, 0.9] {
            let p = v(1.0, y, 0.0);
            let [large, small] = [on_side(0, p), on_side(beside(y).unwrap(), p)];
            assert!((large - small).abs() < 1e-12 && large > 0.0, "{y}: {large} {small}");
        }
    }

    #[test]
    fn surfaces_and_edges_keep_apart() {
        let v = Vec3::new;
        let floor =
            Patch::quad([v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)]).unwrap().unwrap();
        let wall =
            Patch::quad([v(0., 0., 0.), v(0., 1., 0.), v(0., 1., 1.), v(0., 0., 1.)]).unwrap().unwrap();
        let next =
            Patch::quad([v(1., 0., 0.), v(2., 0., 0.), v(2., 1., 0.), v(1., 1., 0.)]).unwrap().unwrap();
        let mut builder = MeshBuilder::default();
        builder.surface("room", 0);
        builder.face(&[floor]).unwrap();
        builder.face(&[wall]).unwrap();
        builder.surface("other", 0);
        builder.face(&[next]).unwrap();
        let mesh = builder.build();
        let leaves = [[1.0; 3], [2.0; 3], [4.0; 3]];
        let colours = corner_colours(&mesh, &leaves);
        for (leaf, colour) in leaves.iter().enumerate() {
            assert_eq!(colours[leaf], vec![*colour; 4]);
        }
    }

    #[test]
    fn a_constant_stays_constant_on_triangles() {
        let v = Vec3::new;
        let (a, b, c, d) = (v(0., 0., 0.), v(1., 0., 0.1), v(1., 1., 0.), v(0., 1., 0.1));
        let mut builder = MeshBuilder::default();
        builder.surface("roof", 0);
        builder.face(&[Patch::triangle([a, b, c]).unwrap(), Patch::triangle([a, c, d]).unwrap()]).unwrap();
        let mesh = builder.build();
        let colours = corner_colours(&mesh, &[[1.0; 3], [2.0; 3]]);
        assert_eq!((colours[0][0][0], colours[0][1][0], colours[0][2][0]), (1.5, 1.0, 1.5));
    }
}
