//! Point to polygon in closed form for many polygons at once: all their edges one behind the other, one lane an edge.
//!
//! The formula and its bits are those of [`point_to_polygon`](super::point_to_polygon).

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::lanes::{LANES, Lanes, Lanes3};
use super::point_polygon::{edge_terms, factor};
use fredholm_mesh::Vec3;
use pulp::{Arch, NullaryFnOnce};

/// Polygons relative to the points that see them. Buffers are kept.
#[derive(Clone, Debug, Default)]
pub(super) struct Rims {
    arch: Arch,
    edges: Vec<[Lanes3; 2]>,
    terms: Vec<Lanes>,
    /// Where the edges of each polygon end.
    ends: Vec<usize>,
}

impl Rims {
    pub(super) fn clear(&mut self) {
        self.edges.clear();
        self.ends.clear();
    }

    fn len(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Appends a polygon.
    pub(super) fn push(&mut self, corners: &[Vec3]) {
        let [.., last] = corners else { return self.ends.push(self.len()) };
        let (mut place, end) = (self.len(), self.len() + corners.len());
        self.edges.resize(end.div_ceil(LANES), Default::default());
        let mut from = last;
        for to in corners {
            let [starts, ends] = &mut self.edges[place / LANES];
            set(starts, place % LANES, from);
            set(ends, place % LANES, to);
            (from, place) = (to, place + 1);
        }
        self.ends.push(end);
    }

    /// The form factors of all polygons from points with normal `n`.
    pub(super) fn factors(&mut self, n: Vec3) -> impl Iterator<Item = f64> + '_ {
        self.arch.dispatch(Terms { edges: &self.edges, n, found: &mut self.terms });
        let (terms, mut start) = (&self.terms, 0);
        self.ends.iter().map(move |&end| {
            let sum = (start..end).map(|k| terms[k / LANES][k % LANES]).sum();
            start = end;
            factor(sum)
        })
    }
}

#[inline]
fn set(lanes: &mut Lanes3, m: usize, x: &Vec3) {
    (lanes[0][m], lanes[1][m], lanes[2][m]) = (x.x, x.y, x.z);
}

/// The terms of all edges, compiled for each width of vectors: a closure would be compiled once, for the narrowest.
struct Terms<'a> {
    edges: &'a [[Lanes3; 2]],
    n: Vec3,
    found: &'a mut Vec<Lanes>,
}

impl NullaryFnOnce for Terms<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.found.clear();
        for [from, to] in self.edges {
            self.found.push(edge_terms(self.n, from, to));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::point_to_polygon;

    #[test]
    fn polygons_have_the_factors_that_they_have_alone() {
        let corner =
            |k: usize| Vec3::new((0.7 * k as f64).sin(), (1.3 * k as f64).cos(), 0.2 * (k % 7 + 1) as f64);
        let polygons: Vec<Vec<Vec3>> = (3..9)
            .map(|n| (0..n).map(|k| corner(5 * n + k) * if n < 6 { 0.01 } else { 1.0 } + Vec3::Z).collect())
            .collect();
        let mut rims = Rims::default();
        for polygon in &polygons {
            rims.push(polygon);
        }
        let alone = polygons.iter().map(|polygon| point_to_polygon(Vec3::Z, polygon.iter().copied()));
        assert!(rims.factors(Vec3::Z).eq(alone));
    }
}
