//! Rules for pairs of patches that touch: ∫∫ f(x, y) dy dx with f singular where x = y.
//!
//! S. A. Sauter, C. Schwab, *Boundary Element Methods*, Springer 2011, section 5.2,
//! doi:10.1007/978-3-540-68093-2. The four dimensions are cut into pieces that the map (ξ, η₁, η₂,
//! η₃) of the unit cube covers, with |x − y| proportional to a product of coordinates that the
//! Jacobian contains: a kernel 1/|x − y| becomes analytic, and Gauss–Legendre converges
//! exponentially. Polynomials are exact to total degree 2n − 4, since the factor ξ³ of the Jacobian
//! takes three.
//!
//! Corners carry labels; equal labels are the same corner. A quadrilateral is cut into two
//! triangles along a diagonal, and the degree stays. The parameters of a triangle's corners are (0,
//! 0), (1, 0), (0, 1), those of a quadrilateral's (0, 0), (1, 0), (1, 1), (0, 1).

use crate::{PlanePoint, collapsed_triangle, tensor_quad};

/// A point of a pair rule: the parameters on both patches, and the weight. The weights sum to the
/// product of both measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairPoint {
    /// Parameters (u, v) on the first patch.
    pub x: [f64; 2],
    /// Parameters (u, v) on the second patch.
    pub y: [f64; 2],
    /// Weight.
    pub weight: f64,
}

/// The parameters of one point on the triangle of Sauter and Schwab, 0 ≤ x₂ ≤ x₁ ≤ 1.
type Point = [f64; 2];
/// The parameters of the three corners of a triangle in its patch.
type Corners = [Point; 3];

/// The rule with n points a direction for two triangles with corner labels `a` and `b`: 6n⁴ points
/// where they are the same, 5n⁴ with a common edge, 2n⁴ with a common corner (degree 2n − 4 each),
/// n⁴ apart (degree 2n − 1 in each of x and y).
///
/// ```
/// let touching = fredholm_quadrature::triangle_pair([0, 1, 2], [2, 1, 3], 4);
/// assert_eq!(touching.len(), 5 * 256);
/// assert!((touching.iter().map(|p| p.weight).sum::<f64>() - 0.25).abs() < 1e-15);
/// ```
#[must_use]
pub fn triangle_pair(a: [usize; 3], b: [usize; 3], n: usize) -> Vec<PairPoint> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    place((a, corners), (b, corners), n)
}

/// The rule for two quadrilaterals, the sum of the rules of four pairs of triangles, whose degree
/// it has. It holds for any parametrisation that is smooth on both sides of the diagonal, the
/// bilinear one among them.
///
/// ```
/// let same = fredholm_quadrature::quad_pair([0, 1, 2, 3], [0, 1, 2, 3], 3);
/// assert!((same.iter().map(|p| p.weight).sum::<f64>() - 1.0).abs() < 1e-14);
/// ```
#[must_use]
pub fn quad_pair(a: [usize; 4], b: [usize; 4], n: usize) -> Vec<PairPoint> {
    // Where both are one patch, the same diagonal must cut both, wherever the second list starts.
    let same = a.iter().all(|label| b.contains(label));
    let start = if same { b.iter().position(|&label| label == a[0]).unwrap_or(0) } else { 0 };
    let mut points = Vec::new();
    for first in halves(a, 0) {
        for second in halves(b, start) {
            points.extend(place(first, second, n));
        }
    }
    points
}

/// The two triangles on either side of the diagonal from corner `start`.
fn halves(labels: [usize; 4], start: usize) -> [([usize; 3], Corners); 2] {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    [[0, 1, 2], [0, 2, 3]].map(|triangle| {
        let at = triangle.map(|i| (start + i) % 4);
        (at.map(|i| labels[i]), at.map(|i| corners[i]))
    })
}

/// The rule for two labelled triangles, with the common corners brought to the front of both.
fn place(a: ([usize; 3], Corners), b: ([usize; 3], Corners), n: usize) -> Vec<PairPoint> {
    let (first, second, common) = matched(a.0, b.0);
    let (p, q) = (first.map(|i| a.1[i]), second.map(|i| b.1[i]));
    // Twice the area of each triangle is the Jacobian; in its patch's parameters that is 1, for a
    // half square too.
    let put = |x: PairPoint| PairPoint { x: on(&p, x.x), y: on(&q, x.y), weight: x.weight };
    reference(common, n).into_iter().map(put).collect()
}

