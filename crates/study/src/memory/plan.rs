//! The memory that a run will take, known before any of it is taken.

use std::fmt;

use super::Limit;
use fredholm_linop::Watch;

use crate::error::{Error, ErrorKind};
use crate::size::Bytes;

/// Bytes of the program itself, before there is a scene.
const BYTES_OF_PROGRAM: u128 = 10 << 20;

/// Bytes by use: what is held from its beginning on, and what each stage holds besides, of which
/// there is one at a time.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    held: Vec<Part>,
    stages: Vec<Part>,
    /// Addresses that are set aside and hardly touched.
    aside: u128,
}

/// A use of memory.
#[derive(Clone, Debug)]
struct Part {
    what: String,
    bytes: u128,
}

impl Plan {
    /// Adds what is held all along.
    pub(crate) fn hold(mut self, what: impl Into<String>, bytes: u128) -> Self {
        self.held.push(Part { what: what.into(), bytes });
        self
    }

    /// Adds what is held in one stage only.
    pub(crate) fn stage(mut self, what: impl Into<String>, bytes: u128) -> Self {
        self.stages.push(Part { what: what.into(), bytes });
        self
    }

    /// Adds addresses that are set aside and, but for what is counted, never touched.
    pub(crate) fn aside(self, bytes: u128) -> Self {
        Self { aside: self.aside.max(bytes), ..self }
    }

    /// The most that is held at a time.
    #[must_use]
    pub fn peak(&self) -> Bytes {
        let held = self.held.iter().fold(BYTES_OF_PROGRAM, |sum, part| sum.saturating_add(part.bytes));
        Bytes(held.saturating_add(self.largest().map_or(0, |part| part.bytes)))
    }

    /// The stage that holds most.
    fn largest(&self) -> Option<&Part> {
        self.stages.iter().max_by_key(|part| part.bytes)
    }

    /// Whether it stays within a limit.
    pub(crate) fn fits(&self, limit: Limit) -> bool {
        self.peak().0.saturating_add(limit.counted(self.aside)) <= limit.bytes.0
    }

    /// Tells what is predicted and what is allowed.
    pub(crate) fn tell(&self, limit: Limit, watch: &dyn Watch) {
        watch.memory(self.peak().0, limit.bytes.0);
    }

    /// Refuses what is above the limit; `help` says how to need less.
    pub(crate) fn admit(&self, limit: Limit, help: &str) -> Result<(), Error> {
        if self.fits(limit) {
            return Ok(());
        }
        let aside = match limit.counted(self.aside) {
            0 => String::new(),
            _ => format!(" and {} of addresses that its threads set aside", Bytes(self.aside)),
        };
        let threads = if aside.is_empty() { "" } else { ", fewer --threads" };
        let text = format!("this needs {}{aside}, but the limit is {limit}: {self}", self.peak());
        let help = format!("{help}{threads}, or {}", limit.help());
        Err(Error::new(ErrorKind::Resources, text).with_help(help))
    }
}

impl fmt::Display for Plan {
    /// The uses, in order, the stage that holds most among them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Part { what, bytes } in self.held.iter().chain(self.largest()).filter(|part| part.bytes > 0) {
            write!(f, "{} for {what}, ", Bytes(*bytes))?;
        }
        write!(f, "{} for the program", Bytes(BYTES_OF_PROGRAM))
    }
}

#[cfg(test)]
mod tests {
    use super::super::limit::Bound;
    use super::*;

    #[test]
    fn stages_come_one_after_the_other() {
        let plan =
            Plan::default().hold("the mesh", 1 << 20).stage("the matrix", 8 << 20).stage("files", 2 << 20);
        assert_eq!(plan.peak(), Bytes(19 << 20));
        let text = "1.0 MiB for the mesh, 8.0 MiB for the matrix, 10.0 MiB for the program";
        assert_eq!(plan.to_string(), text);
        let limit = |bytes| Limit { bytes: Bytes(bytes), bound: Bound::Group, spare: None };
        assert!(plan.admit(limit(19 << 20), "less").is_ok());
        let refused = plan.admit(limit((19 << 20) - 1), "use less").unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::Resources);
        let text = refused.to_string();
        assert!(text.contains("help: use less, or raise the limit of the control group"), "{text}");
    }

    #[test]
    fn addresses_set_aside_are_refused_where_they_are_limited() {
        let plan = Plan::default().hold("all", 6 << 20).aside(8 << 20).aside(4 << 20);
        let limit = |spare| Limit { bytes: Bytes(20 << 20), bound: Bound::AddressSpace, spare };
        assert!(plan.fits(limit(None)) && plan.fits(limit(Some(4 << 20))));
        let refused = plan.admit(limit(Some(0)), "use less").unwrap_err().to_string();
        assert!(refused.contains("and 8.0 MiB of addresses") && refused.contains("--threads"), "{refused}");
    }

    #[test]
    fn too_much_to_count_is_still_refused() {
        let plan = Plan::default().hold("all", u128::MAX).stage("more", u128::MAX);
        assert_eq!(plan.peak(), Bytes(u128::MAX));
    }
}
