//! The integrals of all pairs of triangles of the halves of functions, each by the rule that suits
//! it.

use crate::dual::PARTS;
use crate::kernel::{Apart, Eight, Eights, Medium, Points, Touching, Values, WIDTH, Wanted};
use crate::rules::{CLASSES, Rule, Rules};
use crate::set::{Halves, Shape};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use pulp::Arch;

/// Halvings after which a pair is taken as it is: only triangles that cut each other come here.
pub(crate) const MOST_HALVINGS: usize = 24;
/// Elongation beyond which touching triangles are halved.
pub(crate) const MOST_ELONGATION: f64 = 3.0;
/// Product of the shares of both areas below which they are not: a sharp corner stays one however
/// it is cut.
pub(crate) const LEAST_AREA_SHARES: f64 = 1.0 / 500.0;

/// Both parts of all pairs of corners (3a + b) of a pair of triangles: the integrals of the kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pair {
    pub(crate) electric: [Complex64; 9],
    pub(crate) magnetic: [Complex64; 9],
}

/// What integrates pairs of triangles in one medium.
#[derive(Clone, Debug)]
pub(crate) struct Integrator {
    pub(crate) medium: Medium,
    pub(crate) wanted: Wanted,
    pub(crate) rules: Rules,
    pub(crate) arch: Arch,
    /// Whether the observers are the parts that the sources are cut into (`dual`): those of source
    /// t have the names 6t to 6t + 5.
    pub(crate) observers_cut: bool,
}

/// The triangle of one set that meets all of the other.
struct One<'a> {
    eights: &'a Eights,
    shape: &'a Shape,
    points: [Vec<[Eight; 3]>; CLASSES],
}

impl<'a> One<'a> {
    fn new(shape: &'a Shape, eights: &'a Eights) -> Self {
        Self { eights, shape, points: Default::default() }
    }

    /// The points of a rule in all lanes.
    fn points(&mut self, rule: &Rule, class: usize) -> &[[Eight; 3]] {
        if self.points[class].is_empty() {
            let splat = |&uv: &[f64; 2]| self.shape.point(uv).to_array().map(|c| [c; WIDTH]);
            self.points[class] = rule.points.iter().map(splat).collect();
        }
        &self.points[class]
    }
}

impl Integrator {
    /// Visits the integrals of all pairs (observer, source) of two sets of triangles.
    pub(crate) fn each(&self, rows: &Halves, columns: &Halves, mut visit: impl FnMut(usize, usize, &Pair)) {
        if rows.shapes.len() <= columns.shapes.len() {
            for (row, shape) in rows.shapes.iter().enumerate() {
                self.one(shape, rows.triangles[row], columns, true, |column, pair| visit(row, column, pair));
            }
        } else {
            for (column, shape) in columns.shapes.iter().enumerate() {
                self.one(shape, columns.triangles[column], rows, false, |row, pair| visit(row, column, pair));
            }
        }
    }

    /// Visits the integrals of one triangle with all of a set; `observes` says which of them is the
    /// observer.
    fn one(
        &self,
        shape: &Shape,
        name: u32,
        set: &Halves,
        observes: bool,
        mut visit: impl FnMut(usize, &Pair),
    ) {
        let eights = Eights::splat(shape.centre, shape.corners);
        let mut one = One::new(shape, &eights);
        let mut values = Values::default();
        for eight in 0..set.eights.len() {
            let lanes = eight * WIDTH..((eight + 1) * WIDTH).min(set.shapes.len());
            let (classes, spread) = self.classes(shape, set, eight);
            // Every lane by its own rule: the integrals of a pair do not depend on what is computed
            // with it.
            let mut computed = None;
            for (lane, other) in lanes.enumerate() {
                if let Some(class) = classes[lane] {
                    if computed != Some(class) {
                        self.regular(&mut one, set, eight, class, spread, observes, &mut values);
                        computed = Some(class);
                    }
                    visit(other, &Pair::of(&values, lane));
                } else {
                    let (near, names) = (&set.shapes[other], [name, set.triangles[other]]);
                    let pair = if observes {
                        self.near([shape, near], names)
                    } else {
                        self.near([near, shape], [names[1], names[0]])
                    };
                    visit(other, &pair);
                }
            }
        }
    }

