//! The memory of a scene of waves, known before it is taken.

use fredholm_scene::waves::{Receiver, WaveScene};

use crate::memory::Plan;

/// Bytes of a facet: its patch in the mesh, its frame, what blocks the view, radiating points, and
/// the arrays of its file.
const BYTES_A_FACET: u128 = 490;
/// Bytes of a facet and frequency: its currents, and their arrays while the file is written.
const BYTES_OF_CURRENTS: u128 = 96;
const BYTES_OF_CURRENT_ARRAYS: u128 = 144;
/// Bytes of a receiver's point, and of a row of it at one frequency while the fields are put
/// together and written.
const BYTES_A_POINT: u128 = 24;
const BYTES_A_ROW: u128 = 716;
/// Bytes of the plots and of the page with its viewer while they are written.
const BYTES_OF_PAGE: u128 = 6 << 20;
/// Bytes of a point while its field is sampled, of each batch that is in memory, and of a point at
/// one frequency while the results are written.
const BYTES_A_SAMPLED_POINT: u128 = 72;
const BYTES_A_BATCH: u128 = 48;
const BYTES_AN_ESTIMATE: u128 = 440;

/// What so many facets take, and the fields at all points sampled so many batches at once.
pub(super) fn sampled(facets: u128, scene: &WaveScene, batches: u32) -> Plan {
    let bands = scene.waves().len() as u128;
    let places = all_places(scene);
    let sampling = places.saturating_mul(BYTES_A_SAMPLED_POINT + BYTES_A_BATCH * (2 + u128::from(batches)));
    Plan::default()
        .hold(format!("{facets} facets"), facets.saturating_mul(BYTES_A_FACET))
        .hold(format!("{places} points"), places.saturating_mul(BYTES_A_POINT))
        .stage(format!("{batches} batches of samples"), sampling)
        .stage("the estimates and their files", places.saturating_mul(BYTES_AN_ESTIMATE * bands))
}

/// Points and directions of all receivers.
fn all_places(scene: &WaveScene) -> u128 {
    scene.receivers().iter().map(Receiver::count).sum()
}

/// What so many facets and all receivers take.
pub(super) fn plan(facets: u128, scene: &WaveScene) -> Plan {
    let bands = scene.waves().len() as u128;
    let places = all_places(scene);
    let arrays = facets.saturating_mul(BYTES_OF_CURRENT_ARRAYS * bands);
    Plan::default()
        .hold(format!("{facets} facets"), facets.saturating_mul(BYTES_A_FACET + BYTES_OF_CURRENTS * bands))
        .hold(
            format!("{places} points and directions"),
            places.saturating_mul(BYTES_A_POINT + BYTES_A_ROW * bands),
        )
        .stage("plots, the page and the files of currents", arrays.saturating_add(BYTES_OF_PAGE))
}
