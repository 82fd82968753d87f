//! Stated errors of rows: in a closed room the row sums of F are 1, so that the distance from 1 is
//! the true error.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod enclosures;

use enclosures::{Place, cube_with_a_box, cube_with_a_tilted_box, furnished_room, room_with_a_corner};
use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_coupling::{Assembled, assemble};
use fredholm_linop::Quiet;
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;

/// Share of the rows whose stated error must hold.
const LEAST_COVERED_SHARE: f64 = 0.99;
/// Largest error that may be stated for a row, in tolerances, as long as rounding is less.
const MOST_STATED_ERROR: f64 = 5.0;
/// A row that sees less than this is covered by what stands on it.
const LEAST_ROW_SUM: f64 = 0.5;

/// What was stated for a row, and how far its sum is from what it is in a closed room.
struct Row {
    stated: f64,
    off: f64,
}

fn rows(patches: &[Patch], tolerance: f64) -> Vec<Row> {
    let occluders = Occluders::new(patches).unwrap();
    let integrator = PairIntegrator::new(patches, &occluders, tolerance);
    let found: Assembled<f64> = assemble(&integrator, &Quiet).unwrap();
    let sums = found.matrix.row_sums().into_iter().zip(&found.error).zip(patches);
    let row = |((sum, error), patch): ((f64, &f64), &Patch)| {
        let (sum, stated) = (sum / patch.area(), error / patch.area());
        Row { stated, off: if sum < LEAST_ROW_SUM { sum } else { (sum - 1.0).abs() } }
    };
    sums.map(row).collect()
}

/// The row errors of a scene at some tolerances. Returns the largest stated error over the
/// tolerance.
fn prove(name: &str, patches: &[Patch], tolerances: &[f64]) -> f64 {
    let mut largest = 0.0f64;
    for &tolerance in tolerances {
        let rows = rows(patches, tolerance);
        let covered = rows.iter().filter(|row| row.off <= row.stated).count();
        let seeing = rows.iter().filter(|row| row.off > 0.0);
        let mut ratios: Vec<f64> = seeing.map(|row| row.stated / row.off).collect();
        ratios.sort_by(f64::total_cmp);
        let off = rows.iter().map(|row| row.off).fold(0.0, f64::max);
        let stated = rows.iter().map(|row| row.stated).fold(0.0, f64::max);
        println!(
            "{name}, T = {tolerance:e}: {covered} of {} rows covered, off by {off:.1e}, stated {stated:.1e}, stated over true: least {:.2}, median {:.0}",
            rows.len(),
            ratios[0],
            ratios[ratios.len() / 2]
        );
        assert!(
            covered as f64 >= LEAST_COVERED_SHARE * rows.len() as f64,
            "{name}, T = {tolerance:e}: {covered}"
        );
        largest = largest.max(stated / tolerance);
    }
    largest
}

const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

#[test]
fn behind_a_box() {
    assert!(prove("cube with a box", &cube_with_a_box(4, Place::Upright), &TOLERANCES) < MOST_STATED_ERROR);
}

#[test]
fn behind_a_box_where_nothing_is_parallel_to_an_axis() {
    assert!(
        prove("turned cube with a box", &cube_with_a_box(2, Place::Turned), &TOLERANCES) < MOST_STATED_ERROR
    );
}

#[test]
fn behind_a_tilted_box() {
    assert!(prove("cube with a tilted box", &cube_with_a_tilted_box(2), &TOLERANCES) < MOST_STATED_ERROR);
}

#[test]
fn round_a_corner() {
    assert!(
        prove("room with a corner", &room_with_a_corner(2, Place::Upright), &TOLERANCES) < MOST_STATED_ERROR
    );
}

/// Corners are rounded to 1e-13 of the size of the scene, and what is stated says so.
#[test]
fn round_a_corner_far_from_the_origin() {
    let room = room_with_a_corner(2, Place::Far);
    assert!(prove("room with a corner, far away", &room, &TOLERANCES[..3]) < MOST_STATED_ERROR);
    prove("room with a corner, far away", &room, &TOLERANCES[3..]);
}

#[test]
fn behind_several_boxes() {
    assert!(prove("furnished room", &furnished_room(1), &[1e-3, 1e-5]) < MOST_STATED_ERROR);
}

#[test]
#[ignore = "several minutes long"]
fn with_more_patches() {
    for place in [Place::Upright, Place::Turned, Place::Far] {
        prove("cube with a box", &cube_with_a_box(8, place), &TOLERANCES);
        prove("room with a corner", &room_with_a_corner(5, place), &TOLERANCES);
    }
    prove("cube with a tilted box", &cube_with_a_tilted_box(4), &TOLERANCES);
    // At 1e-12 stated errors behind several bodies are too small (docs/form-factors.md).
    prove("furnished room", &furnished_room(2), &TOLERANCES[..3]);
}
