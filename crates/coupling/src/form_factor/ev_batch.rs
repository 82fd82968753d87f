//! Which corners and edges line up, seen from somewhere in a polygon: eight pairs at once, one a
//! lane.
//!
//! A corner w and an edge a b do where the plane through them passes through the polygon, det(b −
//! a, w − a, x − a) having both signs there, and where on the line in which it does the ray to the
//! corner meets the edge ([`EdgeVertexEvent`]). Most planes miss the polygon. Lengths in metres.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]
#![allow(clippy::needless_bitwise_bool, reason = "a jump a lane costs more than to ask both")]

use super::critical::Plane;
use super::ev_events::{CHORD_END_MARGIN, EDGE_END_MARGIN, EdgeVertexEvent};
use super::lanes::{LANES, Lanes, Lanes3, Mask, any, ask, cross, difference, dot, each, heights, same};
use fredholm_mesh::Vec3;
use pulp::{Arch, NullaryFnOnce};

/// Squared sine below which a corner and an edge span no plane.
const LEAST_SQUARED_SINE: f64 = 1e-24;

/// Where a pair is asked about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region<'a> {
    /// A convex polygon.
    pub source: &'a [Vec3],
    /// A polygon through which the plane has to pass as well.
    pub target: Option<&'a [Vec3]>,
    /// Heights that count as 0, m.
    pub flat: f64,
}

/// Eight pairs. Those that lack have an edge without length, which spans no plane.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    corner: Lanes3,
    start: Lanes3,
    end: Lanes3,
    /// 1 where the edge lies behind the corner, and 0 where it lies before it.
    behind: Lanes,
}

impl Block {
    fn set(&mut self, m: usize, ev_event: &EdgeVertexEvent) {
        let [start, end] = ev_event.edge;
        for (lanes, x) in
            [(&mut self.corner, ev_event.corner), (&mut self.start, start), (&mut self.end, end)]
        {
            (lanes[0][m], lanes[1][m], lanes[2][m]) = (x.x, x.y, x.z);
        }
        self.behind[m] = f64::from(u8::from(ev_event.behind));
    }

    fn get(&self, m: usize) -> EdgeVertexEvent {
        let [corner, start, end] = [&self.corner, &self.start, &self.end]
            .map(|lanes| Vec3::new(lanes[0][m], lanes[1][m], lanes[2][m]));
        EdgeVertexEvent { corner, edge: [start, end], behind: self.behind[m] > 0.0 }
    }
}

/// A pair that lines up: its number and the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aligned {
    pub pair: usize,
    pub plane: Plane,
}

/// Pairs that may line up. Buffers are kept.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeVertexBatch {
    arch: Arch,
    blocks: Vec<Block>,
    len: usize,
    found: Vec<Aligned>,
}

impl EdgeVertexBatch {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.len = 0;
    }

    /// Adds a pair.
    pub(super) fn push(&mut self, ev_event: &EdgeVertexEvent) {
        let m = self.len % LANES;
        if m == 0 {
            self.blocks.push(Block::default());
        }
        if let Some(block) = self.blocks.last_mut() {
            block.set(m, ev_event);
        }
        self.len += 1;
    }

    /// A pair by its number.
    pub(super) fn get(&self, pair: usize) -> EdgeVertexEvent {
        self.blocks[pair / LANES].get(pair % LANES)
    }

    /// Finds the pairs that line up.
    pub(super) fn ask(&mut self, place: Region) {
        self.found.clear();
        let Self { arch, blocks, found, .. } = self;
        arch.dispatch(Ask { blocks, place, found });
    }

    /// Those that were found.
    pub(super) fn found(&self) -> &[Aligned] {
        &self.found
    }
}

/// A question, compiled for each width of vectors: a closure would be compiled once, for the
/// narrowest.
struct Ask<'a> {
    blocks: &'a [Block],
    place: Region<'a>,
    found: &'a mut Vec<Aligned>,
}

impl NullaryFnOnce for Ask<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (k, block) in self.blocks.iter().enumerate() {
            let planes = Planes::through(block);
            if !any(&planes.pass(self.place.source, &block.start)) {
                continue;
            }
            let (normal, active) = planes.line_up(block, &self.place);
            for m in (0..LANES).filter(|m| active[*m] != 0) {
                let n = Vec3::new(normal[0][m], normal[1][m], normal[2][m]);
                let a = Vec3::new(block.start[0][m], block.start[1][m], block.start[2][m]);
                self.found.push(Aligned { pair: k * LANES + m, plane: (n, n.dot(a)) });
            }
        }
    }
}

/// Planes through a corner and an edge.
struct Planes {
    /// Of any length.
    normal: Lanes3,
    edge: Lanes3,
    arm: Lanes3,
}

impl Planes {
    #[inline(always)]
    fn through(block: &Block) -> Self {
        let (edge, arm) = (difference(&block.end, &block.start), difference(&block.corner, &block.start));
        Self { normal: cross(&edge, &arm), edge, arm }
    }

