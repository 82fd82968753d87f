//! Clusters of input elements: a binary tree, first by place, then by plane, then by place in the
//! plane.
//!
//! Elements of at most [`MOST_PLANES`] planes are parted between planes, others through the middle
//! of their longest extent. Where nearly each element has a plane of its own, normals count as
//! places, so that what faces elsewhere is parted from what only lies elsewhere. Elements of one
//! plane are parted along a line that cuts none of them, where there is one. Lengths in metres.

use super::hull::filled;
use super::{Cone, NO_NODE, Node, Tree};
use fredholm_mesh::{Mesh, Patch, Vec3};

/// Planes up to which a group is parted between planes.
const MOST_PLANES: usize = 32;
/// Planes from which on a group is curved, if each is met within [`MOST_ELEMENTS_BETWEEN_PLANES`]
/// elements.
const LEAST_CURVED_PLANES: usize = 7;
const MOST_ELEMENTS_BETWEEN_PLANES: usize = 3;
/// Length of a unit normal as a place, over the extent of the group.
const NORMAL_LENGTH: f64 = 0.5;
/// Cosine of the angle between normals, less than 1 by this, up to which they count as one.
const COSINE_TOLERANCE: f64 = 1e-12;

/// Appends the clusters and roots of a mesh, parents before children.
pub(super) fn build(mesh: &Mesh, tolerance: f64, tree: &mut Tree) {
    let patches: Vec<&Patch> = mesh.patches().collect();
    let builder = Builder { mesh, patches, tolerance };
    let all: Vec<u32> = (0..mesh.len() as u32).collect();
    let mut stack = vec![(NO_NODE, all)];
    while let Some((parent, order)) = stack.pop() {
        let index = tree.nodes.len() as u32;
        tree.nodes.push(Node { parent, ..builder.node(&order, index) });
        if parent != NO_NODE {
            let children = &mut tree.nodes[parent as usize].children;
            children[usize::from(children[0] != NO_NODE)] = index;
        }
        if let [single] = *order {
            tree.roots[single as usize] = index;
        } else {
            let (low, high) = builder.part(order);
            stack.push((index, high));
            stack.push((index, low));
        }
    }
}

struct Builder<'a> {
    mesh: &'a Mesh,
    patches: Vec<&'a Patch>,
    tolerance: f64,
}

