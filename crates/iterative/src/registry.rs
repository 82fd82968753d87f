//! The schemes by name, with their options.

use crate::{
    Anderson, Bicgstab, BlockGaussSeidel, BlockJacobi, CgPsi, CgTheta, Chebyshev, GaussSeidel, Gmres,
    GroupShooting, Hgs1, Hgs2, Hybrid, Jacobi, Minres, Neumann, PcgCholesky, PcgJacobi, PcgSsor, Progressive,
    Sor, Southwell, Ssor, Sur,
};
use fredholm_linop::{Access, Entry, OfScalar, OptionError, Options, Scalar, Scheme, Solver, build};
use num_complex::Complex64;

/// All schemes of this crate, by name.
///
/// ```
/// use fredholm_linop::build;
///
/// let scheme = build(&fredholm_iterative::entries::<f64>(), "sor:omega=1.2")?;
/// assert_eq!(scheme.name(), "sor");
/// # use fredholm_linop::Scheme;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn entries<T: Scalar>() -> Vec<Entry<dyn Scheme<T>>> {
    T::choose::<Entries>(real, complex)
}

struct Entries;

impl OfScalar for Entries {
    type Of<T: Scalar> = Vec<Entry<dyn Scheme<T>>>;
}

fn real() -> Vec<Entry<dyn Scheme<f64>>> {
    all()
}

fn complex() -> Vec<Entry<dyn Scheme<Complex64>>> {
    all()
}

fn all<T: Scalar>() -> Vec<Entry<dyn Scheme<T>>> {
    let mut entries = relaxations();
    entries.extend(shootings());
    entries.extend(blocks());
    entries.extend(krylov());
    entries.extend(hybrids());
    entries
}

/// All schemes of this crate with their default options.
///
/// ```
/// let names: Vec<_> = fredholm_iterative::solvers::<f64>().iter().map(|solver| solver.name()).collect();
/// assert!(names.contains(&"gauss-seidel") && names.contains(&"gmres"));
/// ```
#[must_use]
pub fn solvers<T: Scalar>() -> Vec<Box<dyn Solver<T>>> {
    let made = entries().into_iter().filter_map(|entry| entry.build(Options::default()).ok());
    made.map(|scheme| Box::new(scheme) as Box<dyn Solver<T>>).collect()
}

type Made<T> = Result<Box<dyn Scheme<T>>, OptionError>;

const NEEDS_DIAGONAL: &str = "a diagonal without zeros";
const NEEDS_SYMMETRY: &str = "a symmetric coupling, factors at least 0, positive definite";

fn relaxations<T: Scalar>() -> Vec<Entry<dyn Scheme<T>>> {
    vec![
        plain("gauss-seidel", Access::Entries, NEEDS_DIAGONAL, |_| Ok(Box::new(GaussSeidel))),
        plain("neumann", Access::Products, "none", |_| Ok(Box::new(Neumann))),
        Entry {
            name: "jacobi",
            access: Access::Diagonal,
            symmetric: false,
            requirements: NEEDS_DIAGONAL,
            options: &[("omega", "weight above 0, default 1")],
            make: |options| {
                let omega = options.number("omega", "a number above 0", |x| x > 0.0 && x.is_finite())?;
                Ok(Box::new(omega.map_or_else(Jacobi::default, |omega| Jacobi { omega })))
            },
        },
        Entry {
            name: "sor",
            access: Access::Entries,
            symmetric: false,
            requirements: NEEDS_DIAGONAL,
            options: &[("omega", "factor between 0 and 2, default automatic")],
            make: |options| Ok(Box::new(Sor { omega: omega(options, 2.0)? })),
        },
        Entry {
            name: "sur",
            access: Access::Entries,
            symmetric: false,
            requirements: NEEDS_DIAGONAL,
            options: &[("omega", "factor between 0 and 1, default 0.8")],
            make: |options| {
                Ok(Box::new(omega(options, 1.0)?.map_or_else(Sur::default, |omega| Sur { omega })))
            },
        },
        Entry {
            name: "ssor",
            access: Access::Entries,
            symmetric: false,
            requirements: NEEDS_DIAGONAL,
            options: &[("omega", "factor between 0 and 2, default 1")],
            make: |options| {
                Ok(Box::new(omega(options, 2.0)?.map_or_else(Ssor::default, |omega| Ssor { omega })))
            },
        },
    ]
}

