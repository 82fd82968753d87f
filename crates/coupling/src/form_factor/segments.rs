//! The share of an exchange that gets through between bodies, from few segments: the way of pairs
//! that matter little to their rows.
//!
//! ```text
//! G_ij = G⁰_ij R,   R = Σ_k w_k V_k / Σ_k w_k
//! ```
//!
//! over pairs of points (p_k, q_k), w the kernel at them times the areas that they stand for, V
//! whether the segment is free. The points are those of a four-dimensional additive recurrence that
//! begins at a place of its own for every pair (R. Cranley, T. N. L. Patterson, SIAM J. Numer.
//! Anal. 13 (1976) 904, doi:10.1137/0713071), so that errors of pairs are independent and average
//! out in a row. The standard error is that of independent points,
//! σ² = Σ w² (V − R)² / (Σ w)², which is more than that of the recurrence. A ratio is off by 1/n
//! in the mean where w is uneven: such pairs are left to other methods.
//!
//! A segment is blocked by a convex body where it is below all of its faces at once (M. Cyrus, J.
//! Beck, Comput. Graph. 3(1) (1978) 23, doi:10.1016/0097-8493(78)90021-3). In metres.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]
#![allow(clippy::needless_bitwise_bool, reason = "a branch is not compiled to vectors")]

use super::lanes::{LANES, Lanes, Lanes3, any, ask, dot, each, heights, same};
use crate::method::keyed::keyed;
use crate::rays::STEPS;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::{Bodies, Body};
use pulp::{Arch, NullaryFnOnce};

/// Weight of one pair of points over the mean, above which the weights are uneven.
const MOST_WEIGHT: f64 = 6.0;

/// A share and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    pub value: f64,
    pub deviation: f64,
}

/// The bodies of a scene as half-spaces n·x ≤ c.
#[derive(Debug)]
pub(crate) struct Blockers {
    /// n and c, those of a body one after the other.
    planes: Vec<[f64; 4]>,
    bodies: Vec<Blocker>,
    /// Depth up to which a point is not in a body, m.
    tolerance: f64,
    arch: Arch,
}

/// The half-spaces of a body: its faces, or the plane of a flat one and then its sides.
#[derive(Clone, Copy, Debug)]
struct Blocker {
    first: usize,
    end: usize,
    solid: bool,
}

impl Blockers {
    pub(crate) fn new(bodies: &Bodies) -> Self {
        let (mut planes, mut blockers) = (Vec::new(), Vec::new());
        for body in bodies.as_slice() {
            let first = planes.len();
            if body.is_solid() {
                planes.extend(body.faces().iter().map(|face| plane(face.normal, face.offset)));
            } else {
                planes.extend(flat(body));
            }
            blockers.push(Blocker { first, end: planes.len(), solid: body.is_solid() });
        }
        Self { planes, bodies: blockers, tolerance: bodies.tolerance(), arch: Arch::new() }
    }

    /// The share of an exchange that gets through between some bodies, from about so many segments;
    /// `names` tell pairs apart. None where the weights are too uneven.
    pub(crate) fn share(
        &self,
        pair: [&Patch; 2],
        list: &[u32],
        samples: usize,
        names: [usize; 2],
    ) -> Option<Share> {
        let sums = self.arch.dispatch(Ask {
            blockers: self,
            sides: pair.map(Parameters::of),
            list,
            blocks: samples.div_ceil(LANES),
            start: [0, 1, 2, 3].map(|axis| keyed(names[0] as u64, names[1] as u64, axis)),
        });
        sums.share(samples.div_ceil(LANES) * LANES)
    }
}

fn plane(normal: Vec3, offset: f64) -> [f64; 4] {
    [normal.x, normal.y, normal.z, offset]
}

/// The plane of a flat body, and the half-spaces within its edges.
fn flat(body: &Body) -> impl Iterator<Item = [f64; 4]> {
    let up = body.faces().first().copied();
    let sides = body.edges().iter().filter_map(move |edge| {
        let [a, b] = body.ends(edge);
        let out = (b - a).cross(up?.normal).normalize_or_zero();
        Some(plane(out, out.dot(a)))
    });
    up.map(|face| plane(face.normal, face.offset)).into_iter().chain(sides)
}

