//! Scenes of waves: their files, what they mean, and what is written.

mod balance;
mod check;
mod choice;
mod compare;
mod compute;
mod estimate;
mod files;
mod forecast;
mod galerkin;
mod geometry;
mod interpolation;
mod maps;
mod memory;
mod methods;
mod model;
mod monostatic;
mod over_angle;
mod over_frequency;
mod record;
mod registry;
mod solving;
mod study;

pub use balance::{Balance, Reciprocity};
pub use check::{CheckedCoupling, CheckedWaves, check_waves};
pub(crate) use compare::compare;
pub(crate) use compute::compute;
pub use estimate::Estimated;
pub use interpolation::Interpolated as InterpolatedSweep;
pub use methods::WaveMethod;
pub(crate) use model::{Band, Method, Model};
pub(crate) use record::Outcome;
pub use record::Solved as SolvedFrequency;
pub use registry::build as build_wave_solver;
pub use study::{
    CouplingStorage, SolvedWaves, WaveCompareOptions, WaveOptions, check_wave_solver, compare_wave_methods,
    compare_waves, waves,
};
