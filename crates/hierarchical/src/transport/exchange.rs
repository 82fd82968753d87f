//! Open exchanges of many pairs of nodes, m², in batches that share a node.

use crate::Link;
use crate::tree::Tree;
use fredholm_coupling::form_factor::{Exchange, Unoccluded, Work};
use fredholm_mesh::Patch;
use rayon::prelude::*;

/// Links that one thread takes at a time.
const CHUNK: usize = 512;

/// Sets the open exchanges of links between flat nodes, which must be sorted by their first node, to a relative `tolerance`.
pub(crate) fn exchanges(tree: &Tree, links: &mut [Link], tolerance: f64) {
    let nodes = tree.nodes();
    let mut places = vec![u32::MAX; nodes.len()];
    let mut patches: Vec<&Patch> = Vec::new();
    for (place, patch) in places.iter_mut().zip(nodes).filter_map(|(p, node)| Some((p, node.patch()?))) {
        *place = patches.len() as u32;
        patches.push(patch);
    }
    let open = Unoccluded::new(&patches, tolerance);
    links.par_chunks_mut(CHUNK).for_each_init(Work::default, |work, chunk| {
        for same in chunk.chunk_by_mut(|x, y| x.a == y.a) {
            row(&open, &places, same, work);
        }
    });
}

/// The links of one node.
fn row(open: &Unoccluded, places: &[u32], links: &mut [Link], work: &mut Work) {
    let others: Vec<u32> = links.iter().map(|link| places[link.b as usize]).collect();
    let mut found = vec![NOTHING; links.len()];
    open.row(places[links[0].a as usize] as usize, &others, work, &mut found);
    for (link, exchange) in links.iter_mut().zip(found) {
        link.open = exchange.value;
    }
}

const NOTHING: Exchange =
    Exchange { value: 0.0, error: 0.0, method: fredholm_coupling::form_factor::Method::Hidden };
