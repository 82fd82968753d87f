//! Scene files: from TOML and OBJ to a meshed problem.
//!
//! A scene file names surfaces, what they are made of and how they are cut. [`Scene::load`] reads
//! it and the files it names, and refuses what makes no sense with a [`SceneError`] that points at
//! the place. [`Scene::mesh`] cuts the surfaces, [`Scene::check`] looks for mistakes that only the
//! whole geometry shows, [`Scene::report`] tells what a mesh is. A mesh file stands for a scene,
//! too. [`Scene::outline`] is the scene as other programs read it. [`schema()`] is the JSON Schema
//! of the format.
//!
//! Units: metres, degrees where a name says so, W/m².

mod bare;
mod check;
mod error;
mod export;
mod files;
mod format;
mod geometry;
mod import;
mod parse;
mod part;
mod resolve;
mod scene;
mod schema;
mod source;
mod suggest;
pub mod waves;

pub use check::{Finding, Report, Shown, Warning};
pub use error::{ErrorKind, Place, SceneError};
pub use export::{ExportFormat, Exported, Outline, OutlineMaterial, OutlineSurface};
pub use geometry::{By, Geometry, Rows, Surfaces};
pub use resolve::{Camera, Material, SolveDefaults, Storage};
pub use scene::Scene;
pub use schema::{schema, wave_schema};
