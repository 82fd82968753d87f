//! What the verbs that trace random paths have in common.

mod args;
mod fields;
mod ground;
mod tracer;

pub(crate) use args::{PathArgs, TraceStopArgs, share};
pub(crate) use fields::{FIELD_METHODS, FieldPoint, FieldRun, field_points};
pub(crate) use ground::{Drawn, Ground, control, enclosure, expected_error, faces, with_tracing};
pub(crate) use tracer::{Tracer, failure};
