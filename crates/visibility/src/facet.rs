//! Does a segment cross a triangle or a parallelogram? Decided in f64, or exactly where that is in doubt.
//!
//! A facet has a corner a, two edges b and c from it, and the unit normal n. Every point x has the height
//! s = n·(x − a) over its plane and the coordinates u and v with x = a + u b + v c + s n. The segment from p to q
//! crosses the plane where its height is zero; there, up to the common factor D = s_q − s_p,
//!
//! U = u_p s_q − u_q s_p,  V = v_p s_q − v_q s_p.
//!
//! With D > 0 (else all signs are changed) the crossing is inside where U ≥ 0, V ≥ 0 and, for a triangle,
//! U + V ≤ D, for a parallelogram, max(U, V) ≤ D. Swapping p and q only changes the signs of D, U and V, bit for bit.
//!
//! Rounding: u_p, v_p and s_p are dot products of few terms, so with g = |∇u| + |∇v|, the condition number
//! κ = |b| |c| / |b × c| and the distance M that bounds all lengths in the query, U, V and D err by less than
//! a small multiple of ε κ g M². Closer to zero than that the exact predicates decide.
//!
//! Units: metres, in coordinates relative to the centre of the scene.

use fredholm_mesh::Vec3;

use crate::probe::Probe;

/// A generous count of the roundings on the way to U and V, each of the size ε κ g M².
const ROUNDINGS: f64 = 64.0;

/// An affine function of position: gradient·x + constant.
#[derive(Clone, Copy, Debug)]
struct Affine {
    gradient: Vec3,
    constant: f64,
}

impl Affine {
    fn new(gradient: Vec3, zero: Vec3) -> Self {
        Self { gradient, constant: -gradient.dot(zero) }
    }

    #[inline]
    fn at(&self, p: Vec3) -> f64 {
        self.gradient.x * p.x + self.gradient.y * p.y + self.gradient.z * p.z + self.constant
    }

    /// At both ends of a segment; two lanes of one instruction each.
    #[inline]
    fn ends(&self, probe: &Probe) -> [f64; 2] {
        let [x, y, z] = &probe.axes;
        [0, 1].map(|k| self.gradient.x * x[k] + self.gradient.y * y[k] + self.gradient.z * z[k] + self.constant)
    }
}

/// A triangle or a parallelogram, ready to be tested.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    height: Affine,
    u: Affine,
    v: Affine,
    /// What U, V and D may be wrong by, over M².
    doubt: f64,
    /// 1 for a triangle, 0 for a parallelogram: U + V − D is max(U, V) + triangle · min(U, V) − D.
    triangle: f64,
    /// Index of the patch it belongs to.
    pub patch: u32,
}

/// What a segment does to a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Crossing {
    /// It misses for sure.
    Miss,
    /// It crosses for sure, `fraction` of the way from p to q.
    Hit {
        /// Between 0 and 1.
        fraction: f64,
    },
    /// It crosses the plane so close to the outline that rounding could decide.
    Doubt {
        /// Between 0 and 1.
        fraction: f64,
    },
}

impl Facet {
    /// The triangle with the given corners.
    pub(crate) fn triangle([a, b, c]: [Vec3; 3], patch: u32) -> Self {
        Self::new(a, [b - a, c - a], 0.0, patch)
    }

    /// The parallelogram with the corners b and c beside a. `slack` is the distance by which the fourth corner may be
    /// elsewhere, over the extent of the scene.
    pub(crate) fn parallelogram([a, b, c]: [Vec3; 3], slack: f64, patch: u32) -> Self {
        Self { triangle: 0.0, ..Self::new(a, [b - a, c - a], slack, patch) }
    }

    fn new(a: Vec3, [b, c]: [Vec3; 2], slack: f64, patch: u32) -> Self {
        let cross = b.cross(c);
        let area = cross.length();
        let (u, v) = (c.cross(cross / area) / area, (cross / area).cross(b) / area);
        let condition = b.length() * c.length() / area;
        Self {
            height: Affine::new(cross / area, a),
            u: Affine::new(u, a),
            v: Affine::new(v, a),
            doubt: (u.length() + v.length()) * (ROUNDINGS * f64::EPSILON * condition + slack),
            triangle: 1.0,
            patch,
        }
    }

    /// Tests the segment. An end within its tolerance of the plane does not cross it.
    #[inline]
    pub(crate) fn crossing(&self, probe: &Probe) -> Crossing {
        let [s_p, s_q] = self.height.ends(probe);
        if !((s_p * s_q < 0.0) & (s_p.abs() > probe.near[0]) & (s_q.abs() > probe.near[1])) {
            return Crossing::Miss;
        }
        let side = s_q.signum();
        let [u_p, u_q] = self.u.ends(probe);
        let [v_p, v_q] = self.v.ends(probe);
        let u = side * (u_p * s_q - u_q * s_p);
        let v = side * (v_p * s_q - v_q * s_p);
        let d = (s_q - s_p).abs();
        let (least, most) = if u < v { (u, v) } else { (v, u) };
        let rest = d - (most + self.triangle * least);
        let inside = if least < rest { least } else { rest };
        let doubt = self.doubt * probe.reach_squared;
        if inside < -doubt {
            return Crossing::Miss;
        }
        let fraction = s_p.abs() / d;
        if inside > doubt { Crossing::Hit { fraction } } else { Crossing::Doubt { fraction } }
    }

    /// Height of a point over the plane, m.
    #[inline]
    pub(crate) fn height(&self, point: Vec3) -> f64 {
        self.height.at(point)
    }
}
