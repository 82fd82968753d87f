//! Two facing unit squares at distance 1, of quads or of triangles: x = e^{x/2} cos y + z sin(x +
//! y), Lambert's kernel, ρ = 0.8.

use super::{Manufactured, resolved};
use crate::{Chart, FlatChart};
use fredholm_coupling::kernel::lambert;
use fredholm_mesh::{Patch, Vec3};

/// Points a direction of the rule for b: the error falls by the factor 4.2² a point.
const SOURCE_RULE_POINTS: usize = 12;

/// Two facing squares of quads.
#[must_use]
pub fn facing_squares() -> Manufactured {
    build("facing squares of quads", squares)
}

/// Two facing squares of triangles.
#[must_use]
pub fn facing_triangles() -> Manufactured {
    build("facing squares of triangles", triangles)
}

fn build(name: &'static str, charts: fn(usize) -> Vec<Box<dyn Chart>>) -> Manufactured {
    let irradiance = resolved(&squares(1), SOURCE_RULE_POINTS, lambert, exact, normal);
    Manufactured {
        name,
        curved: false,
        reflectance: 0.8,
        pieces: 2,
        kernel: Box::new(lambert),
        charts,
        exact,
        irradiance: Box::new(irradiance),
        peak: None,
    }
}

fn exact(p: Vec3) -> f64 {
    (0.5 * p.x).exp() * p.y.cos() + p.z * (p.x + p.y).sin()
}

fn normal(p: Vec3) -> Vec3 {
    if p.z < 0.5 { Vec3::Z } else { Vec3::NEG_Z }
}

/// Corners of cell (i, j) of a square at height z, lit upwards below and downwards above.
fn cell(n: usize, i: usize, j: usize, z: f64) -> [Vec3; 4] {
    let at = |i: usize, j: usize| Vec3::new(i as f64 / n as f64, j as f64 / n as f64, z);
    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    if z < 0.5 { [a, b, c, d] } else { [a, d, c, b] }
}

fn cells(n: usize) -> impl Iterator<Item = [Vec3; 4]> {
    let all = move |z| (0..n * n).map(move |k| cell(n, k / n, k % n, z));
    all(0.0).chain(all(1.0))
}

fn chart(patch: Patch) -> Box<dyn Chart> {
    Box::new(FlatChart(patch))
}

fn squares(n: usize) -> Vec<Box<dyn Chart>> {
    // Squares are flat and convex: none is left out.
    cells(n).filter_map(|corners| Patch::quad(corners).ok().flatten()).map(chart).collect()
}

fn triangles(n: usize) -> Vec<Box<dyn Chart>> {
    let halves = |[a, b, c, d]: [Vec3; 4]| [[a, b, c], [c, d, a]];
    cells(n).flat_map(halves).filter_map(|corners| Patch::triangle(corners).ok()).map(chart).collect()
}
