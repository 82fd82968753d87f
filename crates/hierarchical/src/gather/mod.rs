//! Final gather: the irradiance of a point from the radiosity of all nodes, E(x) = Σ_q B_q F(x→q),
//! with exact factors of what the point sees of each polygon.
//!
//! The tree is walked from the top. A node is taken as a whole where its radiosity varies too
//! little to matter: of the radiosity B and the kernel K over a node of area A, with standard
//! deviations σ_B and σ_K, the product of the means leaves |∫ (B − B̄)(K − K̄) dA| ≤ A σ_B σ_K
//! (Cauchy and Schwarz). A K is at most the bound F of the factor of a ball round the node, and
//! σ_K/K at most about 2 r/d where nothing is in the way, else 1. A node is taken where that is
//! below a share of the irradiance expected at the point; leaves always.
//!
//! Factors are Lambert's sums over the edges of what is visible (P. Schröder & P. Hanrahan,
//! SIGGRAPH 1993, doi:10.1145/166117.166138). Final gathering: M. C. Reichert, *A two-pass
//! radiosity method driven by lights and viewer position*, Cornell University 1992; D. Lischinski,
//! F. Tampieri, D. P. Greenberg, SIGGRAPH 1993, doi:10.1145/166117.166143. W/m².

mod lamps;
mod senders;
mod shadows;
mod walk;

use std::ops::ControlFlow;

use crate::{HierarchyError, Tree};
use fredholm_coupling::Receiver;
use fredholm_linop::{MultiVector, Watch};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::Bodies;
pub use lamps::{Lamps, Lighter};
use rayon::prelude::*;
use senders::Senders;
pub use walk::Gatherer;

/// Points that one thread takes at a time.
const CHUNK: usize = 16;
/// Share of the mean irradiance that counts as present everywhere: nothing is resolved below it.
const IRRADIANCE_FLOOR: f64 = 0.01;

/// A solution as points see it.
#[derive(Debug)]
pub struct Gather<'a> {
    tree: &'a Tree,
    occluders: &'a Occluders,
    bodies: Bodies,
    senders: Senders,
    /// Error that one node may leave, over the irradiance expected.
    share: f64,
    /// Irradiance that counts as present everywhere, of each band, W/m².
    floor: Vec<f64>,
}

/// The radiosity of the leaves of a tree, in their order.
#[derive(Clone, Copy, Debug)]
pub struct Leaves<'a> {
    /// Radiosity of the exposed parts, leaves × bands, W/m².
    pub radiosity: &'a MultiVector<f64>,
    /// Irradiance, leaves × bands, W/m².
    pub irradiance: &'a MultiVector<f64>,
    /// Exposed areas, m².
    pub exposed: &'a [f64],
}

impl<'a> Gather<'a> {
    /// Prepares the gathering from the leaves of a tree. A node may leave an error of `share` of
    /// the irradiance expected at a point; `points` are those that do not lie on the surfaces.
    ///
    /// # Errors
    /// [`HierarchyError::Shape`] for vectors that have not a row a leaf.
    pub fn new(
        tree: &'a Tree,
        leaves: &Leaves,
        occluders: &'a Occluders,
        points: &[Vec3],
        share: f64,
    ) -> Result<Self, HierarchyError> {
        let order = tree.leaves();
        let rows = [leaves.radiosity.dim(), leaves.irradiance.dim(), leaves.exposed.len()];
        let what = ["the radiosity", "the irradiance", "the list of exposed areas"];
        for (what, found) in what.into_iter().zip(rows) {
            if found != order.len() {
                return Err(HierarchyError::Shape { what, found, expected: order.len() });
            }
        }
        let patches: Vec<&Patch> = order.iter().filter_map(|&k| tree.nodes()[k as usize].patch()).collect();
        Ok(Self {
            tree,
            occluders,
            bodies: Bodies::new(occluders, &patches, points),
            senders: Senders::new(tree, &order, leaves),
            share,
            floor: floor(tree, &order, leaves.irradiance),
        })
    }

    /// Bytes that the gathering from a tree of some nodes takes.
    #[must_use]
    pub fn bytes(nodes: usize, bands: usize) -> u64 {
        Senders::bytes(nodes, bands)
    }

    /// The irradiance expected at a point where nothing is known of it, of each band, W/m².
    #[must_use]
    pub fn usual(&self) -> Vec<f64> {
        self.floor.iter().map(|e| e / IRRADIANCE_FLOOR).collect()
    }

    /// The tree that is gathered from.
    #[must_use]
    pub fn tree(&self) -> &'a Tree {
        self.tree
    }

    /// What hides parts of it.
    #[must_use]
    pub fn bodies(&self) -> &Bodies {
        &self.bodies
    }

    /// Gathers for one thread.
    #[must_use]
    pub fn gatherer(&self) -> Gatherer<'_> {
        Gatherer::new(self)
    }

    /// Irradiance of receivers, receivers × bands, W/m², in parallel; `expected` has a row for each
    /// of them.
    ///
    /// # Errors
    /// [`HierarchyError::Shape`] unless `expected` has a row a receiver,
    /// [`HierarchyError::Interrupted`] where the watch wants it no more: it is asked for every
    /// receiver.
    pub fn irradiance(
        &self,
        receivers: &[Receiver],
        expected: &MultiVector<f64>,
        watch: &dyn Watch,
    ) -> Result<MultiVector<f64>, HierarchyError> {
        if expected.dim() != receivers.len() {
            let (found, expected) = (expected.dim(), receivers.len());
            return Err(HierarchyError::Shape { what: "the expected irradiance", found, expected });
        }
        let bands = self.floor.len();
        let mut found = MultiVector::zeros(receivers.len(), bands);
        let chunks = found.as_mut_slice().par_chunks_mut(CHUNK * bands).enumerate();
        let gathered = chunks.try_for_each(|(chunk, rows)| {
            let mut gatherer = self.gatherer();
            for (k, row) in rows.chunks_exact_mut(bands).enumerate() {
                watch.go_on()?;
                let at = chunk * CHUNK + k;
                row.copy_from_slice(gatherer.irradiance(&receivers[at], expected.row(at)));
            }
            ControlFlow::Continue(())
        });
        if gathered.is_break() { Err(HierarchyError::Interrupted) } else { Ok(found) }
    }
}

/// The least irradiance that is resolved: a share of its root mean square over the leaves.
fn floor(tree: &Tree, order: &[u32], irradiance: &MultiVector<f64>) -> Vec<f64> {
    let (mut squares, mut area) = (vec![0.0; irradiance.rhs_count()], 0.0);
    for (i, &leaf) in order.iter().enumerate() {
        let size = tree.nodes()[leaf as usize].area();
        area += size;
        squares.iter_mut().zip(irradiance.row(i)).for_each(|(sum, e)| *sum += size * e * e);
    }
    squares.into_iter().map(|sum| IRRADIANCE_FLOOR * (sum / area).sqrt()).collect()
}
