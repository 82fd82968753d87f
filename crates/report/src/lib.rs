//! What people look at: tables, VTU, NPZ, pictures and plots.
//!
//! [`write_all`] turns a solved [`Field`] and the [`RunRecord`] of how it came about into a result
//! folder:
//!
//! | file | contents |
//! |---|---|
//! | `field.csv` | a row per leaf element |
//! | `faces.csv` | area means, a row per input face |
//! | `surfaces.csv` | area means and powers, a row per surface |
//! | `field.vtu` | the leaf elements for `ParaView` |
//! | `field.npz` | the same numbers as `NumPy` arrays |
//! | `image.png` | a camera view |
//! | `convergence.svg` | residual against iterations and seconds |
//! | `mesh.png`, `links.png` | the elements and links, where there are any |
//! | `pixels.npz` | colours of the pixels and their errors, where light was gathered |
//! | `false_colour.png`, `false_colour.csv` | irradiance in false colour, and its numbers, where asked for |
//! | `points.csv` | the irradiance of points, where asked for |
//! | `shadows.vtu` | triangles cut along the borders of shadows, where asked for |
//! | `field.ply`, `field.glb` | the elements with the light as colours of their corners, where asked for |
//! | `report.html` | all of it as a page to turn, pick and read, where asked for |
//! | `run.json` | what made all this; written last, so its presence means a complete folder |
//!
//! [`write_comparison`] writes a comparison of solvers: `compare.csv`, `compare_history.csv`,
//! `compare.svg`, `compare.json`. [`write_spectrum`] writes an analysis of the matrix:
//! `spectrum.csv`, `spectrum.svg`, `spectrum.json`. [`write_shooting`] writes progressive radiosity
//! without a matrix: pictures on the way, `shots.csv`, `shots.svg`, the field so far, `shots.json`.
//! [`write_face_estimates`], [`write_crosscheck`] and [`write_reference`] write what random paths
//! came to, beside deterministic solutions. [`write_refinement`] writes a study of convergence:
//! `converge.csv`, `converge.svg`, `converge.json`.
//!
//! A [`ResultFolder`] is claimed by one run at a time, which removes what earlier ones have left.
//! Every file appears whole or not at all. Units: metres, W/m², W, seconds.

mod atomic;
mod baked;
mod camera;
mod catalogue;
mod cie;
mod colour;
mod comparison;
mod convergence;
mod csv;
mod error;
mod eye;
mod faces_csv;
mod false_colour_csv;
mod field;
mod field_csv;
mod folder;
mod hierarchy;
mod html;
mod interpolate;
mod judgement;
mod mean;
mod names;
mod nodal;
mod npz;
mod number;
mod outputs;
mod picture;
mod plot;
mod points_csv;
mod reading;
mod refinement;
mod run;
mod shading;
mod shadows_vtu;
mod shooting;
mod spectrum;
mod stochastic;
mod surfaces_csv;
mod tone;
mod viewfactors;
mod vtu;
mod waves;
mod words;
mod xml;

