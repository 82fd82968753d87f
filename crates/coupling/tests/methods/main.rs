//! The named form-factor methods against closed forms, limits and each other.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod cases;
mod catalogue;
#[allow(dead_code, reason = "shared with the test of random pairs, which needs more of it")]
#[path = "../random_pairs/generator.rs"]
mod generator;
mod limits;
mod occlusion;
mod random;
#[allow(dead_code, reason = "the generator needs one function of it")]
#[path = "../random_pairs/reference.rs"]
mod reference;
mod sampling;

use fredholm_coupling::method::{Evaluated, Setting, method};
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;

/// A method by name on a pair with nothing between.
fn open(name: &str, pair: &[Patch; 2], setting: Setting) -> Evaluated {
    behind(name, pair, &[], setting)
}

/// The same behind some patches.
fn behind(name: &str, pair: &[Patch; 2], occluders: &[Patch], setting: Setting) -> Evaluated {
    let occluders = Occluders::new(occluders).unwrap();
    method(name).unwrap().exchange(&pair[0], &pair[1], &occluders, setting).unwrap()
}

fn smaller(pair: &[Patch; 2]) -> f64 {
    pair[0].area().min(pair[1].area())
}
