//! The module `fredholm._core`: every study of [`fredholm_study`] as a function of Python.
//!
//! What is here moves numbers and names between Python and the studies, and nothing else: the
//! names, the documentation and the checks that users see are the Python sources in
//! `python/fredholm`. Arrays that are made here are moved into NumPy and those of a result share
//! its memory; none is copied. A study runs on threads of its own while the interpreter is
//! free.

mod arrays;
mod coupling;
mod failure;
mod locks;
mod operator;
mod options;
mod run;
mod scene;
mod solved;
mod solvers;
mod studies;
mod viewfactors;
mod waves;

use pyo3::prelude::*;

/// The compiled part of the package.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::coupling::{Coupling, Couplings, couplings};
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::solved::{Solved, solve};
    #[pymodule_export]
    use crate::solvers::{solve_system, solvers};
    #[pymodule_export]
    use crate::studies::{Study, check, compare, converge, crosscheck, judge, reference, spectrum, trace};
    #[pymodule_export]
    use crate::viewfactors::{ViewFactors, methods, view_factors};
    #[pymodule_export]
    use crate::waves::{Waves, compare_wave_methods, compare_waves, waves};

    /// Version of the package.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
