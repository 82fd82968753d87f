//! Which part of every leaf sees a lit side or the open: what stands on a floor buries the part
//! under it.
//!
//! Of an input element its rays tell it; where it is partly buried, it and its parts are looked at
//! once, on grids of points. What is wholly exposed or wholly buried is so in all of its parts.

use crate::opening::Opening;
use crate::{HierarchyError, Tree};
use fredholm_coupling::{Extent, exposed_share};
use fredholm_mesh::{Mesh, Patch};
use fredholm_visibility::Occluders;
use rayon::prelude::*;

/// Points along a side of the grid over an input element that is partly buried.
const POINTS_ALONG_ELEMENT: usize = 16;
/// Points along a side of the grid over a part of it.
const POINTS_ALONG_PART: usize = 4;

/// Exposed shares of the nodes that were looked at, and what is needed to look at others.
pub(crate) struct Exposure<'a> {
    patches: Vec<&'a Patch>,
    lit: Occluders,
    opening: Opening,
    /// Of the nodes of a tree; not a number where it is not known.
    shares: Vec<f64>,
}

impl<'a> Exposure<'a> {
    /// Sends the rays of the elements; `reflectance` is the largest one.
    pub fn new(mesh: &'a Mesh, reflectance: f64) -> Result<Self, HierarchyError> {
        let patches: Vec<&Patch> = mesh.patches().collect();
        let lit = Occluders::new(&patches.iter().map(|patch| **patch).collect::<Vec<_>>())?;
        let opening = Opening::new(&patches, &lit, reflectance);
        Ok(Self { patches, lit, opening, shares: Vec::new() })
    }

    /// What rays from the input elements meet.
    pub fn opening(&self) -> &Opening {
        &self.opening
    }

    /// Areas and exposed areas of the leaves, m². The tree must be that of the call before, or
    /// grown from it.
    pub fn extents(&mut self, tree: &Tree, leaves: &[u32]) -> Vec<Extent> {
        let known = self.shares.len();
        self.shares.resize(tree.nodes().len(), f64::NAN);
        let mut asked = Vec::new();
        for index in known..tree.nodes().len() {
            self.find(tree, index as u32, &mut asked);
        }
        self.look(tree, &mut asked);
        let extent = |&leaf: &u32| {
            let area = tree.nodes()[leaf as usize].area();
            Extent { area, exposed: self.shares[leaf as usize] * area }
        };
        leaves.iter().map(extent).collect()
    }

    /// Takes the share of a node from its parent, or adds it to the nodes to be looked at.
    fn find(&mut self, tree: &Tree, index: u32, asked: &mut Vec<u32>) {
        let node = &tree.nodes()[index as usize];
        let Some(root) = node.root() else { return };
        let parent = node.parent().filter(|_| tree.roots()[root] != index);
        if parent.is_some_and(|parent| self.shares[parent as usize].is_nan()) {
            self.look(tree, asked);
        }
        match parent.map(|parent| self.shares[parent as usize]) {
            Some(share) if share <= 0.0 || share >= 1.0 => self.shares[index as usize] = share,
            _ => asked.push(index),
        }
    }

    /// Looks at nodes, in parallel.
    fn look(&mut self, tree: &Tree, asked: &mut Vec<u32>) {
        let found: Vec<f64> = asked.par_iter().map(|&index| self.share(tree, index)).collect();
        for (index, share) in asked.drain(..).zip(found) {
            self.shares[index as usize] = share;
        }
    }

    fn share(&self, tree: &Tree, index: u32) -> f64 {
        let node = &tree.nodes()[index as usize];
        let Some(patch) = node.patch() else { return 1.0 };
        let on_grid = |n: usize| exposed_share(patch, n, &self.patches, &self.lit);
        match node.root().filter(|&root| tree.roots()[root] == index) {
            None => on_grid(POINTS_ALONG_PART),
            Some(element) => {
                let first = self.opening.exposed(element);
                if first > 0.0 && first < 1.0 { on_grid(POINTS_ALONG_ELEMENT) } else { first }
            }
        }
    }
}
