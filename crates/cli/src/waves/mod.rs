//! Scenes of waves: their files, what they mean, and what is written.

mod compare;
mod compute;
mod estimate;
mod files;
mod format;
mod geometry;
mod located;
mod memory;
mod model;
mod monostatic;
mod receivers;
mod record;
mod registry;
mod solving;
mod sources;

pub(crate) use compare::compare;
pub(crate) use compute::compute;
pub(crate) use files::write;
pub(crate) use model::{Band, Method, Model, is_scene};
pub(crate) use receivers::Places;
pub(crate) use record::Outcome;
pub(crate) use registry::{build, names};
