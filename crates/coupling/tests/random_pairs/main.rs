//! Form factors of random pairs of patches against other formulas.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod behind;
mod generator;
mod occluded;
mod open;
mod reference;
