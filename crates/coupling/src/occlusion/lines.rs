//! Some segments between two patches against one convex body: what they tell about all segments
//! costs little.
//!
//! Heights over the faces of the body are affine along a segment. A segment that gets below all
//! faces passes through the body: M. Cyrus & J. Beck, Comput. Graph. 3(1) 23, 1978,
//! doi:10.1016/0097-8493(78)90021-3. Lengths in metres.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use crate::form_factor::{LANES, Lanes, Lanes3, any, ask, each, heights, range, same};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::{Body, Face};
use pulp::{Arch, NullaryFnOnce};

/// Height over a body, in lengths of a segment, that is not rounding.
const CERTAIN_HEIGHT: f64 = 1e-6;
/// The corners of the second patch to which the segments from those of the first go: to those of
/// the same place and of the opposite,
const FIRST_TARGETS: [usize; LANES] = [0, 1, 2, 3, 2, 3, 0, 1];
/// and to the others.
const OTHER_TARGETS: [usize; LANES] = [1, 2, 3, 0, 3, 0, 1, 2];

/// What is known of a body between two patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stands {
    /// A face of the body has both patches in front: it is in no segment's way.
    Beside,
    /// In the way of a segment, and not of another.
    Partly,
    /// In the way of all segments as far as a few of them tell.
    Across,
    /// In the way of all segments: the points that a body hides from a point make a convex set, on
    /// either side.
    Certainly,
    /// In the way of none of them.
    Unknown,
}

impl Stands {
    /// Whether no segment is known to be free.
    pub(crate) fn may_be_across(self) -> bool {
        matches!(self, Self::Across | Self::Certainly)
    }
}

/// Segments between the corners of two patches, one a lane: those that are asked about first, and
/// then others from the same starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lines {
    starts: Lanes3,
    ends: Lanes3,
    others: Lanes3,
    /// A height that is not rounding.
    certain: f64,
}

impl Lines {
    pub(crate) fn between(p: &Patch, q: &Patch, tolerance: f64) -> Self {
        let size = |x: Vec3| x.abs().element_sum();
        let reach = size(q.corner(0) - p.corner(0))
            + size(p.corner(2) - p.corner(0))
            + size(q.corner(2) - q.corner(0));
        let starts = lanes(p, [0, 1, 2, 3, 0, 1, 2, 3]);
        Self {
            starts,
            ends: lanes(q, FIRST_TARGETS),
            others: lanes(q, OTHER_TARGETS),
            certain: tolerance + CERTAIN_HEIGHT * reach,
        }
    }

    /// How a body stands between the patches. `heights` is a buffer.
    pub(crate) fn ask(
        &self,
        body: &Body,
        tolerance: f64,
        (arch, heights): (Arch, &mut Vec<Heights>),
    ) -> Stands {
        arch.dispatch(Ask { lines: self, body, tolerance, heights })
    }
}

/// Some corners of a patch, by components; a triangle has its last one twice.
fn lanes(patch: &Patch, places: [usize; LANES]) -> Lanes3 {
    let (given, last) = (patch.corners(), patch.sides() - 1);
    let corners = [given[0], given[1], given[2], given[last]];
    [each(|m| corners[places[m]].x), each(|m| corners[places[m]].y), each(|m| corners[places[m]].z)]
}

/// Heights of the ends of segments over a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Heights {
    face: Face,
    from: Lanes,
    to: Lanes,
}

/// A question, compiled for each width of vectors: a closure would be compiled once, for the
/// narrowest.
struct Ask<'a> {
    lines: &'a Lines,
    body: &'a Body,
    tolerance: f64,
    heights: &'a mut Vec<Heights>,
}

impl NullaryFnOnce for Ask<'_> {
    type Output = Stands;

    #[inline(always)]
    fn call(self) -> Stands {
        let Self { lines, body, tolerance, heights: list } = self;
        list.clear();
        for &face in body.faces() {
            let (n, c) = (same(face.normal), [face.offset; LANES]);
            let (from, to) = (heights(&n, &c, &lines.starts), heights(&n, &c, &lines.ends));
            let low = each(|m| if from[m] < to[m] { from[m] } else { to[m] });
            let high = each(|m| if from[m] > to[m] { from[m] } else { to[m] });
            if range(&low)[0] >= -tolerance {
                return Stands::Beside;
            }
            // What is below a face along all segments says nothing about them.
            if range(&high)[1] >= -lines.certain {
                list.push(Heights { face, from, to });
            }
        }
        let (deeply, touched) = (pierced(list, lines.certain), pierced(list, -lines.certain));
        let (some, all) = (body.is_solid() && deeply != Pierced::None, touched == Pierced::All);
        match (some, all) {
            (true, true) if deeply == Pierced::All && lines.others_pierced(list) => Stands::Certainly,
            (_, true) => Stands::Across,
            (true, false) => Stands::Partly,
            (false, false) => Stands::Unknown,
        }
    }
}

