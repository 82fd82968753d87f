//! The operator of all links, y = G x on the leaves of the tree, without its n² entries.
//!
//! Every node has the mean X of the radiosity x over the exposed areas w of its leaves and the
//! first moment M = Σ w x (c_leaf − c)/Σ w about its centre c (*pull*). A link of p and q with the
//! exchange g (m²) and the gradients g_p and g_q brings the power s = g (X_q + g_q·M_q) to p, as s
//! (1 + g_p·(x − c_p)) over its area, and the like to q (*gather*). A node shares its power and its
//! gradient among its children (*push*). So G_ij = Σ g v_i v_j over the links of nodes p that hold
//! i and q that hold j, v_i = (w_i/W_p) (1 + g_p·(c_i − c_p)): symmetric, with the exchanges of the
//! links as sums. Row sums that exceed what a leaf can send are taken back by a diagonal scaling S
//! on both sides, S G S ([`crate::closure`]). One pass over the links serves all bands. P.
//! Hanrahan, D. Salzman, L. Aupperle, SIGGRAPH 1991, doi:10.1145/122718.122740, for constants; H.
//! R. Zatz, SIGGRAPH 1993, doi:10.1145/166117.166150, for higher orders.
//!
//! The links of a receiver are summed in order, by one thread: the bits do not depend on the number
//! of threads.

use crate::Link;
use crate::tree::{Node, Tree};
use fredholm_linop::{LinearOperator, MultiVector, Symmetry};
use fredholm_mesh::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Receivers that one thread takes at a time.
const CHUNK: usize = 256;
/// Share of the area of a buried element that counts as exposed.
const BURIED_SHARE: f64 = 1e-9;
/// Numbers of a node and band: the mean and the three components of the moment or gradient.
const NUMBERS_OF_A_NODE: usize = 4;

/// The bit of an end that says that the receiver is the second node of its link.
const RECEIVER_IS_SECOND: u32 = 1 << 31;
/// Links that the ends can number.
pub(crate) const MOST_LINKS: usize = RECEIVER_IS_SECOND as usize;

/// G on the leaves of a tree.
#[derive(Clone, Debug)]
pub struct HierarchicalOperator {
    parents: Vec<u32>,
    /// Exposed areas, m², and their centres.
    areas: Vec<f64>,
    centres: Vec<Vec3>,
    buried: Vec<bool>,
    leaves: Vec<u32>,
    links: Arc<Vec<Link>>,
    /// The links of receiver p are those that `ends` numbers from `starts[p]` up to
    /// `starts[p + 1]`, with a bit for the side on which p is.
    starts: Vec<usize>,
    ends: Vec<u32>,
    /// S, of each leaf.
    scale: Vec<f64>,
}

impl HierarchicalOperator {
    /// The operator of some links between nodes of a tree. `exposed` are the exposed areas of the
    /// leaves, m²: what is buried neither sends nor receives.
    pub(crate) fn new(tree: &Tree, links: Arc<Vec<Link>>, exposed: &[f64]) -> Self {
        let (nodes, leaves) = (tree.nodes(), tree.leaves());
        let starts = starts(nodes.len(), &links);
        let mut next = starts.clone();
        let mut ends = vec![0; 2 * links.len()];
        for (number, link) in (0..).zip(links.iter()) {
            for (to, side) in [(link.a, 0), (link.b, RECEIVER_IS_SECOND)] {
                ends[next[to as usize]] = number | side;
                next[to as usize] += 1;
            }
        }
        let parents = nodes.iter().map(|node| node.parent().unwrap_or(u32::MAX)).collect();
        let (areas, centres) = areas(tree, &leaves, exposed);
        let limit = |(area, node): (&f64, &Node)| *area <= 2.0 * BURIED_SHARE * node.area();
        let buried = areas.iter().zip(nodes).map(limit).collect();
        let scale = vec![1.0; leaves.len()];
        Self { parents, areas, centres, buried, leaves, links, starts, ends, scale }
    }

    /// Bytes that the operator takes for each link beside the link itself.
    pub(crate) const BYTES_OF_LINK: u64 = 2 * size_of::<u32>() as u64;

    /// Takes another scaling S, one number for each leaf.
    pub(crate) fn set_scale(&mut self, scale: Vec<f64>) {
        self.scale = scale;
    }

