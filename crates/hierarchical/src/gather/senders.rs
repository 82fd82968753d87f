//! What all nodes send: mean and standard deviation of the radiosity over their exposed leaves, and
//! a ball round each.
//!
//! σ² = Σ w (σ_c² + (B̄_c − B̄)²)/Σ w over the children c with exposed areas w. W/m², metres.

use super::Leaves;
use crate::Tree;
use fredholm_linop::MultiVector;
use fredholm_mesh::{Bounds, Patch, Vec3};

/// Share of the area of a buried leaf that counts as exposed, so that shares are numbers.
const BURIED_SHARE: f64 = 1e-9;

#[derive(Debug)]
pub(super) struct Senders {
    /// Means, nodes × bands.
    mean: MultiVector<f64>,
    /// Standard deviations, nodes × bands.
    deviation: MultiVector<f64>,
    /// Centres and radii.
    balls: Vec<(Vec3, f64)>,
}

impl Senders {
    pub fn new(tree: &Tree, order: &[u32], leaves: &Leaves) -> Self {
        let (nodes, bands) = (tree.nodes().len(), leaves.radiosity.rhs_count());
        let mut senders = Self {
            mean: MultiVector::zeros(nodes, bands),
            deviation: MultiVector::zeros(nodes, bands),
            balls: balls(tree),
        };
        let mut areas = vec![0.0; nodes];
        for (i, &leaf) in order.iter().enumerate() {
            let area = tree.nodes()[leaf as usize].area();
            areas[leaf as usize] = leaves.exposed[i].max(BURIED_SHARE * area);
            senders.mean.row_mut(leaf as usize).copy_from_slice(leaves.radiosity.row(i));
        }
        for node in (0..nodes).rev() {
            senders.add_up(tree, node, &mut areas);
        }
        senders
    }

    pub fn bytes(nodes: usize, bands: usize) -> u64 {
        (nodes * (16 * bands + size_of::<(Vec3, f64)>() + 8)) as u64
    }

    /// Mean and deviation of a node from those of its children.
    fn add_up(&mut self, tree: &Tree, node: usize, areas: &mut [f64]) {
        let children = tree.nodes()[node].children();
        if children.is_empty() {
            return;
        }
        areas[node] = children.iter().map(|&c| areas[c as usize]).sum();
        for band in 0..self.mean.rhs_count() {
            let share = |c: u32| areas[c as usize] / areas[node];
            let mean: f64 = children.iter().map(|&c| share(c) * self.mean.row(c as usize)[band]).sum();
            let square = |&c: &u32| {
                let (b, s) = (self.mean.row(c as usize)[band], self.deviation.row(c as usize)[band]);
                share(c) * (s * s + (b - mean) * (b - mean))
            };
            let square: f64 = children.iter().map(square).sum();
            (self.mean.row_mut(node)[band], self.deviation.row_mut(node)[band]) = (mean, square.sqrt());
        }
    }

    pub fn mean(&self, node: u32) -> &[f64] {
        self.mean.row(node as usize)
    }

    pub fn deviation(&self, node: u32) -> &[f64] {
        self.deviation.row(node as usize)
    }

    /// Centre and radius of a ball that holds a node.
    pub fn ball(&self, node: u32) -> (Vec3, f64) {
        self.balls[node as usize]
    }

    /// Whether nothing comes from any part of a node.
    pub fn is_dark(&self, node: u32) -> bool {
        self.mean(node).iter().chain(self.deviation(node)).all(|&x| x == 0.0)
    }
}

/// Balls round the boxes of all nodes.
fn balls(tree: &Tree) -> Vec<(Vec3, f64)> {
    let nodes = tree.nodes();
    let empty = Bounds { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
    let mut boxes = vec![empty; nodes.len()];
    for (index, node) in nodes.iter().enumerate().rev() {
        let corners = node.patch().into_iter().flat_map(Patch::corners);
        let own = corners.fold(boxes[index], |b, &x| Bounds { min: b.min.min(x), max: b.max.max(x) });
        boxes[index] = own;
        if let Some(parent) = node.parent() {
            let whole = &mut boxes[parent as usize];
            *whole = Bounds { min: whole.min.min(own.min), max: whole.max.max(own.max) };
        }
    }
    boxes.into_iter().map(|b| (0.5 * (b.min + b.max), 0.5 * b.min.distance(b.max))).collect()
}
