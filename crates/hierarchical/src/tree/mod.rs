//! The tree of elements: clusters above the input elements, similar quarters below them.
//!
//! A child has a higher number than its parent, so that a pass over the numbers, forward or
//! backward, visits parents before or after their children. A node is *flat* where its elements
//! fill a convex polygon of three or four corners: then it has a patch. It is *bent* where its
//! elements face about the same way, and *scattered* where they face all ways. P. Hanrahan, D.
//! Salzman, L. Aupperle, SIGGRAPH 1991, doi:10.1145/122718.122740, for the quarters; B. Smits, J.
//! Arvo, D. Greenberg, SIGGRAPH 1994, doi:10.1145/192161.192277, for the clusters. Lengths in
//! metres.

mod bent;
mod cluster;
mod cone;
mod hull;

use crate::HierarchyError;
use bent::Gist;
pub(crate) use cone::Cone;
use fredholm_mesh::{Mesh, Patch, Vec3};

/// Stands for a node that does not exist.
const NO_NODE: u32 = u32::MAX;

/// A node of the tree.
#[derive(Clone, Debug)]
pub struct Node {
    parent: u32,
    children: [u32; 4],
    face: u32,
    root: u32,
    patch: Option<Patch>,
    cone: Cone,
    area: f64,
    gist: Gist,
}

impl Node {
    /// The polygon that its elements fill, where there is one.
    #[must_use]
    pub fn patch(&self) -> Option<&Patch> {
        self.patch.as_ref()
    }

    /// Area of its elements, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The node it is a part of; none for the first.
    #[must_use]
    pub fn parent(&self) -> Option<u32> {
        (self.parent != NO_NODE).then_some(self.parent)
    }

    /// Its parts: two of a cluster, four of an element, none of a leaf.
    #[must_use]
    pub fn children(&self) -> &[u32] {
        let count = self.children.iter().position(|&child| child == NO_NODE).unwrap_or(4);
        &self.children[..count]
    }

    /// The face it lies on; none for a cluster of several elements.
    #[must_use]
    pub fn face(&self) -> Option<usize> {
        (self.face != NO_NODE).then_some(self.face as usize)
    }

    /// The input element it is or lies on, as a leaf of the mesh; none for a cluster.
    #[must_use]
    pub fn root(&self) -> Option<usize> {
        (self.root != NO_NODE).then_some(self.root as usize)
    }

    /// Whether it has no children.
    #[must_use]
    pub fn is_leaf(&self) -> bool {
        self.children[0] == NO_NODE
    }

    /// Whether its elements fill a polygon or face about the same way.
    pub(crate) fn faces_one_way(&self) -> bool {
        self.patch.is_some() || self.gist.bent
    }

    /// Σ A n over its elements, m².
    #[must_use]
    pub fn area_vector(&self) -> Vec3 {
        self.gist.vector
    }

    /// Centre of its area, m.
    pub(crate) fn centre(&self) -> Vec3 {
        self.gist.centre
    }

    /// Number of an element, or of a flat node, near its centre.
    pub(crate) fn middle(&self) -> u32 {
        self.gist.middle
    }

    /// A ball round it, and its normals.
    pub(crate) fn cone(&self) -> &Cone {
        &self.cone
    }
}

/// Clusters and elements of a scene.
#[derive(Clone, Debug)]
pub struct Tree {
    nodes: Vec<Node>,
    roots: Vec<u32>,
    splits: Vec<u32>,
}

impl Tree {
    /// The tree over the leaves of a mesh, none of them split; places nearer than `tolerance` (m)
    /// count as one.
    ///
    /// # Errors
    /// [`HierarchyError::Empty`] for a mesh without elements.
    pub fn new(mesh: &Mesh, tolerance: f64) -> Result<Self, HierarchyError> {
        if mesh.is_empty() {
            return Err(HierarchyError::Empty);
        }
        let mut tree = Self { nodes: Vec::new(), roots: vec![NO_NODE; mesh.len()], splits: Vec::new() };
        cluster::build(mesh, tolerance, &mut tree);
        bent::summarise(&mut tree);
        Ok(tree)
    }

    /// All nodes, parents before children.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The node of each leaf of the mesh.
    #[must_use]
    pub fn roots(&self) -> &[u32] {
        &self.roots
    }

    /// The elements that were split, in order: splitting the same ones again gives the same tree.
    #[must_use]
    pub fn splits(&self) -> &[u32] {
        &self.splits
    }

    /// Numbers of the leaves in the order of the input elements, children in order: one unknown
    /// each.
    #[must_use]
    pub fn leaves(&self) -> Vec<u32> {
        let mut leaves = Vec::new();
        let mut stack: Vec<u32> = self.roots.iter().rev().copied().collect();
        while let Some(node) = stack.pop() {
            match self.nodes[node as usize].children() {
                [] => leaves.push(node),
                children => stack.extend(children.iter().rev()),
            }
        }
        leaves
    }

    /// Splits a leaf into four quarters; an element that has children stays as it is.
    ///
    /// # Errors
    /// [`HierarchyError::Mesh`] where the quarters would be too small for the precision of their
    /// coordinates, and [`HierarchyError::TooLarge`] past 2³² − 2 nodes.
    pub fn split(&mut self, index: u32) -> Result<(), HierarchyError> {
        let node = &self.nodes[index as usize];
        let Some(patch) = node.patch.filter(|_| node.is_leaf()) else { return Ok(()) };
        if self.nodes.len() + 4 >= NO_NODE as usize {
            return Err(HierarchyError::TooLarge);
        }
        let (face, root, first) = (node.face, node.root, self.nodes.len() as u32);
        for (number, quarter) in (first..).zip(patch.split()?) {
            self.nodes.push(Node { parent: index, ..Node::element(quarter, face, root, number) });
        }
        self.nodes[index as usize].children = [first, first + 1, first + 2, first + 3];
        self.splits.push(index);
        Ok(())
    }
}

impl Node {
    fn element(patch: Patch, face: u32, root: u32, number: u32) -> Self {
        let (cone, area) = (Cone::of(&patch), patch.area());
        let gist = Gist { vector: patch.normal() * area, centre: cone.centre, middle: number, bent: false };
        Self { parent: NO_NODE, children: [NO_NODE; 4], face, root, patch: Some(patch), cone, area, gist }
    }

    /// A cluster whose gist is still to be found.
    fn cluster(patch: Option<Patch>, cone: Cone, area: f64) -> Self {
        let gist = Gist { vector: Vec3::ZERO, centre: cone.centre, middle: NO_NODE, bent: false };
        Self {
            parent: NO_NODE,
            children: [NO_NODE; 4],
            face: NO_NODE,
            root: NO_NODE,
            patch,
            cone,
            area,
            gist,
        }
    }
}

impl Tree {
    /// An input element, or a flat node, of a node, chosen with a probability in proportion to its
    /// area by a number `u` in [0, 1).
    pub(crate) fn member(&self, mut index: u32, mut u: f64) -> Option<&Patch> {
        loop {
            let node = &self.nodes[index as usize];
            if let Some(patch) = node.patch() {
                return Some(patch);
            }
            let &[low, high, ..] = node.children() else { return None };
            let share = self.nodes[low as usize].area / node.area;
            (index, u) = if u < share { (low, u / share) } else { (high, (u - share) / (1.0 - share)) };
        }
    }
}

/// Largest distance from the centre to a corner, m.
fn radius(patch: &Patch, centre: Vec3) -> f64 {
    patch.corners().iter().map(|x| x.distance(centre)).fold(0.0, f64::max)
}
