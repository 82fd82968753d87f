//! Triangles, flat or curved, with the functions of the first full order on them.
//!
//! R. D. Graglia, D. R. Wilton, A. F. Peterson, Higher order interpolatory vector bases for
//! computational electromagnetics, IEEE Trans. Antennas Propag. 45 (1997) 329,
//! doi:10.1109/8.558649. A triangle is the image of the unit triangle with the coordinates λ₀, λ₁,
//! λ₂ of sum 1:
//!
//! ```text
//! r(λ) = Σ λ_i c_i + 4 Σ_{i<j} λ_i λ_j (m_ij − (c_i + c_j)/2)
//! ```
//!
//! with corners c and places m_ij in the middle of the sides, which are straight where it is flat.
//! A function is f = F/√g with F = F_u ∂r/∂λ₁ + F_v ∂r/∂λ₂ and √g = |∂r/∂λ₁ × ∂r/∂λ₂|, its charge
//! div f = (∂F_u/∂λ₁ + ∂F_v/∂λ₂)/√g. With ξ the place in the unit triangle and ξ_i its corners, F
//! is
//!
//! ```text
//! ξ − ξ_i               a current through the side opposite to corner i, even on it (0, 1, 2)
//! (λ_j − λ_k)(ξ − ξ_i)  one that changes along it, j and k the next corners       (3, 4, 5)
//! λ_i (ξ − ξ_i)         one that stays inside, for i = 0 and 1                    (6, 7)
//! ```
//!
//! Together they have all vectors linear in λ, and all linear charges. (The third of the last kind
//! is the sum of the other two, turned over.) On a flat triangle the first three are those of Rao,
//! Wilton and Glisson.

use crate::kernel::{Eight, WIDTH};
use fredholm_mesh::Vec3;
use fredholm_quadrature::symmetric_triangle;

/// Degree of the rule for products of two functions: exact on flat triangles.
const PRODUCT_DEGREE: usize = 6;

/// Coordinates of a point of the unit triangle: shares of the three corners, with sum 1.
pub(crate) type Shares = [f64; 3];

