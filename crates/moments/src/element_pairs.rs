//! The integrals of all pairs of triangles with functions of the first full order, flat or curved,
//! each by the rule that suits it.

use crate::element::{Element, Part, WHOLE};
use crate::element_kernel::{ElementPair, ElementValues, ElementsApart, ElementsTouching, Table, Tests};
use crate::kernel::{Medium, Wanted};
use crate::pairs::{
    LEAST_AREA_SHARES, MOST_ELONGATION, MOST_HALVINGS, elongation, length, longest_side, matched,
};
use crate::rules::{CLASSES, Rules};
use crate::set::Halves;
use pulp::Arch;

/// What integrates pairs of triangles in one medium.
#[derive(Clone, Debug)]
pub(crate) struct ElementIntegrator {
    pub(crate) medium: Medium,
    pub(crate) wanted: Wanted,
    pub(crate) tests: Tests,
    pub(crate) rules: Rules,
    pub(crate) arch: Arch,
}

impl ElementIntegrator {
    /// Visits the integrals of all pairs (observer, source) of two sets of triangles.
    pub(crate) fn each(
        &self,
        rows: &Halves,
        columns: &Halves,
        mut visit: impl FnMut(usize, usize, &ElementPair),
    ) {
        let wanted = (self.wanted, self.tests);
        for (row, observer) in rows.elements.iter().enumerate() {
            for (column, source) in columns.elements.iter().enumerate() {
                let parts = [&observer.1, &source.1];
                let mut pair = ElementPair::default();
                if let Some(class) = self.class(parts) {
                    let rule = &self.rules.classes[class];
                    let tables =
                        [rows.table(rule, class, row, wanted), columns.table(rule, class, column, wanted)];
                    self.apart(parts, tables, 1.0, &mut pair);
                } else {
                    let names = [rows.triangles[row], columns.triangles[column]];
                    pair = self.near([&observer.0, &source.0], names);
                }
                visit(row, column, &pair);
            }
        }
    }

    /// The rule for two parts.
    fn class(&self, parts: [&Part; 2]) -> Option<usize> {
        let radii = parts[0].radius + parts[1].radius;
        self.rules.class(parts[0].centre.distance(parts[1].centre) / radii, radii)
    }

    fn apart(&self, parts: [&Part; 2], tables: [&Table; 2], factor: f64, pair: &mut ElementPair) {
        let mut out = ElementValues::default();
        let [observer, source] = tables;
        let spread = parts[0].radius + parts[1].radius;
        let (medium, wanted, tests) = (self.medium, self.wanted, self.tests);
        self.arch.dispatch(ElementsApart { medium, wanted, tests, observer, source, spread, out: &mut out });
        pair.add(&out, medium, factor);
    }

    /// The integrals of an observer and a source that touch or are close; `names` tell triangles
    /// apart. Of integrals that are the same when both change places one of the two is computed for
    /// both, so that loops of currents have no charge (`pairs`).
    fn near(&self, elements: [&Element; 2], names: [u32; 2]) -> ElementPair {
        if self.tests == Tests::Straight && names[0] > names[1] {
            let [observer, source] = elements;
            return self.close([source, observer]).transposed();
        }
        self.close(elements)
    }

    fn close(&self, elements: [&Element; 2]) -> ElementPair {
        let mut pair = ElementPair::default();
        let parts = elements.map(|element| Part::new(element, WHOLE));
        self.add(elements, &parts, [1.0; 2], 0, &mut pair);
        pair
    }

    /// Adds two parts, which have these shares of the unit triangles: halved until a rule suits.
    fn add(
        &self,
        elements: [&Element; 2],
        parts: &[Part; 2],
        shares: [f64; 2],
        depth: usize,
        pair: &mut ElementPair,
    ) {
        let places = parts.map(|part| part.places);
        let (orders, common) = matched(places);
        if common == 0 {
            let class = self.class([&parts[0], &parts[1]]);
            if class.is_some() || depth >= MOST_HALVINGS {
                let rule = &self.rules.classes[class.unwrap_or(CLASSES - 1)];
                let table =
                    |side: usize| Table::new(elements[side], &parts[side], rule, (self.wanted, self.tests));
                let tables = [table(0), table(1)];
                self.apart([&parts[0], &parts[1]], [&tables[0], &tables[1]], shares[0] * shares[1], pair);
                return;
            }
        } else if shares[0] * shares[1] < LEAST_AREA_SHARES
            || places.iter().all(|&corners| elongation(corners) < MOST_ELONGATION)
        {
            self.touching(elements, parts, shares, (orders, common), pair);
            return;
        }
        self.halve(elements, parts, shares, depth + 1, pair);
    }

