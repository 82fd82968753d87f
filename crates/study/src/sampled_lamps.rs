//! What points receive of lamps behind very many bodies: F(x→g), the factor of what x sees of all
//! surfaces of lamp g, from segments to points of the lamps.
//!
//! ```text
//! F(x→g) ≈ F₀(x→g) Σ_i w_i V(x, y_i) / Σ_i w_i,   w_i = cosθ cosθ′/(π d²) / p(y_i)
//! ```
//!
//! over the points y_i of g among those that a tree of lamps gives the element of x (density p),
//! with F₀ of what nothing hides: by Lambert's formula where the lamps are few, else the mean of w.
//! So what is fully lit, or fully in the shadow, has no noise. Every point x shifts the same points
//! by numbers of its own: errors of neighbours are independent, and can be smoothed. Metres.

use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_montecarlo::density::{Cut, LampTree, Receiver};
use fredholm_montecarlo::points::{Key, PointSet, Samples};
use fredholm_report::{LampFactors, Points};
use fredholm_visibility::Occluders;
use std::f64::consts::FRAC_1_PI;

/// Segments of a point, of one of several points of a pixel, and of one whose number is told.
/// Powers of two are where Sobol points are most even.
pub(crate) const SEGMENTS: usize = 32;
const SEGMENTS_OF_PART: usize = 8;
const SEGMENTS_OF_NUMBER: usize = 1024;
/// Lamps before an element up to which each is looked at as a whole.
const MOST_WHOLE_LAMPS: usize = 24;
/// A length that counts as none, over the distance.
const FLAT_HEIGHT: f64 = 1e-9;

/// The lamps of a scene as points among very many bodies see them.
pub(crate) struct SampledLamps<'a> {
    occluders: &'a Occluders,
    elements: Vec<&'a Patch>,
    patches: Vec<Patch>,
    lamp_of: Vec<usize>,
    tree: LampTree,
    count: usize,
    points: Vec<[f64; 3]>,
}

impl<'a> SampledLamps<'a> {
    /// Lamps of some patches each with the power of a square metre, before elements and what blocks
    /// the view.
    pub(crate) fn new(
        lamps: &[Vec<&Patch>],
        power: &[f64],
        elements: Vec<&'a Patch>,
        occluders: &'a Occluders,
    ) -> Self {
        let lamp_of: Vec<usize> =
            lamps.iter().enumerate().flat_map(|(lamp, own)| std::iter::repeat_n(lamp, own.len())).collect();
        let patches: Vec<Patch> = lamps.iter().flatten().map(|patch| **patch).collect();
        let powers: Vec<f64> =
            patches.iter().zip(&lamp_of).map(|(patch, &lamp)| patch.area() * power[lamp]).collect();
        let tree = LampTree::new(&patches, &powers);
        let mut samples =
            Samples::new(PointSet::Sobol, Key { seed: 0, batch: 0, stream: 0 }, SEGMENTS_OF_NUMBER as u32);
        let point = |sample| {
            let mut draw = samples.draw(sample);
            let (choice, [u, v]) = (draw.single(), draw.pair());
            [choice, u, v]
        };
        let points = (0..SEGMENTS_OF_NUMBER as u32).map(point).collect();
        Self { occluders, elements, patches, lamp_of, tree, count: lamps.len(), points }
    }

    /// Number of lamps.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// The factors from points (m) of an element to what they see of each lamp, with fewer segments
    /// each where a pixel has several points.
    pub(crate) fn factors(&self, element: usize, points: &[Vec3], pixel: Points, factors: &mut LampFactors) {
        let patch = self.elements[element];
        let cuts = self.tree.cuts(&[Receiver::of(patch)]);
        let cut = cuts.of(0);
        let before: Vec<usize> = self.tree.patches(cut).take(MOST_WHOLE_LAMPS + 1).collect();
        let is_whole = before.len() <= MOST_WHOLE_LAMPS;
        let segments = match pixel {
            Points::One => SEGMENTS,
            Points::Several => SEGMENTS_OF_PART,
            Points::Told => SEGMENTS_OF_NUMBER,
        };
        let mut sums = vec![Sums::default(); self.count];
        let mut corners = [Vec::new(), Vec::new()];
        for (k, &x) in points.iter().enumerate() {
            sums.fill(Sums::default());
            self.look((x, patch.normal()), cut, &self.points[..segments], &mut sums);
            let own = k * self.count..(k + 1) * self.count;
            let (values, errors) = (&mut factors.values[own.clone()], &mut factors.errors[own]);
            if is_whole {
                for &lamp in &before {
                    let whole = unhidden(&self.patches[lamp], (x, patch.normal()), &mut corners);
                    values[self.lamp_of[lamp]] += whole;
                }
            }
            // What no segment went to is seen as all others are.
            let all = sums.iter().fold(Sums::default(), |all, own| all.and(*own));
            for ((value, error), own) in values.iter_mut().zip(errors).zip(&sums) {
                let (share, of_share) = own.share().or(all.share()).unwrap_or_default();
                let (whole, of_whole) = if is_whole { (*value, 0.0) } else { own.mean(segments) };
                (*value, *error) = (whole * share, (whole * of_share).hypot(of_whole * share));
            }
        }
    }

