//! What convex bodies hide of a convex polygon from a point, exactly: F = Σ over the pieces of the
//! polygon that lie in the shadows.
//!
//! The shadow of a body is an intersection of half-spaces. Clipping a convex polygon by them leaves
//! the hidden piece, convex again; what is cut off on the way stays visible and is asked about the
//! next body. T. Nishita & E. Nakamae, SIGGRAPH 1985, doi:10.1145/325165.325169, treat the same
//! geometry.

use crate::form_factor::point_to_polygon;
use crate::polygon::crossing;
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{Screen, Shadow, ShadowVolume};

/// What a side of a polygon comes from: a side of the target, or a half-space of a shadow volume.
pub(super) type SideId = u32;

/// A convex polygon: corners, and what the side that starts at each comes from.
#[derive(Clone, Debug, Default)]
struct Polygon {
    corners: Vec<Vec3>,
    side_ids: Vec<SideId>,
}

impl Polygon {
    fn clear(&mut self) {
        self.corners.clear();
        self.side_ids.clear();
    }

    #[inline]
    fn push(&mut self, corner: Vec3, side_id: SideId) {
        self.corners.push(corner);
        self.side_ids.push(side_id);
    }
}

/// Convex polygons stored one behind the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct PolygonList {
    all: Polygon,
    ends: Vec<usize>,
}

impl PolygonList {
    fn clear(&mut self) {
        self.all.clear();
        self.ends.clear();
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        (0..self.len()).map(|i| self.get(i).0)
    }

    fn get(&self, i: usize) -> (&[Vec3], &[SideId]) {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        (&self.all.corners[start..self.ends[i]], &self.all.side_ids[start..self.ends[i]])
    }

    /// Appends a polygon, unless it is none.
    fn push(&mut self, corners: &[Vec3], side_ids: &[SideId]) {
        if corners.len() >= 3 {
            self.all.corners.extend_from_slice(corners);
            self.all.side_ids.extend_from_slice(side_ids);
            self.ends.push(self.all.corners.len());
        }
    }

    /// Keeps the first `len` polygons.
    fn truncate(&mut self, len: usize) {
        self.ends.truncate(len);
        let corners = self.ends.last().copied().unwrap_or(0);
        self.all.corners.truncate(corners);
        self.all.side_ids.truncate(corners);
    }
}

/// Buffers of a cut.
#[derive(Clone, Debug, Default)]
struct Cutter {
    heights: Vec<f64>,
    inside: Polygon,
    outside: Polygon,
}

impl Cutter {
    /// Splits a convex polygon into its parts with n·x ≥ c and ≤ c, which are in `inside` and
    /// `outside` only where the plane cuts it.
    #[inline]
    fn split(&mut self, polygon: &Polygon, (n, c, side_id): (Vec3, f64, SideId), tolerance: f64) -> Cut {
        let (mut above, mut below) = (false, false);
        self.heights.clear();
        self.heights.extend(polygon.corners.iter().map(|corner| n.dot(*corner) - c));
        for height in &mut self.heights {
            above |= *height > tolerance;
            below |= *height < -tolerance;
            if height.abs() <= tolerance {
                *height = 0.0;
            }
        }
        match (above, below) {
            (true, true) => {
                self.cut(polygon, side_id);
                Cut::Both
            }
            (true, false) => Cut::Inside,
            _ => Cut::Outside,
        }
    }

    fn cut(&mut self, polygon: &Polygon, side_id: SideId) {
        self.inside.clear();
        self.outside.clear();
        let last = polygon.corners.len() - 1;
        let mut from = (polygon.corners[last], self.heights[last], polygon.side_ids[last]);
        for k in 0..=last {
            let to = (polygon.corners[k], self.heights[k], polygon.side_ids[k]);
            self.side(from, to, side_id);
            from = to;
        }
    }

    /// The side from one corner to the next, of which the second is added.
    #[inline]
    fn side(&mut self, from: (Vec3, f64, SideId), to: (Vec3, f64, SideId), side_id: SideId) {
        if from.1 * to.1 < 0.0 {
            let cut = crossing((from.0, from.1), (to.0, to.1));
            let leaves = from.1 > 0.0;
            self.inside.push(cut, if leaves { side_id } else { from.2 });
            self.outside.push(cut, if leaves { from.2 } else { side_id });
        }
        if to.1 >= 0.0 {
            self.inside.push(to.0, to.2);
        }
        if to.1 <= 0.0 {
            self.outside.push(to.0, to.2);
        }
    }
}

/// On which side of a plane a polygon lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cut {
    Inside,
    Outside,
    Both,
}

/// The topology of the shadow, as a hash of what its sides come from: over a part of the source
/// where it does not change, the hidden part is a smooth function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Topology(u64);

impl Topology {
    /// The number of the first half-space of body `k`: those of other bodies, and sides of the
    /// target, have other numbers.
    pub(super) fn first(k: usize) -> SideId {
        (k as SideId + 1) << 10
    }

