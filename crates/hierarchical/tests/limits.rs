//! Runs that memory or the user ends state errors that hold, row sums are bounded, and no mesh
//! makes the tree endless.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

mod common;
#[path = "common/truth.rs"]
mod truth;

use common::{Bench, SOLVERS, options, room};
use fredholm_hierarchical::{
    HierarchyError, Options, Round, RoundWatch, State, Stated, Tree, conclude, solve,
};
use fredholm_linop::{Quiet, StopReason, Watch};
use std::ops::ControlFlow;
use std::sync::Mutex;
use truth::{error, traced};

#[test]
fn planes_that_are_nearly_one_make_no_endless_tree() {
    // The second square is in the plane of the first up to the tolerance, but not the first in that
    // of the second.
    for tilt in [1e-9, 5e-9, 1e-7, 5e-7, 1e-6] {
        let bench = Bench::text(&format!(
            "[materials.wall]\nreflectance = 0.5\nexitance = 1\n\
             [[surface]]\nname = \"a\"\nmaterial = \"wall\"\nquad = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\n\
             [[surface]]\nname = \"b\"\nmaterial = \"wall\"\nquad = [[1, 0, 0], [2, 0, {tilt:.10}], [2, 1, {tilt:.10}], [1, 1, 0]]\n\
             [[surface]]\nname = \"c\"\nmaterial = \"wall\"\nquad = [[0, 0, 2], [0, 1, 2], [1, 1, 2], [1, 0, 2]]\n"
        ));
        let tree = Tree::new(&bench.mesh, bench.occluders.tolerance()).unwrap();
        assert_eq!(tree.nodes().len(), 5, "{tilt}");
    }
}

#[test]
fn what_memory_ends_states_an_error_that_holds_or_none() {
    let bench = Bench::shipped("cornell_planar.toml");
    let exact = traced(&bench, "cornell_planar", &["E_r", "E_g", "E_b"]);
    let mut limited_runs = 0;
    for kilobytes in [2000, 4000, 8000, 12_000, 16_000, 20_000, 24_000, 28_000, 32_000, 40_000] {
        let limited = Options { bytes: kilobytes * 1000, ..options(0.002) };
        let solution = match solve(&bench.problem(), &limited, SOLVERS, None, &Quiet) {
            Err(HierarchyError::Memory { needed, limit }) => {
                assert!(needed > limit);
                continue;
            }
            found => found.unwrap(),
        };
        assert!(solution.limited && solution.bytes() <= limited.bytes, "{kilobytes}");
        limited_runs += 1;
        if let Some(told) = solution.error.as_ref().map(Stated::worst) {
            let found = error(&bench, &bench.faces(&solution), &exact);
            println!("{kilobytes} kB: {found:.2e}, stated {told:.2e}");
            assert!(found < told, "{kilobytes} kB: {found:e} {told:e}");
        }
    }
    assert!(limited_runs > 0);
}

/// Keeps the last state and stops after so many looks.
struct Hasty {
    looks: Mutex<usize>,
    state: Mutex<Option<Vec<u8>>>,
}

impl Watch for Hasty {
    fn go_on(&self) -> ControlFlow<()> {
        let mut looks = self.looks.lock().unwrap();
        *looks = looks.saturating_sub(1);
        if *looks == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl RoundWatch for Hasty {
    fn round(&self, _: &[Round], state: &State) -> Result<(), HierarchyError> {
        let mut bytes = Vec::new();
        state.write(&mut bytes).unwrap();
        *self.state.lock().unwrap() = Some(bytes);
        Ok(())
    }
}

#[test]
fn what_is_interrupted_is_the_last_round_with_its_error() {
    let bench = Bench::shipped("cornell_planar.toml");
    let exact = traced(&bench, "cornell_planar", &["E_r", "E_g", "E_b"]);
    let (problem, options) = (bench.problem(), options(0.005));
    let mut stated = 0;
    for looks in [20, 60, 100, 150, 200, 250, 300, 400, 500, 600] {
        let watch = Hasty { looks: Mutex::new(looks), state: Mutex::new(None) };
        let found = solve(&problem, &options, SOLVERS, None, &watch);
        let (Err(HierarchyError::Interrupted), Some(bytes)) = (found, watch.state.into_inner().unwrap())
        else {
            continue;
        };
        let state = State::read(&problem, &mut bytes.as_slice()).unwrap();
        let rounds = state.rounds().to_vec();
        let solution = conclude(&problem, &options, SOLVERS, state).unwrap();
        assert!(solution.report.reason == StopReason::Interrupted && solution.rounds == rounds);
        assert_eq!(solution.error.is_some(), rounds.len() > 1);
        if let Some(told) = solution.error.as_ref().map(Stated::worst) {
            let found = error(&bench, &bench.faces(&solution), &exact);
            println!("{looks} looks: {found:.2e}, stated {told:.2e}");
            assert!(found < told, "{looks}: {found:e} {told:e}");
            stated += 1;
        }
    }
    assert!(stated >= 3, "{stated}");
}

#[test]
fn no_row_sum_is_above_one_by_more_than_the_tolerance() {
    let rooms = include_str!("data/two_rooms.toml");
    for (bench, most) in [(Bench::text(rooms), 1.0401), (Bench::text(&room(0.9)), 1.0001)] {
        for accuracy in [0.1, 0.03] {
            let solution = bench.solve(accuracy);
            let largest = solution.closure.iter().copied().fold(0.0, f64::max);
            assert!(largest <= most, "{accuracy}: {largest}");
        }
    }
}
