//! Scenes of waves: their files, what they mean, and what is written.

mod choice;
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
mod study;

pub(crate) use compare::compare;
pub(crate) use compute::compute;
pub use estimate::Estimated;
pub(crate) use model::{Band, Method, Model, is_scene};
pub(crate) use receivers::Places;
pub(crate) use record::Outcome;
pub use record::Solved as SolvedFrequency;
pub use study::{
    CouplingStorage, SolvedWaves, WaveCompareOptions, WaveOptions, check_wave_solver, compare_waves, waves,
};
