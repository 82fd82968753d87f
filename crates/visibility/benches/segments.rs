//! Segments, rays and shafts per second on one core, in a room with two boxes and in a room with
//! four finely tessellated spheres; and the time to build the larger.
//!
//! The ends of the segments are points of the surfaces, uniform by area and in random order.

#![allow(clippy::unwrap_used, reason = "the scenes are fixed")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

const SEGMENTS: usize = 1 << 16;

/// A xorshift generator: numbers in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The six sides of a box of the given half sides, turned about z, lit on the outside or, reversed,
/// on the inside.
fn cuboid(centre: Vec3, half: Vec3, turn: f64, reversed: bool) -> Vec<[Vec3; 4]> {
    let (sin, cos) = turn.sin_cos();
    let (x, y, z) = (Vec3::new(cos, sin, 0.0) * half.x, Vec3::new(-sin, cos, 0.0) * half.y, Vec3::Z * half.z);
    let side = |n: Vec3, u: Vec3, v: Vec3| {
        let sign = if reversed { -1.0 } else { 1.0 };
        [-1.0, 1.0].map(|s| {
            let v = v * s * sign;
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(i, j)| centre + n * s + u * i + v * j)
        })
    };
    [side(x, y, z), side(y, z, x), side(z, x, y)].concat()
}

/// A room of 1 × 1 × 1 with a lamp, two boxes and four panels: 23 quads.
fn room() -> Vec<[Vec3; 4]> {
    let mut quads = cuboid(Vec3::splat(0.5), Vec3::splat(0.5), 0.0, true);
    quads.extend(cuboid(Vec3::new(0.33, 0.35, 0.15), Vec3::splat(0.15), 0.3, false));
    quads.extend(cuboid(Vec3::new(0.65, 0.65, 0.3), Vec3::new(0.14, 0.14, 0.3), -0.4, false));
    let panel = |x: f64, y: f64, z: f64, size: f64| {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(u, v)| Vec3::new(x + size * u, y + size * v, z))
    };
    quads.push(panel(0.4, 0.4, 0.99, 0.2));
    quads.extend([0.0, 0.25, 0.5, 0.75].map(|x| panel(x, 0.1, 0.8, 0.1)));
    quads
}

fn as_quads(quads: &[[Vec3; 4]]) -> Vec<Patch> {
    quads.iter().map(|&q| Patch::quad(q).unwrap().unwrap()).collect()
}

fn as_triangles(quads: &[[Vec3; 4]]) -> Vec<Patch> {
    quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .map(|t| Patch::triangle(t).unwrap())
        .collect()
}

/// Four spheres of 20,480 triangles each, in a room: 81,932 triangles.
fn spheres() -> Vec<Patch> {
    let mut patches = as_triangles(&cuboid(Vec3::splat(0.5), Vec3::splat(0.5), 0.0, true));
    let unit = (0..5).fold(icosahedron(), |triangles, _| triangles.iter().flat_map(split).collect());
    for (centre, radius) in [
        ((0.3, 0.3, 0.2), 0.2),
        ((0.7, 0.65, 0.3), 0.25),
        ((0.25, 0.75, 0.6), 0.15),
        ((0.7, 0.25, 0.75), 0.2),
    ] {
        let centre = Vec3::from(centre);
        patches.extend(unit.iter().map(|t| Patch::triangle(t.map(|p| centre + p * radius)).unwrap()));
    }
    patches
}

fn split(&[a, b, c]: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    let [d, e, f] = [a + b, b + c, c + a].map(Vec3::normalize);
    [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
}

fn icosahedron() -> Vec<[Vec3; 3]> {
    let g = 0.5 * (1.0 + 5.0f64.sqrt());
    let corners: Vec<Vec3> = [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)]
        .iter()
        .flat_map(|&(a, b)| [Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)])
        .collect();
    let near = |i: usize, j: usize| (corners[i].distance(corners[j]) - 2.0).abs() < 1e-9;
    let mut faces = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        if near(i, j) && near(j, k) && near(k, i) {
            let [a, b, c] = [i, j, k].map(|n| corners[n].normalize());
            faces.push(if (b - a).cross(c - a).dot(a) > 0.0 { [a, b, c] } else { [a, c, b] });
        }
    }
    faces
}

