//! Segment, ray and shaft queries against the surfaces of a scene: V(p, q) is 1 where nothing lies
//! between p and q, else 0.
//!
//! [`Occluders`] holds flat convex patches that block the view from both sides. It answers
//! - [`unoccluded`](Occluders::unoccluded): is there anything between two points?
//! - [`closest`](Occluders::closest): what does a ray meet first?
//! - [`shaft`](Occluders::shaft): which patches could come between two patches?
//!
//! [`body::Bodies`] puts the patches together to convex bodies, whose shadows are convex.
//!
//! # What is exact, and what is tolerated
//!
//! *Outlines are exact.* Whether a segment crosses a patch or passes beside it is decided as if
//! with exact arithmetic: what rounding could decide goes to exact predicates. A segment through an
//! edge or a corner that patches share always meets at least one of them, so a closed surface has
//! no leak. Neighbours share an edge if its two ends have the same coordinates, bit for bit.
//!
//! *Ends are tolerant.* The points of a surface lie on it up to rounding only. An end whose height
//! over the plane of a patch is at most the [tolerance](Occluders::tolerance) is on that patch, and
//! the patch does not block. That tolerance is 1e-9 of the longest side of the bounding box, or
//! more where coordinates resolve less. So a surface does not hide its own points; a segment may
//! end on a plate without thickness, made of two coincident faces, on either side, but cannot cross
//! it; and a segment that ends on an edge that several patches share is free of them all.
//!
//! *Boxes are generous.* The tree of boxes that finds the patches is f32 with padded boxes. It
//! decides nothing.
//!
//! No answer depends on the order of the tree or on the number of threads.
//!
//! # Example
//!
//! ```
//! use fredholm_mesh::{Patch, Vec3};
//! use fredholm_visibility::Occluders;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let screen = Patch::triangle([Vec3::ZERO, Vec3::X, Vec3::Y])?;
//! let occluders = Occluders::new(&[screen])?;
//! let (above, below) = (Vec3::new(0.2, 0.2, 1.0), Vec3::new(0.2, 0.2, -1.0));
//!
//! assert!(!occluders.unoccluded(above, below));
//! assert!(occluders.unoccluded(above, Vec3::new(0.2, 0.2, 0.0)));
//! let hit = occluders.closest(above, -Vec3::Z, f64::INFINITY).ok_or("missed")?;
//! assert_eq!((hit.patch, hit.t), (0, 1.0));
//! # Ok(())
//! # }
//! ```
//!
//! Units: metres.

pub mod body;
mod closest;
mod eight;
mod error;
mod exact;
mod facet;
mod frame;
mod occluders;
mod packet;
mod probe;
mod segment;
mod shaft;
mod tree;

pub use closest::Hit;
pub use error::VisibilityError;
pub use occluders::Occluders;
pub use shaft::Shaft;
