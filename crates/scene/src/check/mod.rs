//! Mistakes that only the whole geometry shows.

mod coincident;
mod facing;
mod lamps;

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use fredholm_mesh::Mesh;

use crate::error::{Place, SceneError};
use crate::scene::Scene;

/// Something in a scene that is allowed, but probably not meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The scene file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What is remarkable.
    pub what: String,
    /// What to do where it is not meant.
    pub help: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}; {}", self.file.display(), self.place, self.what, self.help)
    }
}

impl Scene {
    /// Looks at a mesh of this scene as a whole: whether anything emits, whether lit sides face each other and whether
    /// faces coincide.
    ///
    /// # Errors
    /// [`ErrorKind::Inverted`](crate::ErrorKind::Inverted) where no lit side can receive light, as in a room whose
    /// walls are lit outside.
    pub fn check(&self, mesh: &Mesh) -> Result<Vec<Warning>, SceneError> {
        let mut warnings: Vec<Warning> = lamps::check(self, mesh).into_iter().collect();
        warnings.extend(facing::check(self, mesh)?);
        warnings.extend(coincident::check(self, mesh));
        Ok(warnings)
    }

    /// A warning about surface `surface` of the mesh.
    fn warning(&self, surface: usize, what: String, help: &str) -> Warning {
        let span = self.parts().get(surface).map_or(0..0, |part| part.span.clone());
        self.warning_at(span, what, help)
    }

    fn warning_at(&self, span: Range<usize>, what: String, help: &str) -> Warning {
        let (file, place) = (self.path().to_owned(), self.source().place(span));
        Warning { file, place, what, help: help.to_owned() }
    }
}

/// Whether the material of a surface emits in any band.
fn emits(scene: &Scene, mesh: &Mesh, surface: usize) -> bool {
    scene.materials()[mesh.surfaces()[surface].material].exitance.iter().any(|&exitance| exitance > 0.0)
}
