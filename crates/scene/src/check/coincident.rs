//! Faces that lie on each other and are lit on the same side: light would be counted twice.

use std::collections::BTreeMap;

use fredholm_mesh::{Mesh, Vec3};

use super::Warning;
use crate::scene::Scene;

/// Distance, relative to the largest coordinate, within which centroids coincide.
const RELATIVE: f64 = 1e-9;

pub(super) fn check(scene: &Scene, mesh: &Mesh) -> Vec<Warning> {
    let warning = |((first, second), count): (&(usize, usize), &usize)| {
        let name = |surface: usize| &mesh.surfaces()[surface].name;
        let what = format!(
            "{count} elements of `{}` lie on elements of `{}`, lit on the same side",
            name(*second),
            name(*first)
        );
        scene.warning(*second, what, "remove one of the surfaces, or reverse the corners of one")
    };
    pairs(mesh).iter().map(warning).collect()
}

/// Pairs of surfaces, and how many of their elements coincide.
fn pairs(mesh: &Mesh) -> BTreeMap<(usize, usize), usize> {
    let extent =
        mesh.patches().flat_map(|p| p.corners().iter()).map(|c| c.abs().max_element()).fold(0.0, f64::max);
    let grid = |centroid: Vec3| (centroid / (RELATIVE * extent)).round().to_array().map(|x| x as i64);
    let mut keys: Vec<_> = (0..mesh.len()).map(|leaf| (grid(mesh.patch(leaf).centroid()), leaf)).collect();
    keys.sort_unstable();
    let mut pairs = BTreeMap::new();
    for near in keys.chunk_by(|a, b| a.0 == b.0) {
        for couple in near.windows(2) {
            let (a, b) = (couple[0].1, couple[1].1);
            if same(mesh, a, b) {
                *pairs.entry((mesh.surface_of(a), mesh.surface_of(b))).or_default() += 1;
            }
        }
    }
    pairs
}

/// Whether two leaves with the same centroid have the same area and lit side.
fn same(mesh: &Mesh, a: usize, b: usize) -> bool {
    let (a, b) = (mesh.patch(a), mesh.patch(b));
    a.normal().dot(b.normal()) > 1.0 - RELATIVE && (a.area() - b.area()).abs() <= 1e-6 * a.area()
}
