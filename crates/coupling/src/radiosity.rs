//! The radiosity system (I − R F) B = M, for all bands at once.
//!
//! B radiosity, M exitance (W/m²), R = diag(ρ), A_i F_ij = G_ij (m²). With D = diag(ρ_i / A_i) the
//! system is I − D G, so that one symmetric G serves every band. C. M. Goral et al., SIGGRAPH 1984,
//! doi:10.1145/800031.808601.
//!
//! Part of an element may be buried, as the floor is under a box: it sees nothing and nothing sees
//! it. The unknown is the radiosity of the exposed part, w_i A_i, which takes the place of A_i in
//! D. What is reported are means over whole elements, the buried part having irradiance 0: E_i =
//! Σ_j G_ij B_j / A_i.

use crate::CouplingError;
use fredholm_linop::{LinearOperator, MultiVector, PackedSymmetric, Storage};

/// Areas, reflectances and exitances of the elements: everything but the form factors.
#[derive(Clone, Debug, PartialEq)]
pub struct Radiosity {
    elements: Vec<Extent>,
    reflectance: MultiVector<f64>,
    exitance: MultiVector<f64>,
}

/// Size of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Area A, m².
    pub area: f64,
    /// Exposed area w A, m².
    pub exposed: f64,
}

/// Means over whole elements, W/m².
#[derive(Clone, Debug, PartialEq)]
pub struct Means {
    /// E, elements × bands.
    pub irradiance: MultiVector<f64>,
    /// M + ρ E, elements × bands.
    pub radiosity: MultiVector<f64>,
}

/// Where the power of one band goes, W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Σ w A M.
    pub emitted: f64,
    /// Σ A (1 − ρ) E.
    pub absorbed: f64,
    /// Σ w A B (1 − Σ_j F_ij): what leaves through openings, and what errors of the form factors
    /// lose or add.
    pub escaped: f64,
}

impl Radiosity {
    /// Takes sizes, reflectances and exitances (W/m²; elements × bands).
    ///
    /// # Errors
    /// [`CouplingError::Dimension`] where the three do not have the same number of elements, or the
    /// last two not the same number of bands.
    pub fn new(
        elements: Vec<Extent>,
        reflectance: MultiVector<f64>,
        exitance: MultiVector<f64>,
    ) -> Result<Self, CouplingError> {
        let n = elements.len();
        let fits =
            reflectance.dim() == n && exitance.dim() == n && reflectance.rhs_count() == exitance.rhs_count();
        if !fits {
            return Err(CouplingError::Dimension {
                elements: n,
                found: reflectance.dim().min(exitance.dim()),
            });
        }
        Ok(Self { elements, reflectance, exitance })
    }

    /// Sizes of the elements.
    #[must_use]
    pub fn elements(&self) -> &[Extent] {
        &self.elements
    }

    /// ρ, elements × bands.
    #[must_use]
    pub fn reflectance(&self) -> &MultiVector<f64> {
        &self.reflectance
    }

    /// M, the right-hand side, W/m².
    #[must_use]
    pub fn exitance(&self) -> &MultiVector<f64> {
        &self.exitance
    }

    /// D = ρ / (w A), 1/m²: the system is I − D G. An element with nothing exposed reflects
    /// nothing.
    #[must_use]
    pub fn scaling(&self) -> MultiVector<f64> {
        self.map(|i, l| match self.elements[i].exposed {
            exposed if exposed > 0.0 => self.reflectance.row(i)[l] / exposed,
            _ => 0.0,
        })
    }

    /// Means over whole elements for a solution `x`, the radiosity of the exposed parts.
    #[must_use]
    pub fn means(&self, matrix: &dyn LinearOperator<f64>, x: &MultiVector<f64>) -> Means {
        let mut power = MultiVector::zeros(x.dim(), x.rhs_count());
        matrix.apply(x, &mut power);
        let irradiance = self.map(|i, l| power.row(i)[l] / self.elements[i].area);
        let reflected = |i: usize, l: usize| self.reflectance.row(i)[l] * irradiance.row(i)[l];
        let radiosity = self.map(|i, l| self.exitance.row(i)[l] + reflected(i, l));
        Means { irradiance, radiosity }
    }

    /// Σ_j F_ij of the exposed part of every element: 1 in a closed scene. An element with nothing
    /// exposed has 1 too: it loses nothing.
    #[must_use]
    pub fn closure<S: Storage>(&self, matrix: &PackedSymmetric<S>) -> Vec<f64> {
        let rows = matrix.row_sums();
        let sizes = self.elements.iter().map(|e| e.exposed);
        rows.iter().zip(sizes).map(|(sum, exposed)| if exposed > 0.0 { sum / exposed } else { 1.0 }).collect()
    }

    /// The balance of every band for a solution `x`, its means and the closure.
    #[must_use]
    pub fn energy(&self, x: &MultiVector<f64>, means: &Means, closure: &[f64]) -> Vec<Energy> {
        let mut energy = vec![Energy::default(); self.exitance.rhs_count()];
        for (i, size) in self.elements.iter().enumerate() {
            for (l, band) in energy.iter_mut().enumerate() {
                let absorbed = (1.0 - self.reflectance.row(i)[l]) * means.irradiance.row(i)[l];
                band.emitted += size.exposed * self.exitance.row(i)[l];
                band.absorbed += size.area * absorbed;
                band.escaped += size.exposed * x.row(i)[l] * (1.0 - closure[i]);
            }
        }
        energy
    }

    fn map(&self, value: impl FnMut(usize, usize) -> f64) -> MultiVector<f64> {
        MultiVector::from_fn(self.elements.len(), self.exitance.rhs_count(), value)
    }
}
