//! A tree of boxes, eight to a node, over the facets of the scene.
//!
//! Boxes are f32, in local coordinates. Each is larger than its contents by [`PADDING`], more than
//! all roundings of a test, so that a box is never missed; what is met in vain costs time and
//! nothing else.
//!
//! References: I. Wald, C. Benthin, S. Boulos, "Getting rid of packets", IEEE Symp. Interactive Ray
//! Tracing 2008, 49–57, [doi:10.1109/RT.2008.4634620](https://doi.org/10.1109/RT.2008.4634620), for
//! the wide nodes; D. Meister, J. Bittner, "Parallel locally-ordered clustering for bounding volume
//! hierarchy construction", IEEE Trans. Vis. Comput. Graph. 24 (2018) 1345–1353,
//! [doi:10.1109/TVCG.2017.2669983](https://doi.org/10.1109/TVCG.2017.2669983), for the binary tree
//! they are made from.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

mod beam;
mod build;
mod nearest;
mod sieve;

use std::ops::Range;

use smallvec::SmallVec;

pub(crate) use crate::eight::WIDTH;

use crate::eight::Eight;
pub(crate) use beam::{Beam, Splat};
pub(crate) use build::bounds;
pub(crate) use nearest::Seeker;
pub(crate) use sieve::Sieve;

/// What is still to visit. Up to 64 entries need no allocation: a tree of a hundred thousand facets
/// is about six levels deep, and a level leaves seven of its eight boxes for later.
type Stack<T> = SmallVec<[T; 64]>;

/// What boxes are padded with: 8 units in the last place of 1, the extent of the scene.
pub(crate) const PADDING: f32 = 8.0 * f32::EPSILON;

/// Eight boxes and what they hold.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Node {
    /// For each axis the least and the largest coordinates of the boxes.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    children: [Child; WIDTH],
}

/// A node, or a leaf: by its place, and a bit that tells which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child(u32);

impl Child {
    const LEAF_FLAG: u32 = 1 << 31;

    fn node(place: usize) -> Self {
        Self(place as u32)
    }

    fn leaf(place: usize) -> Self {
        Self(place as u32 | Self::LEAF_FLAG)
    }

    #[inline(always)]
    fn is_leaf(self) -> bool {
        self.0 & Self::LEAF_FLAG != 0
    }

    #[inline(always)]
    fn place(self) -> usize {
        (self.0 & !Self::LEAF_FLAG) as usize
    }
}

/// The nodes; the root is the first.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
}

/// What goes down the tree to leaves in any order.
pub(crate) trait Visitor<E: Eight> {
    /// Bit i is set where box i is met.
    fn meets(&self, eight: E, node: &Node) -> u32;

    /// Looks at a leaf; `true` ends the walk.
    fn leaf(&mut self, eight: E, leaf: usize) -> bool;
}

/// A new tree, and what its leaves hold.
pub(crate) struct Built {
    pub tree: Tree,
    /// The boxes by their places in the leaves.
    pub order: Vec<u32>,
    /// The run of `order` in each leaf.
    pub leaves: Vec<Range<usize>>,
}

impl Tree {
    /// Walks down to every leaf whose boxes the visitor meets, until it ends the walk. Returns
    /// whether it did.
    #[inline(always)]
    pub(crate) fn any<E: Eight>(&self, eight: E, visitor: &mut impl Visitor<E>) -> bool {
        let mut stack = Stack::new();
        let mut next = Some(0);
        while let Some(index) = next {
            let node = &self.nodes[index as usize];
            let mut met = visitor.meets(eight, node);
            while met != 0 {
                let child = node.children[met.trailing_zeros() as usize % WIDTH];
                met &= met - 1;
                if !child.is_leaf() {
                    stack.push(child.0);
                } else if visitor.leaf(eight, child.place()) {
                    return true;
                }
            }
            next = stack.pop();
        }
        false
    }
}
