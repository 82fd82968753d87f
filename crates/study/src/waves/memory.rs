//! The memory of a scene of waves, known before it is taken.

use fredholm_scene::waves::{Receiver, WaveScene};

use crate::memory::Plan;

/// Bytes of a facet: its patch in the mesh, its frame, what blocks the view, radiating points, and
/// the arrays of its file.
const FACET: u128 = 490;
/// Bytes of a facet and frequency: its currents, and their arrays in the file.
const CURRENTS: u128 = 240;
/// Bytes of a receiver's point, and of a row of it at one frequency while the fields are put
/// together and written.
const POINT: u128 = 24;
const ROW: u128 = 716;
/// Bytes of the plots and of the page with its viewer while they are written.
const PAGE: u128 = 6 << 20;
/// Bytes of a point while its field is sampled, of each batch that is in memory, and of a point at
/// one frequency while the results are written.
const SAMPLED: u128 = 72;
const BATCH: u128 = 48;
const ESTIMATED: u128 = 440;

/// What so many facets take, and the fields at all points sampled so many batches at once.
pub(super) fn sampled(facets: u128, scene: &WaveScene, batches: u32) -> Plan {
    let bands = scene.waves().len() as u128;
    let places = all_places(scene);
    let sampling = places.saturating_mul(SAMPLED + BATCH * (2 + u128::from(batches)));
    Plan::default()
        .hold(format!("{facets} facets"), facets.saturating_mul(FACET))
        .hold(format!("{places} points"), places.saturating_mul(POINT))
        .stage(format!("{batches} batches of samples"), sampling)
        .stage("the estimates and their files", places.saturating_mul(ESTIMATED * bands))
}

/// Points and directions of all receivers.
fn all_places(scene: &WaveScene) -> u128 {
    scene.receivers().iter().map(Receiver::count).sum()
}

/// What so many facets and all receivers take.
pub(super) fn plan(facets: u128, scene: &WaveScene) -> Plan {
    let bands = scene.waves().len() as u128;
    let places = all_places(scene);
    Plan::default()
        .hold(format!("{facets} facets"), facets.saturating_mul(FACET + CURRENTS * bands))
        .hold(format!("{places} points and directions"), places.saturating_mul(POINT + ROW * bands))
        .hold("plots and the page", PAGE)
}
