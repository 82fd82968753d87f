//! Results of random paths, and of comparing them with deterministic ones.

mod crosscheck;
mod faces;
mod field_scores;
mod fields;
mod histogram;
mod map;
mod pixels;
mod reference;

pub use crosscheck::{
    CROSSCHECK_FILES, CROSSCHECK_FORMAT, CrosscheckPower, CrosscheckRecord, CrosscheckRow, WorstPlace,
    write_crosscheck, write_crosscheck_csv,
};
pub(crate) use crosscheck::{headline, json};
pub use faces::{FaceEstimates, write_face_estimates};
pub use field_scores::{COMPONENTS, FieldScore, write_field_crosscheck};
pub use fields::{SampledField, write_sampled_fields};
pub use histogram::write_score_histogram;
pub use map::score_map;
pub(crate) use map::{score_colour, with_score_bar};
pub use pixels::Pixels;
pub use reference::{
    REFERENCE_FILES, REFERENCE_FORMAT, ReferencePixels, ReferenceRecord, ReferenceTable, write_reference,
};
