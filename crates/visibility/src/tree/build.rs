//! From the boxes of the facets to the tree.

use std::time::Duration;

use glam::{Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;

use super::{Child, Node, PADDING, Tree, VECTORS, WIDTH};
use fredholm_mesh::Vec3;

/// The padded box of a facet.
pub(crate) type Bounds = Aabb;

/// Facets in a leaf, at most.
const LEAF: u32 = 4;

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
    /// The tree over the boxes, and the order in which its leaves refer to them.
    pub(crate) fn new(boxes: &[Bounds]) -> (Self, Vec<u32>) {
        let params = BvhBuildParams {
            pre_split: false,
            max_prims_per_leaf: LEAF,
            ..BvhBuildParams::very_slow_build()
        };
        let binary = build_bvh2(boxes, params, &mut Duration::default());
        let mut tree = Self { nodes: vec![Node::empty()] };
        let mut order = Vec::with_capacity(boxes.len());
        let mut pending = if boxes.is_empty() { vec![] } else { vec![(0, 0)] };
        while let Some((index, source)) = pending.pop() {
            for (slot, &below) in widen(&binary, source).iter().enumerate() {
                let node = &binary.nodes[below];
                let child = if node.is_leaf() {
                    leaf(node, &binary.primitive_indices, &mut order)
                } else {
                    pending.push((tree.nodes.len(), below));
                    tree.nodes.push(Node::empty());
                    Child { first: tree.nodes.len() as u32 - 1, count: 0 }
                };
                tree.nodes[index].set(slot, node.aabb(), child);
            }
        }
        (tree, order)
    }
}

fn leaf(node: &Bvh2Node, indices: &[u32], order: &mut Vec<u32>) -> Child {
    let (first, run) = (order.len() as u32, node.first_index as usize);
    order.extend_from_slice(&indices[run..run + node.prim_count as usize]);
    Child { first, count: node.prim_count }
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
        let slab = [[Vec4::INFINITY; VECTORS], [Vec4::NEG_INFINITY; VECTORS]];
        Self { planes: [slab; 3], children: [Child::default(); WIDTH] }
    }

    fn set(&mut self, slot: usize, aabb: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[axis][0][slot / 4][slot % 4] = aabb.min[axis];
            self.planes[axis][1][slot / 4][slot % 4] = aabb.max[axis];
        }
        self.children[slot] = child;
    }
}
