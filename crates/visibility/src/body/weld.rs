//! Corners with the same coordinates get the same number.

use std::collections::{HashMap, HashSet};

use fredholm_mesh::{Patch, Vec3};

/// A flat convex polygon by the numbers of its corners, counter-clockwise about its normal.
#[derive(Clone, Debug)]
pub(super) struct Polygon {
    pub corners: Vec<u32>,
    pub normal: Vec3,
    /// m².
    pub area: f64,
}

impl Polygon {
    /// Its sides, from corner to corner.
    pub fn sides(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(&a, &b)| [a, b])
    }

    /// The same polygon seen from behind.
    pub fn flipped(mut self) -> Self {
        self.corners.reverse();
        self.normal = -self.normal;
        self
    }
}

/// A side without direction.
pub(super) fn undirected([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The corners of all patches, each once, and the patches as polygons; a patch that repeats
/// another, or its back, is left out.
pub(super) fn weld(patches: &[Patch]) -> (Vec<Vec3>, Vec<Polygon>) {
    let (mut numbers, mut points) = (HashMap::new(), Vec::new());
    let mut seen = HashSet::new();
    let mut polygons = Vec::with_capacity(patches.len());
    for patch in patches {
        let corners: Vec<u32> =
            patch.corners().iter().map(|&x| number(x, &mut numbers, &mut points)).collect();
        let mut sorted = corners.clone();
        sorted.sort_unstable();
        if seen.insert(sorted) {
            polygons.push(Polygon { corners, normal: patch.normal(), area: patch.area() });
        }
    }
    (points, polygons)
}

fn number(x: Vec3, numbers: &mut HashMap<[u64; 3], u32>, points: &mut Vec<Vec3>) -> u32 {
    // Adding 0 makes −0 and 0 the same.
    let key = (x + Vec3::ZERO).to_array().map(f64::to_bits);
    *numbers.entry(key).or_insert_with(|| {
        points.push(x);
        points.len() as u32 - 1
    })
}

/// Lists of polygons that hang together through sides for which `joins` holds, each list and the
/// whole by rising index.
pub(super) fn connected(polygons: &[Polygon], joins: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut sides: Vec<([u32; 2], usize)> = Vec::new();
    for (k, polygon) in polygons.iter().enumerate() {
        sides.extend(polygon.sides().map(|side| (undirected(side), k)));
    }
    sides.sort_unstable();
    let mut leader: Vec<usize> = (0..polygons.len()).collect();
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        for pair in run.windows(2) {
            if joins(pair[0].1, pair[1].1) {
                let (a, b) = (find(&mut leader, pair[0].1), find(&mut leader, pair[1].1));
                leader[a.max(b)] = a.min(b);
            }
        }
    }
    let mut lists = vec![Vec::new(); polygons.len()];
    for k in 0..polygons.len() {
        let first = find(&mut leader, k);
        lists[first].push(k);
    }
    lists.retain(|list| !list.is_empty());
    lists
}

fn find(leader: &mut [usize], mut k: usize) -> usize {
    while leader[k] != k {
        leader[k] = leader[leader[k]];
        k = leader[k];
    }
    k
}
