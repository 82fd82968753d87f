//! The operator of all links, y = G x on the leaves of the tree, without its n² entries.
//!
//! The radiosity of a node is the area mean over its leaves (*pull*). A link of the nodes p and q with the exchange g (m²) brings the power g x_q to p and g x_p to q
//! (*gather*); a node shares its power among its children by area (*push*). So G_ij = Σ g A_i A_j/(A_p A_q) over the links of nodes p that hold i and q that hold j: symmetric,
//! with the row sums of the links. One pass over the links serves all bands. P. Hanrahan, D. Salzman, L. Aupperle, SIGGRAPH 1991, doi:10.1145/122718.122740.
//!
//! The links of a receiver are summed in order, by one thread: the bits do not depend on the number of threads.

use crate::Link;
use crate::tree::Tree;
use fredholm_linop::{LinearOperator, MultiVector, Symmetry};
use rayon::prelude::*;

/// Receivers that one thread takes at a time.
const CHUNK: usize = 256;

/// G on the leaves of a tree.
#[derive(Clone, Debug)]
pub struct HierarchicalOperator {
    parents: Vec<u32>,
    areas: Vec<f64>,
    leaves: Vec<u32>,
    /// The links of receiver p are those from `starts[p]` up to `starts[p + 1]`.
    starts: Vec<usize>,
    senders: Vec<u32>,
    exchanges: Vec<f64>,
}

impl HierarchicalOperator {
    /// The operator of some links between nodes of a tree.
    #[must_use]
    pub fn new(tree: &Tree, links: &[Link]) -> Self {
        let nodes = tree.nodes();
        let starts = starts(nodes.len(), links);
        let mut next = starts.clone();
        let (mut senders, mut exchanges) = (vec![0; 2 * links.len()], vec![0.0; 2 * links.len()]);
        for link in links {
            for [to, from] in [[link.a, link.b], [link.b, link.a]] {
                let at = next[to as usize];
                (senders[at], exchanges[at]) = (from, link.exchange());
                next[to as usize] += 1;
            }
        }
        let parents = nodes.iter().map(|node| node.parent().unwrap_or(u32::MAX)).collect();
        let areas = nodes.iter().map(crate::tree::Node::area).collect();
        Self { parents, areas, leaves: tree.leaves(), starts, senders, exchanges }
    }

    /// The node of each unknown.
    #[must_use]
    pub fn leaves(&self) -> &[u32] {
        &self.leaves
    }

    /// Row sums Σ_j G_ij, m².
    #[must_use]
    pub fn row_sums(&self) -> Vec<f64> {
        let ones = MultiVector::from_fn(self.leaves.len(), 1, |_, _| 1.0);
        let mut sums = MultiVector::zeros(self.leaves.len(), 1);
        self.apply(&ones, &mut sums);
        sums.lane(0)
    }

    /// Area means over all nodes of values on the leaves, nodes × lanes.
    #[must_use]
    pub fn pull(&self, x: &MultiVector<f64>) -> MultiVector<f64> {
        let mut means = MultiVector::zeros(self.parents.len(), x.lanes());
        for (i, &leaf) in self.leaves.iter().enumerate() {
            means.row_mut(leaf as usize).copy_from_slice(x.row(i));
        }
        for child in (1..self.parents.len()).rev() {
            self.to_parent(child, &mut means);
        }
        means
    }

    fn to_parent(&self, child: usize, means: &mut MultiVector<f64>) {
        let (parent, lanes) = (self.parents[child] as usize, means.lanes());
        let share = self.areas[child] / self.areas[parent];
        let (before, from) = means.as_mut_slice().split_at_mut(child * lanes);
        let to = &mut before[parent * lanes..(parent + 1) * lanes];
        to.iter_mut().zip(&from[..lanes]).for_each(|(to, from)| *to += share * from);
    }

    /// The power that reaches each node over its own links, nodes × lanes.
    fn gather(&self, means: &MultiVector<f64>) -> MultiVector<f64> {
        let lanes = means.lanes();
        let mut power = MultiVector::zeros(means.dim(), lanes);
        power.as_mut_slice().par_chunks_mut(CHUNK * lanes).enumerate().for_each(|(chunk, rows)| {
            for (at, row) in rows.chunks_exact_mut(lanes).enumerate() {
                self.receive(chunk * CHUNK + at, means, row);
            }
        });
        power
    }

    fn receive(&self, node: usize, means: &MultiVector<f64>, power: &mut [f64]) {
        let range = self.starts[node]..self.starts[node + 1];
        for (&sender, &exchange) in self.senders[range.clone()].iter().zip(&self.exchanges[range]) {
            let sent = means.row(sender as usize);
            power.iter_mut().zip(sent).for_each(|(power, x)| *power += exchange * x);
        }
    }

    /// Adds to each node its share of what its ancestors received.
    fn push(&self, power: &mut MultiVector<f64>) {
        let lanes = power.lanes();
        for child in 1..self.parents.len() {
            let parent = self.parents[child] as usize;
            let share = self.areas[child] / self.areas[parent];
            let (before, to) = power.as_mut_slice().split_at_mut(child * lanes);
            let from = &before[parent * lanes..(parent + 1) * lanes];
            to[..lanes].iter_mut().zip(from).for_each(|(to, from)| *to += share * from);
        }
    }
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
        let mut power = self.gather(&self.pull(x));
        self.push(&mut power);
        for (i, &leaf) in self.leaves.iter().enumerate() {
            y.row_mut(i).copy_from_slice(power.row(leaf as usize));
        }
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn entries(&self) -> u64 {
        (self.senders.len() + 2 * self.parents.len()) as u64
    }

    /// No element sees itself.
    fn diagonal(&self, _: usize, out: &mut [f64]) {
        out.fill(0.0);
    }
}
