//! What one body hides of a convex polygon from several points at once: one lane a point.
//!
//! From most parts of a source the hidden part looks alike: the same half-spaces cut the same sides
//! of the target. So the points go the same way through the clipping (I. E. Sutherland & G. W.
//! Hodgman, Commun. ACM 17(1) 32, 1974, doi:10.1145/360767.360802), and only the numbers differ.
//! Those for which a corner lies on another side than for the first are left for another turn. I.
//! Wald et al., Comput. Graph. Forum 20(3) 153, 2001, doi:10.1111/1467-8659.00508, trace packets of
//! rays on the same ground. Lengths in metres.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::lanes::{LANES, Lanes, Lanes3, Mask, ask, cross, difference, each, heights, same};
use super::point_polygon::{edge_terms, factor};
use super::shadow::{SideId, Topology};
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{Looking, Screen, Shadow, ShadowVolume, SilhouetteEdge};
use pulp::{Arch, NullaryFnOnce};

/// Points of a packet at most.
pub(super) const POINTS: usize = LANES;

/// Corners of a polygon at most. A half-space adds one.
const MOST_CORNERS: usize = 32;

/// A target, what makes its sides, and the normal of the points that see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target<'a> {
    pub corners: &'a [Vec3],
    pub side_ids: &'a [SideId],
    pub normal: Vec3,
}

/// A half-space that may cut the target.
#[derive(Clone, Copy, Debug)]
enum Side {
    /// Behind a face with this normal and offset.
    Face(Vec3, f64),
    /// Within an edge of the outline, given by its place.
    Edge { place: usize, turned: bool },
}

/// A convex polygon, relative to each point.
#[derive(Clone, Copy, Debug)]
struct Polygon {
    corners: [Lanes3; MOST_CORNERS],
    side_ids: [SideId; MOST_CORNERS],
    len: usize,
}

impl Default for Polygon {
    fn default() -> Self {
        Self { corners: [[[0.0; LANES]; 3]; MOST_CORNERS], side_ids: [0; MOST_CORNERS], len: 0 }
    }
}

/// A polygon that is cut, the place for what is left of it, and what the last plane told of its
/// corners.
#[derive(Clone, Debug)]
struct Cover {
    polygons: [Polygon; 2],
    now: usize,
    heights: [Lanes; MOST_CORNERS],
    /// 1 above, −1 below, 0 on it.
    sides: [i8; MOST_CORNERS],
}

impl Default for Cover {
    fn default() -> Self {
        Self {
            polygons: [Polygon::default(); 2],
            now: 0,
            heights: [[0.0; LANES]; MOST_CORNERS],
            sides: [0; MOST_CORNERS],
        }
    }
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub(super) struct Packet {
    arch: Arch,
    sides: Vec<(Side, SideId)>,
    cover: Cover,
    volume: ShadowVolume,
}

/// The points that are left, by their places.
struct Left {
    places: [usize; POINTS],
    len: usize,
}

impl Left {
    /// The place of the point of a lane: those beyond the last do as the first.
    #[inline]
    fn place(&self, m: usize) -> usize {
        self.places[if m < self.len { m } else { 0 }]
    }

    #[inline]
    fn lanes(&self, points: &[Vec3]) -> Lanes3 {
        let mut lanes = [[0.0; LANES]; 3];
        for m in 0..LANES {
            let x = points[self.place(m)];
            (lanes[0][m], lanes[1][m], lanes[2][m]) = (x.x, x.y, x.z);
        }
        lanes
    }

    /// Keeps the points of some lanes.
    #[inline]
    fn keep(&mut self, keeps: impl Fn(usize) -> bool) {
        let len = std::mem::take(&mut self.len);
        for m in (0..len).filter(|m| keeps(*m)) {
            self.places[self.len] = self.places[m];
            self.len += 1;
        }
    }
}

/// What is found for each point: the factor of the hidden part and its topology, and the shadows
/// that meet the target.
pub(super) struct Found<'a> {
    pub hidden: &'a mut [(f64, Topology)],
    pub shadows: &'a mut [Shadows],
}

/// Which bodies hide something of the target from a point. Those from number 127 on share a bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Shadows {
    bodies: u128,
    together: bool,
}

impl Shadows {
    fn add(&mut self, body: usize) {
        self.together |= self.bodies != 0;
        self.bodies |= Self::bit(body);
    }

