//! A binary tree over the patches of a scene: first by place, then by plane, then by place in the
//! plane.
//!
//! A node whose patches lie in one plane and face the same side is bounded by a rectangle in that
//! plane, which stands for its patches in questions of visibility. Other nodes are bounded by
//! boxes. Lengths in metres.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::GENERIC_DIRECTION;
use std::ops::Range;

/// Planes in a node up to which it is cut between planes rather than through the middle.
const MOST_PLANES: usize = 32;
/// Share of the place along [`GENERIC_DIRECTION`] in the order of patches.
const ORDER_SHEAR: f64 = 1e-4;
/// Rounding of a cosine.
const CONE_ROUNDING: f64 = 1e-12;
/// Cosine of the angle between normals, less than 1 by this, up to which they count as one.
const COSINE_TOLERANCE: f64 = 1e-14;

/// What bounds the patches of a node.
#[derive(Clone, Debug)]
pub(crate) enum Bound {
    /// A rectangle in their plane that faces as they do, or the patch itself.
    Flat(Patch),
    /// A box.
    Box([Vec3; 2]),
}

/// Some patches, by their places in the order of the tree.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub places: Range<usize>,
    /// Nodes that share its patches, none for a single patch.
    pub children: Option<[usize; 2]>,
    pub bound: Bound,
    /// Half its extent, m.
    pub radius: f64,
    /// A ball around its patches: centre and radius, m.
    pub ball: (Vec3, f64),
    pub normals: Cone,
}

/// A cone of directions: axis, and cosine and sine of half its opening.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    axis: Vec3,
    opening: [f64; 2],
}

impl Cone {
    /// Around the normals of some patches; all directions where it would have to open beyond a
    /// right angle.
    fn around(normals: impl Iterator<Item = Vec3> + Clone) -> Self {
        let axis = normals.clone().sum::<Vec3>().normalize_or_zero();
        let cosine = normals.map(|n| n.dot(axis)).fold(1.0, f64::min) - CONE_ROUNDING;
        let opening = if cosine > 0.0 { [cosine, (1.0 - cosine * cosine).sqrt()] } else { [-1.0, 0.0] };
        Self { axis, opening }
    }

    /// The largest n·d of its directions n.
    fn most_along(&self, d: Vec3) -> f64 {
        let [cosine, sine] = self.opening;
        let (along, length) = (self.axis.dot(d), d.length());
        if along >= cosine * length {
            return length;
        }
        along * cosine + (length * length - along * along).max(0.0).sqrt() * sine
    }
}

impl Node {
    /// Whether all of another node lies behind all planes of this one's patches.
    pub(crate) fn has_behind(&self, other: &Self) -> bool {
        let ((here, radius), (there, other_radius)) = (self.ball, other.ball);
        self.normals.most_along(there - here) + radius + other_radius < 0.0
    }
}

/// The tree; node 0 is the root.
#[derive(Clone, Debug)]
pub(crate) struct Clusters {
    pub nodes: Vec<Node>,
    /// The patch at each place.
    pub order: Vec<u32>,
}

impl Clusters {
    /// Builds the tree; places nearer than `tolerance` (m) count as one.
    pub(crate) fn new(patches: &[&Patch], tolerance: f64) -> Self {
        Self::of_kinds(patches, &vec![0; patches.len()], tolerance)
    }

    /// As [`new`](Self::new), where patches of different kinds count as lying in different planes.
    pub(crate) fn of_kinds(patches: &[&Patch], kinds: &[u32], tolerance: f64) -> Self {
        let centres = patches.iter().map(|p| p.centroid()).collect();
        let builder = Builder { patches, kinds, centres, tolerance };
        let mut tree = Self { nodes: Vec::new(), order: (0..patches.len() as u32).collect() };
        if !patches.is_empty() {
            let mut order = std::mem::take(&mut tree.order);
            builder.build(&mut order, 0, &mut tree.nodes);
            tree.order = order;
        }
        tree
    }

    /// The largest nodes of at most `most` patches, in the order of places.
    pub(crate) fn panels(&self, most: usize) -> Vec<usize> {
        let mut panels = Vec::new();
        let mut stack: Vec<usize> = (!self.nodes.is_empty()).then_some(0).into_iter().collect();
        while let Some(node) = stack.pop() {
            match self.nodes[node].children {
                Some([low, high]) if self.nodes[node].places.len() > most => stack.extend([high, low]),
                _ => panels.push(node),
            }
        }
        panels
    }
}

