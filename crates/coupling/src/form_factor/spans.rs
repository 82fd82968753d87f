//! Which planes through an edge and a corner pass through a polygon: eight edges at once.
//!
//! A plane passes where the corners of the polygon lie on both sides of it: det(b − a, w − a, x − a) has both signs. One lane an edge a b. Lengths in metres.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::lanes::{LANES, Lanes3, dot, each};
use fredholm_mesh::Vec3;
use pulp::{Arch, NullaryFnOnce};

/// The answers for some edges and corners. Buffers are kept.
#[derive(Clone, Debug, Default)]
pub(super) struct Spans {
    arch: Arch,
    corners: usize,
    /// For each eight edges, a byte a corner.
    bits: Vec<u8>,
}

impl Spans {
    /// Asks about the planes of all `edges` with all `corners`.
    pub(super) fn ask(&mut self, edges: &[[Vec3; 2]], corners: &[Vec3], polygon: &[Vec3]) {
        self.corners = corners.len();
        self.bits.clear();
        self.arch.dispatch(Ask { edges, corners, polygon, bits: &mut self.bits });
    }

    /// Whether the plane of this edge and this corner passes through the polygon.
    #[inline]
    pub(super) fn passes(&self, edge: usize, corner: usize) -> bool {
        self.bits[edge / LANES * self.corners + corner] >> (edge % LANES) & 1 == 1
    }
}

/// A question, compiled for each width of vectors: a closure would be compiled once, for the narrowest.
struct Ask<'a> {
    edges: &'a [[Vec3; 2]],
    corners: &'a [Vec3],
    polygon: &'a [Vec3],
    bits: &'a mut Vec<u8>,
}

impl NullaryFnOnce for Ask<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for edges in self.edges.chunks(LANES) {
            let (start, along) = lanes(edges);
            for &corner in self.corners {
                self.bits.push(both_sides(&start, &along, corner, self.polygon));
            }
        }
    }
}

/// Starts and directions of edges; edges that lack span no plane.
#[inline(always)]
fn lanes(edges: &[[Vec3; 2]]) -> (Lanes3, Lanes3) {
    let (mut start, mut along) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
    for (m, &[a, b]) in edges.iter().enumerate() {
        let e = b - a;
        (start[0][m], start[1][m], start[2][m]) = (a.x, a.y, a.z);
        (along[0][m], along[1][m], along[2][m]) = (e.x, e.y, e.z);
    }
    (start, along)
}

/// One bit a lane.
#[inline(always)]
fn both_sides(start: &Lanes3, along: &Lanes3, corner: Vec3, polygon: &[Vec3]) -> u8 {
    let across = cross(along, &from(corner, start));
    let (mut low, mut high) = ([0.0; LANES], [0.0; LANES]);
    for &x in polygon {
        let height = dot(&across, &from(x, start));
        low = each(|m| if height[m] < low[m] { height[m] } else { low[m] });
        high = each(|m| if height[m] > high[m] { height[m] } else { high[m] });
    }
    let mut bits = 0;
    for m in 0..LANES {
        bits |= u8::from(low[m] < 0.0 && high[m] > 0.0) << m;
    }
    bits
}

/// x − start in every lane.
#[inline(always)]
fn from(x: Vec3, start: &Lanes3) -> Lanes3 {
    [each(|m| x.x - start[0][m]), each(|m| x.y - start[1][m]), each(|m| x.z - start[2][m])]
}

#[inline(always)]
fn cross(a: &Lanes3, b: &Lanes3) -> Lanes3 {
    [
        each(|m| a[1][m] * b[2][m] - b[1][m] * a[2][m]),
        each(|m| a[2][m] * b[0][m] - b[2][m] * a[0][m]),
        each(|m| a[0][m] * b[1][m] - b[0][m] * a[1][m]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_pass_where_corners_lie_on_both_sides() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let upright = |x: f64| [Vec3::new(x, 0.0, 1.0), Vec3::new(x, 1.0, 1.0)];
        let edges: Vec<_> = (0..12).map(|k| upright(f64::from(k) * 0.1 - 0.05)).collect();
        let mut spans = Spans::default();
        spans.ask(&edges, &[Vec3::Z * 2.0, Vec3::new(0.55, 0.0, 2.0)], &square);
        for k in 0..12 {
            assert_eq!(spans.passes(k, 1), (4..9).contains(&k), "{k}");
        }
        assert!(!spans.passes(0, 0) && spans.passes(5, 0) && !spans.passes(6, 0));
    }
}