    /// Adds a body that only [`Hiding`](super::shadow::Hiding) can tell about.
    fn leave(&mut self, body: usize) {
        self.add(body);
        self.together = true;
    }

    /// Whether the bodies are to be asked together, as their shadows may overlap.
    pub(super) fn are_together(self) -> bool {
        self.together
    }

    pub(super) fn has(self, body: usize) -> bool {
        self.bodies & Self::bit(body) != 0
    }

    fn bit(body: usize) -> u128 {
        1 << body.min(u128::BITS as usize - 1)
    }
}

impl Packet {
    /// Adds what body number `body` hides of the target from at most [`POINTS`] points.
    pub(super) fn hide(
        &mut self,
        points: &[Vec3],
        target: Target,
        (body, screen): (usize, &Screen),
        found: &mut Found,
    ) {
        let mut looking = [None; POINTS];
        for (looking, x) in looking.iter_mut().zip(points) {
            *looking = screen.looking(*x);
        }
        let (mut left, mut listed) = (Left { places: [0, 1, 2, 3, 4, 5, 6, 7], len: points.len() }, None);
        while left.len > 0 {
            let leader = looking[left.places[0]];
            if listed != leader {
                self.list(screen, leader, Topology::first(body));
                listed = leader;
            }
            let differs = if leader.is_none() || target.corners.len() + self.sides.len() > MOST_CORNERS {
                let alone = left.places[0];
                let nothing = screen.shadow(points[alone], &mut self.volume) == Shadow::Nothing;
                if !nothing {
                    found.shadows[alone].leave(body);
                }
                ask(|m| m > 0)
            } else {
                let differs = ask(|m| looking[left.place(m)] != leader);
                self.alike(points, target, (body, screen), (&left, differs), found)
            };
            left.keep(|m| differs[m] != 0);
        }
    }

    /// Adds what is hidden from those of the points that are left for which it looks as for the
    /// first. Returns the others, with those that `differs` marks.
    fn alike(
        &mut self,
        points: &[Vec3],
        target: Target,
        (body, screen): (usize, &Screen),
        (left, mut differs): (&Left, Mask),
        found: &mut Found,
    ) -> Mask {
        if let Some(factors) = self.ask(&left.lanes(points), target, screen, &mut differs) {
            let topology = Topology::of(self.cover.side_ids());
            for m in (0..left.len).filter(|m| differs[*m] == 0) {
                let point = left.places[m];
                found.hidden[point].0 += factors[m];
                found.hidden[point].1.merge(topology);
                found.shadows[point].add(body);
            }
        }
        differs
    }

    /// Lists the half-spaces.
    fn list(&mut self, screen: &Screen, looking: Option<Looking>, first: SideId) {
        self.sides.clear();
        let Some(looking) = looking else { return };
        for (k, face) in screen.faces(looking) {
            self.sides.push((Side::Face(face.normal, face.offset), first + k));
        }
        for SilhouetteEdge { number, place, turned } in screen.silhouette(looking) {
            self.sides.push((Side::Edge { place, turned }, first + number));
        }
    }

    /// The factors of those of the points for which the hidden part looks as for the first; the
    /// others are marked. `None` where nothing is hidden.
    fn ask(&mut self, points: &Lanes3, target: Target, screen: &Screen, differs: &mut Mask) -> Option<Lanes> {
        let Self { arch, sides, cover, .. } = self;
        let (edges, tolerance) = (screen.edges(), screen.tolerance());
        arch.dispatch(Ask { points, target, sides, edges, tolerance, cover, differs })
    }
}

/// A question, compiled for each width of vectors: a closure would be compiled once, for the
/// narrowest.
struct Ask<'a> {
    points: &'a Lanes3,
    target: Target<'a>,
    sides: &'a [(Side, SideId)],
    edges: &'a [[Vec3; 2]],
    tolerance: f64,
    cover: &'a mut Cover,
    differs: &'a mut Mask,
}

impl NullaryFnOnce for Ask<'_> {
    type Output = Option<Lanes>;

    #[inline(always)]
    fn call(self) -> Option<Lanes> {
        let Self { points, target, sides, edges, tolerance, cover, differs } = self;
        cover.start(target, points);
        for (side, side_id) in sides {
            let (normal, offset) = plane(side, edges, points);
            let size = size(&normal);
            // A plane without direction bounds nothing.
            if agree(&size, &[0.0; LANES], differs) > 0
                && !cover.keep((&normal, &offset), &each(|m| tolerance * size[m]), *side_id, differs)
            {
                return None;
            }
        }
        Some(cover.factors(target.normal))
    }
}