    /// The topology of one hidden part. The order of its sides does not matter.
    pub(super) fn of(side_ids: &[SideId]) -> Self {
        Self(scatter(
            side_ids.iter().map(|&side_id| scatter(u64::from(side_id) + 1)).fold(0, u64::wrapping_add),
        ))
    }

    /// Adds other parts. Their order does not matter.
    pub(super) fn merge(&mut self, other: Self) {
        self.0 = self.0.wrapping_add(other.0);
    }
}

/// Spreads a number over all bits. D. Stafford's variant 13 of the finalizer of MurmurHash3, as in
/// G. L. Steele et al., OOPSLA 2014, doi:10.1145/2660193.2660195.
fn scatter(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Buffers of the subtraction, kept between points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hiding {
    visible: PolygonList,
    next: PolygonList,
    /// The target, relative to the point.
    target: Vec<Vec3>,
    rest: Polygon,
    cutter: Cutter,
    volume: ShadowVolume,
    topology: Topology,
}

impl Hiding {
    /// Form factor from the point `x` with normal `n` to what `screens`, given with their numbers,
    /// hide of `target`, which lies in front of the point.
    pub(crate) fn hidden_factor<'s>(
        &mut self,
        x: Vec3,
        n: Vec3,
        target: &[Vec3],
        screens: impl Iterator<Item = (usize, &'s Screen<'s>)>,
    ) -> f64 {
        self.start(x, target);
        let (mut screens, mut hidden) = (screens.peekable(), 0.0);
        while let Some(screen) = screens.next() {
            // After the last body nobody asks for what is left.
            hidden += self.behind(screen, x, n, screens.peek().is_some());
        }
        hidden
    }

    /// Leaves what is seen behind `screens` in [`visible`](Self::visible).
    pub(crate) fn hide(&mut self, x: Vec3, n: Vec3, target: &[Vec3], screens: &[Screen]) {
        self.start(x, target);
        for screen in screens.iter().enumerate() {
            self.behind(screen, x, n, true);
        }
    }

    fn start(&mut self, x: Vec3, target: &[Vec3]) {
        self.topology = Topology::default();
        self.visible.clear();
        self.target.clear();
        self.target.extend(target.iter().map(|&y| y - x));
        self.rest.side_ids.clear();
        self.rest.side_ids.extend(0..target.len() as SideId);
        self.visible.push(&self.target, &self.rest.side_ids);
    }

    /// What makes the hidden parts of the last point.
    pub(crate) fn topology(&self) -> Topology {
        self.topology
    }

    /// What the last point saw: convex polygons, relative to it.
    pub(crate) fn visible(&self) -> &PolygonList {
        &self.visible
    }

    /// Moves what lies in the shadow of a body from the visible pieces to the hidden sum.
    fn behind(&mut self, (k, screen): (usize, &Screen), x: Vec3, n: Vec3, keep: bool) -> f64 {
        if screen.shadow(x, &mut self.volume) == Shadow::Nothing || self.misses(screen.tolerance()) {
            return 0.0;
        }
        self.next.clear();
        let first = Topology::first(k);
        let hidden =
            (0..self.visible.len()).map(|i| self.darken(i, n, keep, first, screen.tolerance())).sum();
        std::mem::swap(&mut self.visible, &mut self.next);
        hidden
    }

    /// Whether the volume has nothing of the target. Where that is in one piece, asking about it is
    /// as quick.
    fn misses(&self, flat: f64) -> bool {
        let outside = |&(m, c, _): &(Vec3, f64, SideId)| {
            let least = c + flat * size(m);
            self.target.iter().all(|y| m.dot(*y) <= least)
        };
        self.visible.len() > 1 && self.volume.planes().iter().any(outside)
    }

    /// Form factor of the part of a visible piece that lies in the volume; with `keep` the rest
    /// goes to the next pieces.
    fn darken(&mut self, i: usize, n: Vec3, keep: bool, first: SideId, flat: f64) -> f64 {
        let (corners, side_ids) = self.visible.get(i);
        self.rest.clear();
        self.rest.corners.extend_from_slice(corners);
        self.rest.side_ids.extend_from_slice(side_ids);
        let start = self.next.len();
        for &(m, c, side_id) in self.volume.planes() {
            match self.cutter.split(&self.rest, (m, c, first + side_id), flat * size(m)) {
                Cut::Inside => {}
                Cut::Outside => {
                    self.next.truncate(start);
                    self.next.push(corners, side_ids);
                    return 0.0;
                }
                Cut::Both => {
                    std::mem::swap(&mut self.rest, &mut self.cutter.inside);
                    if keep {
                        self.next.push(&self.cutter.outside.corners, &self.cutter.outside.side_ids);
                    }
                }
            }
        }
        self.topology.merge(Topology::of(&self.rest.side_ids));
        point_to_polygon(n, self.rest.corners.iter().copied())
    }
}

/// The sum of the sizes of the coordinates: at least the length, and free of a square root.
fn size(v: Vec3) -> f64 {
    let v = v.abs();
    v.x + v.y + v.z
}
