//! The solvers of all crates, by name.

use fredholm_linop::{Access, OptionError, Options, Solver};

/// The solver where none is asked for.
pub(crate) const USUAL_SOLVER: &str = "gauss-seidel";

/// A solver, and what is known of it.
pub struct SolverEntry {
    /// The solver.
    pub solver: Box<dyn Solver<f64>>,
    /// Whether there are iterates on the way that are worth keeping.
    pub iterative: bool,
    /// What it asks of the matrix.
    pub access: Access,
    /// What it asks of the system.
    pub requirements: &'static str,
    /// Its options and what they mean.
    pub options: &'static [(&'static str, &'static str)],
}

/// All solvers of real systems with their usual options.
pub fn solvers() -> impl Iterator<Item = SolverEntry> {
    names().into_iter().filter_map(find)
}

/// The names of all solvers of real systems.
#[must_use]
pub fn names() -> Vec<&'static str> {
    let iterative = fredholm_iterative::entries::<f64>().into_iter().map(|entry| entry.name);
    iterative.chain(fredholm_direct::entries::<f64>().into_iter().map(|entry| entry.name)).collect()
}

/// The names of the solvers of real systems that ask for no more of the matrix.
pub(crate) fn names_within(access: Access) -> String {
    let within = solvers().filter(|entry| entry.access <= access);
    within.map(|entry| entry.solver.name()).collect::<Vec<_>>().join(", ")
}

/// The solver of this name, where there is one.
pub(crate) fn find(name: &str) -> Option<SolverEntry> {
    build(name).ok()
}

/// The solver that a text such as `sor:omega=1.2` asks for.
///
/// # Errors
/// There is none of this name, or its options are wrong.
pub fn build(text: &str) -> Result<SolverEntry, OptionError> {
    let (name, given) = Options::parse(text)?;
    let scheme = fredholm_iterative::entries::<f64>().into_iter().find(|entry| entry.name == name);
    if let Some(entry) = scheme {
        let solver = Box::new(entry.build(given)?);
        let (access, requirements, options) = (entry.access, entry.requirements, entry.options);
        return Ok(SolverEntry { solver, iterative: true, access, requirements, options });
    }
    let direct = fredholm_direct::entries::<f64>().into_iter().find(|entry| entry.name == name);
    let unknown = || OptionError::Solver { name, known: names().join(", ") };
    let entry = direct.ok_or_else(unknown)?;
    let (access, requirements, options) = (entry.access, entry.requirements, entry.options);
    Ok(SolverEntry { solver: entry.build(given)?, iterative: false, access, requirements, options })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_the_default_is_one_of_them() {
        let mut names = names();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert!(names.len() == count && names.contains(&USUAL_SOLVER));
        assert!(find(USUAL_SOLVER).unwrap().iterative && !find("lu").unwrap().iterative);
        assert!(find("magic").is_none());
        assert_eq!(solvers().count(), count);
    }

    #[test]
    fn options_reach_their_solver() {
        assert_eq!(build("gmres:restart=7").unwrap().solver.name(), "gmres");
        assert!(build("lu:omega=1").is_err() && build("gmres:omega=1").is_err() && build("magic").is_err());
    }
}
