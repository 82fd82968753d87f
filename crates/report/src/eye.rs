//! What a camera sees of a mesh.
//!
//! Rays are cast among the leaves that turn their lit side to the eye; the others are invisible, so
//! that a closed room shows its inside.

use fredholm_mesh::{Mesh, Patch, Vec3};
use fredholm_visibility::Occluders;

use crate::camera::Axes;
use crate::{Camera, ReportError};

/// A camera before a mesh.
#[derive(Clone, Debug)]
pub struct Eye {
    camera: Camera,
    axes: Axes,
    /// The leaves that face the eye, and their numbers.
    facing: Occluders,
    leaves: Vec<usize>,
}

impl Eye {
    /// Looks at a mesh.
    ///
    /// # Errors
    /// [`ReportError::Camera`] for settings that make no picture, [`ReportError::Visibility`] where
    /// the surfaces cannot be prepared for ray casting.
    pub fn new(mesh: &Mesh, camera: &Camera) -> Result<Self, ReportError> {
        let axes = camera.axes()?;
        let lit = |patch: &Patch| patch.normal().dot(camera.eye - patch.centroid()) > 0.0;
        let seen = mesh.patches().enumerate().filter(|(_, patch)| lit(patch));
        let (leaves, patches): (Vec<usize>, Vec<Patch>) = seen.map(|(leaf, &patch)| (leaf, patch)).unzip();
        let facing =
            Occluders::new(&patches).map_err(|error| ReportError::Visibility { why: error.to_string() })?;
        Ok(Self { camera: *camera, axes, facing, leaves })
    }

    /// The camera.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Leaf and point (m) seen through a place of the picture, in pixels from the upper left.
    #[must_use]
    pub fn hit(&self, x: f64, y: f64) -> Option<(usize, Vec3)> {
        let direction = self.camera.direction(&self.axes, x, y);
        let hit = self.facing.closest(self.camera.eye, direction, f64::INFINITY)?;
        Some((self.leaves[hit.patch], hit.point))
    }

    /// The point (m) of the plane of a patch that is seen through a place of the picture.
    pub(crate) fn on_plane(&self, patch: &Patch, x: f64, y: f64) -> Vec3 {
        let direction = self.camera.direction(&self.axes, x, y);
        let (origin, normal) = (self.camera.eye, patch.normal());
        origin + direction * (normal.dot(patch.centroid() - origin) / normal.dot(direction))
    }

    /// Where a point is in the picture, pixels from the upper left; none for one behind the eye.
    pub(crate) fn place(&self, point: Vec3) -> Option<(f64, f64)> {
        self.camera.place(&self.axes, point)
    }
}
