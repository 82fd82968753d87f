//! Scenes and random numbers for the tests.

use fredholm_mesh::{Patch, Vec3};

/// The generator `SplitMix64`.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In [−1, 1)³.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    pub fn index(&mut self, len: usize) -> usize {
        (self.bits() % len as u64) as usize
    }

    /// A point of the patch; every part of it is reached.
    pub fn on(&mut self, patch: &Patch) -> Vec3 {
        let (u, v) = (self.unit(), self.unit());
        if patch.sides() == 3 && u + v > 1.0 { patch.point(1.0 - u, 1.0 - v) } else { patch.point(u, v) }
    }
}

pub fn quad(corners: [Vec3; 4]) -> Patch {
    Patch::quad(corners).unwrap().unwrap()
}

pub fn triangle(corners: [Vec3; 3]) -> Patch {
    Patch::triangle(corners).unwrap()
}

/// The vector turned about a fixed axis (Rodrigues' formula).
pub fn turned(v: Vec3, turn: f64) -> Vec3 {
    let axis = Vec3::new(0.3, -0.5, 0.9).normalize();
    v * turn.cos() + axis.cross(v) * turn.sin() + axis * (axis.dot(v) * (1.0 - turn.cos()))
}

/// The six sides of a box turned about an axis, lit on the outside; reversed, on the inside.
pub fn cuboid(centre: Vec3, half: Vec3, turn: f64, reversed: bool) -> Vec<Patch> {
    let axis = Vec3::new(0.3, -0.5, 0.9).normalize();
    let about =
        |v: Vec3| v * turn.cos() + axis.cross(v) * turn.sin() + axis * (axis.dot(v) * (1.0 - turn.cos()));
    let [x, y, z] = [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z].map(about);
    let corner = |i: f64, j: f64, k: f64| centre + x * i + y * j + z * k;
    let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut patches = Vec::new();
    for side in [-1.0, 1.0] {
        for axis in 0..3 {
            let corners = square.map(|(u, v)| match axis {
                0 => corner(side, u, v),
                1 => corner(v, side, u),
                _ => corner(u, v, side),
            });
            let patch = quad(corners);
            patches.push(if (side > 0.0) == reversed { patch.flipped() } else { patch });
        }
    }
    patches
}

/// Every quad as two triangles, every triangle as it is.
pub fn triangulated(patches: &[Patch]) -> Vec<Patch> {
    let halves = |p: &Patch| match *p.corners() {
        [a, b, c, d] => vec![triangle([a, b, c]), triangle([a, c, d])],
        _ => vec![*p],
    };
    patches.iter().flat_map(halves).collect()
}

/// A room of 2 × 2 × 2 around the origin with two boxes in it.
pub fn furnished() -> Vec<Patch> {
    let mut patches = cuboid(Vec3::ZERO, Vec3::ONE, 0.0, true);
    patches.extend(cuboid(Vec3::new(-0.4, 0.3, -0.5), Vec3::new(0.25, 0.3, 0.5), 0.0, false));
    patches.extend(cuboid(Vec3::new(0.4, -0.3, -0.2), Vec3::new(0.2, 0.3, 0.25), 0.7, false));
    patches
}

/// A sphere of 20 · 4^`level` triangles of unit radius.
pub fn sphere(level: usize) -> Vec<[Vec3; 3]> {
    let g = 0.5 * (1.0 + 5.0f64.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        corners
            .extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)].map(Vec3::normalize));
    }
    let side = 2.0 / g.hypot(1.0);
    let near = |i: usize, j: usize| (corners[i].distance(corners[j]) - side).abs() < 1e-9;
    let mut faces = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        if near(i, j) && near(j, k) && near(k, i) {
            faces.push([corners[i], corners[j], corners[k]]);
        }
    }
    assert_eq!(faces.len(), 20);
    (0..level).fold(faces, |faces, _| faces.iter().flat_map(split).collect())
}

fn split(&[a, b, c]: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    // Normalising is the same for a + b and b + a, so neighbours share their corners bit for bit.
    let [d, e, f] = [a + b, b + c, c + a].map(Vec3::normalize);
    [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
}