pub use atomic::write_atomically;
pub use baked::{write_field_glb, write_field_ply};
pub use camera::{Camera, USUAL_PIXELS};
pub use catalogue::{CataloguedFile, catalogue, results_page};
pub use cie::colour_matching;
pub use colour::Colouring;
pub use comparison::{
    COMPARISON_FILES, COMPARISON_FORMAT, ComparisonCase, ComparisonHistory, ComparisonRecord, ComparisonRun,
    write_comparison, write_comparison_csv, write_comparison_history, write_comparison_plot,
    write_sweep_plot,
};
pub use convergence::write_convergence;
pub use error::ReportError;
pub use eye::Eye;
pub use faces_csv::write_faces_csv;
pub use false_colour_csv::write_false_colour_csv;
pub use field::Field;
pub use field_csv::write_field_csv;
pub use folder::{ResultFolder, exit};
pub use hierarchy::{Hierarchy, HierarchyGoal, HierarchyRound};
pub use html::{
    ElementLinks, ElementPhasors, ElementValues, FieldStep, ReportAxis, ReportBadge, ReportCell,
    ReportColumn, ReportModel, ReportPage, ReportPlot, ReportPolar, ReportSeries, ReportTable, WaveReport,
    current_phasors, face_quantities, face_scores,
};
pub use judgement::{
    JUDGE_FILES, JUDGE_FORMAT, JudgeRecord, JudgedPlace, Measured, PictureShape, ReferenceFaces,
    ReferenceValues, read_measured_faces, read_measured_pixels, read_reference_faces, read_reference_pixels,
    read_reference_record, write_judgement,
};
pub use names::{CHECKPOINT, PIXELS, TRACE_STATE, WAVE_FILES, is_result, records};
pub use npz::write_npz;
pub use outputs::{
    Contents, Extras, FALSE_COLOUR, FIELD_EXR, FIELD_GLB, FIELD_PLY, IMAGE, LINKS_PICTURE, MESH_PICTURE,
    OutputFile, REPORT, RUN, RunReport, View, Wanted, output_files, wanted_files, write_all, write_with,
};
pub use picture::{
    Back, DIRECTION_GROUPS, FalseColourPicture, Gathering, LampFactors, LampLight, Layer, Lighter, Link,
    Linked, Lit, LitPicture, Picture, PictureNumber, Points, Seen, Side, Where, render, render_false_colour,
    render_layers, render_lit, sides_map,
};
pub use points_csv::{PointTable, write_points_csv};
pub use refinement::{
    BandConvergence, REFINEMENT_FILES, REFINEMENT_FORMAT, RefinementLevel, RefinementRecord,
    write_refinement, write_refinement_csv, write_refinement_plot,
};
pub use run::{
    Closure, Counts, Energy, FORMAT, FieldError, FormFactorError, History, MeshError, Received, RunRecord,
    Timing, read_run, write_run,
};
pub use shadows_vtu::{ShadowMesh, write_shadows_vtu};
pub use shooting::{
    SHOOTING_FILES, SHOOTING_FORMAT, ShootingRecord, Shot, write_shooting, write_shooting_plot,
    write_shot_picture, write_shots_csv,
};
pub use spectrum::{
    BandSpectrum, Eigenvalues, SPECTRUM_FILES, SPECTRUM_FORMAT, SpectrumRecord, write_spectrum,
    write_spectrum_csv, write_spectrum_plot,
};
pub use stochastic::{
    COMPONENTS, CROSSCHECK_FILES, CROSSCHECK_FORMAT, CrosscheckPower, CrosscheckRecord, CrosscheckRow,
    FaceEstimates, FieldScore, Pixels, REFERENCE_FILES, REFERENCE_FORMAT, ReferencePixels, ReferenceRecord,
    ReferenceTable, SampledField, WorstPlace, score_map, write_crosscheck, write_crosscheck_csv,
    write_face_estimates, write_field_crosscheck, write_reference, write_sampled_fields,
    write_score_histogram,
};
pub use surfaces_csv::write_surfaces_csv;
pub use tone::Exposure;
pub use viewfactors::{
    ClosureChange, Factors, MatrixFormat, Sparse, SurfaceData, VIEW_FACTORS_FORMAT, ViewFactorFiles,
    ViewFactors, ViewFactorsError, ViewFactorsRecord, ViewPoints, heat_map, read_view_factors_record,
    write_closure_histogram, write_view_factors,
};
pub use vtu::write_vtu;
pub use waves::{
    AngleQuantity, FarRow, FarTotal, FieldMap, FrequencyLine, METHODS_FILES, METHODS_FORMAT, MapAxis,
    MapPlane, MapQuantity, MethodAtReceiver, MethodCurves, MethodRun, MethodsRecord, MonostaticRow,
    WAVE_COMPARISON_FORMAT, WaveComparison, WaveComparisonCase, WaveCurrents, WaveResiduals, WaveRow,
    scaled_frequencies, write_angle_plot, write_currents_vtu, write_far_csv, write_far_npz,
    write_frequency_plot, write_methods, write_monostatic_csv, write_monostatic_npz, write_receivers_csv,
    write_receivers_npz, write_residuals_csv, write_residuals_plot, write_wave_comparison,
};