fn shootings<T: Scalar>() -> Vec<Entry<dyn Scheme<T>>> {
    vec![
        plain("southwell", Access::Entries, NEEDS_DIAGONAL, |_| Ok(Box::new(Southwell))),
        Entry {
            name: "progressive",
            access: Access::Entries,
            symmetric: false,
            requirements: NEEDS_DIAGONAL,
            options: &[
                ("overshoot", "yes or no, default no; real unknowns only"),
                ("shots", "shots an iteration, default one for each unknown"),
            ],
            make: |options| {
                let (overshoot, shots) = (yes(options, "overshoot")?, options.count("shots")?);
                Ok(Box::new(Progressive { areas: Vec::new(), overshoot, shots }))
            },
        },
        Entry {
            name: "group-shooting",
            access: Access::Entries,
            symmetric: false,
            requirements: "groups that are not singular",
            options: &[("size", "patches in a group, default 16")],
            make: |options| {
                let size = options.count("size")?;
                Ok(Box::new(size.map_or_else(GroupShooting::default, |size| GroupShooting { size })))
            },
        },
    ]
}

fn blocks<T: Scalar>() -> Vec<Entry<dyn Scheme<T>>> {
    vec![
        Entry {
            name: "block-jacobi",
            access: Access::Entries,
            symmetric: false,
            requirements: "diagonal blocks that are not singular",
            options: &[("size", "unknowns in a block, default 3")],
            make: |options| {
                let size = options.count("size")?;
                Ok(Box::new(size.map_or_else(BlockJacobi::default, |size| BlockJacobi { size })))
            },
        },
        Entry {
            name: "block-gauss-seidel",
            access: Access::Entries,
            symmetric: false,
            requirements: "diagonal blocks that are not singular",
            options: &[("size", "unknowns in a block, default 3")],
            make: |options| {
                let size = options.count("size")?;
                Ok(Box::new(size.map_or_else(BlockGaussSeidel::default, |size| BlockGaussSeidel { size })))
            },
        },
    ]
}

fn krylov<T: Scalar>() -> Vec<Entry<dyn Scheme<T>>> {
    vec![
        symmetric("cg-psi", Access::Products, NEEDS_SYMMETRY, |_| Ok(Box::new(CgPsi))),
        symmetric("cg-theta", Access::Products, NEEDS_SYMMETRY, |_| Ok(Box::new(CgTheta))),
        symmetric("pcg-jacobi", Access::Diagonal, NEEDS_SYMMETRY, |_| Ok(Box::new(PcgJacobi))),
        Entry {
            name: "pcg-ssor",
            access: Access::Entries,
            symmetric: true,
            requirements: NEEDS_SYMMETRY,
            options: &[("omega", "factor between 0 and 2, default 1")],
            make: |options| {
                Ok(Box::new(omega(options, 2.0)?.map_or_else(PcgSsor::default, |omega| PcgSsor { omega })))
            },
        },
        Entry {
            name: "pcg-ic",
            access: Access::Entries,
            symmetric: true,
            requirements: NEEDS_SYMMETRY,
            options: &[("threshold", "what is left out, relative to the mean of a row, default 10")],
            make: |options| {
                let threshold = options.number("threshold", "a number of at least 0", |x| x >= 0.0)?;
                Ok(Box::new(
                    threshold.map_or_else(PcgCholesky::default, |threshold| PcgCholesky { threshold }),
                ))
            },
        },
        Entry {
            name: "chebyshev",
            access: Access::Products,
            symmetric: true,
            requirements: "a real positive spectrum: given, or a symmetric coupling and factors at least 0",
            options: &[("low", "lowest eigenvalue, with high"), ("high", "highest eigenvalue, with low")],
            make: chebyshev,
        },
        symmetric("minres", Access::Products, "a symmetric coupling, factors at least 0", |_| {
            Ok(Box::new(Minres))
        }),
        Entry {
            name: "gmres",
            access: Access::Products,
            symmetric: false,
            requirements: "none",
            options: &[("restart", "steps before it begins anew, default 30")],
            make: |options| {
                let restart = options.count("restart")?;
                Ok(Box::new(restart.map_or_else(Gmres::default, |restart| Gmres { restart })))
            },
        },
        plain("bicgstab", Access::Products, "none", |_| Ok(Box::new(Bicgstab))),
        Entry {
            name: "anderson",
            access: Access::Products,
            symmetric: false,
            requirements: "none",
            options: &[("depth", "differences remembered, default 5")],
            make: |options| {
                let depth = options.count("depth")?;
                Ok(Box::new(depth.map_or_else(Anderson::default, |depth| Anderson { depth })))
            },
        },
    ]
}

