//! Triangles and quadrilaterals of any shape: A_i F_ij = (1/4π) Σₑ Σ_f (e·f) ∫∫ ln(r²/d²) ds dt.
//!
//! The contour integral (E. M. Sparrow 1963, doi:10.1115/1.3686055) with Gauss points along the
//! edges e and f; d is the distance of the centres, and the constant it adds to the logarithm
//! integrates to 0 round a contour. r²/d² − 1 = x is formed from the offsets of the edges, not as a
//! difference of distances: the rounding left is that of h/d, not of 1. Nodes ±s, ±t share a weight
//! and one logarithm: (1 + x)(1 + y) = 1 + (x + y + x y). Lengths in any unit, exchanges in its
//! square.

use super::logarithm::ln_1p;
use super::patches::Patches;
use super::rules::{Node, rule};
use crate::form_factor::lanes::{LANES, Lanes, Lanes3, Places, difference, dot, each, sum};
use std::f64::consts::TAU;

/// A_i F_ij of a block of pairs with so many corners, and so many points along the edges of the
/// first and of the second.
#[inline(always)]
pub(super) fn polygons(
    patches: &Patches,
    pair: [&Places; 2],
    corners: [usize; 2],
    points: [usize; 2],
) -> Lanes {
    let corner = [outline(patches, pair[0]), outline(patches, pair[1])];
    let d = difference(&pair[1].vectors(&patches.centre), &pair[0].vectors(&patches.centre));
    let square = dot(&d, &d);
    let inverse = each(|m| 1.0 / square[m]);
    let mut total = [0.0; LANES];
    for k in 0..corners[0] {
        let e = Edge::new(&corner[0][k], &corner[0][(k + 1) % corners[0]]);
        for l in 0..corners[1] {
            let f = Edge::new(&corner[1][l], &corner[1][(l + 1) % corners[1]]);
            let cosine = dot(&e.side, &f.side);
            let integral = Field::new(&d, &inverse, &e, &f).integral(points);
            total = each(|m| total[m] + cosine[m] * integral[m]);
        }
    }
    each(|m| total[m] * (0.5 / TAU))
}

/// The corners seen from the centre.
#[inline(always)]
fn outline(patches: &Patches, side: &Places) -> [Lanes3; 4] {
    let [a, b, c, d] = &patches.corner;
    [side.vectors(a), side.vectors(b), side.vectors(c), side.vectors(d)]
}

/// An edge: its middle seen from the centre of the polygon, and its side.
struct Edge {
    middle: Lanes3,
    side: Lanes3,
}

impl Edge {
    #[inline(always)]
    fn new(from: &Lanes3, to: &Lanes3) -> Self {
        let [x, y, z] = sum(from, to);
        Self {
            middle: [each(|m| 0.5 * x[m]), each(|m| 0.5 * y[m]), each(|m| 0.5 * z[m])],
            side: difference(to, from),
        }
    }
}

/// The coefficients of x = r²/d² − 1 in s and t.
struct Field {
    base: Lanes,
    s: Lanes,
    t: Lanes,
    ss: Lanes,
    tt: Lanes,
    st: Lanes,
}

impl Field {
    #[inline(always)]
    fn new(d: &Lanes3, inverse: &Lanes, e: &Edge, f: &Edge) -> Self {
        let offset = difference(&f.middle, &e.middle);
        let middle = sum(d, &offset);
        let (linear, square) = (dot(d, &offset), dot(&offset, &offset));
        let scaled = |factor: f64, x: Lanes| -> Lanes { each(|m| factor * inverse[m] * x[m]) };
        Self {
            base: each(|m| inverse[m] * (2.0 * linear[m] + square[m])),
            s: scaled(-2.0, dot(&middle, &e.side)),
            t: scaled(2.0, dot(&middle, &f.side)),
            ss: scaled(1.0, dot(&e.side, &e.side)),
            tt: scaled(1.0, dot(&f.side, &f.side)),
            st: scaled(-2.0, dot(&e.side, &f.side)),
        }
    }

    /// Σ w_s w_t ln(1 + x).
    #[inline(always)]
    fn integral(&self, points: [usize; 2]) -> Lanes {
        let mut sum = [0.0; LANES];
        for &s in rule(points[0]) {
            for &t in rule(points[1]) {
                self.add(s, t, &mut sum);
            }
        }
        sum
    }

    /// Adds the nodes ±s, ±t.
    #[inline(always)]
    fn add(&self, s: Node, t: Node, sum: &mut Lanes) {
        let (x, y, weight) = (s.place, t.place, s.weight * t.weight);
        match (x == 0.0, y == 0.0) {
            (true, true) => self.add_nodes([[x, y]], weight, sum),
            (true, false) => self.add_nodes([[x, y], [x, -y]], weight, sum),
            (false, true) => self.add_nodes([[x, y], [-x, y]], weight, sum),
            (false, false) => self.add_nodes([[x, y], [-x, -y], [x, -y], [-x, y]], weight, sum),
        }
    }

    #[inline(always)]
    fn add_nodes<const N: usize>(&self, nodes: [[f64; 2]; N], weight: f64, sum: &mut Lanes) {
        for m in 0..LANES {
            let join = |x: f64, y: f64| x + y + x * y;
            let first = self.excess(m, nodes[0]);
            let all = nodes[1..].iter().fold(first, |x, &node| join(x, self.excess(m, node)));
            sum[m] += weight * ln_1p(all);
        }
    }

    /// r²/d² − 1.
    #[inline(always)]
    fn excess(&self, m: usize, [s, t]: [f64; 2]) -> f64 {
        (self.base[m] + s * s * self.ss[m] + t * t * self.tt[m])
            + (s * self.s[m] + t * self.t[m] + s * t * self.st[m])
    }
}
