//! What the studies that trace random paths have in common.

mod fields;
mod ground;
mod options;
mod pixels;
mod tracer;

pub use fields::FIELD_METHODS;
pub(crate) use fields::{FieldPoint, FieldRun, field_points};
pub(crate) use ground::{
    Drawn, Ground, control, controlling, enclosure, expected_error, face_means, faces, with_tracing,
};
pub use options::{PathOptions, SamplePoints, TraceStop};
pub(crate) use pixels::PixelTracer;
pub(crate) use tracer::{Tracer, controlled, failure};
