//! Whether lit sides face each other.
//!
//! Patch j can receive light from patch i only where a part of each lies in front of the plane of
//! the other. Patches are convex, so it is enough to look at corners. Nothing in between is looked
//! at.

use fredholm_mesh::{Mesh, Patch, Vec3};

use super::{Warning, emits};
use crate::error::{ErrorKind, SceneError};
use crate::scene::Scene;

/// Sine of the angle above a plane, up to which a corner counts as lying in it.
const GRAZING_SINE: f64 = 1e-9;
/// Most patches that are compared with each other; of larger scenes, every n-th patch of every
/// surface.
const MOST_PATCHES: usize = 4000;

const HELP: &str = "a face is lit on the side from which its corners run counter-clockwise: \
    reverse their order, or set inward = true or two_sided = true";

pub(super) fn check(scene: &Scene, mesh: &Mesh) -> Result<Vec<Warning>, SceneError> {
    let surfaces = samples(mesh);
    let patches: Vec<&Patch> = surfaces.iter().flatten().copied().collect();
    // A surface that others cover has nothing left to face anything.
    let faces_something = |own: &Vec<&Patch>| {
        own.is_empty() || own.iter().any(|a| patches.iter().any(|b| face_each_other(a, b)))
    };
    let facing: Vec<bool> = surfaces.iter().map(faces_something).collect();
    refuse_darkness(scene, mesh, &facing)?;
    let blind = (0..facing.len()).filter(|&surface| !facing[surface]);
    let warning = |surface: usize| {
        let name = &mesh.surfaces()[surface].name;
        scene.warning(surface, format!("the lit side of `{name}` faces no other lit side"), HELP)
    };
    Ok(blind.map(warning).collect())
}

/// Refuses a scene in which no lamp faces anything, or nothing at all where there is no lamp.
fn refuse_darkness(scene: &Scene, mesh: &Mesh, facing: &[bool]) -> Result<(), SceneError> {
    let lamps: Vec<usize> = (0..facing.len()).filter(|&surface| emits(scene, mesh, surface)).collect();
    let mut sources = if lamps.is_empty() { 0..facing.len() } else { 0..0 }.chain(lamps.iter().copied());
    if sources.any(|surface| facing[surface]) {
        return Ok(());
    }
    let what = match lamps.first() {
        Some(&lamp) => {
            format!("the light of `{}` falls on nothing: no lit side faces it", mesh.surfaces()[lamp].name)
        }
        None => "nothing faces anything: are the corners clockwise?".to_owned(),
    };
    let span = scene.parts().get(lamps.first().copied().unwrap_or(0)).map_or(0..0, |part| part.span.clone());
    Err(scene.source().error(ErrorKind::Inverted, span, what, HELP))
}

/// Patches of every surface, evenly picked.
fn samples(mesh: &Mesh) -> Vec<Vec<&Patch>> {
    let mut surfaces: Vec<Vec<&Patch>> = vec![vec![]; mesh.surfaces().len()];
    for (leaf, patch) in mesh.patches().enumerate() {
        surfaces[mesh.surface_of(leaf)].push(patch);
    }
    let quota = (MOST_PATCHES / surfaces.len().max(1)).max(1);
    for patches in &mut surfaces {
        let step = patches.len().div_ceil(quota).max(1);
        *patches = patches.iter().step_by(step).copied().collect();
    }
    surfaces
}

fn face_each_other(a: &Patch, b: &Patch) -> bool {
    in_front(a, b) && in_front(b, a)
}

/// Whether a corner of `b` lies in front of the plane of `a`.
fn in_front(a: &Patch, b: &Patch) -> bool {
    let above = |p: &Vec3| {
        let offset = *p - a.corner(0);
        offset.dot(a.normal()) > GRAZING_SINE * offset.length()
    };
    b.corners().iter().any(above)
}
