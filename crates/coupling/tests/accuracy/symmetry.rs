//! The 48 symmetries of the cube as renumberings of patches that they map onto each other.

use fredholm_mesh::{Patch, Vec3};
use std::collections::BTreeMap;

/// The places of the patches after each of the 48 symmetries of the unit cube about its centre.
pub fn renumberings(patches: &[Patch]) -> Vec<Vec<usize>> {
    let places: BTreeMap<[i64; 6], usize> =
        patches.iter().enumerate().map(|(k, p)| (key(p.centroid() - HALF, p.normal()), k)).collect();
    let image = |turn: &Turn, p: &Patch| places[&key(turn.of(p.centroid() - HALF), turn.of(p.normal()))];
    turns().iter().map(|turn| patches.iter().map(|p| image(turn, p)).collect()).collect()
}

const HALF: Vec3 = Vec3::splat(0.5);

/// A signed permutation of the axes.
struct Turn {
    axes: [usize; 3],
    signs: [f64; 3],
}

impl Turn {
    fn of(&self, x: Vec3) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|k| self.signs[k] * x[self.axes[k]]))
    }
}

fn turns() -> Vec<Turn> {
    let axes = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let signs = |bits: u32| [0, 1, 2].map(|k| if bits >> k & 1 == 0 { 1.0 } else { -1.0 });
    (0..48).map(|k| Turn { axes: axes[k / 8], signs: signs(k as u32 % 8) }).collect()
}

fn key(centre: Vec3, normal: Vec3) -> [i64; 6] {
    let rounded = |x: Vec3, k: usize| (x[k] * 1e6).round() as i64;
    std::array::from_fn(|k| if k < 3 { rounded(centre, k) } else { rounded(normal, k - 3) })
}