/// The whole of the unit triangle, by its corners.
pub(crate) const WHOLE: [Shares; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A triangle, flat or curved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Element {
    /// Corners, m.
    pub(crate) corners: [Vec3; 3],
    /// Four times the way from the middle of the chord opposite to each corner to that of the side,
    /// m.
    pub(crate) bulges: [Vec3; 3],
}

/// F of all functions at a point, along both tangents, and their charges times √g.
pub(crate) struct Functions {
    pub(crate) along: [Eight; 2],
    pub(crate) charges: Eight,
}

impl Functions {
    /// At a point of the unit triangle.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "kernels of the widest vectors call it")]
    pub(crate) fn at([l0, l1, l2]: Shares) -> Self {
        let (s0, s1, s2) = (l1 - l2, l2 - l0, l0 - l1);
        let (u, v) = (l1 - 1.0, l2 - 1.0);
        Self {
            along: [
                [l1, u, l1, s0 * l1, s1 * u, s2 * l1, l0 * l1, l1 * u],
                [l2, l2, v, s0 * l2, s1 * l2, s2 * v, l0 * l2, l1 * l2],
            ],
            charges: [2.0, 2.0, 2.0, 3.0 * s0, 3.0 * s1, 3.0 * s2, 3.0 * l0 - 1.0, 3.0 * l1 - 1.0],
        }
    }
}

impl Element {
    /// A flat one.
    pub(crate) fn flat(corners: [Vec3; 3]) -> Self {
        Self { corners, bulges: [Vec3::ZERO; 3] }
    }

    /// The one whose sides opposite to the corners have these middles.
    pub(crate) fn curved(corners: [Vec3; 3], middles: [Vec3; 3]) -> Self {
        let bulge = |i: usize| 4.0 * (middles[i] - 0.5 * (corners[(i + 1) % 3] + corners[(i + 2) % 3]));
        Self { corners, bulges: [0, 1, 2].map(bulge) }
    }

    /// Its image under a rigid motion or a reflection of places.
    pub(crate) fn moved(&self, image: impl Fn(Vec3) -> Vec3) -> Self {
        let moved = |way: Vec3| image(way) - image(Vec3::ZERO);
        Self { corners: self.corners.map(&image), bulges: self.bulges.map(moved) }
    }

    /// r, m. On a side both triangles have the same bits.
    pub(crate) fn point(&self, [l0, l1, l2]: Shares) -> Vec3 {
        let [a, b, c] = self.corners;
        let [d, e, f] = self.bulges;
        // On a side two of the first terms and one of the others are left, in whichever order.
        (l0 * a + l1 * b + l2 * c) + (l1 * l2 * d + l2 * l0 * e + l0 * l1 * f)
    }

    /// The largest distance of a corner, or of the middle of a side, from a place, m.
    pub(crate) fn reach(&self, place: Vec3) -> f64 {
        let middles = [[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]].map(|at| self.point(at));
        self.corners.into_iter().chain(middles).map(|p| p.distance(place)).fold(0.0, f64::max)
    }

    /// ∂r/∂λ₁ and ∂r/∂λ₂ with λ₀ = 1 − λ₁ − λ₂, m.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "kernels of the widest vectors call it")]
    pub(crate) fn tangents(&self, [l0, l1, l2]: Shares) -> [Vec3; 2] {
        let [a, b, c] = self.corners;
        let [d, e, f] = self.bulges;
        [b - a + l2 * (d - e) + (l0 - l1) * f, c - a + l1 * (d - f) + (l0 - l2) * e]
    }

    /// The unit normal.
    pub(crate) fn normal(&self, at: Shares) -> Vec3 {
        let [u, v] = self.tangents(at);
        u.cross(v).normalize_or_zero()
    }

    /// √g, m².
    pub(crate) fn stretch(&self, at: Shares) -> f64 {
        let [u, v] = self.tangents(at);
        u.cross(v).length()
    }

    /// F of all functions at a point, m.
    pub(crate) fn vectors(&self, at: Shares) -> [Vec3; WIDTH] {
        let ([u, v], functions) = (self.tangents(at), Functions::at(at));
        std::array::from_fn(|i| functions.along[0][i] * u + functions.along[1][i] * v)
    }

    /// ∫ f_a·f_b dA of all pairs of functions.
    pub(crate) fn products(&self) -> [[f64; WIDTH]; WIDTH] {
        let mut sums = [[0.0; WIDTH]; WIDTH];
        // The degree is one of the table.
        for point in symmetric_triangle(PRODUCT_DEGREE).unwrap_or_default() {
            let at = shares([point.u, point.v]);
            let (vectors, weight) = (self.vectors(at), point.weight / self.stretch(at));
            for (row, a) in sums.iter_mut().zip(vectors) {
                row.iter_mut().zip(vectors).for_each(|(sum, b)| *sum += weight * a.dot(b));
            }
        }
        sums
    }
}

/// The coordinates of a point of a rule.
pub(crate) fn shares([u, v]: [f64; 2]) -> Shares {
    [1.0 - u - v, u, v]
}

/// The coordinates in the unit triangle of a point of a part of it.
pub(crate) fn within(part: &[Shares; 3], at: Shares) -> Shares {
    std::array::from_fn(|i| at[0] * part[0][i] + at[1] * part[1][i] + at[2] * part[2][i])
}

/// A part of a triangle, with a ball around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Its corners in the unit triangle.
    pub(crate) corners: [Shares; 3],
    /// The same in space, m.
    pub(crate) places: [Vec3; 3],
    pub(crate) centre: Vec3,
    pub(crate) radius: f64,
}

impl Part {
    pub(crate) fn new(element: &Element, corners: [Shares; 3]) -> Self {
        let places = corners.map(|corner| element.point(corner));
        let centre = element.point(within(&corners, [1.0 / 3.0; 3]));
        let middle = |i: usize| {
            let mut at = [0.5; 3];
            at[i] = 0.0;
            element.point(within(&corners, at))
        };
        let reach = places.into_iter().chain((0..3).map(middle)).map(|p| p.distance(centre));
        Self { corners, places, centre, radius: reach.fold(0.0, f64::max) }
    }

