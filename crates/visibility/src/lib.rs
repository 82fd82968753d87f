//! Segment, ray and shaft queries against the surfaces of a scene.

mod closest;
mod error;
mod exact;
mod facet;
mod frame;
mod occluders;
mod probe;
mod segment;
mod shaft;
mod tree;

pub use closest::Hit;
pub use error::VisibilityError;
pub use occluders::Occluders;