    /// S, of each leaf.
    pub(crate) fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// The node of each unknown.
    #[must_use]
    pub fn leaves(&self) -> &[u32] {
        &self.leaves
    }

    /// Whether nothing of a node is exposed.
    pub(crate) fn is_buried(&self, node: usize) -> bool {
        self.buried[node]
    }

    /// Row sums Σ_j G_ij, m².
    #[must_use]
    pub fn row_sums(&self) -> Vec<f64> {
        let ones = MultiVector::from_fn(self.leaves.len(), 1, |_, _| 1.0);
        let mut sums = MultiVector::zeros(self.leaves.len(), 1);
        self.apply(&ones, &mut sums);
        sums.vector(0)
    }

    /// Means over the exposed areas of all nodes of values on the leaves, nodes × right-hand sides.
    #[must_use]
    pub fn means(&self, x: &MultiVector<f64>) -> MultiVector<f64> {
        let pulled = self.pull(x, |_| 1.0);
        MultiVector::from_fn(self.parents.len(), x.rhs_count(), |node, rhs| {
            pulled.row(node)[NUMBERS_OF_A_NODE * rhs]
        })
    }

    /// What a node exchanges with itself, m²; such links have no gradient.
    fn own_exchange(&self, node: usize) -> f64 {
        let own = |(link, _): &(&Link, usize)| link.a == link.b;
        self.received(node).filter(own).map(|(link, _)| link.exchange()).sum()
    }

    /// The links over which a node receives, each with the side on which the node is.
    fn received(&self, node: usize) -> impl Iterator<Item = (&Link, usize)> {
        let ends = &self.ends[self.starts[node]..self.starts[node + 1]];
        ends.iter().map(|end| {
            (&self.links[(end & !RECEIVER_IS_SECOND) as usize], usize::from(end & RECEIVER_IS_SECOND != 0))
        })
    }

    /// Means and moments of all nodes of values on the leaves, each times a factor.
    fn pull(&self, x: &MultiVector<f64>, factor: impl Fn(usize) -> f64) -> MultiVector<f64> {
        let mut pulled = MultiVector::zeros(self.parents.len(), NUMBERS_OF_A_NODE * x.rhs_count());
        for (i, &leaf) in self.leaves.iter().enumerate() {
            let numbers = pulled.row_mut(leaf as usize).chunks_exact_mut(NUMBERS_OF_A_NODE);
            let factor = factor(i);
            numbers.zip(x.row(i)).for_each(|(numbers, &x)| numbers[0] = factor * x);
        }
        for child in (1..self.parents.len()).rev() {
            let (offset, share) = self.place(child);
            let (parent, child) = rows(&mut pulled, self.parents[child] as usize, child);
            for (to, from) in
                parent.chunks_exact_mut(NUMBERS_OF_A_NODE).zip(child.chunks_exact(NUMBERS_OF_A_NODE))
            {
                to[0] += share * from[0];
                (0..3).for_each(|k| to[k + 1] += share * (from[k + 1] + from[0] * offset[k]));
            }
        }
        pulled
    }

    /// Offset of the centre of a child from that of its parent, m, and its share of the exposed
    /// area.
    fn place(&self, child: usize) -> (Vec3, f64) {
        let parent = self.parents[child] as usize;
        (self.centres[child] - self.centres[parent], self.areas[child] / self.areas[parent])
    }

    /// The power and its gradient that reach each node over its own links.
    fn gather(&self, pulled: &MultiVector<f64>) -> MultiVector<f64> {
        let width = pulled.rhs_count();
        let mut power = MultiVector::zeros(pulled.dim(), width);
        power.as_mut_slice().par_chunks_mut(CHUNK * width).enumerate().for_each(|(chunk, rows)| {
            for (at, row) in rows.chunks_exact_mut(width).enumerate() {
                self.receive(chunk * CHUNK + at, pulled, row);
            }
        });
        power
    }

