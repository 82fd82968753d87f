//! Queries compared with what other arithmetic, other algorithms or geometry itself says of the
//! same scenes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod batches;
mod bodies;
mod integer;
mod leaks;
mod limits;
mod plates;
mod rays;
mod rooms;
mod scenes;
mod shafts;
