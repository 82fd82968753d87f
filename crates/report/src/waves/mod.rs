//! Complex fields: E (V/m) and H (A/m) as peak phasors with time factor e^{+jωt}, at receivers and
//! on surfaces.
//!
//! A phasor vector pair is twelve numbers: ex, ey, ez, hx, hy, hz, each real part first.

mod comparison;
mod csv;
mod map;
mod methods;
mod monostatic;
mod npz;
mod over_angle;
mod over_frequency;
mod residuals;
mod section;
mod vtu;

pub use comparison::{WAVE_COMPARISON_FORMAT, WaveComparison, WaveComparisonCase, write_wave_comparison};
pub use csv::{write_far_csv, write_receivers_csv};
pub use map::{FieldMap, MapAxis, MapQuantity};
pub use methods::{
    METHODS_FILES, METHODS_FORMAT, MethodAtReceiver, MethodCurves, MethodRun, MethodsRecord, write_methods,
};
pub use monostatic::{MonostaticRow, write_monostatic_csv};
pub use npz::{write_far_npz, write_monostatic_npz, write_receivers_npz};
pub use over_angle::{AngleQuantity, write_angle_plot};
pub use over_frequency::{FrequencyLine, scaled_frequencies, write_frequency_plot};
pub use residuals::{WaveResiduals, write_residuals_csv, write_residuals_plot};
pub use section::MapPlane;
pub use vtu::{WaveCurrents, write_currents_vtu};

/// The fields at a point of a receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveRow {
    /// Index of the receiver.
    pub receiver: usize,
    /// Index of the point in it.
    pub index: usize,
    /// Position, m.
    pub position: [f64; 3],
    /// Frequency, Hz.
    pub frequency: f64,
    /// Incident E and H.
    pub incident: [f64; 12],
    /// Scattered E and H.
    pub scattered: [f64; 12],
}

impl WaveRow {
    /// Incident and scattered field together.
    #[must_use]
    pub fn total(&self) -> [f64; 12] {
        std::array::from_fn(|i| self.incident[i] + self.scattered[i])
    }
}

/// The far field in a direction.
#[derive(Clone, Debug, PartialEq)]
pub struct FarRow {
    /// Index of the receiver.
    pub receiver: usize,
    /// Index of the direction in it.
    pub index: usize,
    /// Angle from +z, degrees.
    pub theta_degrees: f64,
    /// Angle from +x about z, degrees.
    pub phi_degrees: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// F of E → F e^{−jkr}/r along θ̂ and φ̂: real and imaginary part, V.
    pub amplitude: [f64; 4],
    /// Radar cross-sections for reception along θ̂ and φ̂, m², where a plane wave is incident.
    pub cross_section: Option<[f64; 2]>,
    /// The far field with that of the sources, where all of them are at places.
    pub total: Option<FarTotal>,
}

/// The far field of located sources and of all that they light, in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarTotal {
    /// F along θ̂ and φ̂: real and imaginary part, V.
    pub amplitude: [f64; 4],
    /// 4π times the power per solid angle over the power that the sources supply; not a number
    /// where that is not known.
    pub gain: f64,
}