struct Builder<'a> {
    patches: &'a [&'a Patch],
    kinds: &'a [u32],
    centres: Vec<Vec3>,
    tolerance: f64,
}

impl Builder<'_> {
    /// Appends the node of `order` (patches from place `start` on) and those below it.
    fn build(&self, order: &mut [u32], start: usize, nodes: &mut Vec<Node>) -> usize {
        let index = nodes.len();
        let planes = self.planes(order);
        let (bound, radius) = self.bound(order, planes.len());
        let ball = ball(extent(order.iter().flat_map(|&k| self.patch(k).corners())));
        let normals = Cone::around(order.iter().map(|&k| self.patch(k).normal()));
        let places = start..start + order.len();
        nodes.push(Node { places, children: None, bound, radius, ball, normals });
        if order.len() > 1 {
            let middle = if (2..=MOST_PLANES).contains(&planes.len()) {
                self.between_planes(order, &planes)
            } else {
                self.through_the_middle(order)
            };
            let (low, high) = order.split_at_mut(middle);
            let low = self.build(low, start, nodes);
            let high = self.build(high, start + middle, nodes);
            nodes[index].children = Some([low, high]);
        }
        index
    }

    fn patch(&self, k: u32) -> &Patch {
        self.patches[k as usize]
    }

    fn in_plane(&self, k: u32, p: u32) -> bool {
        let (patch, first) = (self.patch(k), self.patch(p));
        self.kinds[k as usize] == self.kinds[p as usize]
            && patch.normal().dot(first.normal()) > 1.0 - COSINE_TOLERANCE
            && (patch.corner(0) - first.corner(0)).dot(first.normal()).abs() <= self.tolerance
    }

    /// One patch of each plane, in a geometrical order that the numbering does not change; more
    /// than [`MOST_PLANES`] are not told apart.
    fn planes(&self, order: &[u32]) -> Vec<u32> {
        let mut planes: Vec<u32> = Vec::new();
        for &k in order {
            if !planes.iter().any(|&p| self.in_plane(k, p)) {
                planes.push(k);
                if planes.len() > MOST_PLANES {
                    break;
                }
            }
        }
        planes
    }

    /// Sorts the patches of the first half of the planes to the front. A patch belongs to the first
    /// plane that it lies in: where one patch lies in the plane of another but not the other way
    /// round, as nearly flat quads make them, each plane keeps its own patch, so that neither part
    /// is empty.
    fn between_planes(&self, order: &mut [u32], planes: &[u32]) -> usize {
        let mut sorted = planes.to_vec();
        let key = |&p: &u32| {
            let n = self.patch(p).normal();
            [n.z, n.y, n.x, n.dot(self.patch(p).corner(0)), f64::from(self.kinds[p as usize])]
        };
        sorted.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        let low = &sorted[..sorted.len() / 2];
        let plane = |k: u32| planes.iter().find(|&&p| p == k || self.in_plane(k, p));
        let is_low = |k: u32| plane(k).is_some_and(|p| low.contains(p));
        order.sort_by_cached_key(|&k| !is_low(k));
        order.iter().take_while(|&&k| is_low(k)).count()
    }

    fn through_the_middle(&self, order: &mut [u32]) -> usize {
        let corners = || order.iter().map(|&k| self.centres[k as usize]);
        let low = corners().fold(Vec3::INFINITY, Vec3::min);
        let size = corners().fold(Vec3::NEG_INFINITY, Vec3::max) - low;
        // Extents that are equal but for rounding: the same axis wherever the scene stands.
        let most = size.max_element() * (1.0 - 1e-9);
        let axis = (0..3).find(|&axis| size[axis] >= most).unwrap_or(0);
        // Patches at one place along the axis are told apart by a small shear, not by their
        // numbers.
        let key = |&k: &u32| {
            self.centres[k as usize][axis] + ORDER_SHEAR * self.centres[k as usize].dot(GENERIC_DIRECTION)
        };
        order.sort_by(|a, b| key(a).total_cmp(&key(b)));
        let place = |k: usize| self.centres[order[k] as usize][axis];
        let gap = |k: &usize| place(*k) - place(*k - 1) > 2.0 * ORDER_SHEAR * most;
        // Between rows of a grid rather than through one, so that both halves are rectangles again.
        let middle = order.len() / 2;
        let near = (0..=middle).flat_map(|d| [middle - d, middle + d]);
        near.filter(|k| (1..order.len()).contains(k)).find(gap).unwrap_or(middle)
    }

    fn bound(&self, order: &[u32], planes: usize) -> (Bound, f64) {
        if let [single] = *order {
            let patch = self.patch(single);
            return (Bound::Flat(*patch), 0.5 * patch.diameter());
        }
        let corners = || order.iter().flat_map(|&k| self.patch(k).corners());
        if planes == 1
            && let Some(rectangle) = rectangle(self.patch(order[0]), &corners)
        {
            return (Bound::Flat(rectangle), 0.5 * rectangle.diameter());
        }
        let [low, high] = extent(corners());
        (Bound::Box([low, high]), 0.5 * low.distance(high))
    }
}

