//! What a mesh is, as it comes: which of its pieces hang together, which way they are turned, and
//! what touches what.
//!
//! Pieces are flat convex polygons, undivided: the occluders of a [`Mesh`](crate::Mesh), say.
//! [`Topology`] looks at the sides that they share, [`Contacts`] at pieces that cross or lie on
//! each other without sharing anything. Metres.

mod boxes;
mod contacts;
mod cover;
mod overlap;
mod topology;

pub use contacts::{Contacts, Overlap};
pub use topology::{Component, Repeat, Topology};