/// Orders of the corners of both triangles with the common ones first, and their number.
fn matched(a: [usize; 3], b: [usize; 3]) -> ([usize; 3], [usize; 3], usize) {
    let (mut first, mut second, mut common) = ([0, 1, 2], [0, 1, 2], 0);
    for (i, label) in a.iter().enumerate() {
        let partner = (common..3).find(|&k| b[second[k]] == *label);
        if let (Some(k), Some(at)) = (partner, first.iter().position(|&c| c == i)) {
            first.swap(common, at);
            second.swap(common, k);
            common += 1;
        }
    }
    (first, second, common)
}

/// The image of a point of the reference triangle with corners (0, 0), (1, 0), (1, 1).
fn on(corners: &Corners, [x1, x2]: Point) -> Point {
    [0, 1]
        .map(|k| corners[0][k] + x1 * (corners[1][k] - corners[0][k]) + x2 * (corners[2][k] - corners[1][k]))
}

/// The rule on the reference triangle for triangles with `common` corners.
fn reference(common: usize, n: usize) -> Vec<PairPoint> {
    match common {
        0 => apart(&collapsed_triangle(n)),
        1 => mapped(n, corner),
        2 => mapped(n, edge),
        _ => mapped(n, identical),
    }
}

/// The product of a rule with itself, with (u, v) on the unit triangle turned into (u + v, v).
fn apart(rule: &[PlanePoint]) -> Vec<PairPoint> {
    let at = |p: &PlanePoint| [p.u + p.v, p.v];
    let pair = |p: &PlanePoint, q: &PlanePoint| PairPoint { x: at(p), y: at(q), weight: p.weight * q.weight };
    rule.iter().flat_map(|p| rule.iter().map(move |q| pair(p, q))).collect()
}

/// The n⁴ Gauss points, each sent to the pieces of one kind of contact.
fn mapped<const PIECES: usize>(
    n: usize,
    pieces: fn(f64, f64, f64, f64) -> [PairPoint; PIECES],
) -> Vec<PairPoint> {
    let plane = tensor_quad(n);
    let mut points = Vec::with_capacity(PIECES * plane.len() * plane.len());
    for p in &plane {
        for q in &plane {
            let gauss = p.weight * q.weight;
            let all = pieces(p.u, p.v, q.u, q.v);
            points.extend(all.map(|point| PairPoint { weight: gauss * point.weight, ..point }));
        }
    }
    points
}

/// ξ times both points, with the Jacobian as weight.
fn piece(xi: f64, x: Point, y: Point, weight: f64) -> PairPoint {
    PairPoint { x: x.map(|c| xi * c), y: y.map(|c| xi * c), weight }
}

/// Common corner (0, 0): Sauter and Schwab, section 5.2.3.
fn corner(xi: f64, e1: f64, e2: f64, e3: f64) -> [PairPoint; 2] {
    let jacobian = xi.powi(3) * e2;
    let (far, near) = ([1.0, e1], [e2, e2 * e3]);
    [piece(xi, far, near, jacobian), piece(xi, near, far, jacobian)]
}

/// Common edge from (0, 0) to (1, 0): section 5.2.2.
fn edge(xi: f64, e1: f64, e2: f64, e3: f64) -> [PairPoint; 5] {
    let first = xi.powi(3) * e1 * e1;
    let jacobian = first * e2;
    let (a, b) = ([1.0 - e1 * e2, e1 * (1.0 - e2)], [1.0 - e1 * e2 * e3, e1 * e2 * (1.0 - e3)]);
    let c = [1.0 - e1 * e2 * e3, e1 * (1.0 - e2 * e3)];
    [
        piece(xi, [1.0, e1 * e3], a, first),
        piece(xi, [1.0, e1], b, jacobian),
        piece(xi, a, [1.0, e1 * e2 * e3], jacobian),
        piece(xi, b, [1.0, e1], jacobian),
        piece(xi, c, [1.0, e1 * e2], jacobian),
    ]
}

