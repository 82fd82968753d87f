//! The sign s(p, q) of a pair, for one treatment of shadows.

use crate::{Facet, Kind, Shadow};
use fredholm_mesh::Vec3;

/// Factors of one facet where the other lies behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sides {
    /// As a source.
    pub(crate) source: f64,
    /// As an observer.
    pub(crate) observer: f64,
}

impl Sides {
    pub(crate) fn of(facet: &Facet, shadow: Shadow) -> Self {
        let [source, observer] = match (shadow, facet.kind) {
            (Shadow::Geometric, Kind::Closed) => [0.0, 0.0],
            (Shadow::Radiated, Kind::Closed) => [1.0, 0.0],
            (Shadow::Geometric | Shadow::Radiated, Kind::Sheet) => [1.0, -1.0],
            (Shadow::Exact | Shadow::ExactDual, _) => [1.0, 1.0],
            (Shadow::Thesis, Kind::Closed) => [-1.0, 0.0],
            (Shadow::Thesis, Kind::Sheet) => [-1.0, 1.0],
        };
        Self { source, observer }
    }
}

/// s(p, q), without what blocks; `d` runs from the source q to the observer p.
pub(crate) fn sign(p: &Facet, q: &Facet, d: Vec3, shadow: Shadow) -> f64 {
    let source = if d.dot(q.normal) > 0.0 { 1.0 } else { Sides::of(q, shadow).source };
    let observer = if (-d).dot(p.normal) > 0.0 { 1.0 } else { Sides::of(p, shadow).observer };
    source * observer
}
