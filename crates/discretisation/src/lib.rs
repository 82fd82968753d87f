//! Discretisations of x = b + K x on the surfaces of a scene: x(p) = b(p) + ρ(p) ∫_S k(p, q) x(q)
//! dA(q).
//!
//! An [`Equation`] is a [`Transfer`] (the kernel on a [`Surface`] of [`Chart`]s, with the strategy
//! that integrates it) and a reflectance. A [`Discretisation`] turns it into a
//! [`System`]: a linear operator for the solvers, right-hand sides for any number of sources, and the evaluation of the
//! solution anywhere. [`discretisations`] lists them all.
//!
//! The theory is that of G. Peyré's article on integral equations, sections 1.2 to 1.4 and 3, and
//! of K. E. Atkinson, *The Numerical Solution of Integral Equations of the Second Kind*, Cambridge
//! University Press 1997, doi:10.1017/CBO9780511626340. Lengths in metres; for light x and b in
//! W/m², k in 1/m².

mod assessment;
mod chart;
mod cholesky;
mod convergence;
mod degree;
mod discretisation;
mod equation;
mod error;
mod gram;
mod inverse;
mod lagrange;
mod light;
pub mod manufactured;
mod mass;
mod method;
mod registry;
mod space;
mod surface;
mod system;
mod transfer;

pub use assessment::{Assessment, FieldError};
pub use chart::{Chart, CylinderStrip, FlatChart, Site, SpherePatch};
pub use convergence::{Convergence, Verdict, convergence};
pub use degree::Degree;
pub use discretisation::Discretisation;
pub use equation::{Equation, Source};
pub use error::DiscretisationError;
pub use lagrange::{Lagrange, Nodes};
pub use light::{ElementMeans, Light, Lit, Nodal};
pub use method::{Collocation, DegenerateKernel, Galerkin, LeastSquares, Nystrom};
pub use registry::{discretisation, discretisations};
pub use space::Space;
pub use surface::{Rules, Surface};
pub use system::System;
pub use transfer::{Exchanges, FlatLambert, Kernel, Sink, SmoothTransfer, Transfer};
