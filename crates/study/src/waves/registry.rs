//! The solvers of complex systems, by name.

use fredholm_linop::{Access, OptionError, Options, Solver};
use fredholm_waves::Complex64;

/// The names of all solvers.
pub(crate) fn names() -> Vec<&'static str> {
    let iterative = fredholm_iterative::entries::<Complex64>().into_iter().map(|entry| entry.name);
    iterative.chain(fredholm_direct::entries::<Complex64>().into_iter().map(|entry| entry.name)).collect()
}

/// The names of those that ask for products only and take any coupling: where the matrix does not
/// fit, they compute it anew each time.
pub(super) fn by_products() -> Vec<&'static str> {
    let entries = fredholm_iterative::entries::<Complex64>().into_iter();
    entries
        .filter(|entry| entry.access == Access::Products && !entry.symmetric)
        .map(|entry| entry.name)
        .collect()
}

/// The solver of complex systems that a text such as `gmres:restart=100` asks for.
///
/// # Errors
/// There is none of this name, or its options are wrong.
pub fn build(text: &str) -> Result<Box<dyn Solver<Complex64>>, OptionError> {
    let (name, given) = Options::parse(text)?;
    let scheme = fredholm_iterative::entries::<Complex64>().into_iter().find(|entry| entry.name == name);
    if let Some(entry) = scheme {
        return Ok(Box::new(entry.build(given)?));
    }
    let direct = fredholm_direct::entries::<Complex64>().into_iter().find(|entry| entry.name == name);
    let unknown = || OptionError::Solver { name, known: names().join(", ") };
    direct.ok_or_else(unknown)?.build(given)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_reach_their_solver() {
        assert_eq!(build("gmres:restart=7").unwrap().name(), "gmres");
        assert_eq!(build("lu").unwrap().name(), "lu");
        assert!(build("gmres:omega=1").is_err() && build("magic").is_err() && build("lu:size").is_err());
        assert!(names().iter().all(|name| build(name).is_ok()));
    }
}