/// One triangle twice: section 5.2.1.
fn identical(xi: f64, e1: f64, e2: f64, e3: f64) -> [PairPoint; 6] {
    let jacobian = xi.powi(3) * e1 * e1 * e2;
    let (a, b) = ([1.0, 1.0 - e1 + e1 * e2], [1.0 - e1 * e2 * e3, 1.0 - e1]);
    let (c, d) = ([1.0, e1 * (1.0 - e2 + e2 * e3)], [1.0 - e1 * e2, e1 * (1.0 - e2)]);
    let (e, f) = ([1.0 - e1 * e2 * e3, e1 * (1.0 - e2 * e3)], [1.0, e1 * (1.0 - e2)]);
    [(a, b), (b, a), (c, d), (d, c), (e, f), (f, e)].map(|(x, y)| piece(xi, x, y, jacobian))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_forms::coplanar;
    use crate::exactness::{
        LEAST_WRONG_ERROR, ROUNDING_ALLOWED, chebyshev, chebyshev_integral, peak, triangle_chebyshev,
        triangle_moment,
    };

    fn sum(points: &[PairPoint], f: impl Fn(&PairPoint) -> f64) -> f64 {
        points.iter().map(|p| p.weight * f(p)).sum()
    }

    /// Polynomials Pₐ(u) P_b(v) on a patch: P, their integrals, and measure times largest value.
    struct Family {
        value: fn(usize, f64) -> f64,
        integral: fn(usize, usize) -> f64,
        scale: fn(usize, usize) -> f64,
    }

    const POWER: fn(usize, f64) -> f64 = |k, x| x.powi(k as i32);

    /// What is to be exact, and what shows an error beyond the degree.
    const TRIANGLE: [Family; 2] = [
        Family { value: POWER, integral: triangle_moment, scale: |a, b| 0.5 * peak(a, b) },
        Family { value: chebyshev, integral: triangle_chebyshev, scale: |_, _| 0.5 },
    ];
    const SQUARE_FAMILIES: [Family; 2] = [
        Family { value: POWER, integral: |a, b| 1.0 / ((a + 1) * (b + 1)) as f64, scale: |_, _| 1.0 },
        Family {
            value: chebyshev,
            integral: |a, b| chebyshev_integral(a) * chebyshev_integral(b),
            scale: |_, _| 1.0,
        },
    ];

    impl Family {
        /// Largest error over products with these degrees in (x, y), relative to measure and
        /// largest value.
        fn worst(&self, points: &[PairPoint], degrees: &[[usize; 4]]) -> f64 {
            // Sums of sums: that of many thousand points in a row rounds by more than 1e-14.
            let mut sums = vec![0.0; degrees.len()];
            for block in points.chunks(100) {
                sums.iter_mut().zip(self.sums(block, degrees)).for_each(|(sum, part)| *sum += part);
            }
            let error = |(sum, &[a, b, c, d]): (f64, &[usize; 4])| {
                let exact = (self.integral)(a, b) * (self.integral)(c, d);
                (sum - exact).abs() / ((self.scale)(a, b) * (self.scale)(c, d))
            };
            sums.into_iter().zip(degrees).map(error).fold(0.0, f64::max)
        }

        fn sums(&self, points: &[PairPoint], degrees: &[[usize; 4]]) -> Vec<f64> {
            let highest = degrees.iter().flatten().copied().max().unwrap_or(0);
            let mut sums = vec![0.0; degrees.len()];
            for p in points {
                let values = |x: f64| -> Vec<f64> { (0..=highest).map(|k| (self.value)(k, x)).collect() };
                let [s, t, u, v] = [p.x[0], p.x[1], p.y[0], p.y[1]].map(values);
                for (sum, [a, b, c, d]) in sums.iter_mut().zip(degrees) {
                    *sum += p.weight * s[*a] * t[*b] * u[*c] * v[*d];
                }
            }
            sums
        }
    }

    /// All exponents up to `highest` that `of` keeps.
    fn degrees(highest: usize, of: impl Fn(usize, usize) -> bool) -> Vec<[usize; 4]> {
        let side = highest + 1;
        let all =
            (0..side.pow(4)).map(|k| [k / side.pow(3), k / side.pow(2) % side, k / side % side, k % side]);
        all.filter(|[a, b, c, d]| of(a + b, c + d)).collect()
    }

    /// Total degree 2n − 4 in (x, y), and no more.
    fn touching([exact, beyond]: &[Family; 2], points: &[PairPoint], n: usize, label: &str) {
        let kept = exact.worst(points, &degrees(2 * n - 4, |x, y| x + y <= 2 * n - 4));
        let missed = beyond.worst(points, &degrees(2 * n - 3, |x, y| x + y == 2 * n - 3));
        assert!(
            kept <= ROUNDING_ALLOWED && missed > LEAST_WRONG_ERROR,
            "{label}, n = {n}: {kept:e}, {missed:e}"
        );
    }

    /// Degree 2n − 1 in x and in y, and no more in either.
    fn apart([exact, beyond]: &[Family; 2], points: &[PairPoint], n: usize, label: &str) {
        let kept = exact.worst(points, &degrees(2 * n - 1, |x, y| x.max(y) < 2 * n));
        let in_x = beyond.worst(points, &degrees(2 * n, |x, y| x == 2 * n && y == 0));
        let in_y = beyond.worst(points, &degrees(2 * n, |x, y| x == 0 && y == 2 * n));
        assert!(
            kept <= ROUNDING_ALLOWED && in_x.min(in_y) > LEAST_WRONG_ERROR,
            "{label}, n = {n}: {kept:e}, {in_x:e}, {in_y:e}"
        );
    }

    /// One pair of labels for each kind of contact, with the common corners in different places.
    const CONTACTS: [[usize; 3]; 5] = [[0, 1, 2], [1, 2, 0], [2, 1, 7], [8, 9, 1], [7, 0, 2]];

    #[test]
    fn every_touching_pair_has_its_degree_and_no_more() {
        for (b, n) in CONTACTS.into_iter().flat_map(|b| (2..=8).map(move |n| (b, n))) {
            touching(&TRIANGLE, &triangle_pair([0, 1, 2], b, n), n, &format!("{b:?}"));
        }
    }

    #[test]
    fn triangles_apart_keep_the_full_degree_in_each() {
        assert_eq!(triangle_pair([0, 1, 2], [3, 4, 5], 2).len(), 16);
        for n in 1..=6 {
            apart(&TRIANGLE, &triangle_pair([0, 1, 2], [3, 4, 5], n), n, "triangles");
        }
    }

    /// The same square from two corners, a common edge, a common corner.
    const SQUARES: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 2, 3, 0], [1, 4, 5, 2], [2, 5, 6, 7]];

    #[test]
    fn squares_have_the_degree_of_their_triangles() {
        for (b, n) in SQUARES.into_iter().flat_map(|b| (2..=8).map(move |n| (b, n))) {
            touching(&SQUARE_FAMILIES, &quad_pair([0, 1, 2, 3], b, n), n, &format!("{b:?}"));
        }
        for n in 1..=6 {
            apart(&SQUARE_FAMILIES, &quad_pair([0, 1, 2, 3], [4, 5, 6, 7], n), n, "squares");
        }
    }

    /// ∫∫ 1/|x − y| over the unit square and itself moved by (i, j), by n points a direction.
    fn squares(shift: [f64; 2], labels: [usize; 4], n: usize) -> f64 {
        let moved = |p: &PairPoint| (p.x[0] - p.y[0] - shift[0]).hypot(p.x[1] - p.y[1] - shift[1]);
        sum(&quad_pair([0, 1, 2, 3], labels, n), |p| 1.0 / moved(p))
    }

    /// Errors at n = 2, 4, 6, 8 fall at least by `fall` a step.
    fn converges(shift: [f64; 2], labels: [usize; 4], fall: f64) {
        let exact = coplanar([0.0, 1.0, 0.0, 1.0], [shift[0], shift[0] + 1.0, shift[1], shift[1] + 1.0], 0.0);
        let error = |n| (squares(shift, labels, n) - exact).abs() / exact;
        let errors = [2, 4, 6, 8].map(error);
        for pair in errors.windows(2) {
            assert!(pair[1] < pair[0] / fall || pair[1] < 1e-14, "{shift:?}: {errors:?}");
        }
        assert!(errors[3] < 1e-7, "{shift:?}: {errors:?}");
    }

    #[test]
    fn squares_that_are_one_or_touch_converge_exponentially() {
        converges([0.0, 0.0], [0, 1, 2, 3], 10.0);
        converges([1.0, 0.0], [1, 4, 5, 2], 10.0);
        converges([0.0, -1.0], [7, 8, 1, 0], 10.0);
        converges([1.0, 1.0], [2, 5, 6, 7], 10.0);
    }

    #[test]
    fn the_unit_square_with_itself_has_its_known_energy() {
        let known = 4.0 / 3.0 * (1.0 - 2f64.sqrt()) + 4.0 * 1f64.asinh();
        assert!((squares([0.0, 0.0], [0, 1, 2, 3], 12) - known).abs() < 1e-9);
    }

    #[test]
    fn one_patch_listed_from_another_corner_gives_the_same() {
        // The second list starts at (1, 0): its (u, v) is (v, 1 − u) turned back.
        let turned = quad_pair([0, 1, 2, 3], [1, 2, 3, 0], 6);
        let value = sum(&turned, |p| 1.0 / (p.x[0] - 1.0 + p.y[1]).hypot(p.x[1] - p.y[0]));
        assert!((value - squares([0.0, 0.0], [0, 1, 2, 3], 6)).abs() < 1e-13);
    }
}
