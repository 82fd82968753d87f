//! Which patches could come between two patches, or between a point and a patch?

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use fredholm_mesh::{Patch, Vec3};

use super::Shaft;
use crate::Occluders;
use crate::body::{Bodies, Body};
use crate::eight::{Eight, Work, run};
use crate::tree::{Node, Sieve, Visitor};

impl Occluders {
    /// Lists the patches that could block a segment between a point of `a` and a point of `b`, by
    /// rising index.
    ///
    /// Only segments that leave `a` and reach `b` on their lit sides count: they carry light. Every
    /// patch that [`unoccluded`](Self::unoccluded) finds on such a segment is in the list, so where
    /// the list is empty each patch sees all of the other that is in front of it. The list may name
    /// patches that block nothing. Patches that only touch the room between `a` and `b`, or reach
    /// into it by less than twice the [tolerance](Self::tolerance), are not in it: neighbours that
    /// share an edge, the floor below a box, and `a` and `b` themselves. Where no part of one lies
    /// in front of the other the list is empty.
    ///
    /// `candidates` is cleared first; a buffer that is used again costs no allocation.
    pub fn shaft(&self, a: &Patch, b: &Patch, candidates: &mut Vec<u32>) {
        candidates.clear();
        if let Some(shaft) = Shaft::between(a, b, &self.frame) {
            self.sift(&shaft, usize::MAX, candidates);
        }
    }

    /// As [`shaft`](Self::shaft), but the search ends after more than `most` patches were found.
    /// Returns whether the list holds all of them.
    pub fn shaft_up_to(&self, a: &Patch, b: &Patch, most: usize, candidates: &mut Vec<u32>) -> bool {
        candidates.clear();
        Shaft::between(a, b, &self.frame).is_none_or(|shaft| self.sift(&shaft, most, candidates))
    }

    /// Lists the patches that could block a segment between the point `p` and a point of `b`, by
    /// rising index.
    ///
    /// As [`shaft`](Self::shaft), for segments that reach `b` on its lit side. Where `p` is not in
    /// front of `b` the list is empty.
    pub fn shaft_point(&self, p: Vec3, b: &Patch, candidates: &mut Vec<u32>) {
        candidates.clear();
        if let Some(shaft) = Shaft::from_point(p, b, &self.frame) {
            self.sift(&shaft, usize::MAX, candidates);
        }
    }

    /// The room that the segments between two patches keep to, or `None` where no part of one lies
    /// in front of the other.
    #[must_use]
    pub fn shaft_between(&self, a: &Patch, b: &Patch) -> Option<Shaft> {
        Shaft::between(a, b, &self.frame)
    }

    /// The room that the segments between a point and a patch keep to, or `None` where the point is
    /// not in front of it.
    #[must_use]
    pub fn shaft_from(&self, p: Vec3, b: &Patch) -> Option<Shaft> {
        Shaft::from_point(p, b, &self.frame)
    }

    /// Whether a body could block a segment that keeps to the shaft. It may say so of one that does
    /// not.
    #[must_use]
    pub fn reaches(&self, body: &Body, shaft: &Shaft) -> bool {
        let tolerance = self.frame.tolerance;
        let beside = body.faces().iter().any(|face| {
            let offset = self.frame.local_length(face.height(self.frame.centre()));
            shaft.corners().iter().all(|x| face.normal.dot(*x) + offset >= -tolerance)
        });
        !beside && !shaft.planes().iter().any(|plane| plane.excludes(&body.local))
    }

    /// The bodies that [reach](Self::reaches) into the shaft, with their numbers.
    pub fn reaching<'b, 's>(
        &'s self,
        bodies: &'b Bodies,
        shaft: &'s Shaft,
    ) -> impl Iterator<Item = (u32, &'b Body)> + use<'b, 's> {
        let near = bodies.balls().iter().zip((0..).zip(bodies.as_slice()));
        let near = near.filter(|(ball, _)| !shaft.capsule.is_beside(**ball)).map(|(_, body)| body);
        near.filter(|(_, body)| self.reaches(body, shaft))
    }

    /// Whether all of them were listed.
    fn sift(&self, shaft: &Shaft, most: usize, candidates: &mut Vec<u32>) -> bool {
        let sieve = Sieve::new(shaft.planes());
        let ended = run(Sift { occluders: self, shaft, sieve: &sieve, most, candidates });
        candidates.sort_unstable();
        candidates.dedup();
        !ended
    }

    /// Whether facet `k` has parts of the shaft on both sides, and reaches into it as far as its
    /// half-spaces tell.
    fn cuts(&self, shaft: &Shaft, k: usize) -> bool {
        let tolerance = self.frame.tolerance;
        let (mut low, mut high) = (0.0f64, 0.0f64);
        for &corner in shaft.corners() {
            let height = self.facets[k].height(corner);
            (low, high) = (low.min(height), high.max(height));
        }
        let apart = low < -tolerance && high > tolerance;
        apart && !shaft.planes().iter().any(|plane| plane.excludes(&self.outlines[k]))
    }
}

/// The search for what reaches into a shaft, which ends after more than `most` were found.
struct Sift<'a> {
    occluders: &'a Occluders,
    shaft: &'a Shaft,
    sieve: &'a Sieve,
    most: usize,
    candidates: &'a mut Vec<u32>,
}

impl Work for Sift<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<E: Eight>(mut self, eight: E) -> bool {
        self.occluders.tree.any(eight, &mut self)
    }
}

impl<E: Eight> Visitor<E> for Sift<'_> {
    #[inline(always)]
    fn meets(&self, eight: E, node: &Node) -> u32 {
        self.sieve.passes(eight, node)
    }

    #[inline(always)]
    fn leaf(&mut self, _: E, leaf: usize) -> bool {
        let Self { occluders, shaft, .. } = *self;
        let cutting = occluders.packets[leaf].places().filter(|&k| occluders.cuts(shaft, k));
        self.candidates.extend(cutting.map(|k| occluders.facets[k].patch));
        self.candidates.len() > self.most
    }
}
