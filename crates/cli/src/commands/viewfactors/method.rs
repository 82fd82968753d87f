//! The methods that form factors can be computed with. This is the one place that knows them.

/// The cheapest method whose error estimate meets the tolerance, for each pair.
pub(super) const AUTO: &str = "auto";

/// The names of all methods.
pub(super) fn names() -> Vec<&'static str> {
    vec![AUTO]
}
