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
    /// What is left in the last lanes of the last block nobody asks for.
    edges: Vec<[Lanes3; 2]>,
    terms: Vec<Lanes>,
    /// Where the edges of each polygon end.
    ends: Vec<usize>,
}

impl Rims {
    pub(super) fn clear(&mut self) {
        self.ends.clear();
    }

    fn len(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Appends a polygon.
    pub(super) fn push(&mut self, corners: &[Vec3]) {
        let (start, end) = (self.len(), self.len() + corners.len());
        self.ends.push(end);
        let blocks = end.div_ceil(LANES);
        if self.edges.len() < blocks {
            self.edges.resize(blocks, Default::default());
        }
        let Some((first, others)) = corners.split_first() else { return };
        let mut from = first;
        for (place, to) in (start..end).zip(others.iter().chain([first])) {
            let ([starts, ends], m) = (&mut self.edges[place / LANES], place % LANES);
            (starts[0][m], starts[1][m], starts[2][m]) = (from.x, from.y, from.z);
            (ends[0][m], ends[1][m], ends[2][m]) = (to.x, to.y, to.z);
            from = to;
        }
    }

    /// The form factors of all polygons from points with normal `n`.
    pub(super) fn factors(&mut self, n: Vec3) -> impl Iterator<Item = f64> + '_ {
        let edges = &self.edges[..self.len().div_ceil(LANES)];
        self.arch.dispatch(Terms { edges, n, found: &mut self.terms });
        let (terms, mut start) = (&self.terms, 0);
        self.ends.iter().map(move |&end| {
            let sum = (start..end).map(|k| terms[k / LANES][k % LANES]).sum();
            start = end;
            factor(sum)
        })
    }
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
