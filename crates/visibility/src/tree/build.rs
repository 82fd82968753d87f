//! From the boxes of the facets to the tree.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use super::{Built, Child, Node, PADDING, Tree, WIDTH};
use fredholm_mesh::Vec3;

/// The padded box of a facet.
pub(crate) type Bounds = Aabb;

/// Facets in a leaf, at most: those of a packet.
const FACETS_OF_A_LEAF: u32 = WIDTH as u32;
/// What it costs to go through a node of two boxes, over the test of one facet. A packet is tested
/// as a whole, so that as many facets as it holds stay together.
const TRAVERSAL_COST: f32 = 16.0;

/// The padded box of some points.
pub(crate) fn bounds(corners: &[Vec3]) -> Bounds {
    let scaled = |p: &Vec3| Vec3A::from(p.as_vec3());
    let (low, high) = corners
        .iter()
        .map(scaled)
        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    Aabb::new(low - PADDING, high + PADDING)
}

impl Tree {
    /// The tree over the boxes.
    pub(crate) fn over(boxes: &[Bounds]) -> Built {
        let params = BvhBuildParams {
            pre_split: false,
            max_prims_per_leaf: FACETS_OF_A_LEAF,
            collapse_traversal_cost: TRAVERSAL_COST,
            ..BvhBuildParams::very_slow_build()
        };
        let binary = build_bvh2(boxes, params, &mut Duration::default());
        let mut built = Built {
            tree: Self { nodes: vec![Node::empty()] },
            order: Vec::with_capacity(boxes.len()),
            leaves: Vec::new(),
        };
        let mut pending = if boxes.is_empty() { vec![] } else { vec![(0, 0)] };
        while let Some((index, source)) = pending.pop() {
            for (slot, &below) in widen(&binary, source).iter().enumerate() {
                let node = &binary.nodes[below];
                let nodes = &mut built.tree.nodes;
                let child = if node.is_leaf() {
                    let (first, run) = (built.order.len(), node.first_index as usize);
                    let end = run + node.prim_count as usize;
                    built.order.extend_from_slice(&binary.primitive_indices[run..end]);
                    built.leaves.push(first..built.order.len());
                    Child::leaf(built.leaves.len() - 1)
                } else {
                    pending.push((nodes.len(), below));
                    nodes.push(Node::empty());
                    Child::node(nodes.len() - 1)
                };
                nodes[index].set(slot, node.aabb(), child);
            }
        }
        built
    }
}

/// Up to eight descendants of a node of the binary tree that cover it: the largest is opened first.
fn widen(binary: &Bvh2, root: usize) -> Vec<usize> {
    let mut cover = vec![root];
    let area = |&i: &usize| binary.nodes[i].aabb().half_area();
    while cover.len() < WIDTH {
        let inner = (0..cover.len()).filter(|&k| !binary.nodes[cover[k]].is_leaf());
        let Some(k) = inner.max_by(|&i, &j| area(&cover[i]).total_cmp(&area(&cover[j]))) else { break };
        let first = binary.nodes[cover[k]].first_index as usize;
        cover[k] = first;
        cover.push(first + 1);
    }
    cover.sort_by(|i, j| area(j).total_cmp(&area(i)));
    cover
}

impl Node {
    /// Boxes that nothing meets.
    fn empty() -> Self {
        let slab = [[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]];
        Self { planes: [slab; 3], children: [Child::default(); WIDTH] }
    }

    fn set(&mut self, slot: usize, aabb: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[axis][0][slot] = aabb.min[axis];
            self.planes[axis][1][slot] = aabb.max[axis];
        }
        self.children[slot] = child;
    }
}
