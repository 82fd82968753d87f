//! A tree of boxes, eight to a node, over the facets of the scene.
//!
//! Boxes are f32, in local coordinates. Each is larger than its contents by [`PADDING`], more than all roundings of a
//! test, so that a box is never missed; what is met in vain costs time and nothing else.
//!
//! References: I. Wald, C. Benthin, S. Boulos, "Getting rid of packets", IEEE Symp. Interactive Ray Tracing 2008,
//! 49–57, [doi:10.1109/RT.2008.4634620](https://doi.org/10.1109/RT.2008.4634620), for the wide nodes; D. Meister,
//! J. Bittner, "Parallel locally-ordered clustering for bounding volume hierarchy construction", IEEE Trans. Vis.
//! Comput. Graph. 24 (2018) 1345–1353, [doi:10.1109/TVCG.2017.2669983](https://doi.org/10.1109/TVCG.2017.2669983), for
//! the binary tree they are made from.

mod beam;
mod build;
mod nearest;
mod sieve;
mod stack;

use std::ops::Range;

use glam::Vec4;

pub(crate) use beam::Beam;
pub(crate) use build::bounds;
pub(crate) use sieve::Sieve;
use stack::Stack;

/// What boxes are padded with: 8 units in the last place of 1, the extent of the scene.
pub(crate) const PADDING: f32 = 8.0 * f32::EPSILON;

/// Vectors of four boxes in a node.
const VECTORS: usize = 2;
/// Children of a node.
const WIDTH: usize = 4 * VECTORS;

/// One number for each box.
type Lanes = [Vec4; VECTORS];

/// Eight boxes and what they hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// For each axis the least and the largest coordinates of the boxes.
    pub planes: [[Lanes; 2]; 3],
    children: [Child; WIDTH],
}

/// A node (`count` is 0), or a run of facets that starts at `first`.
#[derive(Clone, Copy, Debug, Default)]
struct Child {
    first: u32,
    count: u32,
}

/// The nodes; the root is the first.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    /// Walks down to every leaf whose boxes `meets` accepts (bit i of its answer for box i), until `found` accepts one.
    #[inline]
    pub(crate) fn any(
        &self,
        meets: impl Fn(&Node) -> u32,
        mut found: impl FnMut(Range<usize>) -> bool,
    ) -> bool {
        let mut stack = Stack::default();
        let mut next = Some(0);
        while let Some(index) = next {
            let node = &self.nodes[index as usize];
            let mut met = meets(node);
            while met != 0 {
                let child = node.children[met.trailing_zeros() as usize % WIDTH];
                met &= met - 1;
                if child.count == 0 {
                    stack.push(child.first);
                } else if found(child.range()) {
                    return true;
                }
            }
            next = stack.pop();
        }
        false
    }
}

impl Child {
    fn range(self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}
