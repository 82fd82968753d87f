//! A study is a scene, a question and its answer: everything that a program asks of Fredholm, as
//! plain functions.
//!
//! | question | function |
//! |---|---|
//! | the light of a scene, on its elements or to an accuracy | [`solve`], [`resume`] |
//! | whether a scene is valid, and what its solution will take | [`check`] |
//! | the order of the error on finer and finer meshes | [`converge`] |
//! | which solver needs how long | [`compare`] |
//! | eigenvalues and conditions of the matrix | [`spectrum`] |
//! | pictures at once, and scenes whose matrix would not fit | [`shoot`] |
//! | the matrix of view factors | [`view_factors`], [`solve_view_factors`] |
//! | the couplings themselves, for solvers and analyses of one's own | [`couplings`] |
//! | the fields of a scene of waves | [`waves`], [`check_waves`], [`compare_waves`], [`compare_wave_methods`] |
//! | estimates by random paths | [`trace`] |
//! | whether a solution and random paths agree | [`crosscheck`] |
//! | reference values for other programs | [`reference()`] |
//! | whether another tracer agrees with such values | [`judge()`] |
//! | a scene for other programs, a mesh in another format | [`export`], [`convert`] |
//!
//! Options are structs with defaults: what is not asked for is as the scene says, else as usual.
//! Every function takes one [`Watch`], which is told of progress and can cancel the run; [`Quiet`]
//! does neither. Errors say of which kind they are and how to mend them ([`Error`]). Nothing here
//! prints, reads a command line or ends the process. Runs use the threads of the pool they are
//! called in; [`thread_pool`] makes one. Memory is predicted before it is taken, and result files
//! appear whole or not at all.

mod check;
mod checkpoint;
mod choice;
mod compare;
mod converge;
mod couplings;
mod crosscheck;
mod directions;
mod discretised;
mod error;
mod exchange;
mod folder;
mod hierarchical;
mod judge;
mod lamplight;
mod lit_by;
mod memory;
mod mesh_error;
mod meter;
mod openness;
mod options;
mod pictures;
mod prediction;
mod problem;
mod rays;
mod record;
mod reference;
mod registry;
mod rounds;
mod sample;
mod sampled_lamps;
mod shadows;
mod shoot;
mod size;
mod solution;
mod solve;
mod spectrum;
mod stages;
mod stochastic;
mod summary;
mod threads;
mod trace;
mod trial;
mod viewfactors;
mod watcher;
mod waves;

pub use check::{Checked, Forecast, ToAccuracy, check};
pub use checkpoint::Checkpoint;
pub use compare::{CompareOptions, check_solver, compare, reflectance_sweep};
pub use converge::{ConvergeOptions, converge};
pub use couplings::{Couplings, couplings};
pub use crosscheck::{CrosscheckOptions, MultipleTests, Verdict, crosscheck};
pub use error::{Error, ErrorKind};
pub use exchange::{Written, convert, export};
pub use folder::{claim as claim_folder, claim_to_add as claim_folder_to_add};
pub use fredholm_coupling::Receiver;
pub use fredholm_discretisation::{discretisation, discretisations};
pub use fredholm_linop::{Quiet, Watch};
pub use fredholm_mesh::Vec3;
pub use fredholm_report::{ResultFolder, WAVE_FILES};
pub use fredholm_scene::ExportFormat;
pub use judge::{JudgeOptions, judge};
pub use memory::{
    Limit as MemoryLimit, Plan as MemoryPlan, addresses_are_limited, less_than_asked, peak as peak_memory,
};
pub use options::{
    FalseColour, FieldFile, GatherPoints, PointGrid, Precision, ProblemOptions, Recorded, SceneSource,
    SolveOptions, StopOptions, Way,
};
pub use reference::{ReferenceOptions, reference};
pub use registry::{SolverEntry, build as build_solver, names as solver_names, solvers};
pub use shoot::{ShootOptions, shoot};
pub use size::Bytes;
pub use solve::{Ended, Solved, SurfaceLight, resume, solve};
pub use spectrum::{SpectrumOptions, spectrum};
pub use stochastic::{FIELD_METHODS, PathOptions, SamplePoints, TraceStop};
pub use summary::{Lines, Made, Summarise, WaveRecord, extent, frequencies, info, summary};
pub use threads::thread_pool;
pub use trace::{LIGHT_METHODS, TraceOptions, Traced, trace};
pub use viewfactors::{
    MatrixFiles, MatrixRows, SKY, SolvedViewFactors, ViewFactorOptions, closure as matrix_closure, largest,
    point_closure, solve_view_factors, view_factor_methods, view_factors,
};
pub use waves::{
    Balance, CheckedCoupling, CheckedWaves, CouplingStorage, Estimated, InterpolatedSweep, Reciprocity,
    SolvedFrequency, SolvedWaves, WaveCompareOptions, WaveMethod, WaveOptions, build_wave_solver,
    check_wave_solver, check_waves, compare_wave_methods, compare_waves, waves,
};
