//! Exact waves by the method of moments: Galerkin boundary elements for Maxwell's equations on
//! triangle surfaces.
//!
//! Time factor e^{+jωt}, outgoing waves G = e^{−jkR}/(4πR), SI units, peak phasors. The unknown
//! surface currents are sums of Rao–Wilton–Glisson functions, or of those of the first full order
//! on flat or curved triangles; the equations are tested with the same functions and integrated to
//! a stated tolerance.

mod basis;
mod composite;
mod condition;
mod currents;
mod curve;
mod dual;
mod element;
mod element_kernel;
mod element_pairs;
mod equation;
mod error;
mod kernel;
pub mod meshing;
mod operator;
mod pairs;
mod patterns;
mod regions;
mod rules;
mod set;
mod surface;
mod topology;

pub use basis::{Basis, Function, Half, Order, Place};
pub use composite::Composite;
pub use condition::{Condition, Imperfect};
pub use currents::Currents;
pub use curve::Curve;
pub use equation::{Conductor, Equation};
pub use error::MomentsError;
pub use operator::Operator;
pub use regions::{Face, Filling, Placed, Regions};
pub use set::Set;
pub use surface::Surface;
pub use topology::{Component, Edge, Report, Side, TJunction, Topology};
