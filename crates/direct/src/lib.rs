//! Direct solvers of (I − D K) x = b, and its spectrum.
//!
//! A solver is one file here and one entry in the registry, see [`entries`]. All report the same
//! residual ‖b − A x‖₂/‖b‖₂ per right-hand side as the iterative ones, see
//! [`fredholm_linop::Monitor`].

mod buffers;
mod bunch_kaufman;
mod cholesky;
mod dense_ldlt;
mod dense_lu;
mod eigen;
mod factorisation;
mod groups;
mod mixed_lu;
mod scalar;
mod spectrum;
mod symmetric_form;

pub use buffers::thread_addresses;
pub use cholesky::Cholesky;
pub use dense_ldlt::DenseLdlt;
pub use dense_lu::DenseLu;
pub use mixed_lu::MixedLu;
pub use scalar::DenseScalar;
pub use spectrum::{Spectrum, SpectrumError, spectrum, spectrum_bytes};

use fredholm_linop::{Access, Entry, Options, Solver};

/// All solvers of this crate, by name. T is f64 or Complex64.
#[must_use]
pub fn entries<T: DenseScalar>() -> Vec<Entry<dyn Solver<T>>> {
    let none = "a matrix that is not singular to working precision";
    vec![
        Entry {
            name: "lu",
            access: Access::Entries,
            symmetric: false,
            requirements: none,
            options: &[],
            make: |_| Ok(Box::new(DenseLu)),
        },
        Entry {
            name: "lu-mixed",
            access: Access::Entries,
            symmetric: false,
            requirements: "a condition below about a million",
            options: &[],
            make: |_| Ok(Box::new(MixedLu)),
        },
        Entry {
            name: "ldlt",
            access: Access::Entries,
            symmetric: true,
            requirements: "a symmetric coupling, factors at least 0 where they are real",
            options: &[],
            make: |_| Ok(Box::new(DenseLdlt)),
        },
        Entry {
            name: "cholesky",
            access: Access::Entries,
            symmetric: true,
            requirements: "a symmetric coupling, factors at least 0, positive definite",
            options: &[],
            make: |_| Ok(Box::new(Cholesky)),
        },
    ]
}

/// All solvers of this crate.
///
/// ```
/// let names: Vec<_> = fredholm_direct::solvers::<f64>().iter().map(|solver| solver.name()).collect();
/// assert_eq!(names, ["lu", "lu-mixed", "ldlt", "cholesky"]);
/// ```
#[must_use]
pub fn solvers<T: DenseScalar>() -> Vec<Box<dyn Solver<T>>> {
    entries().into_iter().filter_map(|entry| entry.build(Options::default()).ok()).collect()
}
