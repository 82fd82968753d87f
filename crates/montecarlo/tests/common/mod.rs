//! Scenes with closed forms, and how they are run.

// Each test file uses a part of it.
#![allow(dead_code)]

use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Patch, Shape, Vec3};
use fredholm_montecarlo::light::{Estimator, PhotonMap, Switches, estimator};
use fredholm_montecarlo::points::PointSet;
use fredholm_montecarlo::{Enclosure, Groups, State, Stop, Tracing};

/// A mesh of shapes, each with its lines and its reflectance and exitance.
pub fn mesh(shapes: &[(Shape, Lines)]) -> Mesh {
    let mut builder = MeshBuilder::default();
    for (index, (shape, lines)) in shapes.iter().enumerate() {
        builder.surface(format!("surface {index}"), index);
        builder.add(shape, &Cutting { lines: lines.clone(), ..Cutting::default() }).unwrap();
    }
    builder.build()
}

/// The enclosure of a mesh, materials by surface, in one band.
pub fn enclosure(mesh: &Mesh, material: impl Fn(usize) -> (f64, f64)) -> Enclosure {
    let patches: Vec<Patch> = mesh.patches().copied().collect();
    let (rho, exitance) = (0..mesh.len()).map(|leaf| material(mesh.surface_of(leaf))).unzip();
    Enclosure::new(patches, 1, rho, exitance).unwrap()
}

/// A closed box, one material: E = M/(1 − ρ).
pub fn furnace(rho: f64) -> Enclosure {
    let room = Shape::Box { min: Vec3::ZERO, max: Vec3::new(1.0, 1.5, 0.8), inward: true };
    enclosure(&mesh(&[(room, Lines::Whole)]), |_| (rho, 1.0))
}

/// Unit squares at distance 1, facing each other; the second one emits.
pub fn squares(rho: f64) -> Enclosure {
    let corner = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let below = [corner(0.0, 0.0, 0.0), corner(1.0, 0.0, 0.0), corner(1.0, 1.0, 0.0), corner(0.0, 1.0, 0.0)];
    let above = [corner(0.0, 0.0, 1.0), corner(0.0, 1.0, 1.0), corner(1.0, 1.0, 1.0), corner(1.0, 0.0, 1.0)];
    let quad = |corners| (Shape::Quad { corners, skip: Vec::new() }, Lines::Whole);
    enclosure(&mesh(&[quad(below), quad(above)]), |surface| (rho, surface as f64))
}

/// F of these squares.
pub const SQUARES: f64 = 0.199_824_895_698_388;

/// A sphere of radius 1 lit inside, the half z > 0 emitting 1.
pub fn sphere(rho: f64, segments: usize) -> Enclosure {
    let ball = Shape::Sphere { centre: Vec3::ZERO, radius: 1.0, inward: true, segments };
    let mesh = mesh(&[(ball, Lines::Whole)]);
    let patches: Vec<Patch> = mesh.patches().copied().collect();
    let exitance = patches.iter().map(|patch| if patch.centroid().z > 0.0 { 1.0 } else { 0.0 }).collect();
    let reflectance = vec![rho; patches.len()];
    Enclosure::new(patches, 1, reflectance, exitance).unwrap()
}

/// Everything as one group: the mean irradiance by area.
pub fn whole(scene: &Enclosure) -> Groups {
    Groups::new(scene, vec![0; scene.len()], 1).unwrap()
}

/// Each patch by itself.
pub fn single(scene: &Enclosure) -> Groups {
    Groups::new(scene, (0..scene.len()).collect(), scene.len()).unwrap()
}

pub fn method(name: &str, scene: &Enclosure) -> Box<dyn Estimator> {
    if name == "photon" {
        // A small map is as unbiased here, and quick.
        return Box::new(PhotonMap::new(scene, Switches::default(), 256));
    }
    estimator(name, scene, Switches::default()).unwrap()
}

/// Samples of a batch that make about `rays` rays.
pub fn samples(estimator: &dyn Estimator, scene: &Enclosure, per_patch: u32) -> u32 {
    if estimator.gathers() { per_patch } else { per_patch * scene.len() as u32 }
}

/// So many batches.
pub fn run(
    scene: &Enclosure,
    estimator: &dyn Estimator,
    groups: Groups,
    (seed, samples, batches): (u64, u32, u64),
) -> State {
    run_with(scene, estimator, groups, (seed, samples, batches), PointSet::default())
}

pub fn run_with(
    scene: &Enclosure,
    estimator: &dyn Estimator,
    groups: Groups,
    (seed, samples, batches): (u64, u32, u64),
    points: PointSet,
) -> State {
    let tracing = Tracing::new(scene, estimator, groups, seed, samples).unwrap().with_points(points);
    let mut state = tracing.start();
    let stop = Stop { batches: Some(batches), ..Stop::default() };
    tracing.go_on(&mut state, &stop, &fredholm_linop::Quiet).unwrap();
    state
}
