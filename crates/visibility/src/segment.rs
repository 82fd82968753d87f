//! Is there anything between two points?

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use fredholm_mesh::Vec3;
use rayon::prelude::*;

use crate::Occluders;
use crate::eight::{Eight, Work, run};
use crate::packet::Ends;
use crate::probe::Probe;
use crate::tree::{Beam, Node, Splat, Visitor};

/// Segments that one thread takes at a time.
const CHUNK: usize = 1024;

impl Occluders {
    /// Whether no patch blocks the open segment from `p` to `q`.
    ///
    /// A patch blocks the segment where its plane has `p` and `q` on different sides, both farther
    /// from it than the [tolerance](Self::tolerance), and the segment crosses the patch, outline
    /// included. So a patch that contains an end does not block, from either side, and both
    /// directions have the same answer. A segment without length, or with coordinates that are not
    /// finite or beyond 1e38 times the extent of the scene, meets nothing.
    #[must_use]
    pub fn unoccluded(&self, p: Vec3, q: Vec3) -> bool {
        !run(Blocked { occluders: self, p, q })
    }

    /// Whether none of the `candidates`, indices of patches, blocks the open segment from `p` to
    /// `q`.
    ///
    /// With the list of [`shaft`](Self::shaft) this answers as [`unoccluded`](Self::unoccluded) for
    /// the segments that the list was made for, and faster where it is short. An index that names
    /// no patch blocks nothing.
    #[must_use]
    pub fn unoccluded_by(&self, p: Vec3, q: Vec3, candidates: &[u32]) -> bool {
        let Some(probe) = Probe::segment(p, q, &self.frame) else { return true };
        let mut places = candidates.iter().filter_map(|&patch| self.places.get(patch as usize));
        let crosses = |place: u32| self.crossing(place as usize, &probe).is_some();
        !places.any(|&[first, last]| crosses(first) || (first != last && crosses(last)))
    }

    /// [`unoccluded`](Self::unoccluded) for every segment, in parallel.
    #[must_use]
    pub fn unoccluded_batch(&self, segments: &[(Vec3, Vec3)]) -> Vec<bool> {
        segments.par_iter().with_min_len(CHUNK).map(|&(p, q)| self.unoccluded(p, q)).collect()
    }

    /// [`unoccluded`](Self::unoccluded) for the segments from one point to many, in parallel.
    #[must_use]
    pub fn unoccluded_from(&self, p: Vec3, ends: &[Vec3]) -> Vec<bool> {
        ends.par_iter().with_min_len(CHUNK).map(|&q| self.unoccluded(p, q)).collect()
    }
}

/// Is the segment from p to q blocked?
struct Blocked<'a> {
    occluders: &'a Occluders,
    p: Vec3,
    q: Vec3,
}

impl Work for Blocked<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<E: Eight>(self, eight: E) -> bool {
        let frame = &self.occluders.frame;
        let Some(probe) = Probe::segment(self.p, self.q, frame) else { return false };
        let Some(beam) = Beam::new(&probe, frame) else { return false };
        let ends = Ends::new(eight, &probe);
        let mut crossing =
            Segment { occluders: self.occluders, probe: &probe, beam: beam.splat(eight), ends };
        self.occluders.tree.any(eight, &mut crossing)
    }
}

/// A segment on its way to the first facet that blocks it.
struct Segment<'a, E: Eight> {
    occluders: &'a Occluders,
    probe: &'a Probe,
    beam: Splat<E>,
    ends: Ends<E>,
}

impl<E: Eight> Visitor<E> for Segment<'_, E> {
    #[inline(always)]
    fn meets(&self, eight: E, node: &Node) -> u32 {
        self.beam.meets(eight, node)
    }

    #[inline(always)]
    fn leaf(&mut self, eight: E, leaf: usize) -> bool {
        let packet = &self.occluders.packets[leaf];
        let crossed = packet.crossed(eight, &self.ends, 1.0);
        if crossed.does != 0 {
            return true;
        }
        let mut left = crossed.may;
        while left != 0 {
            let place = packet.place(left.trailing_zeros());
            left &= left - 1;
            if self.occluders.crossing(place, self.probe).is_some() {
                return true;
            }
        }
        false
    }
}
