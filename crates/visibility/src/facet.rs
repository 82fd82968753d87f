//! Does a segment cross a triangle or a parallelogram? Decided at once, or left to exact arithmetic
//! where in doubt.
//!
//! A facet has a corner a, two edges b and c from it, and the unit normal n. Every point x has the
//! height s = n·(x − a) over its plane, and the coordinates u and v with x = a + u b + v c + s n. A
//! segment from p to q whose ends are on different sides crosses the plane where the height is
//! zero; there u and v are U/D and V/D with
//!
//! ```text
//! D = |s_p| + |s_q|,   U = u_p |s_q| + u_q |s_p|,   V = v_p |s_q| + v_q |s_p|.
//! ```
//!
//! The crossing is inside where U ≥ 0, V ≥ 0 and, for a triangle, U + V ≤ D, for a parallelogram,
//! max(U, V) ≤ D. Swapping p and q changes no bit of this.
//!
//! Heights are f64, since they are compared with the tolerance; u and v are f32. With g = |∇u| +
//! |∇v|, the condition number κ = |b| |c| / |b × c| and the length M that bounds all distances in
//! the query, roundings change U, V and D by less than a small multiple of g M (ε₃₂ D + κ ε₆₄ M).
//! What is closer to zero than that is *in doubt*. A fourth corner that lies the distance h off the
//! parallelogram changes them by less than 3 g M h.
//!
//! All lengths are local, that is over the extent of the scene.

use fredholm_mesh::Vec3;
use glam::{Vec4, Vec4Swizzles};

use crate::probe::Probe;

/// Counts of the roundings on the way to U, V and D, about twice what a term by term estimate
/// gives.
const ROUNDINGS_32: f64 = 16.0;
const ROUNDINGS_64: f64 = 64.0;
/// The factor 3 above, over the least M, which is ½.
const ROUNDING_FACTOR: f64 = 6.0;

/// A triangle or a parallelogram: its plane, and what is known of it beside its [`Slopes`]. Where a
/// segment surely crosses it nothing else is needed, so that it is one line of memory: rays through
/// large scenes wait for little else.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Facet {
    normal: Vec3,
    offset: f64,
    /// Roundings of U, V and D, over M D and over M².
    doubt: [f32; 2],
    /// 1 for a triangle, 0 for a parallelogram: the third condition is max(U, V) + triangle ·
    /// min(U, V) ≤ D.
    pub triangle: f32,
    /// Index of the patch it belongs to.
    pub patch: u32,
}

/// The coordinates u and v of a facet as functions of the point, for the test of a segment that may
/// cross it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slopes {
    /// ∂u/∂x, ∂v/∂x, ∂u/∂y, ∂v/∂y.
    xy: Vec4,
    /// ∂u/∂z, ∂v/∂z and the values of u and v at 0.
    z: Vec4,
}

/// Where a segment crosses the plane of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Meeting {
    /// The share of the way from p to q.
    pub fraction: f64,
    /// Whether the facet turns its back to the start.
    pub is_back: bool,
}

/// What a segment does to a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Crossing {
    /// It misses for sure.
    Miss,
    /// It crosses for sure.
    Hit(Meeting),
    /// It crosses the plane, so close to the outline that rounding could decide.
    Doubt(Meeting),
}

impl Facet {
    /// The triangle with the corner a and the edges b and c from it.
    pub(crate) fn triangle(a: Vec3, edges: [Vec3; 2], patch: u32) -> (Self, Slopes) {
        Self::new(a, edges, 0.0, patch)
    }

    /// The parallelogram with the corner a and the edges b and c from it, whose fourth corner may
    /// lie the distance `slack` off.
    pub(crate) fn parallelogram(a: Vec3, edges: [Vec3; 2], slack: f64, patch: u32) -> (Self, Slopes) {
        let (facet, slopes) = Self::new(a, edges, slack, patch);
        (Self { triangle: 0.0, ..facet }, slopes)
    }

