//! Some segments between two patches against one convex body: what they tell about all segments costs little.
//!
//! Heights over the faces of the body are affine along a segment. A segment that gets below all faces passes through the body: M. Cyrus & J. Beck, Comput. Graph. 3(1) 23,
//! 1978, doi:10.1016/0097-8493(78)90021-3. Lengths in metres.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::Body;

/// Height over a body, in lengths of a segment, that is not rounding.
const CERTAIN: f64 = 1e-6;
/// Corners of two patches.
const CORNERS: usize = 8;
/// The segments, by their ends: those between corners of the same place, of the opposite, and the others.
const LINES: [[usize; 2]; 16] = [
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
    [0, 6],
    [1, 7],
    [2, 4],
    [3, 5],
    [0, 5],
    [1, 6],
    [2, 7],
    [3, 4],
    [0, 7],
    [1, 4],
    [2, 5],
    [3, 6],
];
/// Those of them that are asked about first.
const FIRST: usize = 8;

/// What is known of a body between two patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stands {
    /// A face of the body has both patches in front: it is in no segment's way.
    Beside,
    /// In the way of a segment, and not of another.
    Partly,
    /// In the way of all segments as far as a few of them tell.
    Across,
    /// In the way of all segments: the points that a body hides from a point make a convex set, on either side.
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

/// The corners of two patches, by components.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lines {
    corners: [[f64; CORNERS]; 3],
    /// A height that is not rounding.
    certain: f64,
}

impl Lines {
    pub(crate) fn between(p: &Patch, q: &Patch, tolerance: f64) -> Self {
        let of = |patch: &Patch, m: usize| patch.corner(m.min(patch.sides() - 1));
        let ends = [0, 1, 2, 3, 4, 5, 6, 7].map(|m| if m < 4 { of(p, m) } else { of(q, m - 4) });
        let corners = [ends.map(|x| x.x), ends.map(|x| x.y), ends.map(|x| x.z)];
        let size = |x: Vec3| x.abs().element_sum();
        let reach = size(q.corner(0) - p.corner(0))
            + size(p.corner(2) - p.corner(0))
            + size(q.corner(2) - q.corner(0));
        Self { corners, certain: tolerance + CERTAIN * reach }
    }

    /// How a body stands between the patches. `heights` is a buffer.
    pub(crate) fn ask(&self, body: &Body, tolerance: f64, heights: &mut Vec<[f64; CORNERS]>) -> Stands {
        heights.clear();
        for face in body.faces() {
            let over = self.heights(face.normal, face.offset);
            let [low, high] = range(&over);
            if low >= -tolerance {
                return Stands::Beside;
            }
            // What is below a face along all segments says nothing about them.
            if high >= -self.certain {
                heights.push(over);
            }
        }
        let meets = |[a, b]: [usize; 2], depth: f64| is_pierced(heights, a, b, depth);
        let some = body.is_solid() && LINES[..FIRST].iter().any(|&line| meets(line, self.certain));
        let all = LINES[..FIRST].iter().all(|&line| meets(line, -self.certain));
        match (some, all) {
            (true, true) if LINES.iter().all(|&line| meets(line, self.certain)) => Stands::Certainly,
            (_, true) => Stands::Across,
            (true, false) => Stands::Partly,
            (false, false) => Stands::Unknown,
        }
    }

    #[inline]
    fn heights(&self, n: Vec3, offset: f64) -> [f64; CORNERS] {
        let mut heights = [0.0; CORNERS];
        for (m, height) in heights.iter_mut().enumerate() {
            *height = n.x * self.corners[0][m] + n.y * self.corners[1][m] + n.z * self.corners[2][m] - offset;
        }
        heights
    }
}

/// The least and the largest of some heights.
#[inline]
fn range(heights: &[f64; CORNERS]) -> [f64; 2] {
    let [mut low, mut high] = [heights[0]; 2];
    for &h in heights {
        low = if h < low { h } else { low };
        high = if h > high { h } else { high };
    }
    [low, high]
}

/// Whether a part of the segment between two corners lies deeper than `depth` below all faces.
#[inline]
fn is_pierced(heights: &[[f64; CORNERS]], a: usize, b: usize, depth: f64) -> bool {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for over in heights {
        let (from, to) = (over[a] + depth, over[b] + depth);
        if from >= 0.0 && to >= 0.0 {
            return false;
        }
        if from > 0.0 {
            first = first.max(from / (from - to));
        } else if to > 0.0 {
            last = last.min(from / (from - to));
        }
    }
    first < last
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
            Lines::between(&p, &q, 1e-9).ask(&bodies.as_slice()[0], 1e-9, &mut Vec::new())
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
        let ask = |p: &Patch, q: &Patch| Lines::between(p, q, 1e-9).ask(body, 1e-9, &mut Vec::new());
        assert_eq!(ask(&ends[0], &ends[1]), Stands::Across);
        assert_eq!(ask(&ends[0], &square(0.4, 0.1, 0.0)), Stands::Beside);
    }
}
