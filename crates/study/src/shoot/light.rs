//! Exitances, reflectances and exposed areas of the elements, and the field that follows from what
//! they have received.

use fredholm_coupling::{Constants, Extent, Groups, MeshError, exposed_shares};
use fredholm_linop::{MultiVector, Watch};
use fredholm_mesh::Patch;
use fredholm_report::Field;

use crate::error::{Error, ErrorKind};
use crate::mesh_error;
use crate::problem::{Open, prepare};
use crate::solve::report_failure;

/// The elements as sources and receivers of light.
pub(super) struct Light {
    /// M, W/m², elements × bands.
    pub(super) exitance: MultiVector<f64>,
    reflectance: MultiVector<f64>,
    /// A, m².
    areas: Vec<f64>,
    /// w A, m².
    pub(super) exposed: Vec<f64>,
    /// w.
    shares: Vec<f64>,
}

impl Light {
    pub(super) fn new(scene: &Open) -> Result<Self, Error> {
        let patches: Vec<Patch> = scene.mesh.patches().copied().collect();
        let shares = exposed_shares(&scene.patches(), &prepare(&patches)?);
        let areas: Vec<f64> = patches.iter().map(Patch::area).collect();
        let exposed = areas.iter().zip(&shares).map(|(area, share)| area * share).collect();
        let values = |values: Vec<f64>| {
            MultiVector::from_vec(scene.mesh.len(), scene.scene.bands().len(), values)
                .map_err(|error| Error::new(ErrorKind::Input, error))
        };
        Ok(Self {
            exitance: values(scene.scene.exitance(&scene.mesh))?,
            reflectance: values(scene.scene.reflectance(&scene.mesh))?,
            areas,
            exposed,
            shares,
        })
    }

    /// D = ρ/(w A), 1/m².
    pub(super) fn scaling(&self) -> MultiVector<f64> {
        MultiVector::from_fn(self.areas.len(), self.exitance.rhs_count(), |i, l| match self.exposed[i] {
            exposed if exposed > 0.0 => self.reflectance.row(i)[l] / exposed,
            _ => 0.0,
        })
    }

    /// Groups of elements that reflect alike and are exposed as a whole.
    pub(super) fn groups(&self, scene: &Open) -> Groups {
        let mut known: Vec<&[f64]> = Vec::new();
        let mut kind = |i: usize| {
            let row = self.reflectance.row(i);
            known.iter().position(|other| *other == row).unwrap_or_else(|| {
                known.push(row);
                known.len() - 1
            })
        };
        let alone = |i: usize| u32::MAX - i as u32;
        let kinds: Vec<u32> = (0..self.areas.len())
            .map(|i| if self.shares[i] < 1.0 { alone(i) } else { kind(i) as u32 })
            .collect();
        Groups::new(&scene.patches(), &kinds, scene.occluders.tolerance())
    }

    /// The stated error of the field so far, of which `unshot` is still to be sent; none where
    /// `watch` breaks.
    pub(super) fn error(
        &self,
        scene: &Open,
        (received, unshot): (&MultiVector<f64>, &MultiVector<f64>),
        watch: &dyn Watch,
    ) -> Result<Option<MeshError>, Error> {
        let scaling = self.scaling();
        let radiosity = MultiVector::from_fn(received.dim(), received.rhs_count(), |i, l| {
            self.exitance.row(i)[l] + scaling.row(i)[l] * received.row(i)[l]
        });
        let irradiance = self.irradiance(received);
        let size = |(&area, &exposed): (&f64, &f64)| Extent { area, exposed };
        let elements: Vec<Extent> = self.areas.iter().zip(&self.exposed).map(size).collect();
        let patches = scene.patches();
        let constants = Constants {
            patches: &patches,
            occluders: &scene.occluders,
            elements: &elements,
            reflectance: &self.reflectance,
            radiosity: &radiosity,
            irradiance: &irradiance,
        };
        mesh_error::of_shooting(&scene.mesh, &constants, unshot, watch)
    }

    /// Means over whole elements, W/m², from the power that each has received.
    pub(super) fn irradiance(&self, received: &MultiVector<f64>) -> MultiVector<f64> {
        MultiVector::from_fn(received.dim(), received.rhs_count(), |i, l| received.row(i)[l] / self.areas[i])
    }

    /// M + ρ E, means over whole elements, W/m², from the power that each has received.
    pub(super) fn means(&self, received: &MultiVector<f64>) -> MultiVector<f64> {
        MultiVector::from_fn(received.dim(), received.rhs_count(), |i, l| {
            self.exitance.row(i)[l] + self.reflectance.row(i)[l] * received.row(i)[l] / self.areas[i]
        })
    }

    /// Shows the field of a radiosity (W/m²) and of the power received (W).
    pub(super) fn field<R>(
        &self,
        scene: &Open,
        received: &MultiVector<f64>,
        radiosity: &MultiVector<f64>,
        show: impl FnOnce(&Field<'_>) -> Result<R, Error>,
    ) -> Result<R, Error> {
        let irradiance = self.irradiance(received);
        let bands = scene.scene.bands();
        let field = Field::new(&scene.mesh, bands, irradiance.as_slice(), radiosity.as_slice())
            .and_then(|field| field.with_exitance(self.exitance.as_slice()))
            .and_then(|field| field.with_exposed(&self.shares))
            .map_err(report_failure)?;
        show(&field)
    }
}
