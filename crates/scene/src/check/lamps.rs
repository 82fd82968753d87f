//! Whether anything emits.

use fredholm_mesh::Mesh;

use super::{Warning, emits};
use crate::scene::Scene;

pub(super) fn check(scene: &Scene, mesh: &Mesh) -> Option<Warning> {
    if (0..mesh.surfaces().len()).any(|surface| emits(scene, mesh, surface)) {
        return None;
    }
    let what = "no surface emits light, so the solution is dark everywhere".to_owned();
    Some(scene.warning(0, what, "give the material of a surface an exitance above 0"))
}