fn hybrids<T: Scalar>() -> Vec<Entry<dyn Scheme<T>>> {
    vec![
        Entry {
            name: "hgs1",
            access: Access::Entries,
            symmetric: false,
            requirements: "those of the sequence",
            options: &[("sequence", "name of a scheme, default gauss-seidel")],
            make: |options| {
                let sequence = named(options, "sequence")?;
                Ok(Box::new(sequence.map_or_else(Hgs1::default, |sequence| Hgs1 { sequence })))
            },
        },
        plain("hgs2", Access::Entries, NEEDS_DIAGONAL, |_| Ok(Box::new(Hgs2))),
        Entry {
            name: "hybrid",
            access: Access::Entries,
            symmetric: false,
            requirements: "those of both schemes",
            options: &[
                ("first", "name of a scheme, default gauss-seidel"),
                ("second", "name of a scheme, default progressive"),
            ],
            make: |options| {
                let (first, second) = (named(options, "first")?, named(options, "second")?);
                let Hybrid { first: usual_first, second: usual_second } = Hybrid::default();
                let (first, second) = (first.unwrap_or(usual_first), second.unwrap_or(usual_second));
                Ok(Box::new(Hybrid { first, second }))
            },
        },
    ]
}

/// One for symmetric couplings.
fn symmetric<T: Scalar>(
    name: &'static str,
    access: Access,
    requirements: &'static str,
    make: fn(&mut Options) -> Made<T>,
) -> Entry<dyn Scheme<T>> {
    Entry { symmetric: true, ..plain(name, access, requirements, make) }
}

fn plain<T: Scalar>(
    name: &'static str,
    access: Access,
    requirements: &'static str,
    make: fn(&mut Options) -> Made<T>,
) -> Entry<dyn Scheme<T>> {
    Entry { name, access, symmetric: false, requirements, options: &[], make }
}

fn omega(options: &mut Options, below: f64) -> Result<Option<f64>, OptionError> {
    let expected = if below > 1.0 { "a number between 0 and 2" } else { "a number between 0 and 1" };
    options.number("omega", expected, |omega| omega > 0.0 && omega < below)
}

fn yes(options: &mut Options, option: &str) -> Result<bool, OptionError> {
    match options.text(option).as_deref() {
        None | Some("no") => Ok(false),
        Some("yes") => Ok(true),
        Some(other) => {
            let (option, value) = (option.to_owned(), other.to_owned());
            Err(OptionError::Value { option, value, expected: "yes or no" })
        }
    }
}

fn chebyshev<T: Scalar>(options: &mut Options) -> Made<T> {
    let mut bound = |name| options.number(name, "a number above 0", |x| x > 0.0 && x.is_finite());
    let interval = match (bound("low")?, bound("high")?) {
        (Some(low), Some(high)) => Some((low, high)),
        (None, None) => None,
        (low, _) => {
            let option = if low.is_some() { "high" } else { "low" }.to_owned();
            let expected = "given where the other end of the interval is";
            return Err(OptionError::Value { option, value: String::new(), expected });
        }
    };
    Ok(Box::new(Chebyshev { interval }))
}

/// The scheme that an option names, with its default options.
fn named<T: Scalar>(options: &mut Options, option: &str) -> Result<Option<Box<dyn Scheme<T>>>, OptionError> {
    options.text(option).map(|name| build(&entries(), &name)).transpose()
}
