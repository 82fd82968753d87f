//! Open exchanges of many pairs of nodes, m², in batches that share a node.

use crate::Link;
use crate::tree::Tree;
use fredholm_coupling::form_factor::{Exchange, Unoccluded, Work};
use fredholm_mesh::Patch;
use rayon::prelude::*;

/// Links that one thread takes at a time.
const CHUNK: usize = 512;

/// Sets the open exchanges of links between flat nodes to a relative `tolerance`; the links must be
/// sorted by their first node.
pub(crate) fn exchanges(tree: &Tree, links: &mut [Link], tolerance: f64) {
    let nodes = tree.nodes();
    let flat = |link: &Link| [link.a, link.b].iter().all(|&node| nodes[node as usize].patch().is_some());
    let mut places = vec![u32::MAX; nodes.len()];
    for link in links.iter().filter(|link| flat(link)) {
        (places[link.a as usize], places[link.b as usize]) = (0, 0);
    }
    let mut patches: Vec<&Patch> = Vec::new();
    for (place, node) in places.iter_mut().zip(nodes).filter(|(place, _)| **place == 0) {
        *place = patches.len() as u32;
        patches.extend(node.patch());
    }
    let open = Unoccluded::new(&patches, tolerance);
    links.par_chunks_mut(CHUNK).for_each_init(Work::default, |work, chunk| {
        for same in chunk.chunk_by_mut(|x, y| x.a == y.a) {
            let mut same: Vec<&mut Link> = same.iter_mut().filter(|link| flat(link)).collect();
            row(&open, &places, &mut same, work);
        }
    });
}

/// The links of one node.
fn row(open: &Unoccluded, places: &[u32], links: &mut [&mut Link], work: &mut Work) {
    let Some(first) = links.first().map(|link| places[link.a as usize] as usize) else { return };
    let others: Vec<u32> = links.iter().map(|link| places[link.b as usize]).collect();
    let mut found = vec![Exchange::NONE; links.len()];
    open.row(first, &others, work, &mut found);
    for (link, exchange) in links.iter_mut().zip(found) {
        link.open = exchange.value;
    }
}
