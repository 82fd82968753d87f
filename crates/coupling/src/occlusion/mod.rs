//! Which pairs of patches see each other wholly, in part or not at all, decided for groups of patches at once.

mod cluster;
mod walk;

pub(crate) use cluster::Clusters;
pub(crate) use walk::{Panel, Sight, walk};
