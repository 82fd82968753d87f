//! The share of an exchange that gets through, ∫∫ K V dA dA'/∫∫ K dA dA' with the kernel K and the
//! visibility V, from segments between two patches.
//!
//! Where the patches are near each other K varies by orders, and of a few uniform segments hardly
//! one is among those that count: the ratio of two sums is then too small or too large by several
//! per cent, the same way in all pairs of a kind. So many segments are drawn, which costs little,
//! and [`SEGMENTS_TESTED`] of them are tested, each chosen as likely as it weighs (resampling: D.
//! B. Rubin, J. Am. Stat. Assoc. 82, 543–546, 1987; one at every step of the running sum: G.
//! Kitagawa, J. Comput. Graph. Stat. 5, 1–25, 1996). The share is the part of them that gets
//! through.

use super::draw::Places;
use super::side::{POINTS, POINTS_OF_THE_MEAN, Points, Side};
use fredholm_coupling::kernel::lambert;
use fredholm_mesh::{Patch, Vec3};

/// Segments of a pair that are tested.
const SEGMENTS_TESTED: usize = 16;
/// Standard errors by which a share is taken to be uncertain.
const STANDARD_ERRORS: f64 = 1.7;
/// Distances of the centroids over the sum of the diameters, and how many segments are drawn for
/// each part of either side below them.
const SEGMENTS_BY_DISTANCE: [(f64, usize); 2] = [(0.75, 16), (1.5, 4)];

/// A segment, the parts of the patches that its ends are on, and the kernel between its ends, 1/m².
#[derive(Clone, Copy, Debug)]
struct Segment {
    ends: [Vec3; 2],
    parts: [usize; 2],
    weight: f64,
}

/// What the tested segments tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Through {
    /// Share of the exchange.
    pub share: f64,
    /// How it varies over both sides, relative to the open exchange.
    pub sides: [Side; 2],
    /// Uncertainty of the share.
    pub doubt: f64,
}

/// Segments between the parts of two patches; the memory is kept from pair to pair.
#[derive(Debug, Default)]
pub(super) struct Segments {
    drawn: Vec<Segment>,
}

impl Segments {
    /// What gets through between two patches; none where no segment lies in front of both.
    pub fn between(
        &mut self,
        [a, b]: [&Patch; 2],
        points: [&Points; 2],
        clear: impl Fn(Vec3, Vec3) -> bool,
    ) -> Option<Through> {
        self.draw([a, b], points);
        let weight: f64 = self.drawn.iter().map(|segment| segment.weight).sum();
        (weight > 0.0).then(|| self.test(weight, points, clear))
    }

    fn draw(&mut self, [a, b]: [&Patch; 2], [xs, ys]: [&Points; 2]) {
        let mut places = Places::at(xs.at[POINTS_OF_THE_MEAN], ys.at[POINTS_OF_THE_MEAN]);
        let distance = a.centroid().distance(b.centroid()) / (a.diameter() + b.diameter());
        let number =
            SEGMENTS_BY_DISTANCE.iter().find(|(near, _)| distance < *near).map_or(1, |(_, number)| *number);
        self.drawn.clear();
        for parts in (0..POINTS_OF_THE_MEAN).flat_map(|i| (0..POINTS_OF_THE_MEAN).map(move |j| [i, j])) {
            for _ in 0..number {
                let [(_, s), (_, t)] = places.next();
                let ends = [xs.within(parts[0], s), ys.within(parts[1], t)];
                let weight = lambert(ends[0], a.normal(), ends[1], b.normal());
                if weight > 0.0 {
                    self.drawn.push(Segment { ends, parts, weight });
                }
            }
        }
    }

    fn test(&self, weight: f64, points: [&Points; 2], clear: impl Fn(Vec3, Vec3) -> bool) -> Through {
        let mut tallies = [[Tally::default(); POINTS_OF_THE_MEAN]; 2];
        let step = weight / SEGMENTS_TESTED as f64;
        // In the middle of the steps: no rounding of the running sum adds or loses one.
        let (mut next, mut sum, mut passed) = (0.5 * step, 0.0, 0.0);
        for Segment { ends: [x, y], parts, weight } in &self.drawn {
            sum += weight;
            let mut times = 0.0;
            while next < sum {
                times += 1.0;
                next += step;
            }
            let through = if times > 0.0 && clear(*x, *y) { times } else { 0.0 };
            passed += through;
            for (side, &part) in tallies.iter_mut().zip(parts) {
                side[part].add(*weight, times, through);
            }
        }
        let share = passed / SEGMENTS_TESTED as f64;
        let sides = [0, 1].map(|k| varied(points[k], &tallies[k], share));
        Through { share, sides, doubt: doubt(passed) }
    }
}

