//! The elements cut along the borders of the shadows that lamps cast, with the irradiance gathered
//! at the corners of the parts.

use fredholm_coupling::Receiver;
use fredholm_hierarchical::{Gatherer, Tree, shadow_edges};
use fredholm_mesh::{Patch, Vec3, Weld, Welded, cut_polygon, part_inside};
use fredholm_report::ShadowMesh;
use rayon::prelude::*;

use crate::pictures::Gathered;

/// Most lines that cut an element, where elements are few: the longest ones within it.
const MOST_LINES: usize = 24;
/// Triangles that all elements together are cut into, about. `n` lines cut an element into `n²`
/// triangles at most. Many small elements show the borders of shadows by themselves already, and
/// light is gathered at every corner: that must not take longer than the solution.
const MOST_TRIANGLES: usize = 200_000;
/// How far from a corner of a triangle its irradiance is gathered, over the distance of the
/// centroid: each side of a border has its own.
const CORNER_INSET: f64 = 1e-5;

impl Gathered<'_> {
    /// All elements, cut; nothing where the run was cancelled before the end.
    pub(crate) fn shadows(&self) -> Option<ShadowMesh> {
        let mesh = &self.problem.mesh;
        let polygons = mesh.anchored(Weld::Everywhere).polygons;
        let edges = Edges {
            lamps: lamps(self.gather.tree(), &|leaf| self.emits(leaf)),
            most: most_lines(mesh.len()),
        };
        let faces = (0..mesh.faces().len()).into_par_iter().map(|face| self.face(face, &polygons, &edges));
        let faces = faces.collect::<Option<Vec<ShadowMesh>>>()?;
        let mut whole = ShadowMesh::default();
        for face in faces {
            whole.triangles.extend(face.triangles);
            whole.elements.extend(face.elements);
            whole.irradiance.extend(face.irradiance);
        }
        Some(whole)
    }

    /// The elements of a face, cut; nothing where the run was cancelled.
    fn face(&self, face: usize, polygons: &Welded, edges: &Edges) -> Option<ShadowMesh> {
        let mesh = &self.problem.mesh;
        let mut gatherer = self.gather.gatherer();
        let (mut cut, mut plane, mut lines) = (ShadowMesh::default(), None, Vec::new());
        for leaf in mesh.leaves_of_face(face) {
            let patch = mesh.patch(leaf);
            if plane != Some(patch.normal()) {
                lines = shadow_edges(&edges.lamps, self.gather.bodies(), patch);
                plane = Some(patch.normal());
            }
            let corners: Vec<Vec3> = polygons.patch(leaf).iter().map(|&k| polygons.vertices[k]).collect();
            let cuts = longest(&corners, patch.normal(), &lines, edges.most);
            for triangle in cut_polygon(&corners, patch.normal(), &cuts) {
                if self.go_on().is_break() {
                    return None;
                }
                self.light(leaf, triangle, &mut gatherer, &mut cut.irradiance);
                cut.triangles.push(triangle);
                cut.elements.push(leaf);
            }
        }
        Some(cut)
    }

    /// Appends the irradiance at the corners of a triangle.
    fn light(&self, leaf: usize, triangle: [Vec3; 3], gatherer: &mut Gatherer, irradiance: &mut Vec<f64>) {
        let (normal, middle) = (self.problem.mesh.patch(leaf).normal(), triangle.iter().sum::<Vec3>() / 3.0);
        for corner in triangle {
            let receiver = Receiver { point: corner.lerp(middle, CORNER_INSET), normal };
            irradiance.extend_from_slice(gatherer.irradiance(&receiver, self.expected(leaf)));
        }
    }
}

/// What cuts the elements.
struct Edges {
    /// What casts the shadows.
    lamps: Vec<Patch>,
    /// Most lines that cut an element.
    most: usize,
}

/// Most lines that cut each of some elements.
fn most_lines(elements: usize) -> usize {
    (MOST_TRIANGLES / elements.max(1)).isqrt().min(MOST_LINES)
}

/// The parts of lines in a polygon that are longest, some at most.
fn longest(corners: &[Vec3], normal: Vec3, lines: &[[Vec3; 2]], most: usize) -> Vec<[Vec3; 2]> {
    let mut parts: Vec<[Vec3; 2]> =
        lines.iter().filter_map(|&line| part_inside(corners, normal, line)).collect();
    parts.sort_by(|[a, b], [c, d]| c.distance(*d).total_cmp(&a.distance(*b)));
    parts.truncate(most);
    parts
}

/// The largest flat nodes of which all elements emit.
fn lamps(tree: &Tree, emits: &dyn Fn(usize) -> bool) -> Vec<Patch> {
    let nodes = tree.nodes();
    let mut lit = vec![true; nodes.len()];
    for (i, leaf) in tree.leaves().into_iter().enumerate() {
        lit[leaf as usize] = emits(i);
    }
    for (index, node) in nodes.iter().enumerate().rev() {
        if let Some(parent) = node.parent().filter(|_| !lit[index]) {
            lit[parent as usize] = false;
        }
    }
    let (mut found, mut stack) = (Vec::new(), vec![0]);
    while let Some(index) = stack.pop() {
        let node = &nodes[index as usize];
        match node.patch().filter(|_| lit[index as usize]) {
            Some(patch) => found.push(*patch),
            None => stack.extend(node.children()),
        }
    }
    found
}
