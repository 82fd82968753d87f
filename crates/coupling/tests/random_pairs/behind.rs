//! Random pairs behind one to six things, and their exchanges to many more digits.

use crate::generator::{Kind, Random, axes, pair, patch, polygon};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;

/// Sets of pairs, by the seeds they start from, and pairs of each.
pub const SETS: [u64; 5] = [5, 21, 22, 23, 24];
pub const PAIRS: usize = 500;

/// The exchange that two patches would have squarely facing each other, or the smaller area where
/// that is less, m².
pub fn facing(patches: &[Patch]) -> f64 {
    let d2 = patches[0].centroid().distance_squared(patches[1].centroid());
    let [a, b] = [patches[0].area(), patches[1].area()];
    (a * b / (PI * d2)).min(a.min(b))
}

/// A point of a patch, even in its parameters.
fn point(patch: &Patch, random: &mut Random) -> Vec3 {
    let (u, v) = (random.between(0.1, 0.9), random.between(0.1, 0.9));
    if patch.sides() == 3 && u + v > 1.0 { patch.point(1.0 - u, 1.0 - v) } else { patch.point(u, v) }
}

/// Something between two patches: free, standing on the first, touching the second with a corner,
/// or lying on it face down.
fn occluder(a: &Patch, b: &Patch, size: f64, random: &mut Random) -> Option<Patch> {
    let (p, q) = (point(a, random), point(b, random));
    match random.below(8) {
        0 | 1 => {
            let [u, _] = axes(a.normal(), random);
            let (side, height) = (u * size, a.normal() * (size * random.between(0.3, 2.0)));
            patch(&[p, p + side, p + side + height, p + height])
        }
        2 => {
            let n = random.direction();
            let [u, v] = axes(n, random);
            patch(&[q, q + u * size, q + v * size])
        }
        3 => {
            let shrunk: Vec<Vec3> = b.flipped().corners().iter().map(|&x| q + (x - q) * 0.4).collect();
            patch(&shrunk)
        }
        _ => Some(polygon(p + (q - p) * random.between(0.1, 0.9), random.direction(), size, 1.5, random)),
    }
}

/// A pair with `count` things between, partly seen.
fn scene(count: usize, random: &mut Random) -> Vec<Patch> {
    let kind = [Kind::Near, Kind::Apart, Kind::SharedEdge, Kind::Crossing][random.below(4)];
    let mut patches = pair(kind, random).to_vec();
    while patches.len() < 2 + count {
        let size = random.scale(0.05, 0.7);
        let (a, b) = (patches[0], patches[1]);
        patches.extend(occluder(&a, &b, size, random));
    }
    patches
}

/// Pairs with one to six things between, without end.
pub fn scenes(seed: u64) -> impl Iterator<Item = Vec<Patch>> {
    let mut random = Random::new(seed);
    std::iter::repeat_with(move || {
        let count = 1 + random.below(6);
        scene(count, &mut random)
    })
}

/// Over-resolved exchanges, m², of the first [`PAIRS`] of each set that are computed by exact
/// shadows, set after set.
pub fn resolved() -> Vec<f64> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/occluded_pairs.csv");
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect()
}