    fn new(a: Vec3, [b, c]: [Vec3; 2], slack: f64, patch: u32) -> (Self, Slopes) {
        let cross = b.cross(c);
        let area = cross.length();
        let normal = cross / area;
        let (u, v) = (c.cross(normal) / area, normal.cross(b) / area);
        let gradient = u.length() + v.length();
        let blur = ROUNDINGS_64 * f64::EPSILON * b.length() * c.length() / area + ROUNDING_FACTOR * slack;
        let vector = |[a, b, c, d]: [f64; 4]| Vec4::new(a as f32, b as f32, c as f32, d as f32);
        let facet = Self {
            normal,
            offset: -normal.dot(a),
            doubt: [ROUNDINGS_32 * f64::from(f32::EPSILON), blur].map(|share| (gradient * share) as f32),
            triangle: 1.0,
            patch,
        };
        (facet, Slopes { xy: vector([u.x, v.x, u.y, v.y]), z: vector([u.z, v.z, -u.dot(a), -v.dot(a)]) })
    }

    /// Heights of the ends of a segment.
    #[inline]
    fn heights(&self, probe: &Probe) -> [f64; 2] {
        let [x, y, z] = &probe.axes;
        let n = self.normal;
        [0, 1].map(|k| n.x * x[k] + n.y * y[k] + n.z * z[k] + self.offset)
    }

    /// Where a segment that surely crosses the facet does so.
    #[inline]
    pub(crate) fn meeting(&self, probe: &Probe) -> Meeting {
        let [s_p, s_q] = self.heights(probe);
        Meeting { fraction: s_p.abs() / (s_p.abs() + s_q.abs()), is_back: s_p < 0.0 }
    }

    /// Tests the segment. An end within its tolerance of the plane does not cross it.
    #[inline]
    pub(crate) fn crossing(&self, slopes: &Slopes, probe: &Probe) -> Crossing {
        let [s_p, s_q] = self.heights(probe);
        if !((s_p * s_q < 0.0) & (s_p.abs() > probe.near[0]) & (s_q.abs() > probe.near[1])) {
            return Crossing::Miss;
        }
        let is_back = s_p < 0.0;
        let (s_p, s_q) = (s_p.abs(), s_q.abs());
        let d = s_p + s_q;
        let meeting = Meeting { fraction: s_p / d, is_back };
        let (inside, doubt) = self.inside(slopes, probe, [s_p, s_q, d].map(|s| s as f32));
        // Not a number, where f32 overflows, is in doubt.
        if inside < -doubt {
            Crossing::Miss
        } else if inside > doubt {
            Crossing::Hit(meeting)
        } else {
            Crossing::Doubt(meeting)
        }
    }

    /// The least of what must be positive, and how wrong it can be.
    #[inline]
    fn inside(&self, slopes: &Slopes, probe: &Probe, [s_p, s_q, d]: [f32; 3]) -> (f32, f32) {
        let [x, y, z] = probe.lanes;
        let (xy, z1) = (slopes.xy, slopes.z);
        let uv = xy.xxyy() * x + xy.zzww() * y + z1.xxyy() * z + z1.zzww();
        let terms = uv * Vec4::new(s_q, s_p, s_q, s_p);
        let (u, v) = (terms.x + terms.y, terms.z + terms.w);
        let (least, most) = if u < v { (u, v) } else { (v, u) };
        let rest = d - (most + self.triangle * least);
        let doubt = probe.reach * (self.doubt[0] * d + self.doubt[1] * probe.reach);
        (if least < rest { least } else { rest }, doubt)
    }

    /// The unit normal and the offset: the height of x is n·x + offset.
    pub(crate) fn plane(&self) -> [f64; 4] {
        [self.normal.x, self.normal.y, self.normal.z, self.offset]
    }

    /// g, and what changes U, V and D whatever they are rounded to, over M².
    pub(crate) fn doubts(&self) -> (f32, f32) {
        (self.doubt[0] / (ROUNDINGS_32 as f32 * f32::EPSILON), self.doubt[1])
    }

    /// Height of a point over the plane.
    #[inline]
    pub(crate) fn height(&self, point: Vec3) -> f64 {
        self.normal.dot(point) + self.offset
    }
}

impl Slopes {
    /// ∂/∂x, ∂/∂y, ∂/∂z and the value at 0 of u and of v.
    pub(crate) fn rows(&self) -> [[f32; 4]; 2] {
        let ([u_x, v_x, u_y, v_y], [u_z, v_z, u, v]) = (self.xy.to_array(), self.z.to_array());
        [[u_x, u_y, u_z, u], [v_x, v_y, v_z, v]]
    }
}
