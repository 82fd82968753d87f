//! The share of an exchange that gets through between bodies, from segments, as few as the budget of
//! the row allows.
//!
//! ```text
//! G_ij = G⁰_ij R,   R = Σ_k w_k V_k / Σ_k w_k
//! ```
//!
//! over pairs of points (p_k, q_k), w the kernel at them times the areas that they stand for, V
//! whether the segment is free. The points are [Sobol's](fredholm_quadrature::sobol) in four
//! dimensions, scrambled for every pair by itself, so that errors of pairs are independent and
//! average out in a row. A ratio is off by 1/n in the mean where w is uneven: such pairs are left to
//! other methods.
//!
//! The standard error of few segments is that of independent points, σ² = Σ w² (V − R)² / (Σ w)²,
//! which is more than that of Sobol's. Where that would ask for many, eight sets of points scrambled
//! each by itself take an eighth of them, and their differences tell the error, which falls faster
//! than n^−½. They go on until it meets the goal.
//!
//! A segment is blocked by a convex body where it is below all of its faces at once (M. Cyrus, J.
//! Beck, Comput. Graph. 3(1) (1978) 23, doi:10.1016/0097-8493(78)90021-3). In metres.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]
#![allow(clippy::needless_bitwise_bool, reason = "a branch is not compiled to vectors")]

use super::lanes::{LANES, Lanes, Lanes3, any, ask, dot, each, heights, same};
use crate::method::keyed::keyed;
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::sobol::{reversed, scrambled};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Body};
use pulp::{Arch, NullaryFnOnce};
use std::ops::Range;

/// Weight of one pair of points over the mean, above which the weights are uneven.
const MOST_WEIGHT: f64 = 6.0;
/// Segments of which the heaviest, at this weight, is a tenth of all: what is no less even will do
/// where its error does.
const EVEN_ENOUGH: usize = 60;
/// Coordinates of a segment.
const AXES: usize = 4;
/// Segments above which eight sets of points take an eighth each.
const FEWEST_REPLICATED: usize = 256;
/// The order in which the error falls with the number of segments.
const ORDER_OF_SEGMENTS: f64 = 0.63;
/// The variance of the fewest segments of easy pairs over that of as many independent ones at most.
const EASIEST_VARIANCE: f64 = 0.07;
/// By which the standard error of eight sets is raised: they go on until it is low, so that those
/// which end have a low one by chance.
const OF_STOPPING: f64 = 1.2;
/// Doublings from one turn to the next at most.
const MOST_DOUBLINGS: u32 = 3;
/// Bodies above which the tree of the occluders takes less time than the list.
const MOST_LISTED_BODIES: usize = 32;

/// How exact a share is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Segments that it would take if they were independent,
    pub independent: usize,
    /// the standard error that they would have,
    pub deviation: f64,
    /// and how many are worth their time.
    pub most: usize,
}

impl Wanted {
    /// Segments that it takes in eight sets where bodies hide nearly all or nothing.
    fn fewest_replicated(&self) -> usize {
        let fewest = FEWEST_REPLICATED as f64;
        let over = EASIEST_VARIANCE * self.independent as f64 / fewest;
        (fewest * over.max(1.0).powf(0.5 / ORDER_OF_SEGMENTS)) as usize
    }
}

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
    /// What the numbers of eight points of one set add to their coordinates.
    lanes: [[u32; LANES]; AXES],
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
        let lanes = [0, 1, 2, 3].map(|axis| [0, 1, 2, 3, 4, 5, 6, 7].map(|lane| reversed(lane, axis)));
        Self { planes, bodies: blockers, tolerance: bodies.tolerance(), lanes, arch: Arch::new() }
    }

    /// Faces of some bodies; a flat one has one.
    pub(crate) fn faces(&self, list: &[u32]) -> usize {
        let faces = |body: Blocker| if body.solid { body.end - body.first } else { 1 };
        list.iter().map(|&number| faces(self.bodies[number as usize])).sum()
    }

    /// The share of an exchange that gets through between some bodies; `names` tell pairs apart.
    /// None where the weights are too uneven, or where it would take more segments than are wanted.
    pub(crate) fn share(
        &self,
        pair: [&Patch; 2],
        (list, occluders): (&[u32], &Occluders),
        wanted: Wanted,
        names: [usize; 2],
    ) -> Option<Share> {
        let occluders = (list.len() > MOST_LISTED_BODIES).then_some(occluders);
        let ask = Ask { blockers: self, occluders, sides: pair.map(Parameters::of), list };
        let names = names.map(|name| name as u64);
        let mut samples = wanted.independent.next_multiple_of(LANES);
        while samples <= FEWEST_REPLICATED.min(wanted.most) {
            let sums = self.sums(&ask, &Points::of_one_set(names, self.lanes), 0..samples / LANES);
            let share = sums.share_of_independent(samples);
            let even_enough = sums.are_even(EVEN_ENOUGH) && share.deviation <= wanted.deviation;
            if sums.are_even(samples) || even_enough {
                return Some(share);
            }
            samples *= 2;
        }
        if wanted.fewest_replicated() > wanted.most { None } else { self.replicated(&ask, wanted, names) }
    }

    /// From a set of points a lane, until the standard error is met.
    fn replicated(&self, ask: &Ask, wanted: Wanted, names: [u64; 2]) -> Option<Share> {
        let (mut sums, mut done, mut next) = (Sums::default(), 0, FEWEST_REPLICATED / LANES);
        let mut expected: Option<f64> = None;
        loop {
            sums.add(&self.sums(ask, &Points::of_eight_sets(names), done..next));
            done = next;
            if total(&sums.all) == 0.0 {
                // Nothing faces each other as far as these points tell.
                return None;
            }
            let Share { value, deviation } = sums.share_of_replicates();
            // Segments end where the error is low, by chance too; what fewer let expect was not.
            let both =
                expected.map_or(deviation, |expected| (0.5 * (deviation.powi(2) + expected.powi(2))).sqrt());
            let share = Share { value, deviation: OF_STOPPING * both };
            let even = sums.are_even(FEWEST_REPLICATED);
            if even && share.deviation <= wanted.deviation {
                return Some(share);
            }
            // Whole powers of two, which fill the square evenly.
            let missing = (share.deviation / wanted.deviation).powf(ORDER_OF_SEGMENTS.recip()).log2().ceil();
            let doublings = (missing as u32).clamp(1, MOST_DOUBLINGS);
            expected = Some(both * f64::from(1 << doublings).powf(-ORDER_OF_SEGMENTS));
            next = done << doublings;
            // What was begun is worth a little more.
            if next * LANES > 2 * wanted.most {
                return None;
            }
        }
    }

    fn sums(&self, ask: &Ask, points: &Points, blocks: Range<usize>) -> Sums {
        self.arch.dispatch(Look { ask, points, blocks })
    }
}

