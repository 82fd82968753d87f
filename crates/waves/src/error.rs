//! What can be wrong with a problem of waves, and how to mend it.

use fredholm_linop::LinopError;
use fredholm_mesh::MeshError;
use fredholm_visibility::VisibilityError;
use thiserror::Error;

/// A problem that cannot be set up or computed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum WaveError {
    /// The frequency is none.
    #[error("the frequency is {value} Hz, but must be finite and above 0")]
    Frequency {
        /// What was given, Hz.
        value: f64,
    },
    /// A length is none.
    #[error("{what} is {value} m, but must be finite and above 0")]
    Length {
        /// Which length.
        what: &'static str,
        /// What was given, m.
        value: f64,
    },
    /// A direction has no length, or is not finite.
    #[error("{what} must be a finite vector other than 0")]
    Direction {
        /// Which direction.
        what: &'static str,
    },
    /// A polarisation points along the direction of travel.
    #[error("the polarisation is parallel to the direction of travel")]
    Polarisation,
    /// A plane wave comes from where it cannot.
    #[error("the direction of travel {what}")]
    Travel {
        /// What is wrong with it.
        what: &'static str,
    },
    /// A wedge has no such angle.
    #[error("the open angle of a wedge is {value} π, but must be above 0 and at most 2 π")]
    Wedge {
        /// What was given, over π.
        value: f64,
    },
    /// An amplitude or a coordinate is NaN or infinite.
    #[error("{what} is not a finite number")]
    NotFinite {
        /// What the number is.
        what: &'static str,
    },
    /// There is no facet.
    #[error("the scatterer has no facets")]
    NoFacets,
    /// Facets are too large for the wave.
    #[error(
        "facet {facet} has edges up to {edge} m, which is more than half the wavelength of {wavelength} m"
    )]
    Coarse {
        /// Index of the facet.
        facet: usize,
        /// Its longest edge, m.
        edge: f64,
        /// λ, m.
        wavelength: f64,
    },
    /// A receiver lies on a facet, where the field jumps.
    #[error("point {receiver} of the receivers lies on facet {facet}, where the field jumps")]
    OnSurface {
        /// Index of the point.
        receiver: usize,
        /// Index of the facet.
        facet: usize,
    },
    /// A receiver lies in a source.
    #[error("the field of a source at point {receiver} of the receivers is not finite")]
    InSource {
        /// Index of the point.
        receiver: usize,
    },
    /// The treatment of shadows asks for closed bodies.
    #[error(
        "the magnetic field equation is made for closed bodies, but facet {facet} belongs to an open sheet"
    )]
    NotClosed {
        /// Index of the facet.
        facet: usize,
    },
    /// A closed body has no room for a second surface inside.
    #[error(
        "the second surface would be {depth} m behind facet {facet}, too close to the first for the equation on two surfaces"
    )]
    Thin {
        /// Index of the facet.
        facet: usize,
        /// Depth of the second surface, m.
        depth: f64,
    },
    /// The equation on two surfaces is asked for as means over facets.
    #[error("the equation on two surfaces is made discrete at the centres of the facets only")]
    CentresOnly,
    /// A model of perfect conductors meets another material.
    #[error("{what} knows perfect conductors only, but facet {facet} is of another material")]
    NotConductor {
        /// The model.
        what: &'static str,
        /// Index of the facet.
        facet: usize,
    },
    /// A material passes no energy law.
    #[error("material {what}: {reason}")]
    Material {
        /// Its name or number.
        what: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The geometry cannot be meshed.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The geometry cannot be searched.
    #[error(transparent)]
    Visibility(#[from] VisibilityError),
    /// A matrix cannot be built.
    #[error(transparent)]
    Linop(#[from] LinopError),
}

impl WaveError {
    /// What to do about it, where that is more than to correct the value.
    #[must_use]
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::Polarisation => Some("give one across it"),
            Self::NoFacets => Some("add a surface"),
            Self::Coarse { .. } => Some("mesh finer, λ/10 is usual"),
            Self::OnSurface { .. } => Some("move it off the surface"),
            Self::InSource { .. } => Some("move the point out of the source"),
            Self::NotClosed { .. } => {
                Some("close the body, or take method = \"physical-optics\" or \"efie\"")
            }
            Self::Thin { .. } => Some("take method = \"mfie\" or \"cfie\", or make the body thicker there"),
            Self::CentresOnly => Some("ask for Nyström"),
            Self::NotConductor { .. } => Some("take method = \"physical-optics\" without edge currents"),
            Self::Mesh(error) => Some(error.help()),
            Self::Frequency { .. }
            | Self::Length { .. }
            | Self::Direction { .. }
            | Self::Travel { .. }
            | Self::Wedge { .. }
            | Self::NotFinite { .. }
            | Self::Material { .. }
            | Self::Visibility(_)
            | Self::Linop(_) => None,
        }
    }
}
