//! Goals: the mean irradiance of some surfaces against over-refined solutions, the dual identity,
//! states, and the same bits for any number of threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

mod common;

use common::{Bench, SOLVERS, options, room};
use fredholm_hierarchical::{
    Goal, HierarchyError, Options, Problem, Round, RoundWatch, Solution, State, solve,
};
use fredholm_linop::{LinearOperator, MultiVector, Quiet, Watch};
use std::sync::Mutex;

const TWO_ROOMS: &str = include_str!("data/two_rooms.toml");

fn reached(problem: &Problem, options: &Options, state: Option<State>, watch: &dyn RoundWatch) -> Solution {
    solve(problem, options, SOLVERS, state, watch).unwrap()
}

/// What is found, its stated error and the links of a solution to the goal.
fn found(bench: &Bench, goal: &Goal, accuracy: f64) -> (f64, f64, usize) {
    let problem = Problem { goal: Some(goal), ..bench.problem() };
    let solution = reached(&problem, &options(accuracy), None, &Quiet);
    let stated = solution.error.unwrap().worst();
    (solution.goal.unwrap().irradiance[0], stated, solution.links.len())
}

#[test]
fn the_stated_error_holds_with_far_fewer_links_than_everything_needs() {
    let bench = Bench::text(TWO_ROOMS);
    let fine = bench.solve(0.01);
    let faces = bench.faces(&fine);
    // The lamp lights the table; the desk stands in the room next door. The fine solution has 0.03
    // % and 0.7 % there.
    for (name, accuracy, fewer) in [("table", 0.02, 5), ("table", 0.01, 5), ("desk", 0.1, 5)] {
        let goal = Goal::new(&bench.mesh, &[name]).unwrap();
        let exact = goal.means(&bench.mesh, &faces, 1)[0];
        let (value, stated, links) = found(&bench, &goal, accuracy);
        let error = (value / exact - 1.0).abs();
        println!(
            "{name} {accuracy}: {error:.2e}, stated {stated:.2e}, {links} links of {}",
            fine.links.len()
        );
        assert!(error < stated && stated <= accuracy, "{name}: {error:e} {stated:e}");
        assert!(
            fewer * links < fine.links.len(),
            "{name}: {links} links, {} for everything",
            fine.links.len()
        );
    }
}

#[test]
fn the_dual_sees_the_same_mean_as_the_solution() {
    let bench = Bench::text(
        &room(0.7)
            .replace("exitance = 1", "exitance = [1, 0.25]")
            .replace("[materials.wall]\n", "bands = [\"a\", \"b\"]\n[materials.wall]\n"),
    );
    let goal = Goal::new(&bench.mesh, &["block"]).unwrap();
    let problem = Problem { goal: Some(&goal), ..bench.problem() };
    let exact = Options { residual: 1e-12, ..options(0.1) };
    let solution = reached(&problem, &exact, None, &Quiet);
    let importance = &solution.goal.as_ref().unwrap().importance;
    let operator = solution.operator();
    let applied = |x: &MultiVector<f64>| {
        let mut y = MultiVector::zeros(x.dim(), x.rhs_count());
        operator.apply(x, &mut y);
        y
    };
    let (lit, seen) = (applied(&solution.radiosity), applied(importance));
    // The block is 0.5 × 0.3 × 0.3 m.
    let area = 2.0 * (0.5 * 0.3 + 0.5 * 0.3 + 0.3 * 0.3);
    let block = bench.mesh.surfaces().iter().position(|surface| surface.name == "block").unwrap();
    let leaves = solution.tree.leaves();
    for band in 0..2 {
        let (mut primal, mut dual) = (0.0, 0.0);
        for (i, &leaf) in leaves.iter().enumerate() {
            let face = solution.tree.nodes()[leaf as usize].face().unwrap();
            let inside = bench.mesh.faces()[face].surface == block;
            primal += if inside { lit.row(i)[band] / area } else { 0.0 };
            dual += [1.0, 0.25][band] * seen.row(i)[band];
        }
        let stated = solution.goal.as_ref().unwrap().irradiance[band];
        assert!(primal > 0.1 && (primal / dual - 1.0).abs() < 1e-10, "{primal} {dual}");
        assert!((primal / stated - 1.0).abs() < 1e-12, "{primal} {stated}");
    }
}

/// Keeps all states.
#[derive(Default)]
struct Keep(Mutex<Vec<Vec<u8>>>);

impl Watch for Keep {}

impl RoundWatch for Keep {
    fn round(&self, _: &[Round], state: &State) -> Result<(), HierarchyError> {
        let mut bytes = Vec::new();
        state.write(&mut bytes).unwrap();
        self.0.lock().unwrap().push(bytes);
        Ok(())
    }
}

fn same(one: &Solution, other: &Solution) -> bool {
    one.links == other.links
        && one.rounds == other.rounds
        && one.radiosity == other.radiosity
        && one.goal == other.goal
        && one.error == other.error
}

#[test]
fn every_saved_state_leads_to_the_same_bits_with_any_number_of_threads() {
    let bench = Bench::text(TWO_ROOMS);
    let goal = Goal::new(&bench.mesh, &["table", "chest"]).unwrap();
    let problem = Problem { goal: Some(&goal), ..bench.problem() };
    let keep = Keep::default();
    let whole = reached(&problem, &options(0.05), None, &keep);
    let states = keep.0.into_inner().unwrap();
    assert!(states.len() >= 2);
    for (threads, bytes) in states.iter().enumerate() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads + 1).build().unwrap();
        let state = State::read(&problem, &mut bytes.as_slice()).unwrap();
        let resumed = pool.install(|| reached(&problem, &options(0.05), Some(state), &Quiet));
        assert!(same(&whole, &resumed), "{threads}");
    }
}

#[test]
fn foreign_goals_and_unknown_surfaces_are_refused() {
    let bench = Bench::text(TWO_ROOMS);
    let [table, desk] = ["table", "desk"].map(|name| Goal::new(&bench.mesh, &[name]).unwrap());
    let problem = Problem { goal: Some(&table), ..bench.problem() };
    let keep = Keep::default();
    reached(&problem, &options(0.3), None, &keep);
    let bytes = keep.0.into_inner().unwrap().pop().unwrap();
    for goal in [None, Some(&desk)] {
        let other = Problem { goal, ..problem };
        let read = State::read(&other, &mut bytes.as_slice()).unwrap_err();
        assert!(read.to_string().contains("belongs to another goal"), "{read}");
        let state = State::read(&problem, &mut bytes.as_slice()).unwrap();
        let solved = solve(&other, &options(0.3), SOLVERS, Some(state), &Quiet).unwrap_err();
        assert!(solved.to_string().contains("belongs to another goal"), "{solved}");
    }
    let unknown = Goal::new(&bench.mesh, &["desk", "dsek"]).unwrap_err().to_string();
    assert!(unknown.contains("\"dsek\"") && unknown.contains("floor, ceiling, south"), "{unknown}");
    assert!(Goal::new::<&str>(&bench.mesh, &[]).is_err());
}
