//! Scenes made from a number, for tests, examples and benchmarks. The same number gives the same
//! files on every machine.
//!
//! - [`City`]: blocks of houses that touch, overlap and go through each other, under a lit sky;
//! - [`Scan`]: a creased figure with noisy normals, as a scanner gives, in a closed room;
//! - [`Office`] and [`Classroom`]: rooms full of furniture, as programs that model them write it;
//! - [`Room`]: a closed room of any reflectance, whose energy balance is known;
//! - [`Almond`]: the NASA almond, a body for radar cross-sections, with a scene of waves;
//! - [`Case`]: a random valid scene and a command line for it, to look for crashes with;
//! - [`mutated`]: a text with random damages.
//!
//! Lengths in metres, z is up.
//!
//! ```
//! use fredholm_generate::Room;
//!
//! let folder = tempfile::tempdir()?;
//! let room = Room { reflectance: 0.98, furnace: true, ..Room::default() };
//! let scene = fredholm_scene::Scene::load(room.files().write(folder.path())?)?;
//! let mesh = scene.mesh()?;
//! assert!(scene.reflectance(&mesh).iter().all(|&r| r == 0.98));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod almond;
mod body;
mod city;
mod classroom;
mod dice;
mod files;
mod furnished;
mod furniture;
mod mutate;
mod office;
mod random;
mod room;
mod scan;

pub use almond::Almond;
pub use city::City;
pub use classroom::Classroom;
pub use dice::Dice;
pub use files::Files;
pub use mutate::mutated;
pub use office::Office;
pub use random::Case;
pub use room::Room;
pub use scan::Scan;