    /// Adds up what segments from a point to those of a cut tell of each lamp.
    fn look(&self, (x, normal): (Vec3, Vec3), cut: Cut, points: &[[f64; 3]], sums: &mut [Sums]) {
        let shift = shifts(x);
        for point in points {
            let [choice, u, v] = [0, 1, 2].map(|i| (point[i] + shift[i]).fract());
            let Some((patch, y, density)) = self.tree.sample(cut, choice, [u, v]) else { return };
            let between = y - x;
            let square = between.length_squared();
            let (out, back) = (normal.dot(between), -self.patches[patch].normal().dot(between));
            if out > 0.0 && back > 0.0 {
                let weight = out * back * FRAC_1_PI / (square * square * density);
                let seen = if self.occluders.unoccluded(x, y) { weight } else { 0.0 };
                let own = &mut sums[self.lamp_of[patch]];
                *own = own.and(Sums { weights: weight, squares: weight * weight, seen });
            }
        }
    }
}

/// Sums over the segments to a lamp: of the weights, of their squares, and of those that nothing
/// blocks.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    weights: f64,
    squares: f64,
    seen: f64,
}

impl Sums {
    fn and(self, other: Self) -> Self {
        let Self { weights, squares, seen } = other;
        Self { weights: self.weights + weights, squares: self.squares + squares, seen: self.seen + seen }
    }

    /// The share that is seen, with its standard error; none where no segment went there.
    fn share(self) -> Option<(f64, f64)> {
        let share = self.seen / self.weights;
        // As many segments as have weight. Of a share 0 or 1 of n it is known to about 1/n.
        let n = self.weights * self.weights / self.squares;
        let within = (share * n + 0.5) / (n + 1.0);
        (self.weights > 0.0).then(|| (share, (within * (1.0 - within) / n).sqrt()))
    }

    /// The mean weight of so many segments, with its standard error.
    fn mean(self, segments: usize) -> (f64, f64) {
        let n = segments as f64;
        let mean = self.weights / n;
        (mean, ((self.squares / n - mean * mean).max(0.0) / n).sqrt())
    }
}

/// The factor from a point to a patch that nothing hides.
fn unhidden(patch: &Patch, (x, normal): (Vec3, Vec3), [outline, above]: &mut [Vec<Vec3>; 2]) -> f64 {
    if patch.normal().dot(x - patch.corner(0)) <= 0.0 {
        return 0.0;
    }
    outline.clear();
    outline.extend(patch.corners().iter().map(|&corner| corner - x));
    above.clear();
    let flat = FLAT_HEIGHT * (patch.centroid().distance(x) + patch.diameter());
    clip(outline, HalfSpace { normal, offset: 0.0 }, flat, above);
    if above.len() < 3 { 0.0 } else { point_to_polygon(normal, above.iter().copied()).max(0.0) }
}

