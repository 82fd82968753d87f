//! The pairs of one panel of patches with all patches before it, sorted by what they see of each
//! other.
//!
//! Node against node: where no body reaches into the shaft between two bounding rectangles their
//! patches see each other wholly; where one body blocks every segment between the rectangles they
//! see nothing; otherwise the larger node is halved and each half keeps the bodies that may matter
//! to it. Both answers are conservative. E. A. Haines & J. R. Wallace 1994,
//! doi:10.1007/978-3-642-57963-9_12, treat the shaft; S. Teller & P. Hanrahan, SIGGRAPH 1993,
//! doi:10.1145/166117.166148, the descent with lists of blockers.

use super::cluster::{Bound, Clusters, Node, extent};
use super::lines::{Heights, Lines, Stands};
use crate::form_factor::blocks;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, ShadowVolume};
use pulp::Arch;
use std::ops::Range;

/// Sine of the angle between the side of a hull of two balls and its axis, up to which it is told
/// from the larger ball.
const MOST_SINE: f64 = 0.95;
/// Rounding of a radius.
const TUBE_ROUNDING: f64 = 1e-12;

/// What the walk asks about.
#[derive(Clone, Copy)]
pub(crate) struct Sight<'a> {
    pub clusters: &'a Clusters,
    pub occluders: &'a Occluders,
    pub bodies: &'a Bodies,
}

/// The patches that each patch of a panel sees, and what stands between.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    /// Per row, the patches that are wholly seen as far as bodies go, then those of `partly`.
    pub seen: Vec<Vec<u32>>,
    /// Per row, patches behind some bodies, as places in `lists`.
    pub partly: Vec<Vec<(u32, Range<usize>)>>,
    /// Bodies by number.
    pub lists: Vec<u32>,
}

/// Sorts the pairs (i, j) with i in the panel and j at an earlier place.
pub(crate) fn walk(sight: &Sight, panel: usize) -> Panel {
    let rows = sight.clusters.nodes[panel].places.clone();
    let found =
        Panel { seen: vec![Vec::new(); rows.len()], partly: vec![Vec::new(); rows.len()], lists: Vec::new() };
    let mut walker = Walker {
        sight,
        first: rows.start,
        end: rows.end,
        found,
        volume: ShadowVolume::default(),
        arch: Arch::new(),
        heights: Vec::new(),
        stack: Vec::new(),
    };
    walker.stack.extend(0..sight.bodies.as_slice().len() as u32);
    let all = 0..walker.stack.len();
    walker.against(panel, 0, all);
    walker.found
}

/// Sorts the pairs (i, j) with i the one patch of `node` and j any patch below the root; the pair
/// of a patch with itself is among them.
pub(crate) fn walk_from(sight: &Sight, node: usize) -> Panel {
    let first = sight.clusters.nodes[node].places.start;
    let found = Panel { seen: vec![Vec::new()], partly: vec![Vec::new()], lists: Vec::new() };
    let mut walker = Walker {
        sight,
        first,
        end: first + 1,
        found,
        volume: ShadowVolume::default(),
        arch: Arch::new(),
        heights: Vec::new(),
        stack: Vec::new(),
    };
    walker.stack.extend(0..sight.bodies.as_slice().len() as u32);
    let all = 0..walker.stack.len();
    walker.pair(node, 0, all);
    walker.found
}

struct Walker<'a> {
    sight: &'a Sight<'a>,
    first: usize,
    end: usize,
    found: Panel,
    volume: ShadowVolume,
    arch: Arch,
    /// A buffer of [`Lines::ask`].
    heights: Vec<Heights>,
    /// Lists of bodies, one behind the other.
    stack: Vec<u32>,
}