/// The lowest and highest coordinates of some corners.
pub(super) fn extent<'a>(corners: impl Iterator<Item = &'a Vec3>) -> [Vec3; 2] {
    corners.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
}

/// The ball around a box.
fn ball([low, high]: [Vec3; 2]) -> (Vec3, f64) {
    (0.5 * (low + high), 0.5 * low.distance(high))
}

/// A rectangle in the plane of a patch round some corners.
fn rectangle<'a, I: Iterator<Item = &'a Vec3>>(first: &Patch, corners: &impl Fn() -> I) -> Option<Patch> {
    let origin = first.corner(0);
    let u = (first.corner(1) - origin).normalize();
    let v = first.normal().cross(u);
    let range = |axis: Vec3| {
        let places = corners().map(|&x| (x - origin).dot(axis));
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let ([u0, u1], [v0, v1]) = (range(u), range(v));
    let at = |s: f64, t: f64| origin + u * s + v * t;
    Patch::quad([at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1)]).ok().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square that looks down, its corner at `corner` and its side along x falling by
    /// `slope`.
    fn square(corner: Vec3, slope: f64) -> Patch {
        let (u, v) = (Vec3::new(1.0, 0.0, -slope), Vec3::Y);
        Patch::quad([corner, corner + v, corner + u + v, corner + u]).unwrap().unwrap()
    }

    /// Triangles on a ball, as nodes of the tree: those that face away are told, and no others.
    #[test]
    fn what_faces_away_is_behind_and_what_is_behind_faces_away() {
        let point = |i: usize, j: usize| {
            let (polar, turn) = (0.2 + 0.2 * i as f64, 0.35 * j as f64);
            Vec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos())
        };
        let corner = |k: usize| [point(k / 9, k % 9), point(k / 9 + 1, k % 9), point(k / 9, k % 9 + 1)];
        let patches: Vec<Patch> = (0..108).map(|k| Patch::triangle(corner(k)).unwrap()).collect();
        let tree = Clusters::new(&patches.iter().collect::<Vec<_>>(), 1e-9);
        let mut told = 0;
        for (one, other) in tree.nodes.iter().flat_map(|one| tree.nodes.iter().map(move |other| (one, other)))
        {
            if !one.has_behind(other) {
                continue;
            }
            told += 1;
            for (a, b) in one.places.clone().flat_map(|a| other.places.clone().map(move |b| (a, b))) {
                let [a, b] = [a, b].map(|place| &patches[tree.order[place] as usize]);
                assert!(b.corners().iter().all(|x| a.normal().dot(*x - a.corner(0)) < 0.0));
            }
        }
        assert!(told > 1000, "{told}");
        assert!(!tree.nodes[0].has_behind(&tree.nodes[0]));
    }

    #[test]
    fn a_patch_in_the_plane_of_another_that_is_not_in_its_own_ends_the_tree() {
        // The level square's plane goes through the corner of the tilted one, that of the tilted
        // one passes 1e-7 below the level one.
        let patches = [square(Vec3::ZERO, 1e-7), square(Vec3::X * 3.0, 0.0)];
        let tree = Clusters::new(&patches.each_ref(), 1e-9);
        assert_eq!(tree.nodes.len(), 3);
        let copies: Vec<&Patch> = patches.iter().cycle().take(7).collect();
        assert_eq!(Clusters::new(&copies, 1e-9).nodes.len(), 13);
    }
}