    /// Both halves, cut across the side from corner `first`.
    pub(crate) fn halves(&self, element: &Element, first: usize) -> [Self; 2] {
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[(first + i) % 3]);
        let middle = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        [[a, middle, c], [middle, b, c]].map(|corners| Self::new(element, corners))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curved() -> Element {
        let corners = [Vec3::ZERO, Vec3::new(1.0, 0.1, 0.0), Vec3::new(0.2, 0.9, 0.3)];
        Element::curved(
            corners,
            [Vec3::new(0.7, 0.6, 0.1), Vec3::new(0.05, 0.5, 0.2), Vec3::new(0.5, -0.05, 0.1)],
        )
    }

    #[test]
    fn sides_go_through_their_middles_and_tangents_are_their_slopes() {
        let element = curved();
        let middle = element.point([0.0, 0.5, 0.5]);
        assert!((middle - Vec3::new(0.7, 0.6, 0.1)).length() < 1e-15);
        let (at, h) = ([0.2, 0.5, 0.3], 1e-6);
        let [u, v] = element.tangents(at);
        let along_u =
            (element.point([0.2 - h, 0.5 + h, 0.3]) - element.point([0.2 + h, 0.5 - h, 0.3])) / (2.0 * h);
        let along_v =
            (element.point([0.2 - h, 0.5, 0.3 + h]) - element.point([0.2 + h, 0.5, 0.3 - h])) / (2.0 * h);
        assert!((u - along_u).length() < 1e-9 && (v - along_v).length() < 1e-9);
    }

    /// Their charges are the slopes of F, their currents leave by their own side only, and they
    /// span all linear vectors.
    #[test]
    fn functions_are_what_they_are_said_to_be() {
        let h = 1e-6;
        for at in [[0.2, 0.5, 0.3], [0.6, 0.1, 0.3]] {
            let [l0, l1, l2] = at;
            let f = |l: Shares| Functions::at(l).along;
            let (forth, back) = (f([l0 - h, l1 + h, l2]), f([l0 + h, l1 - h, l2]));
            let (up, down) = (f([l0 - h, l1, l2 + h]), f([l0 + h, l1, l2 - h]));
            for (i, charge) in Functions::at(at).charges.into_iter().enumerate() {
                let slope = (forth[0][i] - back[0][i] + up[1][i] - down[1][i]) / (2.0 * h);
                assert!((slope - charge).abs() < 1e-9, "{i}");
            }
        }
        // Through the sides opposite to the corners: F·(1, 1), −F_u and −F_v.
        let t = 0.3;
        let through = [
            ([0.0, t, 1.0 - t], [1.0, 1.0], [1.0, 2.0 * t - 1.0]),
            ([1.0 - t, 0.0, t], [-1.0, 0.0], [1.0, 2.0 * t - 1.0]),
            ([t, 1.0 - t, 0.0], [0.0, -1.0], [1.0, 2.0 * t - 1.0]),
        ];
        for (side, (at, normal, [even, odd])) in through.into_iter().enumerate() {
            let [u, v] = Functions::at(at).along;
            for (i, (u, v)) in u.into_iter().zip(v).enumerate() {
                let expected = match i {
                    _ if i == side => even,
                    _ if i == side + 3 => odd,
                    _ => 0.0,
                };
                let flux = u * normal[0] + v * normal[1];
                assert!((flux - expected).abs() < 1e-15, "{side} {i} {flux}");
            }
        }
    }

    /// ∫ f_a·f_b dA of the first three on a flat triangle.
    fn closed(corners: [Vec3; 3], [a, b]: [usize; 2]) -> f64 {
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        let corners = corners.map(|corner| corner - centre);
        let spread: f64 = corners.iter().map(|corner| corner.length_squared()).sum();
        (spread / 12.0 + corners[a].dot(corners[b])) / (4.0 * area)
    }

    #[test]
    fn products_on_a_flat_triangle_are_the_closed_ones() {
        let corners = [Vec3::ZERO, Vec3::new(1.0, 0.1, 0.0), Vec3::new(0.2, 0.9, 0.3)];
        let products = Element::flat(corners).products();
        for (a, row) in products.iter().enumerate().take(3) {
            for (b, product) in row.iter().enumerate().take(3) {
                assert!((product - closed(corners, [a, b])).abs() < 1e-14);
            }
        }
    }
}