impl Walker<'_> {
    fn node(&self, index: usize) -> &Node {
        &self.sight.clusters.nodes[index]
    }

    /// The panel against the parts of a node that come before it, and against itself.
    fn against(&mut self, panel: usize, other: usize, bodies: Range<usize>) {
        let places = self.node(other).places.clone();
        if places.start >= self.end {
            return;
        }
        if places.end <= self.first {
            self.pair(panel, other, bodies);
        } else if places.start >= self.first && places.end <= self.end {
            self.within(other, bodies);
        } else if let Some(children) = self.node(other).children {
            for child in children {
                self.against(panel, child, bodies.clone());
            }
        }
    }

    /// A node against itself; patches of one plane do not see each other.
    fn within(&mut self, node: usize, bodies: Range<usize>) {
        if matches!(self.node(node).bound, Bound::Flat(_)) {
            return;
        }
        if let Some([low, high]) = self.node(node).children {
            self.within(low, bodies.clone());
            self.within(high, bodies.clone());
            self.pair(high, low, bodies);
        }
    }

    fn pair(&mut self, a: usize, b: usize, bodies: Range<usize>) {
        let (one, other) = (self.node(a), self.node(b));
        if one.has_behind(other) || other.has_behind(one) {
            return;
        }
        let start = self.stack.len();
        match self.between(a, b, bodies) {
            Seen::Nothing => {}
            Seen::All => self.emit(a, b),
            Seen::Part => self.divide(a, b, start..self.stack.len()),
        }
        self.stack.truncate(start);
    }

    /// Appends the bodies that matter to the stack.
    fn between(&mut self, a: usize, b: usize, bodies: Range<usize>) -> Seen {
        let start = self.stack.len();
        let nodes = &self.sight.clusters.nodes;
        let blocked = if let (Bound::Flat(p), Bound::Flat(q)) = (&nodes[a].bound, &nodes[b].bound) {
            self.between_rectangles(p, q, bodies)
        } else {
            let tube = Tube::between(&nodes[a], &nodes[b]);
            let around = self.sight.bodies.bounds();
            self.keep(bodies, |body| tube.meets(around[body as usize]));
            false
        };
        match (blocked, self.stack.len() == start) {
            (true, _) => Seen::Nothing,
            (false, true) => Seen::All,
            (false, false) => Seen::Part,
        }
    }

    /// Whether nothing of one rectangle is seen from the other.
    fn between_rectangles(&mut self, p: &Patch, q: &Patch, bodies: Range<usize>) -> bool {
        let Sight { occluders, bodies: all, .. } = *self.sight;
        let tolerance = all.tolerance();
        let sides = [side(p, q, tolerance), side(q, p, tolerance)];
        if sides.contains(&Side::Behind) {
            return true;
        }
        // Of patches that cross each other's plane, only parts see each other.
        let wholly = sides == [Side::Before; 2];
        let (mut shaft, lines) = (None, Lines::between(p, q, tolerance));
        for k in bodies {
            let number = self.stack[k];
            let body = &all.as_slice()[number as usize];
            let stands = lines.ask(body, tolerance, (self.arch, &mut self.heights));
            match stands {
                Stands::Beside => continue,
                Stands::Certainly if wholly => return true,
                _ => {}
            }
            if stands != Stands::Partly || !wholly {
                let Some(shaft) = shaft.get_or_insert_with(|| occluders.shaft_between(p, q)) else {
                    return true;
                };
                if !occluders.reaches(body, shaft) {
                    continue;
                }
                if stands.may_be_across() && blocks(body, p, q, tolerance, &mut self.volume) {
                    return true;
                }
            }
            self.stack.push(number);
        }
        false
    }

    fn keep(&mut self, bodies: Range<usize>, matters: impl Fn(u32) -> bool) {
        for k in bodies {
            let body = self.stack[k];
            if matters(body) {
                self.stack.push(body);
            }
        }
    }

    fn emit(&mut self, a: usize, b: usize) {
        let order = &self.sight.clusters.order;
        let columns = &order[self.node(b).places.clone()];
        for place in self.node(a).places.clone() {
            self.found.seen[place - self.first].extend_from_slice(columns);
        }
    }

    fn divide(&mut self, a: usize, b: usize, bodies: Range<usize>) {
        let larger_first = self.node(a).radius >= self.node(b).radius;
        let halves = |node: &Node| node.children;
        match (halves(self.node(a)), halves(self.node(b))) {
            (None, None) => self.leave(a, b, bodies),
            (Some(parts), other) if larger_first || other.is_none() => {
                for part in parts {
                    self.pair(part, b, bodies.clone());
                }
            }
            (_, Some(parts)) => parts.into_iter().for_each(|part| self.pair(a, part, bodies.clone())),
            (Some(_), None) => {}
        }
    }

    fn leave(&mut self, a: usize, b: usize, bodies: Range<usize>) {
        let row = self.node(a).places.start - self.first;
        let column = self.sight.clusters.order[self.node(b).places.start];
        let start = self.found.lists.len();
        self.found.lists.extend_from_slice(&self.stack[bodies]);
        self.found.partly[row].push((column, start..self.found.lists.len()));
    }
}