    fn receive(&self, node: usize, pulled: &MultiVector<f64>, power: &mut [f64]) {
        for (link, side) in self.received(node) {
            let (to, from) = (link.gradient[side].as_dvec3(), link.gradient[1 - side].as_dvec3());
            let (sender, exchange) = (if side == 0 { link.b } else { link.a }, link.exchange());
            let sent = pulled.row(sender as usize).chunks_exact(NUMBERS_OF_A_NODE);
            for (power, x) in power.chunks_exact_mut(NUMBERS_OF_A_NODE).zip(sent) {
                let s = exchange * (x[0] + from.x * x[1] + from.y * x[2] + from.z * x[3]);
                power[0] += s;
                (0..3).for_each(|k| power[k + 1] += s * to[k]);
            }
        }
    }

    /// Adds to each node its share of what its ancestors received.
    fn push(&self, power: &mut MultiVector<f64>) {
        for child in 1..self.parents.len() {
            let (offset, share) = self.place(child);
            let (parent, child) = rows(power, self.parents[child] as usize, child);
            for (from, to) in
                parent.chunks_exact(NUMBERS_OF_A_NODE).zip(child.chunks_exact_mut(NUMBERS_OF_A_NODE))
            {
                let rise = offset.x * from[1] + offset.y * from[2] + offset.z * from[3];
                to[0] += share * (from[0] + rise);
                (1..NUMBERS_OF_A_NODE).for_each(|k| to[k] += share * from[k]);
            }
        }
    }
}

/// Two rows, the lower one first.
fn rows(vector: &mut MultiVector<f64>, lower: usize, higher: usize) -> (&mut [f64], &mut [f64]) {
    let width = vector.rhs_count();
    let (before, after) = vector.as_mut_slice().split_at_mut(higher * width);
    (&mut before[lower * width..(lower + 1) * width], &mut after[..width])
}

/// Exposed areas of all nodes, m², and their centres. Where nothing is exposed, a small part of the
/// area stands for it, so that shares are numbers.
fn areas(tree: &Tree, leaves: &[u32], exposed: &[f64]) -> (Vec<f64>, Vec<Vec3>) {
    let nodes = tree.nodes();
    let (mut areas, mut centres) = (vec![0.0; nodes.len()], vec![Vec3::ZERO; nodes.len()]);
    for (&leaf, &exposed) in leaves.iter().zip(exposed) {
        let node = &nodes[leaf as usize];
        areas[leaf as usize] = exposed.max(BURIED_SHARE * node.area());
        centres[leaf as usize] = areas[leaf as usize] * node.cone().centre;
    }
    for (index, parent) in nodes.iter().map(Node::parent).enumerate().rev() {
        if let Some(parent) = parent {
            areas[parent as usize] += areas[index];
            let moment = centres[index];
            centres[parent as usize] += moment;
        }
    }
    let centres = centres.iter().zip(&areas).map(|(moment, area)| *moment / *area).collect();
    (areas, centres)
}

fn starts(nodes: usize, links: &[Link]) -> Vec<usize> {
    let mut starts = vec![0; nodes + 1];
    for end in links.iter().flat_map(|link| [link.a, link.b]) {
        starts[end as usize + 1] += 1;
    }
    for k in 0..nodes {
        starts[k + 1] += starts[k];
    }
    starts
}

impl LinearOperator<f64> for HierarchicalOperator {
    fn dim(&self) -> usize {
        self.leaves.len()
    }

    fn apply(&self, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
        let mut power = self.gather(&self.pull(x, |leaf| self.scale[leaf]));
        self.push(&mut power);
        for (i, &leaf) in self.leaves.iter().enumerate() {
            let numbers = power.row(leaf as usize).chunks_exact(NUMBERS_OF_A_NODE);
            y.row_mut(i).iter_mut().zip(numbers).for_each(|(y, numbers)| *y = self.scale[i] * numbers[0]);
        }
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn entries(&self) -> u64 {
        (self.ends.len() + 2 * self.parents.len()) as u64
    }

    /// No element sees itself, but a bent cluster that is linked with itself gives each of its
    /// elements a share of its own light.
    fn diagonal(&self, _: usize, out: &mut [f64]) {
        let mut own: Vec<f64> = (0..self.parents.len()).map(|node| self.own_exchange(node)).collect();
        for child in 1..own.len() {
            let (_, share) = self.place(child);
            own[child] += share * share * own[self.parents[child] as usize];
        }
        let leaves = self.leaves.iter().zip(&self.scale);
        out.iter_mut()
            .zip(leaves)
            .for_each(|(out, (&leaf, scale))| *out = scale * scale * own[leaf as usize]);
    }
}
