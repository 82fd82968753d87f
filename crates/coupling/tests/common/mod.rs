//! Scenes that several tests share.

use fredholm_coupling::form_factor::{Exchange, PairIntegrator, Workspace};
use fredholm_mesh::{Mesh, Patch, Vec3};
use fredholm_visibility::Occluders;

pub fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A patch of three or four corners.
pub fn patch(corners: &[Vec3]) -> Patch {
    match *corners {
        [a, b, c] => Patch::triangle([a, b, c]).unwrap(),
        [a, b, c, d] => Patch::quad([a, b, c, d]).unwrap().unwrap(),
        _ => panic!("a patch has three or four corners"),
    }
}

#[allow(dead_code, reason = "not every test needs every helper")]
/// Exchange of the first two of some patches, all of which block.
pub fn exchange(patches: &[Patch], tolerance: f64) -> Exchange {
    let occluders = Occluders::new(patches).unwrap();
    let integrator = PairIntegrator::new(patches, &occluders, tolerance);
    integrator.exchange(0, 1, &mut Workspace::default())
}

/// The integrator of a mesh, handed to `use_it`.
#[allow(dead_code, reason = "not every test needs every helper")]
pub fn with_integrator<R>(mesh: &Mesh, tolerance: f64, use_it: impl FnOnce(&PairIntegrator) -> R) -> R {
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    use_it(&PairIntegrator::new(mesh.patches(), &occluders, tolerance))
}
