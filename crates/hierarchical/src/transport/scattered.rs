//! What two nodes exchange of which at least one faces all ways, such as a piece of furniture or a
//! house: an estimate from a few pairs of points.
//!
//! G = ∫∫ cosθ cosθ'/(π r²) over both nodes is A A' times the mean over points of either, which are
//! taken from low-discrepancy sequences with a start of their own for every pair of nodes, members
//! in proportion to their areas. So the estimates are free of a systematic error, the same in every
//! run, and their errors have nothing to do with each other: over the many small links of a
//! receiver they average out. The standard error of the mean is the doubt of the link, so that an
//! oracle divides what matters. The members of a scattered node receive very differently, which
//! counts as a deviation of [`SCATTERED_DEVIATION`]. Exchanges in m², lengths in metres. B. Smits,
//! J. Arvo, D. Greenberg, SIGGRAPH 1994, doi:10.1145/192161.192277, for links of clusters that face
//! all ways.

use super::draw::Places;
use super::sight::Viewer;
use crate::tree::{Node, Tree};
use fredholm_coupling::kernel::lambert;
use fredholm_coupling::polygon::folded;
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;

/// Pairs of points.
const PAIRS: usize = 16;
/// Distance of the centres over the sum of the radii from which on two nodes are apart: the kernel
/// has no peaks then.
const APART_DISTANCE: f64 = 1.5;
/// Deviation over a scattered node, over its mean. Members that face the sender receive up to five
/// times the mean of a box, others nothing, and what many senders on one side do to them goes the
/// same way and adds up: so such links must be small beside what counts.
const SCATTERED_DEVIATION: f64 = 20.0;
/// Share of what two nodes would exchange face to face that they may exchange where no pair of
/// points does.
const GRAZING_SHARE: f64 = 0.02;
/// Pairs of points of two nodes.
pub(crate) struct Chance {
    /// Exchange A_a F_ab with nothing between, m².
    pub open: f64,
    /// Deviation over a and over b.
    pub deviations: [f64; 2],
    /// Both points and what they exchange, over the sum of that.
    pairs: Vec<([Vec3; 2], f64)>,
    /// Standard error of the mean of the pairs, relative.
    error: f64,
}

/// Whether two nodes lie far enough apart.
pub(crate) fn apart(a: &Node, b: &Node) -> bool {
    a.cone().centre.distance(b.cone().centre) > APART_DISTANCE * (a.cone().radius + b.cone().radius)
}

impl Chance {
    /// The pairs of points of two nodes, which must lie apart.
    pub fn of(tree: &Tree, nodes: [u32; 2]) -> Self {
        let [a, b] = nodes.map(|index| &tree.nodes()[index as usize]);
        let (low, high) = (nodes[0].min(nodes[1]), nodes[0].max(nodes[1]));
        let mut places = Places::of((u64::from(low) << 32) | u64::from(high));
        let mut pairs = Vec::with_capacity(PAIRS);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..PAIRS {
            let [(of_a, on_a), (of_b, on_b)] = places.next();
            let (Some(p), Some(q)) = (tree.member(nodes[0], of_a), tree.member(nodes[1], of_b)) else {
                continue;
            };
            let (x, y) = (place(p, on_a), place(q, on_b));
            let weight = lambert(x, p.normal(), y, q.normal());
            if weight > 0.0 {
                (sum, squares) = (sum + weight, squares + weight * weight);
                pairs.push(([x, y], weight));
            }
        }
        let areas = a.area() * b.area();
        let distance = a.cone().centre.distance(b.cone().centre);
        // What faces one way sees a sender of about this size under angles that vary by its own
        // size over the distance.
        let deviations = [a, b].map(|node| {
            if node.faces_one_way() { 2.0 * node.cone().radius / distance } else { SCATTERED_DEVIATION }
        });
        if sum <= 0.0 {
            let open = GRAZING_SHARE * areas / (PI * distance * distance);
            return Self { open: open.min(a.area()).min(b.area()), deviations, pairs, error: 1.0 };
        }
        let count = PAIRS as f64;
        let (mean, square) = (sum / count, squares / count);
        let error = ((square - mean * mean).max(0.0) / count).sqrt() / mean;
        for (_, weight) in &mut pairs {
            *weight /= sum;
        }
        Self { open: (mean * areas).min(a.area()).min(b.area()), deviations, pairs, error }
    }

    /// The share of the open exchange that gets through, and its doubt, that of the open exchange
    /// included.
    pub fn seen(&self, viewer: &Viewer) -> [f64; 2] {
        let clear = |([x, y], weight): &([Vec3; 2], f64)| if viewer.sees(*x, *y) { *weight } else { 0.0 };
        let share: f64 = self.pairs.iter().map(clear).sum();
        // A ray of either kind more: a few that agree do not make sure.
        let mixed = (share * (1.0 - share)).max(1.0 / PAIRS as f64) / PAIRS as f64;
        [share, mixed.sqrt().hypot(share * self.error)]
    }
}

/// The point of a patch for a point of the unit square.
pub(super) fn place(patch: &Patch, [u, v]: [f64; 2]) -> Vec3 {
    let (u, v) = folded(patch, u, v);
    patch.point(u, v)
}
