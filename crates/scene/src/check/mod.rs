//! Mistakes that only the whole geometry shows.

mod facing;
mod lamps;
mod overlaps;
mod pieces;
mod report;

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use fredholm_mesh::Mesh;

use crate::error::{Place, SceneError};
use crate::scene::Scene;

pub(crate) use pieces::Pieces;
pub use report::{Finding, Report, Shown};

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
    /// Looks at a mesh of this scene as a whole: whether anything emits, whether lit sides face
    /// each other, whether faces lie on each other and objects are turned inside out. What was read
    /// from material libraries and what was mended comes first.
    ///
    /// # Errors
    /// [`ErrorKind::Inverted`](crate::ErrorKind::Inverted) where no lit side can receive light, as
    /// in a room whose walls are lit outside.
    pub fn check(&self, mesh: &Mesh) -> Result<Vec<Warning>, SceneError> {
        let mut warnings: Vec<Warning> = self.notes().to_vec();
        warnings.extend(lamps::check(self, mesh));
        warnings.extend(facing::check(self, mesh)?);
        warnings.extend(overlaps::check(self));
        warnings.extend(report::inside_out(self, mesh));
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
    scene.emits(mesh.surfaces()[surface].material)
}
