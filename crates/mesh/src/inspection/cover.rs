//! Light would be counted twice where elements lie on each other and are lit on the same side: each
//! place is left to one of them.

use super::boxes::Boxes;
use super::contacts::{around, tolerance};
use super::overlap::{common, uncovered};
use crate::mesh::Cut;
use crate::{Bounds, Mesh, MeshBuilder, MeshError, Patch, Vec3};

impl Mesh {
    /// The mesh without what other elements cover that are lit on the same side. A lamp (a surface
    /// for which `emits` holds) covers what does not emit; else the smaller face covers the larger
    /// one, and the one with the smaller number what is as large. Faces of which nothing is left
    /// are gone. What is covered does not block the view either: the planes of both are the same up
    /// to rounding only, and it could hide what covers it. The mesh must not have been split.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] past 2³² − 1 elements.
    pub fn without_covered(self, emits: impl Fn(usize) -> bool) -> Result<Self, MeshError> {
        let tolerance = tolerance(self.patches().chain(&self.occluders));
        let order = Order::of(&self, emits);
        let mut covers: Vec<Vec<u32>> = self.covers(&order, tolerance);
        if covers.iter().all(Vec::is_empty) {
            return Ok(self);
        }
        let occluders = self.blocking(&covers, tolerance);
        let mut builder = MeshBuilder::default();
        let mut surface = None;
        for (face, entry) in self.faces.iter().enumerate() {
            while surface.is_none_or(|surface| surface < entry.surface) {
                let next = surface.map_or(0, |surface| surface + 1);
                builder.surface(self.surfaces[next].name.as_str(), self.surfaces[next].material);
                surface = Some(next);
            }
            let leaves = self.leaves_of_face(face);
            let mut roots = Vec::with_capacity(leaves.len());
            for leaf in leaves {
                let patch = self.patch(leaf);
                let own = std::mem::take(&mut covers[leaf]);
                if own.is_empty() {
                    roots.push(*patch);
                    continue;
                }
                roots.extend(self.left_of(leaf, &own, tolerance));
            }
            if !roots.is_empty() {
                builder.face(&roots)?;
            }
        }
        for rest in &self.surfaces[surface.map_or(0, |surface| surface + 1)..] {
            builder.surface(rest.name.as_str(), rest.material);
        }
        for patch in occluders {
            builder.occluder(patch);
        }
        Ok(builder.build())
    }

    /// What is left of a leaf that others cover.
    fn left_of(&self, leaf: usize, covers: &[u32], tolerance: f64) -> Vec<Patch> {
        let patch = self.patch(leaf);
        let others: Vec<&Patch> = covers.iter().map(|&k| self.patch(k as usize)).collect();
        uncovered(patch, &others, tolerance).iter().flat_map(|part| pieces(part, patch)).collect()
    }

    /// The occluders, without what is covered: in the place of those of a shape of which something
    /// is, what is left of its leaves.
    fn blocking(&self, covers: &[Vec<u32>], tolerance: f64) -> Vec<Patch> {
        let mut found = Vec::with_capacity(self.occluders.len());
        let mut next = 0;
        for Cut { faces, occluders } in &self.shapes {
            // Those that were added by themselves stand between those of the shapes.
            found.extend_from_slice(&self.occluders[next..occluders.start]);
            next = occluders.end;
            let leaves = || faces.clone().flat_map(|face| self.leaves_of_face(face));
            if occluders.is_empty() || leaves().all(|leaf| covers[leaf].is_empty()) {
                found.extend_from_slice(&self.occluders[occluders.clone()]);
                continue;
            }
            for leaf in leaves() {
                match &covers[leaf][..] {
                    [] => found.push(*self.patch(leaf)),
                    covers => found.extend(self.left_of(leaf, covers, tolerance)),
                }
            }
        }
        found.extend_from_slice(&self.occluders[next..]);
        found
    }

    /// For every leaf those that lie on it, are lit on the same side, and come before it.
    fn covers(&self, order: &Order, tolerance: f64) -> Vec<Vec<u32>> {
        let boxes: Vec<Bounds> = self.patches().map(around).collect();
        let tree = Boxes::new(boxes.clone());
        let of = |leaf: usize| {
            let patch = self.patch(leaf);
            let covers = |&other: &u32| {
                let over = self.patch(other as usize);
                order.before(self.face_of(other as usize), self.face_of(leaf))
                    && over.normal().dot(patch.normal()) > 0.0
                    && common(patch, over, tolerance).is_some()
            };
            tree.near(&boxes[leaf], tolerance).into_iter().filter(covers).collect()
        };
        (0..self.len()).map(of).collect()
    }
}

/// Which of two faces covers the other.
struct Order {
    emits: Vec<bool>,
    areas: Vec<f64>,
}

/// Difference of areas, relative, up to which faces are as large as each other.
const AREA_TOLERANCE: f64 = 1e-9;

impl Order {
    fn of(mesh: &Mesh, emits: impl Fn(usize) -> bool) -> Self {
        let emits = mesh.faces.iter().map(|face| emits(face.surface)).collect();
        let areas: Vec<f64> = mesh.faces.iter().map(|face| face.area).collect();
        Self { emits, areas: Self::ranked(&areas) }
    }

