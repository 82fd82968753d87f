//! Columns of the exchange matrix for single elements and for flat groups of them, computed when
//! they are asked for: G_iS = Σ_{j∈S} G_ij (m²).
//!
//! A group is a rectangle that its elements fill, so its column is the exchange of the rectangle
//! with every element and costs as much as that of one element. Shooting from patches that are
//! larger than the elements which receive is due to M. F. Cohen, D. P. Greenberg, D. S. Immel & P.
//! J. Brock, IEEE Computer Graphics and Applications 6 (3), 1986, doi:10.1109/MCG.1986.276629; here
//! patches of all sizes shoot.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use fredholm_linop::{Columns, Symmetry};
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;
use rayon::prelude::*;

use crate::form_factor::{Exchange, PairIntegrator, Workspace};
use crate::occlusion::{Bound, Clusters, Node, Panel, walk_from};

/// Receivers that one thread takes at a time.
const CHUNK: usize = 512;
/// Relative difference up to which the areas of elements fill a rectangle.
const AREA_TOLERANCE: f64 = 1e-9;

/// The elements of a scene, and flat groups of them that can shoot as one.
#[derive(Clone, Debug)]
pub struct Groups {
    clusters: Clusters,
    elements: usize,
    /// Nodes of the tree, a group each.
    nodes: Vec<usize>,
}

impl Groups {
    /// Groups elements of the same `kinds`; places nearer than `tolerance` (m) count as one. An
    /// element of a kind of its own shoots alone.
    ///
    /// # Panics
    /// There are fewer kinds than elements.
    #[must_use]
    pub fn new(elements: &[&Patch], kinds: &[u32], tolerance: f64) -> Self {
        let clusters = Clusters::of_kinds(elements, kinds, tolerance);
        let joined = |node: &Node| {
            let members = &clusters.order[node.places.clone()];
            members.len() == 1 || fills(node, members, elements) && alike(members, kinds)
        };
        let nodes = (0..clusters.nodes.len()).filter(|&k| joined(&clusters.nodes[k])).collect();
        Self { clusters, elements: elements.len(), nodes }
    }

    /// Number of groups, single elements included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The elements in an order in which every group stands together.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.clusters.order[..self.elements]
    }

    /// The places of each group in [`order`](Self::order).
    #[must_use]
    pub fn places(&self) -> Vec<Range<usize>> {
        self.nodes.iter().map(|&node| self.clusters.nodes[node].places.clone()).collect()
    }

    /// The rectangles of groups of several elements.
    fn rectangles(&self) -> impl Iterator<Item = &Patch> {
        let nodes = self.nodes.iter().map(|&node| &self.clusters.nodes[node]);
        nodes.filter(|node| node.children.is_some()).filter_map(|node| match &node.bound {
            Bound::Flat(patch) => Some(patch),
            Bound::Box(_) => None,
        })
    }
}

/// Whether elements fill the rectangle round them.
fn fills(node: &Node, members: &[u32], elements: &[&Patch]) -> bool {
    let Bound::Flat(rectangle) = &node.bound else { return false };
    let area: f64 = members.iter().map(|&k| elements[k as usize].area()).sum();
    (area - rectangle.area()).abs() <= AREA_TOLERANCE * area
}

fn alike(members: &[u32], kinds: &[u32]) -> bool {
    members.iter().all(|&k| kinds[k as usize] == kinds[members[0] as usize])
}

/// What computes the columns of groups.
#[derive(Debug)]
pub struct Emitters<'a> {
    integrator: PairIntegrator<'a>,
    clusters: Clusters,
    elements: usize,
    /// A node of one patch for each group.
    nodes: Vec<usize>,
    /// Bits of the largest error of a form factor so far.
    largest: AtomicU64,
}

