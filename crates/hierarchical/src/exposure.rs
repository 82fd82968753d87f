//! Which part of every leaf sees a lit side or the open: what stands on a floor buries the part under it.
//!
//! A node is looked at once, on a grid of points; what is wholly exposed or wholly buried is so in all of its parts.

use crate::opening::Opening;
use crate::{HierarchyError, Tree};
use fredholm_coupling::{Extent, exposed_share};
use fredholm_mesh::{Mesh, Patch};
use fredholm_visibility::Occluders;
use rayon::prelude::*;

/// Points along a side of the grid over an input element, and of the one where it is partly buried.
const WHOLE: [usize; 2] = [6, 16];
/// Points along a side of the grid over a part of a partly buried element.
const PART: usize = 4;

/// Exposed shares of the nodes that were looked at, and what is needed to look at others.
pub(crate) struct Exposure<'a> {
    patches: Vec<&'a Patch>,
    lit: Occluders,
    /// Of the nodes of a tree; not a number where it is not known.
    shares: Vec<f64>,
}

impl<'a> Exposure<'a> {
    pub fn new(mesh: &'a Mesh) -> Result<Self, HierarchyError> {
        let patches: Vec<&Patch> = mesh.patches().collect();
        let lit = Occluders::new(&patches.iter().map(|patch| **patch).collect::<Vec<_>>())?;
        Ok(Self { patches, lit, shares: Vec::new() })
    }

    /// What rays from the input elements meet; `reflectance` is the largest one.
    pub fn opening(&self, reflectance: f64) -> Opening {
        Opening::new(&self.patches, &self.lit, reflectance)
    }

    /// Areas and exposed areas of the leaves, m². The tree must be that of the call before, or grown from it.
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
        if node.root().is_none_or(|root| tree.roots()[root] != index) {
            return on_grid(PART);
        }
        let first = on_grid(WHOLE[0]);
        if first > 0.0 && first < 1.0 { on_grid(WHOLE[1]) } else { first }
    }
}