    /// The areas, those that are alike made the same, so that the order has no circles.
    fn ranked(areas: &[f64]) -> Vec<f64> {
        let mut order: Vec<usize> = (0..areas.len()).collect();
        order.sort_by(|&a, &b| areas[a].total_cmp(&areas[b]).then(a.cmp(&b)));
        let mut ranked = areas.to_vec();
        for pair in order.windows(2) {
            if areas[pair[1]] <= areas[pair[0]] * (1.0 + AREA_TOLERANCE) {
                ranked[pair[1]] = ranked[pair[0]];
            }
        }
        ranked
    }

    fn before(&self, a: usize, b: usize) -> bool {
        let key = |face: usize| (!self.emits[face], self.areas[face], face);
        a != b && key(a) < key(b)
    }
}

/// Triangles of a convex polygon in the plane of a patch; corners that are all but on a line give
/// none.
fn pieces<'a>(polygon: &'a [Vec3], patch: &'a Patch) -> impl Iterator<Item = Patch> + 'a {
    let fan = polygon[1..].windows(2).map(|side| [polygon[0], side[0], side[1]]);
    fan.filter_map(|[a, b, c]| Patch::piece([a, b, c, c], 3, patch.normal()).ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutting, Lines, Shape};

    fn quad(x: [f64; 2], y: [f64; 2], flipped: bool) -> Shape {
        let v = |x, y| Vec3::new(x, y, 0.0);
        let mut corners = [v(x[0], y[0]), v(x[1], y[0]), v(x[1], y[1]), v(x[0], y[1])];
        if flipped {
            corners.reverse();
        }
        Shape::Quad { corners, skip: vec![] }
    }

    fn mesh(shapes: &[Shape], divide: usize) -> Mesh {
        let mut builder = MeshBuilder::default();
        for shape in shapes {
            builder.surface("s", 0);
            let lines = Lines::Counts { u: divide, v: divide };
            builder.add(shape, &Cutting { lines, ..Cutting::default() }).unwrap();
        }
        builder.build()
    }

    fn areas(mesh: &Mesh) -> Vec<f64> {
        let area = |s: usize| mesh.faces.iter().filter(|face| face.surface == s).map(|face| face.area).sum();
        (0..mesh.surfaces.len()).map(area).collect()
    }

    #[test]
    fn each_place_is_left_to_one_face() {
        let (ceiling, lamp) = (quad([0., 4.], [0., 4.], false), quad([1., 2.], [1.3, 2.], false));
        for divide in [1, 3] {
            let left = mesh(&[ceiling.clone(), lamp.clone()], divide).without_covered(|_| false).unwrap();
            assert!((areas(&left)[0] - 15.3).abs() < 1e-12 && (areas(&left)[1] - 0.7).abs() < 1e-15);
            let left = mesh(&[ceiling.clone(), lamp.clone()], divide).without_covered(|s| s == 0).unwrap();
            assert!((areas(&left)[0] - 16.0).abs() < 1e-12 && areas(&left)[1] == 0.0, "a lamp covers");
            let blocking: f64 = left.occluders.iter().map(Patch::area).sum();
            assert!(left.surfaces.len() == 2 && (blocking - 16.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_second_of_two_alike_is_gone_and_backs_stay() {
        let (floor, back) = (quad([0., 1.], [0., 1.], false), quad([0., 1.], [0., 1.], true));
        let all = [floor.clone(), back.clone(), floor.clone(), back];
        let left = mesh(&all, 1).without_covered(|_| false).unwrap();
        assert_eq!(areas(&left), [1.0, 1.0, 0.0, 0.0]);
        assert_eq!((left.faces.len(), left.surfaces.len()), (2, 4));
        let clean = mesh(&[floor, quad([1., 2.], [0., 1.], false)], 2);
        let left = clean.clone().without_covered(|_| true).unwrap();
        assert_eq!(left, clean);
    }

    /// Coordinates of six digits: two walls that were meant to lie in one plane, with a corner that
    /// rounding moved.
    #[test]
    fn what_is_covered_does_not_hide_what_covers_it() {
        let wall = |x: f64, y: f64| {
            let corners = [[0., 0., 0.], [x, y, 0.], [x, y, 10.], [0., 0., 10.]].map(Vec3::from);
            Shape::Quad { corners, skip: vec![] }
        };
        let left = mesh(&[wall(100.0, 1e-6), wall(50.0, 0.0), quad([0., 1.], [8., 9.], false)], 2);
        let area = |patches: &[Patch]| patches.iter().map(Patch::area).sum::<f64>();
        assert!((area(left.occluders()) - 1501.0).abs() < 1e-3);
        let left = left.without_covered(|_| false).unwrap();
        let lit: Vec<Patch> = left.patches().copied().collect();
        assert!((area(&lit) - 1001.0).abs() < 1e-3 && (areas(&left)[1] - 500.0).abs() < 1e-3);
        assert!((area(left.occluders()) - 1001.0).abs() < 1e-3, "{}", area(left.occluders()));
    }
}
