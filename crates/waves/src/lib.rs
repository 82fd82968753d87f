//! Waves: perfect conductors and other bodies in a time-harmonic field, by surface currents.
//!
//! The field of given currents is an integral without approximation ([`Radiator`]); what the
//! currents are is the question. Time factor e^{+jωt}, outgoing waves e^{−jkr}/(4πr), SI units,
//! peak phasors.
//!
//! Here u = (p − q)/R points from the source q to the observer p, and g = e^{−jkR}/(4πR).

pub mod canonical;
mod complex;
mod coupling;
mod current;
mod edges;
mod element;
mod error;
mod field;
mod ground;
pub mod lanes;
pub mod material;
pub mod medium;
mod mie;
mod optics;
mod power;
mod radiation;
mod rule;
pub mod source;
mod stated;
pub mod surface;

pub use complex::ComplexVector;
pub use coupling::{
    Bounced, Bounces, Discretisation, MaterialCoupling, NystromCoupling, System, galerkin, spectral_radius,
};
pub use current::{Current, FacetCurrents, SurfaceCurrent};
pub use edges::EdgeCurrents;
pub use element::{electric_element, magnetic_element};
pub use error::WaveError;
pub use field::Field;
pub use ground::{Ground, Grounded};
pub use medium::Wave;
pub use mie::{ConductingSphere, DielectricSphere, ImpedanceSphere, LayeredSphere, ResistiveShell};
pub use num_complex::Complex64;
pub use optics::{PhysicalOptics, Shadow};
pub use power::{extinct, largest_extinct, radiated, sphere_rule, supplied};
pub use radiation::{
    FarField, Gate, Pattern, Radiator, Sampling, TOLERANCE, cross_section, even_directions, polar_frame,
};
pub use source::{Origin, Source, incident};
pub use stated::{
    Indicator, field_inside, inside_points, left_inside, of_closed_elements, of_closed_first_order,
};
pub use surface::{Facet, Kind, Scatterer};