/// What two nodes see of each other.
enum Seen {
    Nothing,
    All,
    Part,
}

/// Where a patch lies over the plane of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Before,
    Behind,
    Across,
}

/// Where `q` lies over `p`.
fn side(p: &Patch, q: &Patch, tolerance: f64) -> Side {
    let (normal, offset) = (p.normal(), p.normal().dot(p.corner(0)));
    let (mut above, mut below) = (false, false);
    for x in q.corners() {
        let height = normal.dot(*x) - offset;
        above |= height > tolerance;
        below |= height < -tolerance;
    }
    match (above, below) {
        (true, false) => Side::Before,
        (true, true) => Side::Across,
        _ => Side::Behind,
    }
}

fn corners(bound: &Bound) -> [Vec3; 2] {
    match bound {
        Bound::Flat(patch) => extent(patch.corners().iter()),
        Bound::Box(corners) => *corners,
    }
}

/// What holds all segments from one node to another: the box around both, and the convex hull of
/// their balls.
struct Tube {
    low: Vec3,
    high: Vec3,
    start: Vec3,
    way: Vec3,
    /// 1/|way|².
    scale: f64,
    /// Radius of the hull at the start, what it grows by up to the end, and the distance of its side
    /// from the axis over the radius there.
    radius: f64,
    growth: f64,
    secant: f64,
}

impl Tube {
    fn between(a: &Node, b: &Node) -> Self {
        let ([low, high], [least, most]) = (corners(&a.bound), corners(&b.bound));
        let ((start, from), (end, to)) = (a.ball, b.ball);
        let way = end - start;
        let sine = (to - from) / way.length();
        let (low, high, scale) = (low.min(least), high.max(most), way.length_squared().recip());
        if sine.abs() < MOST_SINE {
            let secant = (1.0 - sine * sine).sqrt().recip();
            return Self { low, high, start, way, scale, radius: from, growth: to - from, secant };
        }
        // One ball is nearly within the other, or quite.
        let (scale, radius) = (0.0, from.max(way.length() + to));
        Self { low, high, start, way, scale, radius, growth: 0.0, secant: 1.0 }
    }

    /// Whether a body within a box may reach into it: its ball widens the hull by its own radius.
    fn meets(&self, [least, most]: [Vec3; 2]) -> bool {
        if !(least.cmple(self.high).all() && most.cmpge(self.low).all()) {
            return false;
        }
        let (middle, size) = (0.5 * (least + most) - self.start, 0.5 * least.distance(most));
        let t = (middle.dot(self.way) * self.scale).clamp(0.0, 1.0);
        let reach = (self.radius + self.growth * t + size) * self.secant * (1.0 + TUBE_ROUNDING);
        (middle - t * self.way).length_squared() <= reach * reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::keyed::keyed;

    /// Nodes of two squares anywhere, of any size: points of segments between them are in the tube,
    /// and what is far from it is not.
    #[test]
    fn segments_stay_in_the_tube_and_what_is_far_is_outside() {
        let (mut outside, rounding) = (0, Vec3::splat(1e-12));
        for case in 0..2000 {
            let random = |k: u64| keyed(case, 1, k);
            let square = |k: u64| {
                let size = 0.01_f64.powf(random(k));
                let [low, u, v] = [0, 1, 2].map(|n| {
                    let x = |axis| random(k + 1 + 3 * n + axis) - 0.5;
                    Vec3::new(x(0), x(1), x(2)) * if n == 0 { 2.0 } else { size }
                });
                Patch::triangle([low, low + u, low + v]).unwrap()
            };
            let patches = [square(0), square(20)];
            let clusters = Clusters::new(&patches.each_ref(), 1e-9);
            let leaves: Vec<&Node> = clusters.nodes.iter().filter(|node| node.children.is_none()).collect();
            let tube = Tube::between(leaves[0], leaves[1]);
            let [a, b] = [0, 1].map(|k| &patches[clusters.order[k] as usize]);
            for (x, y) in a.corners().iter().flat_map(|x| b.corners().iter().map(move |y| (*x, *y))) {
                for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
                    let at = x + t * (y - x);
                    assert!(tube.meets([at - rounding, at + rounding]), "{case}");
                }
            }
            let aside = Vec3::new(random(40) - 0.5, random(41) - 0.5, random(42) - 0.5) * 4.0;
            outside += usize::from(!tube.meets([aside, aside]));
        }
        assert!(outside > 1000, "{outside}");
    }
}