    /// Adds the halves of a pair. Where the longest side is a common one, both are halved there.
    fn halve(
        &self,
        elements: [&Element; 2],
        parts: &[Part; 2],
        shares: [f64; 2],
        depth: usize,
        pair: &mut ElementPair,
    ) {
        let places = parts.map(|part| part.places);
        let longest = places.map(longest_side);
        let side = usize::from(length(places[1], longest[1]) > length(places[0], longest[0]));
        let ends = |of: usize, first: usize| [places[of][first], places[of][(first + 1) % 3]];
        let [from, to] = ends(side, longest[side]);
        let is_common = |first: &usize| [[from, to], [to, from]].contains(&ends(1 - side, *first));
        let common = (0..3).find(is_common);
        for half in parts[side].halves(elements[side], longest[side]) {
            let (mut parts, mut shares) = (*parts, shares);
            parts[side] = half;
            shares[side] *= 0.5;
            let Some(first) = common else {
                self.add(elements, &parts, shares, depth, pair);
                continue;
            };
            shares[1 - side] *= 0.5;
            for half in parts[1 - side].halves(elements[1 - side], first) {
                parts[1 - side] = half;
                self.add(elements, &parts, shares, depth, pair);
            }
        }
    }

    /// Adds two parts with common corners, which come first in `orders`.
    fn touching(
        &self,
        elements: [&Element; 2],
        parts: &[Part; 2],
        shares: [f64; 2],
        (orders, common): ([[usize; 3]; 2], usize),
        pair: &mut ElementPair,
    ) {
        let origin = parts[0].centre;
        let moved = |element: &Element| Element {
            corners: element.corners.map(|corner| corner - origin),
            bulges: element.bulges,
        };
        let ordered = |side: usize| orders[side].map(|corner| parts[side].corners[corner]);
        let mut out = ElementValues::default();
        self.arch.dispatch(ElementsTouching {
            medium: self.medium,
            wanted: self.wanted,
            tests: self.tests,
            rule: &self.rules.touching[common - 1],
            elements: elements.map(moved),
            parts: [ordered(0), ordered(1)],
            spread: 2.0 * (parts[0].radius + parts[1].radius),
            out: &mut out,
        });
        pair.add(&out, self.medium, shares[0] * shares[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Functions, shares};
    use crate::pairs::Integrator;
    use crate::set::Shape;
    use fredholm_mesh::Vec3;
    use fredholm_quadrature::{PairPoint, collapsed_triangle, triangle_pair};
    use num_complex::Complex64;

    const BOTH: Wanted = Wanted { electric: true, magnetic: true };

    fn integrator(k: Complex64, tolerance: f64) -> ElementIntegrator {
        let rules = Rules::of_first_order(tolerance, k, true).unwrap();
        ElementIntegrator {
            medium: Medium::new(k),
            wanted: BOTH,
            tests: Tests::Straight,
            rules,
            arch: Arch::new(),
        }
    }

    /// The integrals as they are defined, by a list of pairs of points.
    fn plain(k: Complex64, elements: [&Element; 2], tests: Tests, points: &[PairPoint]) -> ElementPair {
        let mut sum = ElementPair::default();
        for point in points {
            let places = [shares(point.x), shares(point.y)];
            let side = |i: usize| (elements[i].point(places[i]), elements[i].vectors(places[i]));
            let ((r, own), (s, other)) = (side(0), side(1));
            let charges = places.map(|at| Functions::at(at).charges);
            let normal = elements[0].normal(places[0]);
            let distance = r.distance(s);
            let g = (-Complex64::I * k * distance).exp() / distance * point.weight;
            let slope = -(1.0 + Complex64::I * k * distance) * g / (distance * distance);
            for i in 0..64 {
                let (a, b) = (i / 8, i % 8);
                let charge = charges[0][a] * charges[1][b] / (k * k);
                sum.electric[i] += Complex64::I * k * (own[a].dot(other[b]) - charge) * g;
                let test = if tests == Tests::Turned { own[a].cross(normal) } else { own[a] };
                sum.magnetic[i] += slope * test.dot((r - s).cross(other[b]));
            }
        }
        sum
    }

    fn norm(values: &[Complex64]) -> f64 {
        values.iter().map(|value| value.norm()).fold(0.0, f64::max)
    }

    /// Relative errors of both parts.
    fn errors(found: &ElementPair, exact: &ElementPair) -> [f64; 2] {
        let difference = |a: &[Complex64; 64], b: &[Complex64; 64]| {
            norm(&std::array::from_fn::<_, 64, _>(|i| a[i] - b[i])) / norm(b)
        };
        let cancels = norm(&exact.magnetic) < 1e-9 * norm(&exact.electric);
        let magnetic = difference(&found.magnetic, &exact.magnetic);
        [difference(&found.electric, &exact.electric), if cancels { 0.0 } else { magnetic }]
    }

    /// Numbers between −1 and 1 without order.
    fn number(i: usize) -> f64 {
        2.0 * (0.5 + i as f64 * 0.754_877_666_246_692_7).fract() - 1.0
    }

    /// A triangle of about radius 1 around a centre, of no special shape, its sides a little bent.
    fn element(seed: usize, centre: Vec3, bend: f64) -> Element {
        let vector = |i: usize| {
            let at = 27 * seed + 3 * i;
            Vec3::new(number(at), number(at + 1), number(at + 2))
        };
        let corners = [0, 1, 2].map(vector);
        if elongation(corners) > 4.0 {
            return element(seed + 1001, centre, bend);
        }
        let shape = Shape::new(corners);
        let corners = shape.corners.map(|corner| centre + corner / shape.radius);
        let middle = |i: usize| 0.5 * (corners[(i + 1) % 3] + corners[(i + 2) % 3]) + bend * vector(3 + i);
        Element::curved(corners, [0, 1, 2].map(middle))
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

    /// Errors of one rule, over what is to bound them: to measure the constants of `rules`.
    #[test]
    #[ignore = "measures constants"]
    #[allow(clippy::print_stdout, reason = "it prints them")]
    fn calibrate() {
        let points = products(14);
        for degree in [4, 5, 6, 7, 8, 9, 10, 12, 13, 14, 16] {
            let rule = fredholm_quadrature::symmetric_triangle(degree).unwrap();
            let pairs: Vec<PairPoint> = rule
                .iter()
                .flat_map(|x| {
                    rule.iter().map(move |y| PairPoint {
                        x: [x.u, x.v],
                        y: [y.u, y.v],
                        weight: x.weight * y.weight,
                    })
                })
                .collect();
            print!("{degree} ({} points)", rule.len());
            for (ratio, size) in [
                (1.1, 0.02),
                (1.5, 0.02),
                (2.0, 0.02),
                (3.0, 0.02),
                (5.0, 0.02),
                (60.0, 0.5),
                (60.0, 1.0),
                (60.0, 2.0),
            ] {
                let mut worst = [0.0_f64; 2];
                for seed in 0..12 {
                    let way =
                        Vec3::new(number(seed * 3), number(seed * 3 + 1), number(seed * 3 + 2)).normalize();
                    let pair =
                        [element(seed, Vec3::ZERO, 0.05), element(seed + 40, way * (2.0 * ratio), 0.05)];
                    let pair = [&pair[0], &pair[1]];
                    let k = Complex64::from(size);
                    let exact = plain(k, pair, Tests::Straight, &points);
                    let found = errors(&plain(k, pair, Tests::Straight, &pairs), &exact);
                    (0..2).for_each(|i| worst[i] = worst[i].max(found[i]));
                }
                print!("  {ratio}/{size}: {:.1e} {:.1e}", worst[0], worst[1]);
            }
            println!();
        }
        // Pairs that touch.
        for n in 2..11 {
            print!("{n} directions");
            for (labels, pair) in contacts() {
                let pair = [&pair[0], &pair[1]];
                let k = Complex64::new(0.6, -0.1);
                let exact = plain(k, pair, Tests::Straight, &triangle_pair([0, 1, 2], labels, 14));
                let found =
                    errors(&plain(k, pair, Tests::Straight, &triangle_pair([0, 1, 2], labels, n)), &exact);
                print!("  {:.1e} {:.1e}", found[0], found[1]);
            }
            println!();
        }
    }

    /// Pairs that touch, on a curved surface, with labels for equal corners.
    fn contacts() -> Vec<([usize; 3], [Element; 2])> {
        let on = |x: f64, y: f64| Vec3::new(x, y, 0.15 * x * x - 0.2 * y * y + 0.1 * x * y);
        let of = |corners: [[f64; 2]; 3]| {
            let middle = |i: usize| {
                let [[a, b], [c, d]] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
                on(0.5 * (a + c), 0.5 * (b + d))
            };
            Element::curved(corners.map(|[x, y]| on(x, y)), [0, 1, 2].map(middle))
        };
        let first = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        [
            ([0, 1, 2], first),
            ([0, 1, 3], [[0.0, 0.0], [1.0, 0.0], [1.0, -1.0]]),
            ([3, 1, 2], [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]),
            ([0, 3, 4], [[0.0, 0.0], [-1.0, 0.0], [0.0, -1.0]]),
            ([3, 1, 4], [[1.0, -1.0], [1.0, 0.0], [2.0, -1.0]]),
        ]
        .into_iter()
        .map(|(labels, other)| (labels, [of(first), of(other)]))
        .collect()
    }

    #[test]
    fn flat_pairs_have_what_the_lowest_order_has() {
        let k = Complex64::new(0.5, -0.2);
        let corners = |seed: usize, centre: Vec3| element(seed, centre, 0.0).corners;
        let [a, b, c] = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for pair in [
            [corners(1, Vec3::ZERO), corners(2, Vec3::X * 4.0)],
            [corners(1, Vec3::ZERO), corners(2, Vec3::X * 2.5)],
            [[a, b, c], [b, a, Vec3::new(0.2, -0.5, 0.6)]],
            [[a, b, c], [Vec3::new(-1.0, 0.1, 0.0), a, Vec3::new(0.2, -0.5, 0.6)]],
        ] {
            let elements = pair.map(Element::flat);
            let found = integrator(k, 1e-6).near([&elements[0], &elements[1]], [0, 1]);
            let rules = Rules::new(1e-6, k, true).unwrap();
            let lowest = Integrator {
                medium: Medium::new(k),
                wanted: BOTH,
                rules,
                arch: Arch::new(),
                observers_cut: false,
            };
            let shapes = pair.map(Shape::new);
            let exact = lowest.near([&shapes[0], &shapes[1]], [0, 1]);
            for i in 0..9 {
                let [electric, magnetic] = found.at(i / 3, i % 3);
                let [e, m] = exact.at(i / 3, i % 3);
                assert!((electric - e).norm() < 1e-5 * norm(&exact.electric), "{i}: {electric} {e}");
                assert!((magnetic - m).norm() < 1e-5 * norm(&exact.magnetic), "{i}: {magnetic} {m}");
            }
        }
    }

    #[test]
    fn pairs_apart_are_within_the_tolerance_in_every_medium() {
        let points = products(12);
        let media = [Complex64::new(0.01, 0.0), Complex64::new(0.7, -0.3), Complex64::new(0.2, -2.0)];
        let mut worst = 0.0_f64;
        for (i, ratio) in [1.3, 1.7, 2.5, 4.0, 9.0].into_iter().enumerate() {
            for seed in 0..3 {
                let way =
                    Vec3::new(number(seed * 3 + i), number(seed * 3 + 1), number(seed * 3 + 2)).normalize();
                let pair = [element(seed, Vec3::ZERO, 0.05), element(seed + 40, way * (2.0 * ratio), 0.05)];
                for k in media {
                    for tests in [Tests::Straight, Tests::Turned] {
                        let exact = plain(k, [&pair[0], &pair[1]], tests, &points);
                        for tolerance in [1e-2, 1e-3, 1e-5, 1e-7] {
                            let integrator = ElementIntegrator { tests, ..integrator(k, tolerance) };
                            let error = errors(&integrator.close([&pair[0], &pair[1]]), &exact);
                            let share = error[0].max(error[1]) / tolerance;
                            assert!(share < 1.0, "{ratio} {k} {tolerance}: {error:?}");
                            worst = worst.max(share);
                        }
                    }
                }
            }
        }
        assert!(worst > 0.02, "the rules are finer than asked for: {worst}");
    }

    #[test]
    fn pairs_that_touch_are_within_the_tolerance_and_converge() {
        let k = Complex64::new(0.6, -0.1);
        for (labels, pair) in contacts() {
            for tests in [Tests::Straight, Tests::Turned] {
                let exact = plain(k, [&pair[0], &pair[1]], tests, &triangle_pair([0, 1, 2], labels, 13));
                for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
                    let integrator = ElementIntegrator { tests, ..integrator(k, tolerance) };
                    let error = errors(&integrator.close([&pair[0], &pair[1]]), &exact);
                    let worst = error[0].max(error[1]);
                    assert!(worst < 2.0 * tolerance, "{labels:?} {tests:?} {tolerance}: {error:?}");
                }
            }
        }
    }

    /// Not only up to the tolerance.
    #[test]
    fn a_pair_has_the_same_integrals_whichever_triangle_observes_and_on_every_register() {
        let integrator = integrator(Complex64::new(0.5, -0.2), 1e-2);
        let scalar = ElementIntegrator { arch: Arch::Scalar, ..integrator.clone() };
        for (_, [a, b]) in contacts() {
            let (forth, back) = (integrator.near([&a, &b], [3, 5]), integrator.near([&b, &a], [5, 3]));
            assert_eq!(forth, back.transposed());
            assert_eq!(forth, scalar.near([&a, &b], [3, 5]));
        }
        let [a, b] = [element(1, Vec3::ZERO, 0.05), element(2, Vec3::X * 4.0, 0.05)];
        assert_eq!(integrator.close([&a, &b]), scalar.close([&a, &b]));
    }
}
