//! A solution that goes on from any saved state ends in the same bits; damaged states are refused.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

mod common;
#[path = "common/objects.rs"]
mod objects;
#[path = "common/shapes.rs"]
mod shapes;

use common::{Bench, room};
use fredholm_hierarchical::{HierarchyError, Round, RoundWatch, State};
use fredholm_linop::{Quiet, Watch};
use std::sync::Mutex;

const ACCURACY: f64 = 0.02;

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

#[test]
fn every_saved_state_leads_to_the_same_bits() {
    for bench in [Bench::shipped("occluder.toml"), objects::bench("ring", 800)] {
        resumed_from_every_state(&bench);
    }
}

fn resumed_from_every_state(bench: &Bench) {
    let keep = Keep::default();
    let whole = bench.resume(ACCURACY, None, &keep);
    let states = keep.0.into_inner().unwrap();
    assert!(states.len() >= 2 && states.len() + 1 == whole.rounds.len());
    for bytes in &states {
        let state = State::read(&bench.problem(), &mut bytes.as_slice()).unwrap();
        let resumed = bench.resume(ACCURACY, Some(state), &Quiet);
        assert!(whole.links == resumed.links && whole.rounds == resumed.rounds);
        assert!(whole.radiosity == resumed.radiosity && whole.means == resumed.means);
        assert!(whole.error == resumed.error && whole.closure == resumed.closure);
    }
}

#[test]
fn damaged_and_foreign_states_are_refused() {
    let bench = Bench::text(&room(0.5));
    let keep = Keep::default();
    bench.resume(ACCURACY, None, &keep);
    let bytes = keep.0.into_inner().unwrap().pop().unwrap();
    assert!(State::read(&bench.problem(), &mut bytes.as_slice()).is_ok());
    for length in (0..bytes.len()).step_by(97) {
        let cut = State::read(&bench.problem(), &mut &bytes[..length]);
        assert!(matches!(cut, Err(HierarchyError::State { .. })), "{length}");
    }
    let other = Bench::text(&room(0.5).replace("[2, 2]", "[1, 1]"));
    assert!(matches!(
        State::read(&other.problem(), &mut bytes.as_slice()),
        Err(HierarchyError::State { .. })
    ));
    let mut hostile = bytes;
    hostile[8..16].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(matches!(
        State::read(&bench.problem(), &mut hostile.as_slice()),
        Err(HierarchyError::State { .. })
    ));
}