    /// Whether the corners of a polygon lie on both sides.
    #[inline(always)]
    fn pass(&self, polygon: &[Vec3], start: &Lanes3) -> Mask {
        let mut range = Range::default();
        for &x in polygon {
            range.add(&dot(&self.normal, &difference(&same(x), start)));
        }
        range.has_both(0.0)
    }

    /// The unit normals, and which pairs line up.
    #[inline(always)]
    fn line_up(&self, block: &Block, place: &Region) -> (Lanes3, Mask) {
        let (edge2, arm2) = (dot(&self.edge, &self.edge), dot(&self.arm, &self.arm));
        let (length2, flat) = (dot(&self.normal, &self.normal), place.flat);
        let least = each(|m| {
            let slim = LEAST_SQUARED_SINE * arm2[m];
            edge2[m] * if slim > flat * flat { slim } else { flat * flat }
        });
        let inverse = each(|m| 1.0 / length2[m].sqrt());
        let n = [
            scaled(&self.normal[0], &inverse),
            scaled(&self.normal[1], &inverse),
            scaled(&self.normal[2], &inverse),
        ];
        let offset = dot(&n, &block.start);
        let (cuts, ends) = chord(&n, &offset, place.source, flat);
        let across = cross(&self.edge, &n);
        let [first, last] = [
            meeting(block, &shrunk(&ends[0], &ends[1]), &n, &across),
            meeting(block, &shrunk(&ends[1], &ends[0]), &n, &across),
        ];
        let active = lines_up(&first, &last);
        let passes = place.target.map_or([u64::MAX; LANES], |target| passes(&n, &offset, target, flat));
        let all = ask(|m| (length2[m] > least[m]) & (cuts[m] & active[m] & passes[m] != 0));
        (n, all)
    }
}

#[inline(always)]
fn scaled(a: &Lanes, s: &Lanes) -> Lanes {
    each(|m| a[m] * s[m])
}

/// The least and the largest height of corners, and 0.
#[derive(Default)]
struct Range {
    low: Lanes,
    high: Lanes,
}

impl Range {
    #[inline(always)]
    fn add(&mut self, height: &Lanes) {
        self.low = each(|m| if height[m] < self.low[m] { height[m] } else { self.low[m] });
        self.high = each(|m| if height[m] > self.high[m] { height[m] } else { self.high[m] });
    }

    /// Whether there are corners on both sides; heights up to `flat` count as 0.
    #[inline(always)]
    fn has_both(&self, flat: f64) -> Mask {
        ask(|m| (self.low[m] < -flat) & (self.high[m] > flat))
    }
}

/// Whether planes have corners of a polygon on both sides.
#[inline(always)]
fn passes(n: &Lanes3, offset: &Lanes, polygon: &[Vec3], flat: f64) -> Mask {
    let mut range = Range::default();
    for &x in polygon {
        range.add(&heights(n, offset, &same(x)));
    }
    range.has_both(flat)
}

/// Whether planes cut a convex polygon, and the two ends of the line in which they do.
#[inline(always)]
fn chord(n: &Lanes3, offset: &Lanes, polygon: &[Vec3], flat: f64) -> (Mask, [Lanes3; 2]) {
    let (mut ends, mut range) = ([[[0.0; LANES]; 3]; 2], Range::default());
    let mut from = polygon[polygon.len() - 1];
    let mut before = heights(n, offset, &same(from));
    for &to in polygon {
        let after = heights(n, offset, &same(to));
        range.add(&after);
        let share = each(|m| before[m] / (before[m] - after[m]));
        let (start, along) = (from.to_array(), (to - from).to_array());
        let rises = ask(|m| (before[m] < 0.0) & (after[m] >= 0.0));
        let falls = ask(|m| (before[m] >= 0.0) & (after[m] < 0.0));
        for axis in 0..3 {
            let place = each(|m| start[axis] + along[axis] * share[m]);
            ends[0][axis] = each(|m| if rises[m] != 0 { place[m] } else { ends[0][axis][m] });
            ends[1][axis] = each(|m| if falls[m] != 0 { place[m] } else { ends[1][axis][m] });
        }
        (from, before) = (to, after);
    }
    (range.has_both(flat), ends)
}

/// The first end of a chord, moved a little to the other.
#[inline(always)]
fn shrunk(a: &Lanes3, b: &Lanes3) -> Lanes3 {
    let mut moved = *a;
    for axis in 0..3 {
        moved[axis] = each(|m| a[axis][m] * (1.0 - CHORD_END_MARGIN) + b[axis][m] * CHORD_END_MARGIN);
    }
    moved
}

/// Where the line from a point through the corner meets the line of the edge, as in
/// [`EdgeVertexEvent`].
struct Meeting {
    /// Whether the edge and the corner come in the right order.
    order: Mask,
    before_end: Mask,
    behind_start: Mask,
}