/// A patch as x = a + u b + v c + u v d, with its normal.
#[derive(Clone, Copy)]
struct Parameters {
    corner: Vec3,
    along: [Vec3; 3],
    normal: Vec3,
    triangle: bool,
}

impl Parameters {
    fn of(patch: &Patch) -> Self {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| patch.corner(i));
        let triangle = patch.sides() == 3;
        let along = if triangle { [b - a, c - a, Vec3::ZERO] } else { [b - a, d - a, a - b + c - d] };
        Self { corner: a, along, normal: patch.normal(), triangle }
    }

    /// The points at some parameters, and the areas that they stand for.
    #[inline(always)]
    fn at(&self, u: &Lanes, v: &Lanes) -> (Lanes3, Lanes) {
        let over = |m: usize| self.triangle & (u[m] + v[m] > 1.0);
        let fold = |x: &Lanes| each(|m| if over(m) { 1.0 - x[m] } else { x[m] });
        let (u, v) = (fold(u), fold(v));
        let [b, c, d] = self.along;
        let coordinate = |a: f64, b: f64, c: f64, d: f64| each(|m| a + u[m] * b + v[m] * c + u[m] * v[m] * d);
        let points = [
            coordinate(self.corner.x, b.x, c.x, d.x),
            coordinate(self.corner.y, b.y, c.y, d.y),
            coordinate(self.corner.z, b.z, c.z, d.z),
        ];
        // n · (b + v d) × (c + u d).
        let [whole, by_u, by_v] = [b.cross(c), b.cross(d), d.cross(c)].map(|x| x.dot(self.normal));
        (points, each(|m| whole + u[m] * by_u + v[m] * by_v))
    }
}

/// Σ w, Σ w V, Σ w², Σ w² V and the largest w.
#[derive(Clone, Copy)]
struct Sums {
    all: Lanes,
    through: Lanes,
    squares: Lanes,
    squares_through: Lanes,
    largest: Lanes,
}

impl Sums {
    fn share(&self, samples: usize) -> Option<Share> {
        let sum = |lanes: &Lanes| lanes.iter().sum::<f64>();
        let all = sum(&self.all);
        let largest = self.largest.iter().fold(0.0_f64, |a, &b| a.max(b));
        // Nothing has a weight where no pair of points faces each other.
        if all.is_nan() || all <= 0.0 || largest * samples as f64 > MOST_WEIGHT * all {
            return None;
        }
        let value = sum(&self.through) / all;
        let through = sum(&self.squares_through);
        let square = (through * (1.0 - 2.0 * value) + value * value * sum(&self.squares)).max(0.0);
        // n/(n − 1), since the mean is that of the same points.
        let few = samples as f64 / (samples as f64 - 1.0);
        Some(Share { value, deviation: (square * few).sqrt() / all })
    }
}

struct Ask<'a> {
    blockers: &'a Blockers,
    sides: [Parameters; 2],
    list: &'a [u32],
    /// Eights of segments.
    blocks: usize,
    start: [f64; 4],
}

