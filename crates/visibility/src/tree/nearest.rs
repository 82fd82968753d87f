//! Leaves in the order in which a beam meets them.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::beam::Splat;
use super::{Child, Stack, Tree, WIDTH};
use crate::eight::Eight;

/// What looks for the first of what a beam meets.
pub(crate) trait Seeker<E: Eight> {
    /// Looks at a leaf. Beyond the place on the beam that it returns nothing matters any more.
    fn leaf(&mut self, eight: E, leaf: usize) -> f32;
}

/// A child by where the beam enters it; a place on a beam is never negative, so its bits are in the
/// order of its value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Entry(u64);

impl Entry {
    #[inline(always)]
    fn new(enter: f32, child: Child) -> Self {
        Self(u64::from(enter.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline(always)]
    fn enter(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    fn child(self) -> Child {
        Child(self.0 as u32)
    }
}

/// Sorts a few entries.
#[inline(always)]
fn farthest_first(entries: &mut [Entry]) {
    for i in 1..entries.len() {
        let mut k = i;
        while k > 0 && entries[k - 1] < entries[k] {
            entries.swap(k - 1, k);
            k -= 1;
        }
    }
}

impl Tree {
    /// Walks down to the leaves that the beam meets, near ones first.
    #[inline(always)]
    pub(crate) fn nearest<E: Eight>(&self, eight: E, beam: &mut Splat<E>, seeker: &mut impl Seeker<E>) {
        let mut stack: Stack<Entry> = Stack::new();
        let mut next = Some(Entry::default());
        while let Some(entry) = next {
            if beam.reaches(entry.enter()) {
                let child = entry.child();
                if child.is_leaf() {
                    let end = seeker.leaf(eight, child.place());
                    beam.shorten(eight, end);
                } else {
                    let node = &self.nodes[child.place()];
                    let (enter, leave) = beam.slabs(eight, node);
                    let mut met = eight.at_most(enter, leave);
                    let enter = eight.store(enter);
                    let base = stack.len();
                    let mut nearest = None;
                    while met != 0 {
                        let lane = met.trailing_zeros() as usize % WIDTH;
                        met &= met - 1;
                        let entry = Entry::new(enter[lane], node.children[lane]);
                        let Some(known) = nearest.replace(entry) else { continue };
                        stack.push(entry.max(known));
                        nearest = Some(entry.min(known));
                    }
                    if nearest.is_some() {
                        farthest_first(&mut stack[base..]);
                        next = nearest;
                        continue;
                    }
                }
            }
            next = stack.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_in_the_order_of_their_places() {
        let places = [0.25, 1.0, 0.0, 0.5, 1e-30, 0.75];
        let mut entries = [0, 1, 2, 3, 4, 5].map(|leaf| Entry::new(places[leaf], Child::leaf(leaf)));
        farthest_first(&mut entries);
        assert_eq!(entries.map(|entry| entry.child().place()), [1, 5, 3, 0, 4, 2]);
    }
}