/// The numbers of the segments of a block, those of all lanes at once.
#[derive(Clone, Copy)]
struct Points {
    seeds: [[u32; LANES]; AXES],
    /// What the number of a lane adds to its coordinates.
    lanes: [[u32; LANES]; AXES],
    /// How many points of a set make a block.
    stride: u32,
}

impl Points {
    /// Eight points of one set.
    fn of_one_set(names: [u64; 2], lanes: [[u32; LANES]; AXES]) -> Self {
        let seeds = [0, 1, 2, 3].map(|axis| [seed(names, axis); LANES]);
        Self { seeds, lanes, stride: LANES as u32 }
    }

    /// A point of each of eight sets.
    fn of_eight_sets(names: [u64; 2]) -> Self {
        let lane = |axis| [0, 1, 2, 3, 4, 5, 6, 7].map(|lane| seed(names, axis + AXES as u64 * (1 + lane)));
        Self { seeds: [0, 1, 2, 3].map(lane), lanes: [[0; LANES]; AXES], stride: 1 }
    }

    #[inline(always)]
    fn coordinate(&self, block: u32, axis: usize) -> Lanes {
        let first = reversed(block * self.stride, axis as u32);
        let [seeds, lanes] = [&self.seeds[axis], &self.lanes[axis]];
        each(|m| f64::from(scrambled(first ^ lanes[m], seeds[m])) * (1.0 / 4_294_967_296.0))
    }
}

fn seed([first, second]: [u64; 2], which: u64) -> u32 {
    (keyed(first, second, which) * 4_294_967_296.0) as u32
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
#[derive(Clone, Copy, Default)]
struct Sums {
    all: Lanes,
    through: Lanes,
    squares: Lanes,
    squares_through: Lanes,
    largest: Lanes,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        let sum = |a: &Lanes, b: &Lanes| each(|m| a[m] + b[m]);
        self.all = sum(&self.all, &other.all);
        self.through = sum(&self.through, &other.through);
        self.squares = sum(&self.squares, &other.squares);
        self.squares_through = sum(&self.squares_through, &other.squares_through);
        self.largest = each(|m| self.largest[m].max(other.largest[m]));
    }

    /// Whether no segment weighs much more than the mean of so many.
    fn are_even(&self, samples: usize) -> bool {
        let (all, largest) = (total(&self.all), self.heaviest());
        // Nothing has a weight where no pair of points faces each other.
        all > 0.0 && largest * samples as f64 <= MOST_WEIGHT * all
    }

    /// What is not known where all segments see the same: half the heaviest one.
    fn least_deviation(&self) -> f64 {
        0.5 * self.heaviest() / total(&self.all)
    }

    fn heaviest(&self) -> f64 {
        self.largest.iter().fold(0.0_f64, |a, &b| a.max(b))
    }

    fn share_of_independent(&self, samples: usize) -> Share {
        let all = total(&self.all);
        let value = total(&self.through) / all;
        let through = total(&self.squares_through);
        let square = (through * (1.0 - 2.0 * value) + value * value * total(&self.squares)).max(0.0);
        // n/(n − 1), since the mean is that of the same points.
        let few = samples as f64 / (samples as f64 - 1.0);
        Share { value, deviation: ((square * few).sqrt() / all).hypot(self.least_deviation()) }
    }

    fn share_of_replicates(&self) -> Share {
        let all = total(&self.all);
        let value = total(&self.through) / all;
        let square = total(&each(|m| (self.through[m] - value * self.all[m]).powi(2)));
        let n = LANES as f64;
        let deviation = (square * n / (n - 1.0)).sqrt() / all;
        Share { value, deviation: deviation.hypot(self.least_deviation()) }
    }
}

