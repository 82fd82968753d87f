//! Solutions against closed forms and independent references, their stated errors, energy, and the
//! same bits for any number of threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

mod common;
#[path = "common/truth.rs"]
mod truth;

use common::{Bench, SOLVERS, options, room};
use fredholm_hierarchical::{HierarchyError, Solvers, solve};
use fredholm_iterative::{Gmres, Neumann};
use fredholm_linop::Quiet;
use truth::{error, traced};

#[test]
fn a_furnace_is_exitance_over_absorptance() {
    for reflectance in [0.2, 0.8] {
        let bench = Bench::text(&room(reflectance));
        let solution = bench.solve(0.01);
        let exact = 1.0 / (1.0 - reflectance);
        let faces = bench.faces(&solution);
        let (mut squares, mut area) = (0.0, 0.0);
        for (face, e) in bench.mesh.faces().iter().zip(&faces) {
            squares += face.area * (e / exact - 1.0).powi(2);
            area += face.area;
        }
        let (found, stated) = ((squares / area).sqrt(), solution.error.unwrap().worst());
        println!("ρ = {reflectance}: found {found:.2e}, stated {stated:.2e}");
        assert!(found < 0.01 && stated < 0.01, "{found:e} {stated:e}");
    }
}

#[test]
fn the_planar_cornell_box_agrees_with_particle_tracing() {
    let bench = Bench::shipped("cornell_planar.toml");
    let solution = bench.solve(0.02);
    let found =
        error(&bench, &bench.faces(&solution), &traced(&bench, "cornell_planar", &["E_r", "E_g", "E_b"]));
    let stated = solution.error.unwrap().worst();
    println!("found {found:.2e}, stated {stated:.2e}");
    assert!(found < 0.015 && found < stated && stated < 0.02, "{found:e} {stated:e}");
}

#[test]
fn the_occluder_agrees_with_particle_tracing() {
    let bench = Bench::shipped("occluder.toml");
    let solution = bench.solve(0.02);
    let found = error(&bench, &bench.faces(&solution), &traced(&bench, "occluder", &["E"]));
    let stated = solution.error.unwrap().worst();
    println!("found {found:.2e}, stated {stated:.2e}");
    assert!(found < 0.02 && found < stated && stated < 0.02, "{found:e} {stated:e}");
}

#[test]
fn what_is_emitted_is_absorbed_at_every_accuracy() {
    let bench = Bench::text(&room(0.6));
    for accuracy in [0.1, 0.03, 0.01] {
        let solution = bench.solve(accuracy);
        let energy = solution.system.energy(&solution.radiosity, &solution.means, &solution.closure)[0];
        let balance = (energy.absorbed + energy.escaped) / energy.emitted - 1.0;
        let stated = solution.error.unwrap().worst();
        println!("{accuracy}: balance {balance:.2e}, escaped {:.2e}", energy.escaped / energy.emitted);
        assert!(balance.abs() < 1e-3 * accuracy.max(stated), "{balance:e}");
        assert!((energy.escaped / energy.emitted).abs() < stated, "{energy:?}");
    }
}

/// What the solver leaves is multiplied by 1/(1 − ρ): it has to leave less where that is much.
#[test]
fn nearly_white_rooms_reach_their_accuracy() {
    for reflectance in [0.999, 0.9999] {
        let bench = Bench::text(&room(reflectance));
        let solution = bench.solve(0.05);
        let energy = solution.system.energy(&solution.radiosity, &solution.means, &solution.closure)[0];
        let balance = (energy.absorbed / energy.emitted - 1.0).abs();
        let stated = solution.error.unwrap().worst();
        println!("ρ = {reflectance}: balance {balance:.2e}, stated {stated:.2e}, {:?}", solution.rounds);
        assert!(stated <= 0.05 && balance <= stated, "{reflectance}: {balance:e} {stated:e}");
    }
}