/// Normals and offsets of a half-space.
#[inline(always)]
fn plane(side: &Side, edges: &[[Vec3; 2]], points: &Lanes3) -> (Lanes3, Lanes) {
    match *side {
        Side::Face(normal, offset) => (same(-normal), heights(&same(normal), &[offset; LANES], points)),
        Side::Edge { place, turned } => {
            let (a, b) = (edges[place][usize::from(turned)], edges[place][usize::from(!turned)]);
            (cross(&difference(&same(a), points), &difference(&same(b), points)), [0.0; LANES])
        }
    }
}

/// The sum of the sizes of the coordinates.
#[inline(always)]
fn size(v: &Lanes3) -> Lanes {
    each(|m| v[0][m].abs() + v[1][m].abs() + v[2][m].abs())
}

/// On which side the first lane has a height, which up to `flat` counts as 0. Lanes that do not
/// agree are marked.
#[inline(always)]
fn agree(height: &Lanes, flat: &Lanes, differs: &mut Mask) -> i8 {
    let (side, others) = if height[0] > flat[0] {
        (1, ask(|m| height[m] <= flat[m]))
    } else if height[0] < -flat[0] {
        (-1, ask(|m| height[m] >= -flat[m]))
    } else {
        (0, ask(|m| height[m].abs() > flat[m]))
    };
    for (differs, other) in differs.iter_mut().zip(others) {
        *differs |= other;
    }
    side
}

impl Cover {
    fn side_ids(&self) -> &[SideId] {
        let polygon = &self.polygons[self.now];
        &polygon.side_ids[..polygon.len]
    }

    #[inline(always)]
    fn start(&mut self, target: Target, points: &Lanes3) {
        self.now = 0;
        let polygon = &mut self.polygons[0];
        polygon.len = target.corners.len();
        polygon.side_ids[..polygon.len].copy_from_slice(target.side_ids);
        for (moved, &corner) in polygon.corners.iter_mut().zip(target.corners) {
            *moved = difference(&same(corner), points);
        }
    }

    /// Keeps the part with n·x ≥ c as the first lane has it. Returns whether there is one.
    #[inline(always)]
    fn keep(
        &mut self,
        (normal, offset): (&Lanes3, &Lanes),
        flat: &Lanes,
        side_id: SideId,
        differs: &mut Mask,
    ) -> bool {
        let Self { polygons, now, heights: over, sides } = self;
        let polygon = &polygons[*now];
        // A loop of its own: compiled together with what asks about the first lane alone, it is not
        // one of wide vectors.
        for (height, corner) in over.iter_mut().zip(&polygon.corners[..polygon.len]) {
            *height = heights(normal, offset, corner);
        }
        let (mut low, mut high) = (0, 0);
        for k in 0..polygon.len {
            let side = agree(&over[k], flat, differs);
            sides[k] = side;
            low = side.min(low);
            high = side.max(high);
        }
        if low < 0 && high > 0 {
            self.cut(side_id);
        }
        high > 0
    }

    #[inline(always)]
    fn cut(&mut self, side_id: SideId) {
        let Self { polygons: [first, second], now, heights, sides } = self;
        let (polygon, left) = if *now == 0 { (&*first, second) } else { (&*second, first) };
        let (mut len, mut from) = (0, polygon.len - 1);
        for to in 0..polygon.len {
            if sides[from] * sides[to] < 0 {
                let (low, high) = if sides[from] < 0 { (from, to) } else { (to, from) };
                left.side_ids[len] = if sides[from] > 0 { side_id } else { polygon.side_ids[from] };
                let (below, above) =
                    ((&polygon.corners[low], &heights[low]), (&polygon.corners[high], &heights[high]));
                crossing(below, above, &mut left.corners[len]);
                len += 1;
            }
            if sides[to] >= 0 {
                left.side_ids[len] = polygon.side_ids[to];
                left.corners[len] = polygon.corners[to];
                len += 1;
            }
            from = to;
        }
        left.len = len;
        *now = 1 - *now;
    }

