//! Matrices whose rows have a budget, against exact shadows, on shipped scenes: what is stated of a
//! row holds, for light of one and of mixed brightness, is about the tolerance, and its errors
//! average out.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use fredholm::coupling::form_factor::PairIntegrator;
use fredholm::coupling::{Assembled, assemble};
use fredholm::linop::Quiet;
use fredholm::mesh::Mesh;
use fredholm::scene::Scene;
use fredholm::visibility::Occluders;
use std::path::Path;
use std::time::Instant;

/// Share of the rows whose stated error must hold.
const LEAST_COVERED_SHARE: f64 = 0.997;

/// Brightness of element `j` in pattern `k`: all the same, or half of them dark.
fn brightness(j: usize, k: usize) -> f64 {
    if k == 0 || (j.wrapping_mul(2_654_435_761).wrapping_mul(k + 7) >> 13).is_multiple_of(2) {
        1.0
    } else {
        0.0
    }
}

struct Found {
    assembled: Assembled<f64>,
    seconds: f64,
}

fn found(mesh: &Mesh, occluders: &Occluders, tolerance: f64, budget: bool) -> Found {
    let pairs = PairIntegrator::new(mesh.patches(), occluders, tolerance);
    let pairs = if budget { pairs.with_row_budget() } else { pairs };
    let began = Instant::now();
    let assembled = assemble(&pairs, &Quiet).unwrap();
    Found { assembled, seconds: began.elapsed().as_secs_f64() }
}

/// What is stated of the rows, over the areas.
fn stated(mesh: &Mesh, found: &Found) -> Vec<f64> {
    found.assembled.error.iter().zip(mesh.patches()).map(|(error, patch)| error / patch.area()).collect()
}

/// Errors of the rows for a pattern, over the areas.
fn errors(mesh: &Mesh, found: &Found, exact: &Found, pattern: usize) -> Vec<f64> {
    let difference = |i: usize| {
        let of = |j: usize| {
            (found.assembled.matrix.get(i, j) - exact.assembled.matrix.get(i, j)) * brightness(j, pattern)
        };
        (0..mesh.len()).map(of).sum::<f64>() / mesh.patch(i).area()
    };
    (0..mesh.len()).map(difference).collect()
}

fn prove(name: &str, tolerances: &[f64], reference: f64) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let mesh = Scene::load(path).unwrap().mesh().unwrap();
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let exact = found(&mesh, &occluders, reference, false);
    let of_exact = stated(&mesh, &exact);
    for &tolerance in tolerances {
        let loose = found(&mesh, &occluders, tolerance, true);
        let stated = stated(&mesh, &loose);
        let mean = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let methods = loose.assembled.methods;
        println!(
            "{name}, T = {tolerance:e}: {} pairs by segments, {} by shadows, {:.2} s beside {:.2} s; stated {:.1e}, at most {:.1e}",
            methods.segments,
            methods.clipped,
            loose.seconds,
            exact.seconds,
            mean(&stated),
            largest(&stated)
        );
        for pattern in 0..3 {
            let off = errors(&mesh, &loose, &exact, pattern);
            let covered = (0..off.len()).filter(|&i| off[i].abs() <= stated[i] + of_exact[i]).count();
            // Of independent errors that are even, the sum over all is a root of their number.
            let sum: f64 = off.iter().zip(mesh.patches()).map(|(off, patch)| off * patch.area()).sum();
            let all: f64 = mesh.patches().map(fredholm::mesh::Patch::area).sum();
            println!(
                "    pattern {pattern}: {covered} of {} rows covered, off by {:.1e}, at most {:.1e}, in all {:.1e}",
                off.len(),
                mean(&off),
                largest(&off),
                sum / all
            );
            assert!(covered as f64 >= LEAST_COVERED_SHARE * off.len() as f64, "{name}: {covered}");
            assert!(mean(&off) < tolerance, "{name}: {}", mean(&off));
            assert!((sum / all).abs() < 0.3 * tolerance, "{name}: {}", sum / all);
        }
    }
}

#[test]
fn rows_are_within_what_is_stated() {
    for (name, tolerances) in [
        ("occluder.toml", &[1e-1, 1e-2, 1e-3][..]),
        ("leblond_furnished.toml", &[1e-1, 1e-2, 1e-3]),
        ("two_rooms.toml", &[1e-2]),
    ] {
        prove(name, tolerances, 1e-5);
    }
}

#[test]
#[ignore = "minutes of exact shadows"]
fn rows_of_furnished_rooms_are_within_what_is_stated() {
    prove("fifty_boxes.toml", &[1e-2, 1e-3], 1e-4);
    prove("studio.toml", &[1e-2, 1e-3], 1e-4);
}