/// A nearly white room that loses light: a lamp below the ceiling has a black back, and a board
/// sticks through a wall. What its row sums miss is multiplied by 15: links that lose one part in a
/// hundred lose a seventh of the light.
#[test]
fn nearly_white_rooms_that_lose_light_reach_their_accuracy() {
    let bench = Bench::text(
        "[materials.wall]\nreflectance = 0.999\n[materials.lamp]\nreflectance = 0.9\nexitance = 1\n\
         [[surface]]\nname = \"room\"\nmaterial = \"wall\"\n\
         box = { min = [0, 0, 0], max = [4, 3, 3], inward = true }\n\
         [[surface]]\nname = \"lamp\"\nmaterial = \"lamp\"\n\
         quad = [[1.5, 1, 2.5], [1.5, 2, 2.5], [2.5, 2, 2.5], [2.5, 1, 2.5]]\n\
         [[surface]]\nname = \"board\"\nmaterial = \"wall\"\n\
         quad = [[3.2, 1, 0.4], [4.3, 1, 0.5], [4.3, 1.6, 0.6], [3.2, 1.6, 0.5]]\n",
    );
    let fine = bench.faces(&bench.solve(0.01));
    for accuracy in [0.2, 0.1] {
        let solution = bench.solve(accuracy);
        let (links, stated) = (solution.links.len(), solution.error.as_ref().unwrap().worst());
        let found = error(&bench, &bench.faces(&solution), &fine);
        println!("{accuracy}: found {found:.2e}, stated {stated:.2e}, {links} links");
        assert!(found <= stated && stated <= accuracy, "{found:e} {stated:e}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let bench = Bench::shipped("occluder.toml");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bench.solve(0.05))
    };
    let one = with(1);
    for threads in [2, 4] {
        let many = with(threads);
        assert!(one.links == many.links && one.tree.splits() == many.tree.splits());
        assert!(one.radiosity == many.radiosity && one.means == many.means && one.rounds == many.rounds);
    }
    assert!(!one.tree.splits().is_empty());
}

#[test]
fn another_solver_gives_the_same_light() {
    let bench = Bench::text(&room(0.5));
    let other = solve(
        &bench.problem(),
        &options(0.05),
        Solvers { first: &Neumann, fallback: &Gmres { restart: 50 } },
        None,
        &Quiet,
    )
    .unwrap();
    let first = bench.solve(0.05);
    let pairs = bench.faces(&first).into_iter().zip(bench.faces(&other));
    assert!(pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max) < 1e-3);
}

#[test]
fn little_memory_is_respected_and_said() {
    let bench = Bench::shipped("occluder.toml");
    let limited = options(0.001);
    let limited = fredholm_hierarchical::Options { bytes: 12 << 20, ..limited };
    let solution = solve(&bench.problem(), &limited, SOLVERS, None, &Quiet).unwrap();
    assert!(solution.limited && solution.bytes() < 12 << 20, "{} {}", solution.limited, solution.bytes());
    assert!(solution.means.irradiance.as_slice().iter().all(|e| e.is_finite()));
}

#[test]
fn what_cannot_be_solved_is_refused() {
    let bench = Bench::text(&room(0.5));
    let refused = |accuracy| solve(&bench.problem(), &options(accuracy), SOLVERS, None, &Quiet).unwrap_err();
    assert!(matches!(refused(0.0), HierarchyError::Accuracy { .. }));
    assert!(matches!(refused(f64::NAN), HierarchyError::Accuracy { .. }));
    let other = Bench::text(&room(0.5).replace("[2, 2]", "[3, 3]"));
    let mixed = fredholm_hierarchical::Problem { surfaces: &other.surfaces, ..bench.problem() };
    let error = solve(&mixed, &options(0.1), SOLVERS, None, &Quiet).unwrap_err();
    assert!(matches!(error, HierarchyError::Shape { expected: 30, .. }), "{error}");
}
