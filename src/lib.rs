//! Fredholm solves x = b + K x on the surfaces of a scene; this crate re-exports the public face of its parts.

pub use fredholm_coupling as coupling;
pub use fredholm_direct as direct;
pub use fredholm_iterative as iterative;
pub use fredholm_linop as linop;
pub use fredholm_mesh as mesh;
pub use fredholm_quadrature as quadrature;
pub use fredholm_report as report;
pub use fredholm_scene as scene;
pub use fredholm_visibility as visibility;
