//! Which link is too coarse, and which of its nodes to split.
//!
//! The unit of light is the root-mean-square irradiance of the scene in each band. For each node: the *brightness* β, its radiosity in that unit; its *contrast* γ, the deviation of
//! the radiosity within the node; its *level* η, the irradiance in that unit; the latter two may be any number ≥ 0. A link of p and q with form factor F_pq leaves the
//! errors, with what it does not resolve of the variation over each side, s_p and s_q (all of it over a leaf, else what a linear function leaves),
//!
//! - β_q F_pq s_p on the points of p: one function stands for a field that varies otherwise.
//!   Splitting p cures it. What the parts of a large sender do to p goes the same way and adds up:
//!   F_pq is taken to be that of a sender of at least the size of p, and at most 1;
//! - γ_q F_pq s_q on the mean of p: the same for a sender of some contrast. Splitting q cures it;
//! - β_q F_pq d with the uncertainty d of what gets through. Splitting the larger node cures it.
//!
//! They are compared with the irradiance of p. Below the faces an error weighs less: it is the
//! means of faces that accuracy is promised for. On the part of a face that p is, A_p/A_face is the
//! weight of an error of a mean, and a further [`DETAIL_WEIGHT`] that of a deviation from it. The
//! weighting by brightness is that of P. Hanrahan, D. Salzman, L. Aupperle, SIGGRAPH 1991,
//! doi:10.1145/122718.122740.
//!
//! With a [`crate::Goal`] all of this is multiplied by the weight of p in it ([`crate::goal`]).

use crate::tree::{Node, Tree};

/// Weight of deviations within a face.
const DETAIL_WEIGHT: f64 = 0.2;
/// Share of the mean irradiance that counts as present everywhere: nothing is resolved below it.
pub(crate) const LEAST_IRRADIANCE_SHARE: f64 = 0.01;

/// What is known of the light on the nodes.
#[derive(Clone, Debug)]
pub(crate) struct Light {
    /// β, γ, η of each node.
    pub nodes: Vec<[f64; 3]>,
    /// With a goal: the weight of each node in it, at most 1.
    pub weights: Option<Vec<f64>>,
}

/// What to do with a pair of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Keep,
    SplitA,
    SplitB,
}

/// A pair with its form factors' spreads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub nodes: [u32; 2],
    /// Open exchange, m².
    pub open: f64,
    /// Deviation and rest over both sides.
    pub sides: [[f64; 2]; 2],
    pub doubt: f64,
}

/// Decides by a threshold on the relative error that one link leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Oracle<'a> {
    pub tree: &'a Tree,
    pub light: &'a Light,
    pub threshold: f64,
    /// Whether links have gradients.
    pub linear: bool,
    /// Elements smaller than this are not split, m².
    pub least_area: f64,
}

impl Oracle<'_> {
    pub fn judge(&self, pair: &Candidate) -> Verdict {
        let [a, b] = pair.nodes;
        let [into_a, into_b] = [self.errors(a, b, pair, 0), self.errors(b, a, pair, 1)];
        // Each node's own deviation, and what its contrast does to the other.
        let (mut by_a, mut by_b) = (into_a[0].max(into_b[1]), into_b[0].max(into_a[1]));
        let doubt = into_a[2].max(into_b[2]);
        if self.node(a).area() >= self.node(b).area() {
            by_a = by_a.max(doubt);
        } else {
            by_b = by_b.max(doubt);
        }
        let wanted =
            |by: f64, index: u32| if by > self.threshold && self.divisible(index) { by } else { 0.0 };
        match (wanted(by_a, a), wanted(by_b, b)) {
            (x, y) if x == 0.0 && y == 0.0 => Verdict::Keep,
            (x, y) if x >= y => Verdict::SplitA,
            _ => Verdict::SplitB,
        }
    }

    /// Relative errors on p: of deviation, of contrast, of doubt.
    fn errors(&self, p: u32, q: u32, pair: &Candidate, side: usize) -> [f64; 3] {
        let (node, [_, _, level]) = (self.node(p), self.light.nodes[p as usize]);
        let [brightness, contrast, _] = self.light.nodes[q as usize];
        let factor = pair.open
            / node.area()
            / (LEAST_IRRADIANCE_SHARE + (1.0 - LEAST_IRRADIANCE_SHARE) * level.min(1.0));
        let [mean, detail] = match &self.light.weights {
            None => self.weights(node),
            Some(weights) => self.weights(node).map(|weight| weight * weights[p as usize]),
        };
        // What small parts of a sender do to a large receiver adds up.
        let together = (node.area() / self.node(q).area()).max(1.0);
        let light = (factor * together).min(1.0).max(factor) * brightness;
        [
            detail * light * self.left(p, pair.sides[side]),
            mean * factor * contrast * self.left(q, pair.sides[1 - side]),
            mean * factor * brightness * pair.doubt,
        ]
    }

    /// What is not resolved of a variation over a node: all of it over a leaf, else what a linear
    /// function leaves.
    fn left(&self, index: u32, [deviation, rest]: [f64; 2]) -> f64 {
        if self.linear && !self.node(index).is_leaf() { rest } else { deviation }
    }

    /// Weights of the error of a mean and of deviations from it.
    fn weights(&self, node: &Node) -> [f64; 2] {
        match node.root() {
            None => [1.0, 1.0],
            Some(root) => {
                let whole = self.tree.nodes()[self.tree.roots()[root] as usize].area();
                let share = node.area() / whole;
                [share, DETAIL_WEIGHT * share]
            }
        }
    }

    fn node(&self, index: u32) -> &Node {
        &self.tree.nodes()[index as usize]
    }

    fn divisible(&self, index: u32) -> bool {
        let node = self.node(index);
        !node.is_leaf() || node.area() > 4.0 * self.least_area
    }
}