    /// The rule for every lane of an eight, and the largest sum of two radii.
    fn classes(&self, shape: &Shape, set: &Halves, eight: usize) -> ([Option<usize>; WIDTH], f64) {
        let (mut classes, mut spread) = ([None; WIDTH], 0.0_f64);
        let [x, y, z, radius] = &set.spheres;
        for (lane, class) in classes.iter_mut().enumerate() {
            let other = eight * WIDTH + lane;
            if other < set.shapes.len() {
                let centre = Vec3::new(x[other], y[other], z[other]);
                let radii = shape.radius + radius[other];
                *class = self.rules.class(shape.centre.distance(centre) / radii, radii);
                spread = spread.max(radii);
            }
        }
        (classes, spread)
    }

    #[allow(clippy::too_many_arguments, reason = "two sides, the rule and where to write")]
    fn regular(
        &self,
        one: &mut One<'_>,
        set: &Halves,
        eight: usize,
        class: usize,
        spread: f64,
        observes: bool,
        out: &mut Values,
    ) {
        let rule = &self.rules.classes[class];
        let eights = one.eights;
        let own = Points { triangles: eights, places: one.points(rule, class), weights: &rule.weights };
        let points = set.points(rule, class, eight);
        let other = Points { triangles: &set.eights[eight], places: points, weights: &rule.weights };
        let (observers, sources) = if observes { (own, other) } else { (other, own) };
        self.apart(observers, sources, spread, out);
    }

    fn apart(&self, observers: Points<'_>, sources: Points<'_>, spread: f64, out: &mut Values) {
        let (medium, wanted) = (self.medium, self.wanted);
        self.arch.dispatch(Apart { medium, wanted, observers, sources, spread, out });
    }

    /// The integrals of an observer and a source that touch or are close; `names` tell triangles
    /// apart. A flat triangle has no magnetic part with itself.
    ///
    /// Of integrals that are the same when both change places, one of the two is computed for both.
    /// Currents around a loop have no charge only where the charges of all their functions have
    /// potentials with the same errors: the difference of two errors would act as a charge, which
    /// at low frequencies counts (λ/2πh)² times as much as the current itself.
    pub(crate) fn near(&self, shapes: [&Shape; 2], names: [u32; 2]) -> Pair {
        if self.observers_cut {
            return self.close_to_part(shapes, names[0] / PARTS as u32 == names[1]);
        }
        if names[0] > names[1] {
            let [observer, source] = shapes;
            return self.close([source, observer], [names[1], names[0]]).transposed();
        }
        self.close(shapes, names)
    }

    /// The magnetic integrals of a part of a triangle as observer with a source; `within` says
    /// whether it is a part of the source, with which it has none. A source that has half a side in
    /// common with it is halved there, so that the two have a whole one.
    fn close_to_part(&self, shapes: [&Shape; 2], within: bool) -> Pair {
        if within {
            return Pair::default();
        }
        let [observer, source] = shapes;
        let mut sums = Parts { integrator: self, shapes, waiting: Default::default(), sum: Pair::default() };
        let middle = |first: usize| 0.5 * (source.places[first] + source.places[(first + 1) % 3]);
        match (0..3).find(|&first| observer.places.contains(&middle(first))) {
            Some(first) => {
                for half in halves(source.places, first) {
                    sums.add([observer.places, half], [1.0, 0.5], 0);
                }
            }
            None => sums.add([observer.places, source.places], [1.0; 2], 0),
        }
        (0..CLASSES).for_each(|class| sums.flush(class));
        sums.sum
    }