impl<'a> Builder<'a> {
    fn patch(&self, k: u32) -> &'a Patch {
        self.patches[k as usize]
    }

    fn node(&self, order: &[u32], number: u32) -> Node {
        if let [single] = *order {
            let face = self.mesh.face_of(single as usize) as u32;
            return Node::element(*self.patch(single), face, single, number);
        }
        let list: Vec<&Patch> = order.iter().map(|&k| self.patch(k)).collect();
        let area = list.iter().map(|patch| patch.area()).sum();
        let flat = if self.planes(order).0.len() == 1 { filled(&list) } else { None };
        Node::cluster(flat, Cone::around(list.iter().copied()), area)
    }

    /// Parts a group of at least two. Both parts have members: where rounding puts all on one side,
    /// the middle of the list parts them.
    fn part(&self, order: Vec<u32>) -> (Vec<u32>, Vec<u32>) {
        let (planes, met) = self.planes(&order);
        let (mut low, mut high) = match planes.len() {
            1 => self.in_one_plane(order),
            count if count >= LEAST_CURVED_PLANES && met < MOST_ELEMENTS_BETWEEN_PLANES * count => {
                self.through_place_or_normal(order)
            }
            2..=MOST_PLANES => self.between_planes(order, &planes),
            _ => self.through_the_middle(order, [Vec3::X, Vec3::Y, Vec3::Z]),
        };
        if low.is_empty() || high.is_empty() {
            low.append(&mut high);
            high = low.split_off(low.len() / 2);
        }
        (low, high)
    }

    fn same_plane(&self, k: u32, of: u32) -> bool {
        let (patch, first) = (self.patch(k), self.patch(of));
        patch.normal().dot(first.normal()) > 1.0 - COSINE_TOLERANCE
            && (patch.corner(0) - first.corner(0)).dot(first.normal()).abs() <= self.tolerance
    }

    /// One element of each plane, and how many elements were asked; more than [`MOST_PLANES`] are
    /// not told apart.
    fn planes(&self, order: &[u32]) -> (Vec<u32>, usize) {
        let mut planes: Vec<u32> = Vec::new();
        for (met, &k) in order.iter().enumerate() {
            if !planes.iter().any(|&plane| self.same_plane(k, plane)) {
                planes.push(k);
                if planes.len() > MOST_PLANES {
                    return (planes, met + 1);
                }
            }
        }
        (planes, order.len())
    }

    fn between_planes(&self, order: Vec<u32>, found: &[u32]) -> (Vec<u32>, Vec<u32>) {
        let key = |k: u32| {
            let n = self.patch(k).normal();
            [n.z, n.y, n.x, n.dot(self.patch(k).corner(0))]
        };
        let by_key = |a: &u32, b: &u32| {
            key(*a).iter().zip(key(*b)).fold(std::cmp::Ordering::Equal, |o, (a, b)| o.then(a.total_cmp(&b)))
        };
        let mut planes = found.to_vec();
        planes.sort_by(by_key);
        // Each element goes with the first plane that takes it, as when the planes were found: what
        // lies in one plane up to rounding is not the same both ways.
        let low: Vec<u32> = planes[..planes.len() / 2].to_vec();
        let plane = |k: u32| found.iter().find(|&&plane| self.same_plane(k, plane));
        order.into_iter().partition(|&k| plane(k).is_some_and(|plane| low.contains(plane)))
    }

    /// Along a line between elements, else through the middle.
    fn in_one_plane(&self, order: Vec<u32>) -> (Vec<u32>, Vec<u32>) {
        let first = self.patch(order[0]);
        let u = (first.corner(1) - first.corner(0)).normalize();
        let axes = [u, first.normal().cross(u)];
        let extent = |axis: Vec3| {
            let [low, high] = self.range(&order, axis);
            high - low
        };
        let longer_first = if extent(axes[0]) >= extent(axes[1]) { axes } else { [axes[1], axes[0]] };
        let line = longer_first.iter().find_map(|&axis| Some((axis, self.gap(&order, axis)?)));
        match line {
            Some((axis, at)) => order.into_iter().partition(|&k| self.patch(k).centroid().dot(axis) < at),
            None => self.through_the_middle(order, [axes[0], axes[1], axes[0]]),
        }
    }

    fn range(&self, order: &[u32], axis: Vec3) -> [f64; 2] {
        let places = order.iter().flat_map(|&k| self.patch(k).corners()).map(|x| x.dot(axis));
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }

    /// The place along an axis, nearest to the middle, where a line cuts no element.
    fn gap(&self, order: &[u32], axis: Vec3) -> Option<f64> {
        let mut spans: Vec<[f64; 2]> = order.iter().map(|&k| self.range(&[k], axis)).collect();
        spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let (start, mut end) = (spans[0][0], spans[0][1]);
        let last = spans.iter().map(|span| span[1]).fold(end, f64::max);
        let middle = 0.5 * (start + last);
        let mut best: Option<f64> = None;
        for &[from, to] in &spans[1..] {
            if from >= end - self.tolerance && best.is_none_or(|b| (from - middle).abs() < (b - middle).abs())
            {
                best = Some(from);
            }
            end = end.max(to);
        }
        best
    }

    /// Two halves along the axis of the largest extent of places or normals.
    fn through_place_or_normal(&self, order: Vec<u32>) -> (Vec<u32>, Vec<u32>) {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        let place = |k: u32| self.patch(k).centroid();
        let extents = axes.map(|axis| extent(&order, |k| place(k).dot(axis)));
        let length = NORMAL_LENGTH * extents.iter().copied().fold(0.0, f64::max);
        let normal = |k: u32| self.patch(k).normal() * length;
        let turns = axes.map(|axis| extent(&order, |k| normal(k).dot(axis)));
        match (widest(&extents), widest(&turns)) {
            ((_, far), (axis, turn)) if turn > far => halves(order, |k| normal(k).dot(axes[axis])),
            ((axis, _), _) => halves(order, |k| place(k).dot(axes[axis])),
        }
    }

    /// Two halves along the axis of the largest extent.
    fn through_the_middle(&self, order: Vec<u32>, axes: [Vec3; 3]) -> (Vec<u32>, Vec<u32>) {
        let extents = axes.map(|axis| {
            let [low, high] = self.range(&order, axis);
            high - low
        });
        let axis = axes[widest(&extents).0];
        halves(order, |k| self.patch(k).centroid().dot(axis))
    }
}

fn extent(order: &[u32], place: impl Fn(u32) -> f64) -> f64 {
    let ends = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
    let [low, high] = order.iter().map(|&k| place(k)).fold([f64::INFINITY, f64::NEG_INFINITY], ends);
    high - low
}

/// The first of the largest, up to rounding.
fn widest(extents: &[f64; 3]) -> (usize, f64) {
    let most = extents.iter().copied().fold(0.0, f64::max) * (1.0 - 1e-9);
    (extents.iter().position(|&extent| extent >= most).unwrap_or(0), most)
}

/// Two parts of rising places, as nearly halves as elements at one place stay together.
fn halves(mut order: Vec<u32>, place: impl Fn(u32) -> f64) -> (Vec<u32>, Vec<u32>) {
    order.sort_by(|&a, &b| place(a).total_cmp(&place(b)));
    let together = 1e-9 * (place(order[order.len() - 1]) - place(order[0]));
    let apart = |&k: &usize| place(order[k]) - place(order[k - 1]) > together;
    let middle = order.len() / 2;
    let below = (1..=middle).rev().find(apart);
    let above = (middle + 1..order.len()).find(apart);
    let cut = match (below, above) {
        (Some(low), Some(high)) if high - middle < middle - low => high,
        (Some(low), _) => low,
        (None, high) => high.unwrap_or(middle),
    };
    let high = order.split_off(cut);
    (order, high)
}