    #[inline(always)]
    fn factors(&self, n: Vec3) -> Lanes {
        let polygon = &self.polygons[self.now];
        let mut sum = [0.0; LANES];
        for k in 0..polygon.len {
            let next = if k + 1 == polygon.len { 0 } else { k + 1 };
            let terms = edge_terms(n, &polygon.corners[k], &polygon.corners[next]);
            sum = each(|m| sum[m] + terms[m]);
        }
        each(|m| factor(sum[m]))
    }
}

/// As [`crossing`](crate::polygon::crossing), from the lower end.
#[inline(always)]
fn crossing((low, below): (&Lanes3, &Lanes), (high, above): (&Lanes3, &Lanes), cut: &mut Lanes3) {
    let share = each(|m| below[m] / (below[m] - above[m]));
    for axis in 0..3 {
        cut[axis] = each(|m| low[axis][m] + (high[axis][m] - low[axis][m]) * share[m]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::shadow::Hiding;
    use fredholm_mesh::Patch;
    use fredholm_visibility::Occluders;
    use fredholm_visibility::body::Bodies;

    fn square(z: f64, half: f64) -> [Vec3; 4] {
        [[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]].map(|[u, v]| Vec3::new(half * u, half * v, z))
    }

    fn patch(corners: [Vec3; 4]) -> Patch {
        Patch::quad(corners).unwrap().unwrap()
    }

    /// A box from z = 0.4 to 0.6.
    fn block(half: f64) -> Vec<Patch> {
        let (low, high) = (square(0.4, half), square(0.6, half));
        let side = |k: usize| patch([low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]]);
        let ends = [patch(low).flipped(), patch(high)];
        ends.into_iter().chain((0..4).map(side)).collect()
    }

    /// What a packet finds at points on z = 0, and what single points do.
    fn compare(half: f64, tilt: f64, points: &[Vec3]) -> usize {
        let occluders = Occluders::new(&block(half)).unwrap();
        let source = patch(square(0.0, 1.0));
        let target: Vec<Vec3> =
            square(1.0, 0.7).into_iter().rev().map(|x| x + Vec3::Z * (tilt * x.x)).collect();
        let bodies = Bodies::new(&occluders, &[&source], &[]);
        let screen = Screen::new(&bodies.as_slice()[0], source.corners(), &target, 1e-12);
        let side_ids: Vec<SideId> = (0..4).collect();
        let mut found = vec![(0.0, Topology::default()); points.len()];
        let mut shadows = vec![Shadows::default(); points.len()];
        let aim = Target { corners: &target, side_ids: &side_ids, normal: Vec3::Z };
        let mut packet = Packet::default();
        packet.hide(points, aim, (0, &screen), &mut Found { hidden: &mut found, shadows: &mut shadows });
        let mut alone = Hiding::default();
        for ((x, (factor, topology)), shadows) in points.iter().zip(&found).zip(shadows) {
            let single = alone.hidden_factor(*x, Vec3::Z, &target, std::iter::once((0, &screen)));
            assert!((factor - single).abs() < 1e-14, "{x}: {factor} {single}");
            assert_eq!(*topology, alone.topology(), "{x}");
            assert!(shadows.has(0) == (single > 0.0) && !shadows.are_together(), "{x}");
        }
        let mut topologies: Vec<Topology> = found.iter().map(|(_, topology)| *topology).collect();
        topologies.dedup();
        topologies.len()
    }

    #[test]
    fn points_that_see_alike_have_the_factors_that_they_have_alone() {
        let points = [0.01, 0.02, 0.03, 0.04, 0.05].map(|x| Vec3::new(x, 0.5 * x, 0.0));
        assert_eq!(compare(0.2, 0.1, &points), 1);
    }

    #[test]
    fn so_have_points_that_do_not() {
        for (half, tilt) in [(0.1, 0.0), (0.3, 0.2), (0.5, -0.3)] {
            let points: Vec<Vec3> = (0..8u32)
                .map(|k| {
                    let angle = 2.4 * f64::from(k);
                    Vec3::new(angle.cos(), angle.sin(), 0.0) * (0.12 * f64::from(k))
                })
                .collect();
            assert!(compare(half, tilt, &points) > 1);
            assert!(compare(half, tilt, &points[..3]) >= 1);
        }
    }

    #[test]
    fn a_point_on_the_line_of_an_edge_is_a_case_of_its_own() {
        let points = [0.2, 0.2 + 1e-3, 0.0, 0.2].map(|x| Vec3::new(x, 0.1, 0.0));
        compare(0.2, 0.0, &points);
    }
}