impl<'a> Emitters<'a> {
    /// Prepares the columns; `occluders` are what may stand between elements, `tolerance` is that
    /// of [`PairIntegrator`].
    #[must_use]
    pub fn new(
        elements: Vec<&'a Patch>,
        groups: &'a Groups,
        occluders: &'a Occluders,
        tolerance: f64,
    ) -> Self {
        let count = elements.len();
        let integrator = PairIntegrator::with_groups(elements, groups.rectangles(), occluders, tolerance);
        let mut clusters = groups.clusters.clone();
        let nodes = groups.nodes.iter().map(|&node| single(&mut clusters, node)).collect();
        Self { integrator, clusters, elements: count, nodes, largest: AtomicU64::new(0) }
    }

    /// Largest estimated error of a form factor F_Sj or F_jS of the columns so far.
    #[must_use]
    pub fn largest_error(&self) -> f64 {
        f64::from_bits(self.largest.load(Ordering::Relaxed))
    }

    fn exchanges(&self, source: u32, columns: &[u32], panel: &Panel, wholly: usize) -> Vec<Vec<Exchange>> {
        let compute = |(chunk, columns): (usize, &[u32])| {
            let (mut work, mut exchanges) = (Workspace::default(), Vec::new());
            if (source as usize) < self.elements {
                self.integrator.open_row(source as usize, columns, &mut work, &mut exchanges);
            } else {
                self.integrator.open_column(source as usize, columns, &mut work, &mut exchanges);
            }
            for (k, exchange) in exchanges.iter_mut().enumerate() {
                let place = chunk * CHUNK + k;
                if let Some((j, list)) = place.checked_sub(wholly).map(|place| &panel.partly[0][place]) {
                    let pair = [source, *j].map(|patch| patch as usize);
                    *exchange =
                        self.integrator.behind(pair, &panel.lists[list.clone()], *exchange, &mut work);
                }
            }
            exchanges
        };
        columns.par_chunks(CHUNK).enumerate().map(compute).collect()
    }

    /// Remembers the largest error of a form factor.
    fn note(&self, source: u32, columns: &[u32], exchanges: &[Vec<Exchange>]) {
        let error = |(&j, exchange): (&u32, &Exchange)| {
            exchange.stated() / self.integrator.smaller_area(source as usize, j as usize)
        };
        let largest = columns.iter().zip(exchanges.iter().flatten()).map(error).fold(0.0, f64::max);
        self.largest.fetch_max(largest.to_bits(), Ordering::Relaxed);
    }
}

/// The node of a single patch: that of an element, or a new one for the rectangle of a group.
fn single(clusters: &mut Clusters, node: usize) -> usize {
    if clusters.nodes[node].children.is_none() {
        return node;
    }
    let place = clusters.order.len();
    clusters.order.push(place as u32);
    let whole = clusters.nodes[node].clone();
    clusters.nodes.push(Node { places: place..place + 1, children: None, ..whole });
    clusters.nodes.len() - 1
}

impl Columns<f64> for Emitters<'_> {
    fn dim(&self) -> usize {
        self.elements
    }

    fn count(&self) -> usize {
        self.nodes.len()
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::General
    }

    fn diagonal(&self, _: usize) -> f64 {
        0.0
    }

    /// `out[i]` = G_iS, m².
    fn column(&self, group: usize, out: &mut [f64]) {
        let source = self.clusters.order[self.clusters.nodes[self.nodes[group]].places.start];
        let mut panel = walk_from(&self.integrator.sight(&self.clusters), self.nodes[group]);
        let mut columns = std::mem::take(&mut panel.seen[0]);
        columns.retain(|&j| j != source);
        panel.partly[0].retain(|(j, _)| *j != source);
        let wholly = columns.len();
        columns.extend(panel.partly[0].iter().map(|(j, _)| *j));
        out.fill(0.0);
        let exchanges = self.exchanges(source, &columns, &panel, wholly);
        for (&j, exchange) in columns.iter().zip(exchanges.iter().flatten()) {
            out[j as usize] = exchange.value;
        }
        self.note(source, &columns, &exchanges);
    }
}
