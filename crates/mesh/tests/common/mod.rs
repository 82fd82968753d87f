//! What several tests need.
#![allow(dead_code, reason = "each test program uses a part")]
#![allow(clippy::unwrap_used, clippy::missing_panics_doc, reason = "a test may panic")]

use std::collections::BTreeSet;

use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Patch, Shape, Vec3, Weld};

pub fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A mesh of one shape.
pub fn mesh(shape: &Shape, cutting: &Cutting) -> Mesh {
    let mut builder = MeshBuilder::default();
    builder.surface("shape", 0);
    builder.add(shape, cutting).unwrap();
    builder.build()
}

pub fn whole() -> Cutting {
    Cutting::default()
}

pub fn counts(u: usize, v: usize) -> Cutting {
    Cutting { lines: Lines::Counts { u, v }, ..Cutting::default() }
}

pub fn area(mesh: &Mesh) -> f64 {
    mesh.patches().map(Patch::area).sum()
}

/// Σ area · normal: zero for a closed surface.
pub fn area_vector(mesh: &Mesh) -> Vec3 {
    mesh.patches().map(|patch| patch.normal() * patch.area()).sum()
}

/// Volume enclosed, by the divergence theorem: ⅓ Σ area · normal · centroid.
pub fn volume(mesh: &Mesh) -> f64 {
    mesh.patches().map(|patch| patch.area() * patch.normal().dot(patch.centroid()) / 3.0).sum()
}

/// Number of welded edges that only one leaf has. Edges of two leaves must run in opposite
/// directions, and no edge may belong to more.
pub fn border_edges(mesh: &Mesh) -> usize {
    let welded = mesh.welded(Weld::Everywhere);
    let mut edges = BTreeSet::new();
    for patch in welded.patches() {
        for (i, &from) in patch.iter().enumerate() {
            let to = patch[(i + 1) % patch.len()];
            assert_ne!(from, to, "an edge has shrunk to a point");
            assert!(edges.insert((from, to)), "two leaves have an edge in the same direction");
        }
    }
    edges.iter().filter(|(from, to)| !edges.contains(&(*to, *from))).count()
}

pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected} ± {tolerance}");
}

pub fn assert_near(found: Vec3, expected: Vec3, tolerance: f64) {
    assert!(found.distance(expected) <= tolerance, "found {found}, expected {expected} ± {tolerance}");
}
