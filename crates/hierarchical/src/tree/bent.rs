//! Bent clusters: elements that lie near each other and face about the same way, linked as one.
//!
//! Such a cluster stands for its members by up to [`PARTS`] of its parts. What a part far from a
//! source receives is a·Φ with its area vector a = Σ A n and the vector irradiance Φ, as long as
//! all members look at the source. A. J. Willmott, P. S. Heckbert, M. Garland, *Face cluster
//! radiosity*, Rendering Techniques '99, 293–304; F. X. Sillion 1995, doi:10.1109/2945.466719.
//! Lengths in metres.

use super::{NO_NODE, Node, Tree};
use fredholm_mesh::Vec3;

/// Parts that stand for a bent cluster, at most.
const PARTS: usize = 8;
/// Largest angle between the normals of a bent cluster and their axis.
const WIDEST_ANGLE: f64 = 1.4;
/// The same where it has fewer elements than would be parts.
const WIDEST_OF_FEW: f64 = 0.5;

/// Area vector, centre of area and a member near it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gist {
    pub vector: Vec3,
    pub centre: Vec3,
    pub middle: u32,
    /// Whether the node may be linked though it is not flat.
    pub bent: bool,
}

/// Finds the gists of all clusters, from the elements up.
pub(super) fn summarise(tree: &mut Tree) {
    for index in (0..tree.nodes.len()).rev() {
        if tree.nodes[index].root == NO_NODE {
            let node = &tree.nodes[index];
            let bent = node.patch.is_none() && is_fine(tree, index as u32);
            tree.nodes[index].gist = Gist { bent, ..gist(tree, node) };
        }
    }
}

/// Whether a function over a cluster may be linear: it has many parts, or few elements that hardly
/// bend. Over the two sides of an edge it is not, whatever is sent there.
fn is_fine(tree: &Tree, index: u32) -> bool {
    let (parts, angle) = (tree.parts(index), tree.nodes[index as usize].cone.angle);
    let elements = || parts.iter().all(|&part| tree.nodes[part as usize].root != NO_NODE);
    angle <= WIDEST_ANGLE && parts.len() == PARTS || angle <= WIDEST_OF_FEW && elements()
}

fn gist(tree: &Tree, node: &Node) -> Gist {
    let parts = || node.children().iter().map(|&child| &tree.nodes[child as usize]);
    let centre = parts().map(|part| part.gist.centre * part.area).sum::<Vec3>() / node.area;
    let vector = parts().map(|part| part.gist.vector).sum();
    let far = |middle: u32| tree.nodes[middle as usize].gist.centre.distance_squared(centre);
    let nearer = |a: u32, b: u32| if far(b) < far(a) { b } else { a };
    let middle = parts().map(|part| part.gist.middle).reduce(nearer).unwrap_or(0);
    Gist { vector, centre, middle, bent: false }
}

impl Tree {
    /// The parts that stand for a cluster: the largest ones are divided, down to flat nodes, until
    /// there are enough.
    pub(crate) fn parts(&self, index: u32) -> Vec<u32> {
        let mut parts = Vec::with_capacity(PARTS);
        parts.push(index);
        while parts.len() < PARTS {
            let divisible = |&k: &usize| self.nodes[parts[k] as usize].patch.is_none();
            let area = |k: usize| self.nodes[parts[k] as usize].area;
            let larger = |a: usize, b: usize| if area(b) > area(a) { b } else { a };
            let Some(largest) = (0..parts.len()).filter(divisible).reduce(larger) else { break };
            let divided = parts.swap_remove(largest);
            parts.extend(self.nodes[divided as usize].children());
        }
        parts
    }
}
