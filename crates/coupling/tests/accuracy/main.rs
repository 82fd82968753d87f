//! Matrices of enclosures against exact ones, and what the accuracy asked for does to them.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod exact;
mod stacked;
mod symmetry;
mod view3d;
