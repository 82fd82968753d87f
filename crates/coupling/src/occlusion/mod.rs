//! Which pairs of patches see each other wholly, in part or not at all, decided for groups of
//! patches at once.

mod cluster;
mod lines;
mod walk;

pub(crate) use cluster::{Bound, Clusters, Node};
pub(crate) use walk::{Panel, Sight, walk, walk_from};
