//! What a study of convergence leaves: `converge.csv`, `converge.svg`, `converge.json`.

mod csv;
mod files;
mod plot;
mod record;

pub use csv::write_refinement_csv;
pub use files::{REFINEMENT_FILES, write_refinement};
pub use plot::write_refinement_plot;
pub use record::{BandConvergence, REFINEMENT_FORMAT, RefinementLevel, RefinementRecord};