/// Three numbers in [0, 1) of a point: those of its coordinates, mixed (SplitMix64, G. L. Steele,
/// D. Lea, C. H. Flood, OOPSLA 2014, doi:10.1145/2660193.2660195).
fn shifts(x: Vec3) -> [f64; 3] {
    let mut state = 0_u64;
    let mut next = |add: u64| {
        state = state.wrapping_add(add).wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        state = z;
        z
    };
    x.to_array().iter().for_each(|c| {
        next(c.to_bits());
    });
    [0, 1, 2].map(|_| (next(0) >> 11) as f64 / (1_u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_hierarchical::Lamps;

    fn square(corner: Vec3, u: Vec3, v: Vec3) -> Patch {
        Patch::quad([corner, corner + u, corner + u + v, corner + v]).unwrap().unwrap()
    }

    /// A floor below n × n panels of two kinds, and a board between; the panels come last.
    fn room(n: usize) -> (Vec<Patch>, Vec<usize>) {
        let floor = square(Vec3::ZERO, 4.0 * Vec3::X, 4.0 * Vec3::Y);
        let board = square(Vec3::new(1.0, 1.0, 1.0), 1.5 * Vec3::X, 1.2 * Vec3::Y);
        let side = 3.0 / n as f64;
        let panel = |k: usize| {
            let place = Vec3::new((k % n) as f64 + 0.1, (k / n) as f64 + 0.2, 0.0) * (4.0 / n as f64);
            square(place + 2.5 * Vec3::Z, side * Vec3::Y, side * Vec3::X)
        };
        let patches: Vec<Patch> = [floor, board].into_iter().chain((0..n * n).map(panel)).collect();
        (patches, (0..n * n).map(|k| k % 2).collect())
    }

    #[test]
    fn factors_are_those_of_exact_shadows_but_for_their_errors() {
        // Few lamps, each with its own factor, and many.
        for n in [2, 8] {
            let (patches, kinds) = room(n);
            let of_kind = |kind: usize| -> Vec<&Patch> {
                patches[2..].iter().zip(&kinds).filter(|(_, k)| **k == kind).map(|(patch, _)| patch).collect()
            };
            let lamps = [of_kind(0), of_kind(1)];
            let occluders = Occluders::new(&patches).unwrap();
            let sampled = SampledLamps::new(&lamps, &[3.0, 1.0], patches.iter().collect(), &occluders);
            let exact = Lamps::new(&lamps, patches.iter().collect(), &occluders).unwrap().unwrap();
            let place = |k: usize| Vec3::new((k % 40) as f64 + 0.5, (k / 40) as f64 + 0.5, 0.0) * 0.1;
            let points: Vec<Vec3> = (0..1600).map(place).collect();
            let mut truth = vec![0.0; 2 * points.len()];
            exact.lighter().factors(0, &points, &mut truth);
            for pixel in [Points::One, Points::Several, Points::Told] {
                let zeros = vec![0.0; truth.len()];
                let mut found = LampFactors { values: zeros.clone(), errors: zeros };
                sampled.factors(0, &points, pixel, &mut found);
                let off: Vec<f64> = found.values.iter().zip(&truth).map(|(f, t)| f - t).collect();
                let squares = off.iter().map(|o| o * o).sum::<f64>();
                let stated = found.errors.iter().map(|e| e * e).sum::<f64>();
                // Shares are biased by less than a hundredth.
                let (all, bright) = (off.iter().sum::<f64>(), truth.iter().sum::<f64>());
                assert!(all.abs() < 4.0 * stated.sqrt() + 0.01 * bright, "{n} {pixel:?}: {all} of {bright}");
                let ratio = (squares / stated).sqrt();
                assert!((0.1..1.2).contains(&ratio), "{n} {pixel:?}: {ratio}");
                if n == 2 {
                    // What nothing hides is exact, and what sees nothing is dark.
                    let open = (0..truth.len()).filter(|&i| points[i / 2].x > 3.6 && points[i / 2].y > 3.6);
                    open.for_each(|i| assert!(off[i].abs() < 1e-12, "{i}: {}", off[i]));
                }
            }
        }
    }

    #[test]
    fn what_looks_away_is_dark() {
        let (patches, _) = room(2);
        let occluders = Occluders::new(&patches).unwrap();
        let away = square(Vec3::ZERO, Vec3::Y, Vec3::X);
        let lamps = [patches[2..].iter().collect()];
        let sampled = SampledLamps::new(&lamps, &[1.0], vec![&away], &occluders);
        let mut found = LampFactors { values: vec![0.0], errors: vec![0.0] };
        sampled.factors(0, &[Vec3::new(0.5, 0.5, 0.0)], Points::One, &mut found);
        assert!(found.values == [0.0] && found.errors == [0.0]);
    }
}