    fn close(&self, shapes: [&Shape; 2], names: [u32; 2]) -> Pair {
        let mut parts = Parts { integrator: self, shapes, waiting: Default::default(), sum: Pair::default() };
        parts.add(shapes.map(|shape| shape.places), [1.0; 2], 0);
        (0..CLASSES).for_each(|class| parts.flush(class));
        let magnetic = if names[0] == names[1] { Pair::default().magnetic } else { parts.sum.magnetic };
        Pair { magnetic, ..parts.sum }
    }
}

/// Pairs of parts of two triangles. They are halved until a rule suits them; those of one rule are
/// collected until there are eight.
struct Parts<'a> {
    integrator: &'a Integrator,
    shapes: [&'a Shape; 2],
    waiting: [Vec<[(Shape, f64); 2]>; CLASSES],
    sum: Pair,
}

impl Parts<'_> {
    /// Adds a pair of parts, which have these shares of the areas.
    fn add(&mut self, corners: [[Vec3; 3]; 2], shares: [f64; 2], depth: usize) {
        let (orders, common) = matched(corners);
        if common == 0 {
            let parts = corners.map(Shape::new);
            let radii = parts[0].radius + parts[1].radius;
            let ratio = parts[0].centre.distance(parts[1].centre) / radii;
            let class = self.integrator.rules.class(ratio, radii);
            if class.is_some() || depth >= MOST_HALVINGS {
                self.collect(&parts, shares, class.unwrap_or(CLASSES - 1));
                return;
            }
        } else if shares[0] * shares[1] < LEAST_AREA_SHARES
            || corners.iter().all(|&corners| elongation(corners) < MOST_ELONGATION)
        {
            self.touching(corners, shares, orders, common);
            return;
        }
        self.halve(corners, shares, depth + 1);
    }

    /// Adds the parts of a pair, halved along the longest side of both. Where that is a common
    /// side, both are halved there, so that the parts have whole sides in common.
    fn halve(&mut self, corners: [[Vec3; 3]; 2], shares: [f64; 2], depth: usize) {
        let longest = corners.map(longest_side);
        let side = usize::from(length(corners[1], longest[1]) > length(corners[0], longest[0]));
        let ends = |of: usize, first: usize| [corners[of][first], corners[of][(first + 1) % 3]];
        let [from, to] = ends(side, longest[side]);
        let is_common = |first: &usize| [[from, to], [to, from]].contains(&ends(1 - side, *first));
        let common = (0..3).find(is_common);
        for half in halves(corners[side], longest[side]) {
            let (mut corners, mut shares) = (corners, shares);
            corners[side] = half;
            shares[side] *= 0.5;
            let Some(first) = common else {
                self.add(corners, shares, depth);
                continue;
            };
            shares[1 - side] *= 0.5;
            for half in halves(corners[1 - side], first) {
                corners[1 - side] = half;
                self.add(corners, shares, depth);
            }
        }
    }

    /// Adds two parts with common corners, which come first in `orders`.
    fn touching(
        &mut self,
        corners: [[Vec3; 3]; 2],
        shares: [f64; 2],
        orders: [[usize; 3]; 2],
        common: usize,
    ) {
        let parts = corners.map(Shape::new);
        let eights = [0, 1].map(|side| {
            let whole = self.shapes[side];
            Eights::splat(parts[side].centre, whole.seen_from(parts[side].centre))
        });
        let mut values = Values::default();
        self.integrator.arch.dispatch(Touching {
            medium: self.integrator.medium,
            wanted: self.integrator.wanted,
            rule: &self.integrator.rules.touching[common - 1],
            observer: &eights[0],
            source: &eights[1],
            corners: [0, 1].map(|side| orders[side].map(|corner| parts[side].corners[corner])),
            spread: 2.0 * (parts[0].radius + parts[1].radius),
            out: &mut values,
        });
        self.sum.add(&Pair::of(&values, 0), shares[0] * shares[1]);
    }

    /// Adds two parts that a rule suits.
    fn collect(&mut self, parts: &[Shape; 2], shares: [f64; 2], class: usize) {
        let [observer, source] = *parts;
        self.waiting[class].push([(observer, shares[0]), (source, shares[1])]);
        if self.waiting[class].len() == WIDTH {
            self.flush(class);
        }
    }

    /// Integrates the pairs that wait for a rule.
    fn flush(&mut self, class: usize) {
        let pairs = std::mem::take(&mut self.waiting[class]);
        let Some(last) = pairs.last() else { return };
        let rule = &self.integrator.rules.classes[class];
        let mut eights = [Eights::default(); 2];
        let mut points = [0, 1].map(|_| vec![[[0.0; WIDTH]; 3]; rule.points.len()]);
        let mut spread = 0.0_f64;
        for lane in 0..WIDTH {
            let pair = pairs.get(lane).unwrap_or(last);
            spread = spread.max(pair[0].0.radius + pair[1].0.radius);
            for (side, (part, _)) in pair.iter().enumerate() {
                let whole = self.shapes[side];
                eights[side].set(lane, part.centre, whole.seen_from(part.centre));
                for (place, &uv) in points[side].iter_mut().zip(&rule.points) {
                    let p = part.point(uv);
                    (0..3).for_each(|axis| place[axis][lane] = p[axis]);
                }
            }
        }
        let side = |i: usize| Points { triangles: &eights[i], places: &points[i], weights: &rule.weights };
        let mut values = Values::default();
        self.integrator.apart(side(0), side(1), spread, &mut values);
        for (lane, pair) in pairs.iter().enumerate() {
            self.sum.add(&Pair::of(&values, lane), pair[0].1 * pair[1].1);
        }
    }
}

