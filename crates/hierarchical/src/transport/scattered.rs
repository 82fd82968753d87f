//! What two nodes exchange of which at least one faces all ways, such as a piece of furniture or a house: an estimate from a few pairs of points.
//!
//! G = ∫∫ cosθ cosθ'/(π r²) over both nodes is A A' times the mean over points of either, which are taken from low-discrepancy sequences with a start of their own for every pair of nodes, members in proportion to their areas. So the estimates are
//! free of a systematic error, the same in every run, and their errors have nothing to do with each other: over the many small links of a receiver they average out. The standard error of the mean is the doubt of the link, so that an oracle
//! divides what matters. The members of a scattered node receive very differently, which counts as a deviation of [`UNEVEN`]. Exchanges in m², lengths in metres.
//! B. Smits, J. Arvo, D. Greenberg, SIGGRAPH 1994, doi:10.1145/192161.192277, for links of clusters that face all ways.

use super::sight::Viewer;
use crate::tree::{Node, Tree};
use fredholm_coupling::kernel::lambert;
use fredholm_coupling::polygon::folded;
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;

/// Pairs of points.
const PAIRS: usize = 16;
/// Distance of the centres over the sum of the radii from which on two nodes are apart: the kernel has no peaks then.
const APART: f64 = 1.5;
/// Deviation over a scattered node, over its mean. Members that face the sender receive up to five times the mean of a box, others nothing, and what many senders on one side do to them goes the same way and adds up: so such links must be small
/// beside what counts.
const UNEVEN: f64 = 20.0;
/// Share of what two nodes would exchange face to face that they may exchange where no pair of points does.
const GRAZING: f64 = 0.02;
/// Powers of the inverse root of x⁷ = x + 1 (R_d of M. Roberts 2018): a member and a place on it for either node.
const R6: [f64; 6] = [
    0.898_653_712_628_699_2,
    0.807_578_495_221_344_7,
    0.725_733_412_969_759_7,
    0.652_183_025_943_971_5,
    0.586_086_697_577_969_3,
    0.526_687_986_700_735_7,
];

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
    a.cone().centre.distance(b.cone().centre) > APART * (a.cone().radius + b.cone().radius)
}

impl Chance {
    /// The pairs of points of two nodes, which must lie apart.
    pub fn of(tree: &Tree, nodes: [u32; 2]) -> Self {
        let [a, b] = nodes.map(|index| &tree.nodes()[index as usize]);
        let start = start(nodes[0].min(nodes[1]), nodes[0].max(nodes[1]));
        let mut pairs = Vec::with_capacity(PAIRS);
        let (mut sum, mut squares) = (0.0, 0.0);
        for k in 0..PAIRS {
            let u: [f64; 6] = std::array::from_fn(|d| ((k + 1) as f64 * R6[d] + start[d]).fract());
            let (Some(p), Some(q)) = (tree.member(nodes[0], u[0]), tree.member(nodes[1], u[3])) else {
                continue;
            };
            let (x, y) = (place(p, [u[1], u[2]]), place(q, [u[4], u[5]]));
            let weight = lambert(x, p.normal(), y, q.normal());
            if weight > 0.0 {
                (sum, squares) = (sum + weight, squares + weight * weight);
                pairs.push(([x, y], weight));
            }
        }
        let areas = a.area() * b.area();
        let distance = a.cone().centre.distance(b.cone().centre);
        // What faces one way sees a sender of about this size under angles that vary by its own size over the distance.
        let deviations = [a, b]
            .map(|node| if node.faces_one_way() { 2.0 * node.cone().radius / distance } else { UNEVEN });
        if sum <= 0.0 {
            let open = GRAZING * areas / (PI * distance * distance);
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

    /// The share of the open exchange that gets through, and its doubt, that of the open exchange included.
    pub fn seen(&self, viewer: &Viewer) -> [f64; 2] {
        let clear = |([x, y], weight): &([Vec3; 2], f64)| if viewer.sees(*x, *y) { *weight } else { 0.0 };
        let share: f64 = self.pairs.iter().map(clear).sum();
        // A ray of either kind more: a few that agree do not make sure.
        let mixed = (share * (1.0 - share)).max(1.0 / PAIRS as f64) / PAIRS as f64;
        [share, mixed.sqrt().hypot(share * self.error)]
    }
}

/// The point of a patch for a point of the unit square.
fn place(patch: &Patch, [u, v]: [f64; 2]) -> Vec3 {
    let (u, v) = folded(patch, u, v);
    patch.point(u, v)
}

/// Where the sequence of a pair of nodes starts: numbers that follow no pattern (the mixing function of SplitMix64, G. L. Steele, D. Lea, C. H. Flood 2014, doi:10.1145/2660193.2660195).
fn start(a: u32, b: u32) -> [f64; 6] {
    let mut state = (u64::from(a) << 32) | u64::from(b);
    std::array::from_fn(|_| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64)
    })
}
