//! Size, place and numbering of a scene change no factor: every F_ij of a furnished cube before and
//! after, relative to the largest.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;

use common::{patch, v};
use fredholm_coupling::assemble;
use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_linop::{PackedSymmetric, Quiet};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use std::f64::consts::{PI, TAU};

/// An n × n grid on each side of a parallelepiped, seen from inside or outside. Corners that meet
/// have the same bits.
fn sides(corner: Vec3, edges: [Vec3; 3], n: usize, inward: bool) -> Vec<Patch> {
    let at = |k: [usize; 3]| {
        let [a, b, c] = k.map(|k| k as f64 / n as f64);
        corner + (edges[0] * a + edges[1] * b + edges[2] * c)
    };
    let cell = |axis: usize, far: bool, [i, j]: [usize; 2]| {
        let place = |i: usize, j: usize| {
            let mut place = [0; 3];
            (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (i, j, if far { n } else { 0 });
            at(place)
        };
        let cell = patch(&[place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)]);
        if far == inward { cell.flipped() } else { cell }
    };
    let all = (0..6 * n * n).map(|k| (k / (2 * n * n), k / (n * n) % 2 == 1, [k / n % n, k % n]));
    all.map(|(axis, far, place)| cell(axis, far, place)).collect()
}

fn cube(n: usize) -> Vec<Patch> {
    sides(Vec3::ZERO, Vec3::AXES, n, true)
}

/// The cube with a box of side 0.4 in the middle.
fn with_a_box() -> Vec<Patch> {
    let mut patches = cube(8);
    patches.extend(sides(Vec3::splat(0.3), Vec3::AXES.map(|axis| axis * 0.4), 4, false));
    patches
}

/// The cube with a tilted box in one corner and a triangulated ball in another.
fn with_a_tilted_box_and_a_ball() -> Vec<Patch> {
    let mut patches = cube(3);
    let edges = [v(0.36, 0.12, 0.09), v(-0.1, 0.3, 0.03), v(-0.05, -0.05, 0.4)];
    patches.extend(sides(v(0.2, 0.15, 0.17), edges, 1, false));
    patches.extend(ball(v(0.68, 0.7, 0.66), 0.2));
    patches
}

/// A ball of 8 × 4 faces, counter-clockwise from outside: triangles round the poles, trapezia
/// between.
fn ball(centre: Vec3, radius: f64) -> Vec<Patch> {
    let (around, down) = (6, 3);
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
    assemble(&integrator, &Quiet).unwrap().matrix
}

/// The k-th place of a fixed random order, by the linear congruential generator of Numerical
/// Recipes.
fn shuffled(n: usize) -> Vec<usize> {
    let mut state = 7u32;
    let mut order: Vec<usize> = (0..n).collect();
    for k in (1..n).rev() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        order.swap(k, ((u64::from(state) * (k as u64 + 1)) >> 32) as usize);
    }
    order
}

/// A matrix to compare with.
struct Scene {
    patches: Vec<Patch>,
    matrix: PackedSymmetric<f64>,
    tolerance: f64,
}

/// How a scene is changed: scaled, then moved, then renumbered.
struct Change {
    scale: f64,
    shift: Vec3,
    places: Vec<usize>,
}

/// Largest change of a factor over the largest factor, and over the factor itself as far as that is
/// at least a millionth of the largest.
#[derive(Clone, Copy, Debug)]
struct Effect {
    of_largest: f64,
    of_own: f64,
}

impl Scene {
    fn new(patches: Vec<Patch>, tolerance: f64) -> Self {
        let matrix = exchanges(&patches, tolerance);
        Self { patches, matrix, tolerance }
    }

    /// The factors of all pairs before and after a change, as shares of what leaves the smaller
    /// patch.
    fn factors(&self, change: &Change) -> Vec<[f64; 2]> {
        let moved = moved(&self.patches, change.scale, change.shift);
        let other: Vec<Patch> = change.places.iter().map(|&k| moved[k]).collect();
        let matrix = exchanges(&other, self.tolerance);
        let pairs = (0..other.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
        let factors = pairs.map(|[i, j]| {
            let [p, q] = [change.places[i], change.places[j]];
            let least = self.patches[p].area().min(self.patches[q].area());
            let after = matrix.get(i, j) / (change.scale * change.scale);
            [self.matrix.get(p, q) / least, after / least]
        });
        factors.collect()
    }

    fn effect(&self, change: &Change) -> Effect {
        let factors = self.factors(change);
        let largest = factors.iter().map(|[before, _]| *before).fold(0.0, f64::max);
        let worst = |least: f64, scale: &dyn Fn(f64) -> f64| {
            let counted = factors.iter().filter(|pair| pair[0].max(pair[1]) > least);
            counted.map(|[before, after]| (after - before).abs() / scale(*before)).fold(0.0, f64::max)
        };
        Effect {
            of_largest: worst(0.0, &|_| largest),
            of_own: worst(1e-6 * largest, &|before| before.max(1e-6 * largest)),
        }
    }
}

/// Compares a scene with itself at other sizes, places and in another order.
fn prove(name: &str, patches: &[Patch], tolerance: f64) {
    let scene = Scene::new(patches.to_vec(), tolerance);
    let same: Vec<usize> = (0..patches.len()).collect();
    let scaled =
        [1e-6, 1e-3, 1e3, 1e6].map(|scale| Change { scale, shift: Vec3::ZERO, places: same.clone() });
    let shift = v(1e3, -7e2, 3e2);
    let moved = Change { scale: 1.0, shift, places: same };
    let renumbered = Change { scale: 1.0, shift: Vec3::ZERO, places: shuffled(patches.len()) };
    for change in scaled.iter().chain([&moved, &renumbered]) {
        let effect = scene.effect(change);
        let (scale, shift, Effect { of_largest, of_own }) = (change.scale, change.shift, effect);
        println!(
            "{name}, T = {tolerance:e}, × {scale:e} + {shift}: {of_largest:.1e} of the largest, {of_own:.1e} of its own"
        );
        assert!(effect.of_largest < 1e-9, "{effect:?}");
    }
}

#[test]
fn a_cube_with_a_box() {
    for tolerance in [1e-4, 1e-6] {
        prove("box", &with_a_box(), tolerance);
    }
}

#[test]
fn a_cube_with_a_tilted_box_and_a_ball() {
    prove("tilted box and ball", &with_a_tilted_box_and_a_ball(), 1e-4);
}

#[test]
#[ignore = "a minute long"]
fn a_cube_with_a_tilted_box_and_a_ball_to_a_millionth() {
    prove("tilted box and ball", &with_a_tilted_box_and_a_ball(), 1e-6);
}
