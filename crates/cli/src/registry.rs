//! The solvers of all crates, by name.

use fredholm_linop::Solver;

/// The solver where none is asked for.
pub(crate) const DEFAULT: &str = "gauss-seidel";

/// A solver and where it comes from.
pub(crate) struct Entry {
    pub(crate) solver: Box<dyn Solver<f64>>,
    /// Whether there are iterates on the way that are worth keeping.
    pub(crate) iterative: bool,
}

/// All solvers.
pub(crate) fn all() -> impl Iterator<Item = Entry> {
    let entry = |iterative| move |solver| Entry { solver, iterative };
    let iterative = fredholm_iterative::solvers().into_iter().map(entry(true));
    iterative.chain(fredholm_direct::solvers().into_iter().map(entry(false)))
}

/// The names of all solvers.
pub(crate) fn names() -> Vec<&'static str> {
    all().map(|entry| entry.solver.name()).collect()
}

/// The solver of this name, where there is one.
pub(crate) fn find(name: &str) -> Option<Entry> {
    all().find(|entry| entry.solver.name() == name)
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
        assert!(names.len() == count && names.contains(&DEFAULT));
        assert!(find(DEFAULT).unwrap().iterative && !find("lu").unwrap().iterative);
        assert!(find("magic").is_none());
    }
}