/// What the segments of a part of a side weigh, how many of them were tested, and how many of those
/// got through.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    weight: f64,
    tested: f64,
    passed: f64,
}

impl Tally {
    fn add(&mut self, weight: f64, tested: f64, passed: f64) {
        self.weight += weight;
        self.tested += tested;
        self.passed += passed;
    }

    /// What the part sees, of its weight. A part with few segments of its own is taken to see about
    /// what the others do.
    fn seen(&self, share: f64) -> f64 {
        self.weight * (self.passed + share) / (self.tested + 1.0)
    }
}

/// How what is seen varies over a side, relative to the open exchange.
fn varied(points: &Points, tallies: &[Tally; POINTS_OF_THE_MEAN], share: f64) -> Side {
    let side = |value: &dyn Fn(&Tally) -> f64| {
        // Nothing is known of the centroid: it is given the mean.
        let mut values = [tallies.iter().map(value).sum::<f64>() / POINTS_OF_THE_MEAN as f64; POINTS];
        values.iter_mut().zip(tallies).for_each(|(x, tally)| *x = value(tally));
        points.side(&values)
    };
    let (open, seen) = (side(&|tally| tally.weight), side(&|tally| tally.seen(share)));
    seen.scaled(if open.mean > 0.0 { seen.mean / open.mean } else { share })
}

/// How uncertain a share is where so many of the tested segments got through: as if one more got
/// through and one more did not (A. Agresti, B. A. Coull, Am. Stat. 52, 119–126, 1998).
fn doubt(passed: f64) -> f64 {
    let number = SEGMENTS_TESTED as f64 + 2.0;
    let share = (passed + 1.0) / number;
    STANDARD_ERRORS * (share * (1.0 - share) / number).sqrt()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

    use super::*;
    use fredholm_coupling::form_factor::contour_integral;

    fn quad(corners: [[f64; 3]; 4]) -> Patch {
        Patch::quad(corners.map(Vec3::from)).unwrap().unwrap()
    }

    /// Shares of what floors receive from walls they touch, of sizes and places that differ, whose
    /// upper part is hidden.
    #[test]
    fn shares_of_near_pairs_are_right_in_the_mean() {
        let (mut found, mut truth, mut doubts, mut number) = (0.0, 0.0, 0.0, 0);
        for k in 0..400 {
            let (size, off) = (1.0 + f64::from(k % 20) / 20.0, 1e-3 * f64::from(k));
            let floor = quad([[off, 0., 0.], [off + size, 0., 0.], [off + size, 1., 0.], [off, 1., 0.]]);
            let wall = quad([[off, 0., 0.], [off, 1., 0.], [off, 1., 1.], [off, 0., 1.]]);
            // What is seen is near the edge: the part of the segments that weighs most.
            let clear = |x: Vec3, y: Vec3| x.x - off < 0.3 || y.z < 0.3;
            let (xs, ys) = (Points::of(&floor), Points::of(&wall));
            let through = Segments::default().between([&floor, &wall], [&xs, &ys], clear).unwrap();
            // What is hidden: the far part of the floor against the high part of the wall.
            let far =
                quad([[off + 0.3, 0., 0.], [off + size, 0., 0.], [off + size, 1., 0.], [off + 0.3, 1., 0.]]);
            let high = quad([[off, 0., 0.3], [off, 1., 0.3], [off, 1., 1.], [off, 0., 1.]]);
            let exchange = |p: &Patch, q: &Patch| contour_integral(p.corners(), q.corners(), 1e-10).value;
            let exact = 1.0 - exchange(&far, &high) / exchange(&floor, &wall);
            found += through.share;
            truth += exact;
            doubts += f64::from(u8::from((through.share - exact).abs() <= through.doubt));
            number += 1;
        }
        let n = f64::from(number);
        assert!((found / truth - 1.0).abs() < 0.05, "{} {}", found / n, truth / n);
        assert!(doubts / n > 0.85, "{}", doubts / n);
    }

    #[test]
    fn a_pair_that_is_clear_or_blocked_says_so() {
        let low = quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
        let high = quad([[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]]);
        let points = [&Points::of(&low), &Points::of(&high)];
        let mut segments = Segments::default();
        let all = segments.between([&low, &high], points, |_, _| true).unwrap();
        let none = segments.between([&low, &high], points, |_, _| false).unwrap();
        assert_eq!((all.share, none.share), (1.0, 0.0));
        assert!(all.doubt < 0.1 && (all.doubt - none.doubt).abs() < 1e-15);
        assert!(segments.between([&high, &high], [points[1]; 2], |_, _| true).is_none());
    }
}
