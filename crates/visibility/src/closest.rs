//! What does a ray meet first?
//!
//! One walk finds the nearest crossing and what lies within the tolerance of it: of all that was
//! met, that which may still be as near as the nearest is kept.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use fredholm_mesh::Vec3;

use crate::Occluders;
use crate::eight::{Eight, Work, run};
use crate::facet::Meeting;
use crate::packet::Ends;
use crate::probe::Probe;
use crate::tree::{Beam, Seeker};

/// Where a ray first meets a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the patch.
    pub patch: usize,
    /// Place on the ray: `point` is origin + t · direction.
    pub t: f64,
    /// The place that was hit, m.
    pub point: Vec3,
    /// Whether the patch turns its lit side to the origin.
    pub is_lit: bool,
}

impl Occluders {
    /// The first patch that the ray from `origin` meets, at 0 < t < `t_max`, from either side.
    ///
    /// The direction need not be of unit length; `t_max` may be infinite. A patch whose plane is
    /// within the [tolerance](Self::tolerance) of the origin is not met, so a ray may start on a
    /// surface.
    ///
    /// Where several patches are met within the tolerance of the first, as on the two faces of a
    /// plate, the one that turns its lit side to the origin is the answer, and among equals the one
    /// of the smallest index.
    ///
    /// `None` where nothing is met, and for a ray without a direction or with coordinates that are
    /// not finite.
    #[must_use]
    pub fn closest(&self, origin: Vec3, direction: Vec3, t_max: f64) -> Option<Hit> {
        if t_max.is_nan() || t_max <= 0.0 {
            return None;
        }
        let length = direction.length();
        let span = t_max.min(self.frame.beyond(origin) / length);
        let (fraction, (is_back, patch)) = run(First { occluders: self, origin, direction, span })?;
        let t = fraction * span;
        Some(Hit { patch: patch as usize, t, point: origin + direction * t, is_lit: !is_back })
    }
}

/// What does a ray of a span meet first, and at what fraction of it?
struct First<'a> {
    occluders: &'a Occluders,
    origin: Vec3,
    direction: Vec3,
    span: f64,
}

impl Work for First<'_> {
    type Output = Option<(f64, Rank)>;

    #[inline(always)]
    fn run<E: Eight>(self, eight: E) -> Self::Output {
        let Self { occluders, origin, direction, span } = self;
        let probe = Probe::ray(origin, origin + direction * span, &occluders.frame)?;
        let beam = Beam::new(&probe, &occluders.frame)?;
        let alike = occluders.frame.tolerance / probe.p.distance(probe.q);
        let ends = Ends::new(eight, &probe);
        let found = Found { alike, nearest: f64::INFINITY, best: None, others: Vec::new() };
        let mut ray = Ray { occluders, probe: &probe, beam: &beam, ends, end: 1.0, end_of_beam: 1.0, found };
        occluders.tree.nearest(eight, &mut beam.splat(eight), &mut ray);
        ray.found.foremost().map(|rank| (ray.found.nearest, rank))
    }
}

/// A ray on its way to the first facet that it crosses.
struct Ray<'a, E: Eight> {
    occluders: &'a Occluders,
    probe: &'a Probe,
    beam: &'a Beam,
    ends: Ends<E>,
    /// The fraction of the probe beyond which nothing matters.
    end: f64,
    /// The same on the beam.
    end_of_beam: f32,
    found: Found,
}

impl<E: Eight> Seeker<E> for Ray<'_, E> {
    #[inline(always)]
    fn leaf(&mut self, eight: E, leaf: usize) -> f32 {
        let packet = &self.occluders.packets[leaf];
        let crossed = packet.crossed(eight, &self.ends, self.end as f32);
        let mut left = crossed.may;
        while left != 0 {
            let lane = left.trailing_zeros();
            left &= left - 1;
            let place = packet.place(lane);
            let facet = &self.occluders.facets[place];
            let is_sure = crossed.does >> lane & 1 != 0;
            let meeting = if is_sure {
                Some(facet.meeting(self.probe))
            } else {
                self.occluders.crossing(place, self.probe)
            };
            // What is sure may lie a little past the end, which the packet knows in f32.
            if let Some(Meeting { fraction, is_back }) = meeting
                && fraction <= self.end
            {
                self.found.add(Met { fraction, rank: (is_back, facet.patch) });
                let end = self.found.nearest + self.found.alike;
                if end < self.end {
                    self.end = end;
                    self.end_of_beam = self.beam.place(end);
                }
            }
        }
        self.end_of_beam
    }
}

/// Whether a facet turns its back to the start of the ray, and its patch: in this order, facets that
/// may be equally near are preferred.
type Rank = (bool, u32);

/// A facet that was met.
#[derive(Clone, Copy, Debug)]
struct Met {
    fraction: f64,
    rank: Rank,
}

/// The nearest that was met, and what else may be as near as it.
struct Found {
    /// What fractions may differ by and count as one.
    alike: f64,
    nearest: f64,
    best: Option<Met>,
    others: Vec<Met>,
}

impl Found {
    #[inline(always)]
    fn add(&mut self, met: Met) {
        self.nearest = self.nearest.min(met.fraction);
        match self.best {
            Some(best) if best.fraction <= self.nearest + self.alike => self.weigh(best, met),
            _ => self.best = Some(met),
        }
    }

    /// Of two that may be alike the nearer one that ranks first stands for both; else both are
    /// kept.
    #[cold]
    fn weigh(&mut self, best: Met, met: Met) {
        let key = |met: &Met| (met.fraction, met.rank);
        let (near, far) = if key(&met) < key(&best) { (met, best) } else { (best, met) };
        self.best = Some(near);
        if far.rank < near.rank {
            self.others.push(far);
        }
    }

    /// The first rank of those as near as the nearest.
    #[inline(always)]
    fn foremost(&self) -> Option<Rank> {
        let met = self.best.iter().chain(&self.others);
        met.filter(|met| met.fraction <= self.nearest + self.alike).map(|met| met.rank).min()
    }
}
