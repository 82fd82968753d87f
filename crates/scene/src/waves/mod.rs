//! Scenes of waves: conductors and other bodies in a time-harmonic field.
//!
//! They are read as scenes of light are: the same located TOML, the same shapes and mesh files, the
//! same suggestions for unknown names. [`WaveScene::load`] reads a file and refuses what makes no
//! sense, [`WaveScene::cut`] says how the surfaces are cut for a wavelength and how many facets
//! that gives, [`Cut::mesh`] cuts them, and [`WaveScene::check`] looks for mistakes that only the
//! whole geometry shows.

mod check;
mod choices;
mod cut;
mod format;
mod material;
mod receiver;
mod scene;
mod settings;
mod sources;
mod surface;

pub use cut::{Cut, Cuts};
pub use receiver::{Layout, Places, Receiver, direction};
pub use scene::{About, WaveScene, is_wave_scene};
pub use settings::{Method, Settings, Shadows};
pub use sources::Placed;

pub(crate) use format::SceneEntry;