fn total(lanes: &Lanes) -> f64 {
    lanes.iter().sum()
}

/// Two patches, and what is between.
#[derive(Clone, Copy)]
struct Ask<'a> {
    blockers: &'a Blockers,
    /// What is asked in place of a long list.
    occluders: Option<&'a Occluders>,
    sides: [Parameters; 2],
    list: &'a [u32],
}

/// Blocks of segments to look along.
struct Look<'a> {
    ask: &'a Ask<'a>,
    points: &'a Points,
    blocks: Range<usize>,
}

impl NullaryFnOnce for Look<'_> {
    type Output = Sums;

    #[inline(always)]
    fn call(self) -> Sums {
        let Ask { blockers, occluders, sides: [a, b], list } = *self.ask;
        let mut sums = Sums::default();
        let (up, down) = (same(a.normal), same(b.normal));
        for block in self.blocks {
            // A closure called four times stays a call of its own.
            let (block, points) = (block as u32, self.points);
            let (p, at_p) = a.at(&points.coordinate(block, 0), &points.coordinate(block, 1));
            let (q, at_q) = b.at(&points.coordinate(block, 2), &points.coordinate(block, 3));
            let way = [each(|m| q[0][m] - p[0][m]), each(|m| q[1][m] - p[1][m]), each(|m| q[2][m] - p[2][m])];
            let (rise, fall, square) = (dot(&way, &up), dot(&way, &down), dot(&way, &way));
            let weight = each(|m| {
                let faces = (rise[m] > 0.0) & (fall[m] < 0.0);
                let kernel = -rise[m] * fall[m] / (square[m] * square[m]) * at_p[m] * at_q[m];
                if faces { kernel } else { 0.0 }
            });
            let mut free = [1.0; LANES];
            if let Some(occluders) = occluders {
                let at = |x: &Lanes3, m: usize| Vec3::new(x[0][m], x[1][m], x[2][m]);
                let sees = |m: usize| weight[m] > 0.0 && occluders.unoccluded(at(&p, m), at(&q, m));
                free = each(|m| f64::from(u8::from(sees(m))));
            } else {
                for &number in list {
                    blockers.block(blockers.bodies[number as usize], &p, &q, &mut free);
                    if !any(&ask(|m| free[m] > 0.0)) {
                        break;
                    }
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

    fn few(independent: usize) -> Wanted {
        Wanted { independent, deviation: 0.0, most: independent }
    }

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
                    let Some(share) = blockers.share([&a, &b], (&[0], &occluders), few(samples), [0, key])
                    else {
                        continue;
                    };
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
    fn eight_sets_meet_the_error_asked_for_and_state_no_less_than_theirs() {
        let [a, b] = squares();
        let exact = 0.099_506_294_598_985 / 0.199_824_895_698_388;
        let [sheet, _] = blocks();
        let occluders = Occluders::new(&sheet).unwrap();
        let blockers = Blockers::new(&Bodies::new(&occluders, &[&a, &b], &[]));
        for deviation in [0.02, 0.005] {
            let wanted = Wanted { independent: 100_000, deviation, most: 1 << 20 };
            let keys = 300_usize;
            let (mut sum, mut squares, mut stated, mut covered) = (0.0, 0.0, 0.0, 0);
            for key in 0..keys {
                let share = blockers.share([&a, &b], (&[0], &occluders), wanted, [1, key]).unwrap();
                let off = share.value - exact;
                assert!(share.deviation <= deviation);
                sum += off;
                squares += off * off;
                stated += share.deviation.powi(2);
                covered += usize::from(off.abs() <= 3.0 * share.deviation);
            }
            let n = keys as f64;
            println!("{deviation}: {:.4} stated {:.4}, {covered}", (squares / n).sqrt(), (stated / n).sqrt());
            assert!((sum / squares.sqrt()).abs() < 4.0, "{deviation}: {}", sum / n);
            assert!(squares < 1.1 * stated && squares > 0.1 * stated, "{deviation}");
            assert!(covered as f64 >= 0.98 * n, "{deviation}: {covered}");
        }
        // What would take longer than it is worth is left to others.
        let short = Wanted { independent: 100_000, deviation: 1e-4, most: 1 << 12 };
        assert_eq!(blockers.share([&a, &b], (&[0], &occluders), short, [1, 2]), None);
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
        let share =
            |p: &Patch, q: &Patch| blockers.share([p, q], (&[0], &occluders), few(64), [3, 7]).unwrap().value;
        assert!((share(&top, &b) - 1.0).abs() < 1e-15);
        assert!(share(&under, &b).abs() < 1e-15);
        assert!(blockers.share([&top, &a], (&[0], &occluders), few(64), [3, 7]).is_none());
    }
}