impl Pair {
    fn of(values: &Values, lane: usize) -> Self {
        let read = |part: &[[Eight; 2]; 9]| {
            std::array::from_fn(|i| Complex64::new(part[i][0][lane], part[i][1][lane]))
        };
        Self { electric: read(&values.electric), magnetic: read(&values.magnetic) }
    }

    /// The integrals with observer and source exchanged.
    fn transposed(&self) -> Self {
        let turned = |part: &[Complex64; 9]| std::array::from_fn(|i| part[3 * (i % 3) + i / 3]);
        Self { electric: turned(&self.electric), magnetic: turned(&self.magnetic) }
    }

    /// The electric and magnetic part of two corners.
    pub(crate) fn at(&self, observer: usize, source: usize) -> [Complex64; 2] {
        let at = 3 * observer + source;
        [self.electric[at], self.magnetic[at]]
    }

    fn add(&mut self, other: &Self, factor: f64) {
        self.electric.iter_mut().zip(other.electric).for_each(|(sum, part)| *sum += part * factor);
        self.magnetic.iter_mut().zip(other.magnetic).for_each(|(sum, part)| *sum += part * factor);
    }
}

/// Both halves of a triangle, cut across the side from corner `first`.
fn halves(corners: [Vec3; 3], first: usize) -> [[Vec3; 3]; 2] {
    let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
    let middle = 0.5 * (a + b);
    [[a, middle, c], [middle, b, c]]
}

/// Length of the side from corner `first`, m.
pub(crate) fn length(corners: [Vec3; 3], first: usize) -> f64 {
    corners[first].distance(corners[(first + 1) % 3])
}

/// The corner where the longest side begins.
pub(crate) fn longest_side(corners: [Vec3; 3]) -> usize {
    (0..3).fold(0, |best, i| if length(corners, i) > length(corners, best) { i } else { best })
}

/// The longest side over the height on it: 1.15 of an equilateral triangle, 2 of half a square.
pub(crate) fn elongation(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners;
    length(corners, longest_side(corners)).powi(2) / (b - a).cross(c - a).length()
}