impl NullaryFnOnce for Ask<'_> {
    type Output = Sums;

    #[inline(always)]
    fn call(self) -> Sums {
        let zero = [0.0; LANES];
        let mut sums = Sums { all: zero, through: zero, squares: zero, squares_through: zero, largest: zero };
        let [a, b] = self.sides;
        let (up, down) = (same(a.normal), same(b.normal));
        for block in 0..self.blocks {
            let parameter = |axis: usize| {
                each(|m| {
                    let x = self.start[axis] + (block * LANES + m) as f64 * STEPS[axis];
                    x - x.floor()
                })
            };
            let (p, at_p) = a.at(&parameter(0), &parameter(1));
            let (q, at_q) = b.at(&parameter(2), &parameter(3));
            let way = [each(|m| q[0][m] - p[0][m]), each(|m| q[1][m] - p[1][m]), each(|m| q[2][m] - p[2][m])];
            let (rise, fall, square) = (dot(&way, &up), dot(&way, &down), dot(&way, &way));
            let weight = each(|m| {
                let faces = (rise[m] > 0.0) & (fall[m] < 0.0);
                let kernel = -rise[m] * fall[m] / (square[m] * square[m]) * at_p[m] * at_q[m];
                if faces { kernel } else { 0.0 }
            });
            let mut free = [1.0; LANES];
            for &number in self.list {
                self.blockers.block(self.blockers.bodies[number as usize], &p, &q, &mut free);
                if !any(&ask(|m| free[m] > 0.0)) {
                    break;
                }
            }
            let through = each(|m| weight[m] * free[m]);
            sums.all = each(|m| sums.all[m] + weight[m]);
            sums.through = each(|m| sums.through[m] + through[m]);
            sums.squares = each(|m| sums.squares[m] + weight[m] * weight[m]);
            sums.squares_through = each(|m| sums.squares_through[m] + weight[m] * through[m]);
            sums.largest = each(|m| if weight[m] > sums.largest[m] { weight[m] } else { sums.largest[m] });
        }
        sums
    }
}

