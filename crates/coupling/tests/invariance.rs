//! Size, place and numbering of a scene change no factor: every F_ij of a furnished cube before and after, relative to the largest.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;

use common::{patch, v};
use fredholm_coupling::assemble;
use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_linop::PackedSymmetric;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

/// Patches of a wall of the cube along a side.
const WALL: usize = 8;

/// An n × n grid on each side of a parallelepiped, seen from inside or outside.
fn sides(corner: Vec3, edges: [Vec3; 3], n: usize, inward: bool) -> Vec<Patch> {
    let mut patches = Vec::new();
    for axis in 0..3 {
        let [u, v, w] = [0, 1, 2].map(|k| edges[(axis + k) % 3]);
        for (corner, up) in [(corner, true), (corner + w, false)] {
            let at = |i: usize, j: usize| corner + (u * i as f64 + v * j as f64) / n as f64;
            let cells = (0..n * n).map(|k| (k / n, k % n));
            let cell = |(i, j)| patch(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            patches.extend(cells.map(cell).map(|cell| if up == inward { cell } else { cell.flipped() }));
        }
    }
    patches
}

fn cube() -> Vec<Patch> {
    sides(Vec3::ZERO, Vec3::AXES, WALL, true)
}

/// The cube with a box of side 0.4 in the middle.
fn with_a_box() -> Vec<Patch> {
    let mut patches = cube();
    patches.extend(sides(Vec3::splat(0.3), Vec3::AXES.map(|axis| axis * 0.4), 4, false));
    patches
}

/// The cube with a tilted box in one corner and a triangulated ball in another.
fn with_a_tilted_box_and_a_ball() -> Vec<Patch> {
    let mut patches = cube();
    let edges = [v(0.36, 0.12, 0.09), v(-0.1, 0.3, 0.03), v(-0.05, -0.05, 0.4)];
    patches.extend(sides(v(0.2, 0.15, 0.17), edges, 2, false));
    patches.extend(ball(v(0.68, 0.7, 0.66), 0.2));
    patches
}

/// A ball of 8 × 4 faces, counter-clockwise from outside: triangles round the poles, trapezia between.
fn ball(centre: Vec3, radius: f64) -> Vec<Patch> {
    let (around, down) = (8, 4);
    let at = |i: usize, j: usize| {
        let (turn, fall) = (TAU * i as f64 / around as f64, PI * j as f64 / down as f64);
        centre + v(fall.sin() * turn.cos(), fall.sin() * turn.sin(), fall.cos()) * radius
    };
    let face = |i: usize, j: usize| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at((i + 1) % around, j + 1), at((i + 1) % around, j)];
        if j == 0 {
            patch(&[a, b, c])
        } else if j + 1 == down {
            patch(&[a, b, d])
        } else {
            patch(&[a, b, c, d])
        }
    };
    (0..around * down).map(|k| face(k / down, k % down)).collect()
}

/// The same patches at another size and place.
fn moved(patches: &[Patch], scale: f64, shift: Vec3) -> Vec<Patch> {
    let put = |p: &Patch| patch(&p.corners().iter().map(|&x| x * scale + shift).collect::<Vec<_>>());
    patches.iter().map(put).collect()
}

/// A_i F_ij of all pairs.
fn exchanges(patches: &[Patch], tolerance: f64) -> PackedSymmetric<f64> {
    let occluders = Occluders::new(patches).unwrap();
    let integrator = PairIntegrator::new(patches, &occluders, tolerance);
    assemble(&integrator, &|_, _| ControlFlow::Continue(())).unwrap().matrix
}

/// The k-th place of a fixed random order, by the linear congruential generator of Numerical Recipes.
fn shuffled(n: usize) -> Vec<usize> {
    let mut state = 7u32;
    let mut order: Vec<usize> = (0..n).collect();
    for k in (1..n).rev() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        order.swap(k, (u64::from(state) * (k as u64 + 1) >> 32) as usize);
    }
    order
}

/// A matrix to compare with.
struct Scene {
    patches: Vec<Patch>,
    matrix: PackedSymmetric<f64>,
    tolerance: f64,
}

/// Largest changes of a factor: over the largest factor, and over the factor itself.
#[derive(Debug)]
struct Change {
    of_largest: f64,
    of_own: f64,
}

impl Scene {
    fn new(patches: Vec<Patch>, tolerance: f64) -> Self {
        let matrix = exchanges(&patches, tolerance);
        Self { patches, matrix, tolerance }
    }

    /// Compares with the same patches scaled by `scale` and then moved, in the order `places`.
    fn change(&self, scale: f64, shift: Vec3, places: &[usize]) -> Change {
        let other = moved(&self.patches, scale, shift);
        let other: Vec<Patch> = places.iter().map(|&k| other[k]).collect();
        let matrix = exchanges(&other, self.tolerance);
        let (mut largest, mut worst, mut own) = (0f64, (0f64, 0, 0), 0f64);
        for (i, j) in (0..places.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let (p, q) = (places[i], places[j]);
            let least = self.patches[p].area().min(self.patches[q].area());
            let (before, after) = (self.matrix.get(p, q) / least, matrix.get(i, j) / (scale * scale * least));
            largest = largest.max(before);
            let off = (after - before).abs();
            if off > worst.0 { worst = (off, p, q); }
            if off > 0.0 {
                own = own.max(off / before.max(after));
            }
        }
        println!("   worst pair {worst:?} {} {}", self.matrix.get(worst.1, worst.2) , self.patches[worst.1].area());
        Change { of_largest: worst.0 / largest, of_own: own }
    }
}

fn prove(patches: &[Patch], tolerance: f64) {
    let scene = Scene::new(patches.to_vec(), tolerance);
    let same: Vec<usize> = (0..patches.len()).collect();
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        println!("T = {tolerance:e}, × {scale:e}: {:?}", scene.change(scale, Vec3::ZERO, &same));
    }
    println!("T = {tolerance:e}, moved: {:?}", scene.change(1.0, v(1e3, -7e2, 3e2), &same));
    println!("T = {tolerance:e}, renumbered: {:?}", scene.change(1.0, Vec3::ZERO, &shuffled(patches.len())));
}

#[test]
fn a_box() {
    for tolerance in [1e-4, 1e-6] {
        prove(&with_a_box(), tolerance);
    }
}

#[test]
fn a_tilted_box_and_a_ball() {
    for tolerance in [1e-4, 1e-6] {
        prove(&with_a_tilted_box_and_a_ball(), tolerance);
    }
}