/// Orders of the corners of both triangles with the common ones first, and their number. Corners of
/// one surface are common where they are the same point, bit by bit.
pub(crate) fn matched(corners: [[Vec3; 3]; 2]) -> ([[usize; 3]; 2], usize) {
    let mut orders = [[0, 1, 2]; 2];
    let mut common = 0;
    for i in 0..3 {
        let partner = (common..3).find(|&k| corners[1][orders[1][k]] == corners[0][i]);
        if let (Some(k), Some(at)) = (partner, orders[0].iter().position(|&c| c == i)) {
            orders[0].swap(common, at);
            orders[1].swap(common, k);
            common += 1;
        }
    }
    (orders, common)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::parts;
    use fredholm_quadrature::{PairPoint, collapsed_triangle, triangle_pair};

    const WANTED: Wanted = Wanted { electric: true, magnetic: true };

    fn integrator(k: Complex64, tolerance: f64) -> Integrator {
        let rules = Rules::new(tolerance, k, true).unwrap();
        Integrator { medium: Medium::new(k), wanted: WANTED, rules, arch: Arch::new(), observers_cut: false }
    }

    /// The integrals as they are defined, by a list of pairs of points.
    fn plain(k: Complex64, corners: [[Vec3; 3]; 2], points: &[PairPoint]) -> Pair {
        let at = |[a, b, c]: [Vec3; 3], [u, v]: [f64; 2]| a + u * (b - a) + v * (c - a);
        let mut sum = Pair::default();
        for point in points {
            let (r, s) = (at(corners[0], point.x), at(corners[1], point.y));
            let distance = r.distance(s);
            let g = (-Complex64::I * k * distance).exp() / distance * point.weight;
            let slope = -(1.0 + Complex64::I * k * distance) * g / (distance * distance);
            for i in 0..9 {
                let (own, other) = (r - corners[0][i / 3], s - corners[1][i % 3]);
                sum.electric[i] += Complex64::I * k * (own.dot(other) - 4.0 / (k * k)) * g;
                sum.magnetic[i] += slope * own.dot((r - s).cross(other));
            }
        }
        sum
    }

    fn norm(values: &[Complex64; 9]) -> f64 {
        values.iter().map(|value| value.norm()).fold(0.0, f64::max)
    }

    /// Relative errors of both parts; that of a magnetic part that is 0 is left out.
    fn errors(found: &Pair, exact: &Pair) -> [f64; 2] {
        let difference = |a: &[Complex64; 9], b: &[Complex64; 9]| norm(&std::array::from_fn(|i| a[i] - b[i]));
        let magnetic = difference(&found.magnetic, &exact.magnetic) / norm(&exact.magnetic);
        let cancels = norm(&exact.magnetic) < 1e-9 * norm(&exact.electric);
        [
            difference(&found.electric, &exact.electric) / norm(&exact.electric),
            if cancels { 0.0 } else { magnetic },
        ]
    }

    /// Numbers between −1 and 1 without order: the fractional parts of multiples of an irrational
    /// number.
    fn number(i: usize) -> f64 {
        2.0 * (0.5 + i as f64 * 0.754_877_666_246_692_7).fract() - 1.0
    }

    /// A triangle of radius 1 around a centre, of no special shape.
    fn triangle(seed: usize, centre: Vec3) -> [Vec3; 3] {
        let at = |i: usize| 9 * seed + 3 * i;
        let corners = [0, 1, 2].map(|i| Vec3::new(number(at(i)), number(at(i) + 1), number(at(i) + 2)));
        if elongation(corners) > 4.0 {
            return triangle(seed + 1001, centre);
        }
        let shape = Shape::new(corners);
        shape.corners.map(|corner| centre + corner / shape.radius)
    }

    /// What the integrator finds for two triangles.
    fn found(k: Complex64, tolerance: f64, corners: [[Vec3; 3]; 2]) -> Pair {
        let [observer, source] = corners.map(Shape::new);
        let names = [0, u32::from(corners[0] != corners[1])];
        integrator(k, tolerance).near([&observer, &source], names)
    }

    fn products(n: usize) -> Vec<PairPoint> {
        let rule = collapsed_triangle(n);
        let pair = |x: &fredholm_quadrature::PlanePoint, y: &fredholm_quadrature::PlanePoint| PairPoint {
            x: [x.u, x.v],
            y: [y.u, y.v],
            weight: x.weight * y.weight,
        };
        rule.iter().flat_map(|x| rule.iter().map(move |y| pair(x, y))).collect()
    }

    #[test]
    fn pairs_apart_are_within_the_tolerance_in_every_medium() {
        let points = products(12);
        let media = [
            Complex64::new(0.01, 0.0),
            Complex64::new(0.4, 0.0),
            Complex64::new(0.7, -0.3),
            Complex64::new(0.2, -2.0),
        ];
        let mut worst = 0.0_f64;
        for (i, ratio) in [1.3, 1.7, 2.5, 4.0, 9.0, 40.0].into_iter().enumerate() {
            for seed in 0..4 {
                let way =
                    Vec3::new(number(seed * 3 + i), number(seed * 3 + 1), number(seed * 3 + 2)).normalize();
                let corners = [triangle(seed, Vec3::ZERO), triangle(seed + 40, way * (2.0 * ratio))];
                for k in media {
                    let exact = plain(k, corners, &points);
                    for tolerance in [1e-2, 1e-3, 1e-5, 1e-7] {
                        let error = errors(&found(k, tolerance, corners), &exact);
                        let share = error[0].max(error[1]) / tolerance;
                        assert!(share < 1.0, "{ratio} {k} {tolerance}: {error:?}");
                        worst = worst.max(share);
                    }
                }
            }
        }
        assert!(worst > 0.05, "the rules are finer than asked for: {worst}");
    }

    /// Pairs of a grid of right triangles with cells 1 × `height`, folded about y = 0, with labels
    /// for equal corners.
    fn contacts(height: f64, fold: f64) -> Vec<([usize; 3], [[Vec3; 3]; 2])> {
        let at = |x: f64, y: f64| {
            let (sin, cos) = if y < 0.0 { fold.sin_cos() } else { (0.0, 1.0) };
            Vec3::new(x, y * height * cos, -y * height * sin)
        };
        let first = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        let others = [
            ([0, 1, 2], first),
            ([0, 1, 3], [at(0.0, 0.0), at(1.0, 0.0), at(1.0, -1.0)]),
            ([3, 1, 2], [at(1.0, 1.0), at(1.0, 0.0), at(0.0, 1.0)]),
            ([0, 3, 4], [at(0.0, 0.0), at(-1.0, 0.0), at(0.0, -1.0)]),
            ([0, 3, 4], [at(0.0, 0.0), at(0.0, -1.0), at(1.0, -1.0)]),
            ([3, 1, 4], [at(1.0, -1.0), at(1.0, 0.0), at(2.0, -1.0)]),
        ];
        others.into_iter().map(|(labels, other)| (labels, [first, other])).collect()
    }

    #[test]
    fn pairs_that_touch_are_within_the_tolerance_and_converge() {
        let k = Complex64::new(0.6, -0.1);
        for fold in [0.0, 0.8, 1.6] {
            for (labels, corners) in contacts(1.0, fold) {
                let exact = plain(k, corners, &triangle_pair([0, 1, 2], labels, 13));
                let exact =
                    if labels == [0, 1, 2] { Pair { magnetic: Default::default(), ..exact } } else { exact };
                for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
                    let error = errors(&found(k, tolerance, corners), &exact);
                    assert!(
                        error[0].max(error[1]) < 2.0 * tolerance,
                        "{fold} {labels:?} {tolerance}: {error:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn long_triangles_that_touch_are_halved() {
        let k = Complex64::from(0.6);
        for (height, bound) in [(0.25, 1e-3), (0.125, 6e-3)] {
            for (labels, corners) in contacts(height, 0.0) {
                let exact = found(k, 1e-5, corners);
                let error = errors(&found(k, 1e-3, corners), &exact);
                assert!(error[0] < bound, "{height} {labels:?}: {error:?}");
            }
        }
    }

    /// What a point in the plane of a triangle is the sum of its corners with.
    fn coordinates(corners: [Vec3; 3], p: Vec3) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| corner - p);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        [b.cross(c), c.cross(a), a.cross(b)].map(|part| part.dot(normal) / normal.length_squared())
    }

    /// Errors by the number of common corners: to measure the constants of `rules`.
    #[test]
    #[ignore = "measures constants"]
    #[allow(clippy::print_stdout, reason = "it prints them")]
    fn calibrate() {
        let k = Complex64::new(0.6, -0.1);
        for n in 2..11 {
            let mut worst = [[0.0_f64; 2]; 3];
            for fold in [0.0, 0.4, 0.8, 1.2, 1.6] {
                for (labels, corners) in contacts(1.0, fold) {
                    let of = |n: usize| plain(k, corners, &triangle_pair([0, 1, 2], labels, n));
                    let error = errors(&of(n), &of(14));
                    let common = labels.iter().filter(|&&label| label < 3).count();
                    (0..2).for_each(|i| worst[common - 1][i] = worst[common - 1][i].max(error[i]));
                }
            }
            println!("{n} directions: {worst:?}");
        }
        let cut = |tolerance| Integrator { observers_cut: true, ..integrator(k, tolerance) };
        for tolerance in [1e-2, 3e-3, 1e-3, 1e-4] {
            let mut worst = [0.0_f64; 3];
            for fold in [0.4, 0.8, 1.2, 1.6] {
                for (_, [whole, other]) in contacts(1.0, fold).into_iter().skip(1) {
                    let other = Shape::new(other);
                    for (part, corners) in parts(whole).into_iter().enumerate() {
                        let observer = Shape::new(corners);
                        let of = |tolerance| cut(tolerance).near([&observer, &other], [part as u32, 1]);
                        let (found, exact) = (of(tolerance), of(1e-6));
                        let difference = std::array::from_fn(|i| found.magnetic[i] - exact.magnetic[i]);
                        let size = norm(&exact.magnetic).max(0.1 * norm(&exact.electric));
                        let common = matched([corners, other.places]).1;
                        if common > 0 {
                            worst[common - 1] = worst[common - 1].max(norm(&difference) / size);
                        }
                    }
                }
            }
            println!("parts at {tolerance}: {worst:?}");
        }
    }

    /// The parts of a triangle as observers of the ones that it touches, against finer rules, and
    /// together against the whole triangle: r − a is Σ c_i (r − p_i) with Σ c_i p_i = a.
    #[test]
    fn parts_of_a_triangle_are_integrated_within_the_tolerance() {
        let k = Complex64::new(0.6, -0.1);
        let cut = |tolerance| Integrator { observers_cut: true, ..integrator(k, tolerance) };
        for fold in [0.8, 1.6] {
            for (_, [whole, other]) in contacts(1.0, fold).into_iter().skip(1) {
                let other = Shape::new(other);
                let mut sums = [Complex64::ZERO; 9];
                for (part, corners) in parts(whole).into_iter().enumerate() {
                    let observer = Shape::new(corners);
                    let of = |tolerance| cut(tolerance).near([&observer, &other], [part as u32, 1]);
                    let (found, exact) = (of(1e-3), of(1e-6));
                    // Relative to what the part has with magnitudes added: in planes that nearly
                    // hold both, most of it cancels.
                    let difference = std::array::from_fn(|i| found.magnetic[i] - exact.magnetic[i]);
                    let size = norm(&exact.magnetic).max(0.1 * norm(&exact.electric));
                    assert!(norm(&difference) < 6e-3 * size, "{fold} {part}: {:e}", norm(&difference) / size);
                    for (at, sum) in sums.iter_mut().enumerate() {
                        let shares = coordinates(corners, whole[at / 3]);
                        let term = |(i, share): (usize, &f64)| exact.magnetic[3 * i + at % 3] * *share;
                        *sum += shares.iter().enumerate().map(term).sum::<Complex64>() / PARTS as f64;
                    }
                }
                let exact = integrator(k, 1e-6).near([&Shape::new(whole), &other], [0, 1]);
                let difference = std::array::from_fn(|i| sums[i] - exact.magnetic[i]);
                let size = norm(&exact.magnetic).max(0.1 * norm(&exact.electric));
                assert!(norm(&difference) < 1e-4 * size, "{fold}: {:e}", norm(&difference) / size);
            }
        }
        let own = Shape::new(contacts(1.0, 0.8)[0].1[0]);
        assert_eq!(cut(1e-3).near([&own, &own], [11, 1]), Pair::default());
    }

    #[test]
    fn a_turned_pair_has_the_transposed_integrals() {
        let k = Complex64::new(0.5, -0.2);
        for (_, [a, b]) in contacts(1.0, 1.0) {
            let (forth, back) = (found(k, 1e-6, [a, b]), found(k, 1e-6, [b, a]));
            for i in 0..9 {
                let turned = 3 * (i % 3) + i / 3;
                assert!((forth.electric[i] - back.electric[turned]).norm() < 1e-5 * norm(&forth.electric));
                assert!((forth.magnetic[i] - back.magnetic[turned]).norm() < 1e-5 * norm(&forth.electric));
            }
        }
    }

    /// Not only up to the tolerance.
    #[test]
    fn a_pair_has_the_same_integrals_whichever_triangle_observes() {
        let integrator = integrator(Complex64::new(0.5, -0.2), 1e-2);
        for (_, [a, b]) in contacts(0.6, 1.0) {
            let [a, b] = [a, b].map(Shape::new);
            let (forth, back) = (integrator.near([&a, &b], [3, 5]), integrator.near([&b, &a], [5, 3]));
            assert_eq!(forth, back.transposed());
        }
    }

    /// For slow waves the electric part is −(4j/k) ∫∫ 1/R, which is known for a square: 4/3 (1 −
    /// √2) + 4 asinh 1.
    #[test]
    fn slow_waves_have_the_static_energy_of_a_square() {
        let k = 1e-7;
        let corners = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let halves = [[0, 1, 2], [0, 2, 3]].map(|half| half.map(|i| corners[i]));
        let mut energy = Complex64::ZERO;
        for a in halves {
            for b in halves {
                energy += found(k.into(), 1e-7, [a, b]).electric[4] * Complex64::new(0.0, k / 4.0);
            }
        }
        let exact = 4.0 / 3.0 * (1.0 - 2f64.sqrt()) + 4.0 * 1f64.asinh();
        assert!((energy - exact).norm() < 1e-6, "{energy} {exact}");
    }

    #[test]
    fn every_width_of_the_registers_gives_the_same_bits() {
        let k = Complex64::new(0.5, -0.2);
        let [_, (_, touching), ..] = &contacts(1.0, 1.0)[..] else { return };
        for corners in [*touching, [triangle(1, Vec3::ZERO), triangle(2, Vec3::X * 4.0)]] {
            let [observer, source] = corners.map(Shape::new);
            let values = [Arch::new(), Arch::Scalar].map(|arch| {
                let integrator = Integrator { arch, ..integrator(k, 1e-4) };
                integrator.near([&observer, &source], [0, 1])
            });
            assert_eq!(values[0], values[1]);
        }
    }
}
