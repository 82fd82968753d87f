//! Leaves in the order in which a beam meets them.

use std::ops::Range;

use super::{Beam, Node, Tree, VECTORS, WIDTH};

/// A child that was met, and where.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    enter: f32,
    slot: usize,
}

impl Tree {
    /// Walks down to the leaves that the beam meets, near ones first. `found` answers the fraction of the probe from
    /// which on nothing matters any more.
    pub(crate) fn nearest(&self, beam: &Beam, mut found: impl FnMut(Range<usize>) -> f64) {
        let mut beam = *beam;
        let mut pending: Vec<(f32, u32)> = vec![(0.0, 0)];
        while let Some((enter, index)) = pending.pop() {
            if !beam.reaches(enter) {
                continue;
            }
            let node = &self.nodes[index as usize];
            let (met, count) = sorted(&beam, node);
            for met in met[..count].iter().rev() {
                let child = node.children[met.slot];
                if child.count == 0 {
                    pending.push((met.enter, child.first));
                }
            }
            for met in &met[..count] {
                let child = node.children[met.slot];
                if child.count > 0 && beam.reaches(met.enter) {
                    beam = beam.up_to(found(child.range()));
                }
            }
        }
    }
}

/// The met boxes by rising entry.
fn sorted(beam: &Beam, node: &Node) -> ([Met; WIDTH], usize) {
    let (mut sorted, mut count) = ([Met::default(); WIDTH], 0);
    for i in 0..VECTORS {
        let (enter, leave) = beam.slabs(node, i);
        let mut mask = enter.cmple(leave).bitmask();
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % 4;
            mask &= mask - 1;
            let mut place = count;
            while place > 0 && sorted[place - 1].enter > enter[lane] {
                sorted[place] = sorted[place - 1];
                place -= 1;
            }
            sorted[place] = Met { enter: enter[lane], slot: 4 * i + lane };
            count += 1;
        }
    }
    (sorted, count)
}