impl Lines {
    #[inline(always)]
    fn others_pierced(&self, list: &mut [Heights]) -> bool {
        for over in &mut *list {
            over.to = heights(&same(over.face.normal), &[over.face.offset; LANES], &self.others);
        }
        pierced(list, self.certain) == Pierced::All
    }
}

/// How many segments pass through a body.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pierced {
    None,
    Some,
    All,
}

/// How many of the segments have a part deeper than `depth` below all faces.
#[inline(always)]
fn pierced(list: &[Heights], depth: f64) -> Pierced {
    let (mut first, mut last) = ([0.0; LANES], [1.0; LANES]);
    for Heights { from, to, .. } in list {
        let share = each(|m| (from[m] + depth) / (from[m] - to[m]));
        let enters = each(|m| if from[m] >= -depth { share[m] } else { 0.0 });
        let leaves = each(|m| if to[m] > -depth { share[m] } else { 1.0 });
        first = each(|m| if enters[m] > first[m] { enters[m] } else { first[m] });
        last = each(|m| if leaves[m] < last[m] { leaves[m] } else { last[m] });
        // Above at both ends: nothing is left.
        let lower = each(|m| if from[m] < to[m] { from[m] } else { to[m] });
        last = each(|m| if lower[m] >= -depth { -1.0 } else { last[m] });
    }
    match (any(&ask(|m| first[m] < last[m])), any(&ask(|m| first[m] >= last[m]))) {
        (false, _) => Pierced::None,
        (true, true) => Pierced::Some,
        (true, false) => Pierced::All,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_visibility::Occluders;
    use fredholm_visibility::body::Bodies;

    fn square(z: f64, half: f64, x: f64) -> Patch {
        let corner = |u: f64, v: f64| Vec3::new(x + half * u, half * v, z);
        let corners = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        Patch::quad(corners).unwrap().unwrap()
    }

    #[test]
    fn a_box_stands_in_the_way_of_all_of_some_or_of_none() {
        let plates = [square(0.4, 0.5, 0.0).flipped(), square(0.6, 0.5, 0.0)];
        let side = |k: usize| {
            let (low, high) = (square(0.4, 0.5, 0.0), square(0.6, 0.5, 0.0));
            Patch::quad([low.corner(k), low.corner(k + 1), high.corner(k + 1), high.corner(k)])
                .unwrap()
                .unwrap()
        };
        let faces: Vec<Patch> = plates.into_iter().chain((0..4).map(side)).collect();
        let occluders = Occluders::new(&faces).unwrap();
        let ends = |x: f64| [square(0.0, 0.1, x), square(1.0, 0.1, x).flipped()];
        let walls = [square(0.0, 2.0, 0.0), square(1.0, 2.0, 0.0).flipped()];
        let bodies = Bodies::new(&occluders, &[&walls[0], &walls[1]], &[]);
        let ask = |x: f64| {
            let [p, q] = ends(x);
            Lines::between(&p, &q, 1e-9).ask(&bodies.as_slice()[0], 1e-9, (Arch::new(), &mut Vec::new()))
        };
        assert_eq!(bodies.as_slice().len(), 1);
        assert_eq!([0.0, 0.5, 0.7].map(ask), [Stands::Certainly, Stands::Partly, Stands::Beside]);
    }

    #[test]
    fn a_plate_stands_across_or_not() {
        let occluders = Occluders::new(&[square(0.5, 0.5, 0.0)]).unwrap();
        let ends = [square(0.0, 0.1, 0.0), square(1.0, 0.1, 0.0).flipped()];
        let bodies = Bodies::new(&occluders, &[&ends[0], &ends[1]], &[]);
        let body = &bodies.as_slice()[0];
        let ask =
            |p: &Patch, q: &Patch| Lines::between(p, q, 1e-9).ask(body, 1e-9, (Arch::new(), &mut Vec::new()));
        assert_eq!(ask(&ends[0], &ends[1]), Stands::Across);
        assert_eq!(ask(&ends[0], &square(0.4, 0.1, 0.0)), Stands::Beside);
    }
}