#[inline(always)]
fn meeting(block: &Block, c: &Lanes3, n: &Lanes3, across: &Lanes3) -> Meeting {
    let (d, a) = (difference(&block.corner, c), difference(&block.start, c));
    let (whole, distance) = (dot(&d, across), dot(&a, across));
    let place = dot(&cross(&a, &d), n);
    let sign = each(|m| if whole[m] < 0.0 { -1.0 } else { 1.0 });
    let (whole, distance, place) = (scaled(&whole, &sign), scaled(&distance, &sign), scaled(&place, &sign));
    let behind = &block.behind;
    Meeting {
        order: ask(|m| {
            let farther = distance[m] > (1.0 + EDGE_END_MARGIN) * whole[m];
            let nearer = (EDGE_END_MARGIN * whole[m] < distance[m])
                & (distance[m] < (1.0 - EDGE_END_MARGIN) * whole[m]);
            ((behind[m] > 0.0) & farther) | ((behind[m] <= 0.0) & nearer)
        }),
        before_end: ask(|m| place[m] < (1.0 - EDGE_END_MARGIN) * whole[m]),
        behind_start: ask(|m| place[m] > EDGE_END_MARGIN * whole[m]),
    }
}

/// Whether corner and edge line up somewhere between two points, as in
/// [`EdgeVertexEvent::is_active`].
#[inline(always)]
fn lines_up(first: &Meeting, last: &Meeting) -> Mask {
    let mut active = [0; LANES];
    for (m, active) in active.iter_mut().enumerate() {
        let inside =
            (first.before_end[m] | last.before_end[m]) & (first.behind_start[m] | last.behind_start[m]);
        let both = first.order[m] & last.order[m];
        *active = (both & inside) | (first.order[m] ^ last.order[m]);
    }
    active
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT_SQUARE: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];

    fn found(pairs: &[EdgeVertexEvent], target: Option<&[Vec3]>) -> Vec<usize> {
        let mut batch = EdgeVertexBatch::default();
        for pair in pairs {
            batch.push(pair);
        }
        batch.ask(Region { source: &UNIT_SQUARE, target, flat: 1e-12 });
        batch.found().iter().map(|aligned| aligned.pair).collect()
    }

    #[test]
    fn planes_pass_where_corners_lie_on_both_sides() {
        let upright = |k: u32| {
            let x = f64::from(k) * 0.1 - 0.05;
            [Vec3::new(x, 0.0, 1.0), Vec3::new(x, 1.0, 1.0)]
        };
        let pair = |k| EdgeVertexEvent { corner: Vec3::new(0.55, 0.5, 2.0), edge: upright(k), behind: false };
        let pairs: Vec<_> = (0..12).map(pair).collect();
        assert_eq!(found(&pairs, None), [4, 5, 6, 7, 8]);
    }

    #[test]
    fn planes_that_miss_the_target_do_not_count() {
        let edge = [Vec3::new(0.5, 0.0, 1.0), Vec3::new(0.5, 1.0, 1.0)];
        let pair = [EdgeVertexEvent { corner: Vec3::new(0.5, 0.5, 2.0), edge, behind: false }];
        let beside = |x: f64| UNIT_SQUARE.map(|y| y + Vec3::new(x, 0.0, 3.0));
        assert_eq!(found(&pair, None), [0]);
        assert_eq!(found(&pair, Some(&beside(0.2))), [0]);
        assert!(found(&pair, Some(&beside(0.6))).is_empty());
    }

    #[test]
    fn lanes_tell_what_single_sightings_do() {
        let noise = |k: usize| (k as f64 * 12.9898).sin().mul_add(43_758.545_3, 0.0).fract().abs();
        let point = |k: usize, low: f64| Vec3::new(noise(k), noise(k + 1), low + noise(k + 2));
        let pair = |k: usize| {
            let behind = k.is_multiple_of(2);
            let (corner, edge) = if behind { (0.5, 1.5) } else { (1.5, 0.5) };
            let ends = [point(9 * k, edge), point(9 * k + 3, edge)];
            EdgeVertexEvent { corner: point(9 * k + 6, corner), edge: ends, behind }
        };
        let pairs: Vec<_> = (0..400).map(pair).collect();
        let alone = |ev_event: &EdgeVertexEvent| {
            let [a, b] = ev_event.edge;
            let n = (b - a).cross(ev_event.corner - a).normalize();
            let heights = UNIT_SQUARE.map(|x| n.dot(x - a));
            super::super::ev_events::chord(&UNIT_SQUARE, |k| heights[k])
                .is_some_and(|chord| ev_event.is_active(chord, n))
        };
        let expected: Vec<usize> = (0..400).filter(|k| alone(&pairs[*k])).collect();
        assert_eq!(found(&pairs, None), expected);
        assert!(expected.len() > 50 && expected.len() < 350, "{}", expected.len());
    }
}
