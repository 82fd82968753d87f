//! Stochastic counterparts of the deterministic solvers: x = b + K x by random paths, with standard
//! errors.
//!
//! [`light`] estimates the irradiance of patches in seven ways, [`statistics`] decides whether two
//! solutions agree, [`Tracing`] runs batches until there are enough. Random numbers are those of a
//! key, [`points`]: no result depends on the number of threads, or on whether a run was continued.
//!
//! ```
//! use fredholm_linop::Quiet;
//! use fredholm_mesh::{Patch, Vec3};
//! use fredholm_montecarlo::light::{Switches, estimator};
//! use fredholm_montecarlo::{Enclosure, Groups, Stop, Tracing};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A lamp above a floor, unit squares at distance 1: E = 0.1998 M on the floor.
//! let corner = |x, y, z| Vec3::new(x, y, z);
//! let floor = [corner(0., 0., 0.), corner(1., 0., 0.), corner(1., 1., 0.), corner(0., 1., 0.)];
//! let lamp = [corner(0., 0., 1.), corner(0., 1., 1.), corner(1., 1., 1.), corner(1., 0., 1.)];
//! let patches = [floor, lamp].into_iter().map(Patch::quad).collect::<Result<Option<Vec<_>>, _>>()?;
//! let scene = Enclosure::new(patches.ok_or("not flat")?, 1, vec![0.0; 2], vec![0.0, 1.0])?;
//! let path = estimator("path", &scene, Switches::default()).ok_or("no such method")?;
//! let tracing = Tracing::new(&scene, &*path, Groups::new(&scene, vec![0, 1], 2)?, 1, 16)?;
//! let mut state = tracing.start();
//! tracing.go_on(&mut state, &Stop { batches: Some(64), ..Stop::default() }, &Quiet)?;
//! let (mean, error) = (state.groups.mean()[0], state.groups.standard_errors()[0]);
//! assert!((mean - 0.1998).abs() < 4.0 * error && error < 0.01);
//! # Ok(())
//! # }
//! ```
//!
//! Units: metres, W/m².

pub mod density;
mod enclosure;
mod error;
pub mod light;
mod locator;
pub mod philox;
pub mod points;
pub mod rows;
mod run;
pub mod statistics;
mod surfaces;
pub mod waves;

pub use enclosure::Enclosure;
pub use error::MonteCarloError;
pub use run::{BATCHES_AT_ONCE, FEWEST_BATCHES, Groups, State, Stop, Tracing, relative_l2};
pub use surfaces::{Meets, Site, Surfaces};