impl Blockers {
    /// Sets the lanes to 0 whose segments a body blocks.
    #[inline(always)]
    fn block(&self, body: Blocker, p: &Lanes3, q: &Lanes3, free: &mut Lanes) {
        let planes = &self.planes[body.first..body.end];
        let over = |plane: &[f64; 4], x: &Lanes3| {
            heights(&same(Vec3::new(plane[0], plane[1], plane[2])), &[plane[3]; LANES], x)
        };
        let tolerance = self.tolerance;
        if body.solid {
            let (mut enters, mut leaves) = ([0.0; LANES], [1.0; LANES]);
            for plane in planes {
                let (from, to) = (over(plane, p), over(plane, q));
                let (from, to) = (each(|m| from[m] + tolerance), each(|m| to[m] + tolerance));
                let at = each(|m| from[m] / (from[m] - to[m]));
                // Along the face, over it: it is never below.
                let level = each(|m| if from[m] > 0.0 { 2.0 } else { 0.0 });
                let rising = each(|m| if from[m] < to[m] { 0.0 } else { level[m] });
                let below = each(|m| if to[m] < from[m] { at[m] } else { rising[m] });
                let above = each(|m| if from[m] < to[m] { at[m] } else { 1.0 });
                enters = each(|m| if below[m] > enters[m] { below[m] } else { enters[m] });
                leaves = each(|m| if above[m] < leaves[m] { above[m] } else { leaves[m] });
                if !any(&ask(|m| enters[m] < leaves[m])) {
                    return;
                }
            }
            *free = each(|m| if enters[m] < leaves[m] { 0.0 } else { free[m] });
            return;
        }
        let Some((plane, sides)) = planes.split_first() else { return };
        let (from, to) = (over(plane, p), over(plane, q));
        let high = each(|m| if from[m] > to[m] { from[m] } else { to[m] });
        let low = each(|m| if from[m] > to[m] { to[m] } else { from[m] });
        let mut hit = each(|m| if (high[m] > tolerance) & (low[m] < -tolerance) { 1.0 } else { 0.0 });
        if !any(&ask(|m| hit[m] > 0.0)) {
            return;
        }
        let at = each(|m| from[m] / (from[m] - to[m]));
        let place = [
            each(|m| p[0][m] + at[m] * (q[0][m] - p[0][m])),
            each(|m| p[1][m] + at[m] * (q[1][m] - p[1][m])),
            each(|m| p[2][m] + at[m] * (q[2][m] - p[2][m])),
        ];
        for side in sides {
            let outside = over(side, &place);
            hit = each(|m| if outside[m] > 0.0 { 0.0 } else { hit[m] });
        }
        *free = each(|m| if hit[m] > 0.0 { 0.0 } else { free[m] });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_visibility::Occluders;

    fn quad(corners: [[f64; 3]; 4]) -> Patch {
        Patch::quad(corners.map(Vec3::from_array)).unwrap().unwrap()
    }

    fn squares() -> [Patch; 2] {
        [
            quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]),
            quad([[0., 1., 1.], [1., 1., 1.], [1., 0., 1.], [0., 0., 1.]]),
        ]
    }

    /// A block between two squares, as a sheet and as a box.
    fn blocks() -> [Vec<Patch>; 2] {
        let [l, h] = [0.25, 0.75];
        let sheet = quad([[l, l, 0.5], [h, l, 0.5], [h, h, 0.5], [l, h, 0.5]]);
        let (a, b) = (0.499, 0.501);
        let cube = [
            quad([[l, l, b], [h, l, b], [h, h, b], [l, h, b]]),
            quad([[l, h, a], [h, h, a], [h, l, a], [l, l, a]]),
            quad([[l, l, a], [h, l, a], [h, l, b], [l, l, b]]),
            quad([[h, l, a], [h, h, a], [h, h, b], [h, l, b]]),
            quad([[h, h, a], [l, h, a], [l, h, b], [h, h, b]]),
            quad([[l, h, a], [l, l, a], [l, l, b], [l, h, b]]),
        ];
        [vec![sheet], cube.to_vec()]
    }

    #[test]
    fn a_centred_block_hides_half_without_bias_and_within_the_standard_error() {
        let [a, b] = squares();
        // Closed forms by superposition of rectangles, of the sheet.
        let exact = 0.099_506_294_598_985 / 0.199_824_895_698_388;
        for (block, solid) in blocks().into_iter().zip([false, true]) {
            let occluders = Occluders::new(&block).unwrap();
            let bodies = Bodies::new(&occluders, &[&a, &b], &[]);
            assert_eq!((bodies.as_slice().len(), bodies.as_slice()[0].is_solid()), (1, solid));
            let blockers = Blockers::new(&bodies);
            for samples in [16, 64, 256] {
                let keys = 2000_usize;
                let (mut sum, mut squares, mut stated) = (0.0, 0.0, 0.0);
                for key in 0..keys {
                    let Some(share) = blockers.share([&a, &b], &[0], samples, [0, key]) else { continue };
                    sum += share.value - exact;
                    squares += (share.value - exact).powi(2);
                    stated += share.deviation.powi(2);
                }
                let n = keys as f64;
                let z = sum / squares.sqrt();
                // The ratio is off by 1/n, and the box is a little larger than the sheet.
                let bias = 0.3 / samples as f64 + if solid { 2e-3 } else { 0.0 };
                println!(
                    "{samples}: z {z:.2}, {:.4} stated {:.4}",
                    (squares / n).sqrt(),
                    (stated / n).sqrt()
                );
                assert!(z.abs() < 4.0 || sum.abs() / n < bias, "{samples}: {z}");
                assert!(squares < 1.1 * stated && stated < 40.0 * squares, "{samples}");
            }
        }
    }

    #[test]
    fn a_patch_on_a_body_is_not_hidden_by_it_and_what_stands_on_a_patch_hides_it() {
        let [a, b] = squares();
        let [_, cube] = blocks();
        let occluders = Occluders::new(&cube).unwrap();
        let top = quad([[0.3, 0.3, 0.501], [0.7, 0.3, 0.501], [0.7, 0.7, 0.501], [0.3, 0.7, 0.501]]);
        let under = quad([[0.3, 0.3, 0.499], [0.7, 0.3, 0.499], [0.7, 0.7, 0.499], [0.3, 0.7, 0.499]]);
        let bodies = Bodies::new(&occluders, &[&a, &b, &top, &under], &[]);
        let blockers = Blockers::new(&bodies);
        let share = |p: &Patch, q: &Patch| blockers.share([p, q], &[0], 64, [3, 7]).unwrap().value;
        assert!((share(&top, &b) - 1.0).abs() < 1e-15);
        assert!(share(&under, &b).abs() < 1e-15);
        assert!(blockers.share([&top, &a], &[0], 64, [3, 7]).is_none());
    }
}
