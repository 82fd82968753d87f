//! The meshed surfaces of a scene.

use std::sync::Arc;

use fredholm_mesh::{Mesh, Shape};
use fredholm_scene::waves::{Cuts, WaveScene};
use fredholm_waves::material::Material;
use fredholm_waves::{Kind, Scatterer, WaveError};

use crate::error::Error;
use crate::problem::scene_failure;

/// The meshed surfaces: what they are, before their materials, which depend on the frequency.
pub(crate) struct Geometry {
    pub(crate) mesh: Mesh,
    scene: Arc<WaveScene>,
}

impl Geometry {
    /// Cuts the surfaces, where `admit` allows so many facets.
    pub(super) fn new(
        scene: &Arc<WaveScene>,
        cuts: Cuts,
        admit: &dyn Fn(u128) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        let cut = scene.cut(cuts).map_err(scene_failure)?;
        admit(cut.facets())?;
        Ok(Self { mesh: cut.mesh().map_err(scene_failure)?, scene: Arc::clone(scene) })
    }

    /// What each surface is part of.
    pub(super) fn kinds(&self) -> Vec<Kind> {
        self.scene.kinds()
    }

    /// The shape of each surface, where it is one alone.
    pub(super) fn shapes(&self) -> impl Iterator<Item = Option<&Shape>> {
        self.scene.single_shapes()
    }

    /// The number of the material of each surface.
    pub(super) fn materials(&self) -> impl Iterator<Item = usize> {
        self.scene.materials_of_surfaces()
    }

    /// The scatterer at one frequency.
    pub(crate) fn scatterer(&self, materials: &[Material]) -> Result<Scatterer, WaveError> {
        self.scene.scatterer(&self.mesh, materials)
    }
}
