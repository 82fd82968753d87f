//! Which part of every leaf sees a lit side or the open: what stands on a floor buries the part under it.
//!
//! Input elements are looked at once. Only those that are buried in part are looked at leaf by leaf.

use crate::{HierarchicalOperator, HierarchyError, Tree};
use fredholm_coupling::{Extent, exposed_share, extents};
use fredholm_mesh::{Mesh, Patch};
use fredholm_visibility::Occluders;
use rayon::prelude::*;

/// Exposed shares of the input elements, and what is needed to find those of their parts.
pub(crate) struct Exposure<'a> {
    patches: Vec<&'a Patch>,
    lit: Occluders,
    shares: Vec<f64>,
}

impl<'a> Exposure<'a> {
    pub fn new(mesh: &'a Mesh) -> Result<Self, HierarchyError> {
        let patches: Vec<&Patch> = mesh.patches().collect();
        let lit = Occluders::new(&patches.iter().map(|patch| **patch).collect::<Vec<_>>())?;
        let shares = patches.par_iter().map(|patch| exposed_share(patch, &patches, &lit)).collect();
        Ok(Self { patches, lit, shares })
    }

    /// Areas and exposed areas of the leaves, m².
    pub fn extents(&self, tree: &Tree, operator: &HierarchicalOperator) -> Vec<Extent> {
        let leaves: Vec<&Patch> =
            operator.leaves().iter().filter_map(|&leaf| tree.nodes()[leaf as usize].patch()).collect();
        let shares: Vec<f64> = operator.leaves().par_iter().map(|&leaf| self.share(tree, leaf)).collect();
        extents(&leaves, &shares, &operator.row_sums())
    }

    fn share(&self, tree: &Tree, leaf: u32) -> f64 {
        let node = &tree.nodes()[leaf as usize];
        let whole = node.root().map_or(1.0, |root| self.shares[root]);
        match node.patch() {
            Some(patch) if whole > 0.0 && whole < 1.0 => exposed_share(patch, &self.patches, &self.lit),
            _ => whole,
        }
    }
}