/// Pairs of points of the surfaces, uniform by area.
fn pairs(patches: &[Patch]) -> Vec<(Vec3, Vec3)> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let cumulated: Vec<f64> = patches
        .iter()
        .scan(0.0, |sum, p| {
            *sum += p.area();
            Some(*sum)
        })
        .collect();
    let total = cumulated[cumulated.len() - 1];
    let mut point = || {
        let share = random.next() * total;
        let patch = &patches[cumulated.partition_point(|&c| c < share).min(patches.len() - 1)];
        let (u, v) = (random.next(), random.next());
        if patch.sides() == 3 && u + v > 1.0 { patch.point(1.0 - u, 1.0 - v) } else { patch.point(u, v) }
    };
    (0..SEGMENTS).map(|_| (point(), point())).collect()
}

fn scenes() -> [(&'static str, Vec<Patch>); 3] {
    let quads = room();
    [("46 triangles", as_triangles(&quads)), ("23 quads", as_quads(&quads)), ("81932 triangles", spheres())]
}

fn segments(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("segments");
    group.throughput(Throughput::Elements(SEGMENTS as u64));
    for (name, patches) in scenes() {
        let (scene, pairs) = (Occluders::new(&patches).unwrap(), pairs(&patches));
        group.bench_function(name, |bencher| {
            bencher.iter(|| pairs.iter().filter(|&&(p, q)| black_box(&scene).unoccluded(p, q)).count());
        });
    }
}

fn rays(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rays");
    group.throughput(Throughput::Elements(SEGMENTS as u64));
    for (name, patches) in scenes() {
        let (scene, pairs) = (Occluders::new(&patches).unwrap(), pairs(&patches));
        let hits = |&&(p, q): &&(Vec3, Vec3)| black_box(&scene).closest(p, q - p, f64::INFINITY).is_some();
        group.bench_function(name, |bencher| bencher.iter(|| pairs.iter().filter(hits).count()));
    }
}

fn shafts(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("shafts");
    for (name, patches) in scenes() {
        let (scene, elements) = (Occluders::new(&patches).unwrap(), elements(&patches));
        let mut candidates = Vec::new();
        let mut named = |a: &Patch, b: &Patch| {
            black_box(&scene).shaft(a, b, &mut candidates);
            candidates.len()
        };
        group.throughput(Throughput::Elements((elements.len() * elements.len()) as u64));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                elements
                    .iter()
                    .flat_map(|a| elements.iter().map(move |b| (a, b)))
                    .map(|(a, b)| named(a, b))
                    .sum::<usize>()
            });
        });
    }
}

/// Every patch cut into quads around its corners; of many patches, every four-hundredth as it is.
fn elements(patches: &[Patch]) -> Vec<Patch> {
    if patches.len() > 400 {
        return patches.iter().step_by(400).copied().collect();
    }
    patches.iter().flat_map(quarters).collect()
}

fn quarters(patch: &Patch) -> Vec<Patch> {
    let n = patch.sides();
    let middle = |i: usize| 0.5 * (patch.corner(i) + patch.corner(i + 1));
    let around = |i: usize| [patch.corner(i), middle(i), patch.centroid(), middle(i + n - 1)];
    (0..n).map(|i| Patch::quad(around(i)).unwrap().unwrap()).collect()
}

fn build(criterion: &mut Criterion) {
    let patches = spheres();
    let mut group = criterion.benchmark_group("build");
    group.sample_size(10);
    group.bench_function("81932 triangles", |bencher| {
        bencher.iter(|| Occluders::new(&patches));
    });
}

criterion_group!(benches, segments, rays, shafts, build);
criterion_main!(benches);
