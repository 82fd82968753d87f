//! Matrices of view factors.

use std::path::Path;

use fredholm_report::ViewFactorsError::Read;
use fredholm_report::{Closure, ViewFactors, ViewFactorsRecord};

use super::lines::{Lines, number, times};
use super::{Made, Summarise};
use crate::error::{Error, ErrorKind};
use crate::size::Bytes;
use crate::viewfactors::{SKY, closure as matrix_closure, largest, point_closure};

/// Row sums that differ more from 1 are those of an open scene.
const OPEN_SCENE_DEFECT: f64 = 0.01;

impl Summarise for ViewFactorsRecord {
    fn made(&self) -> Made<'_> {
        Made { version: &self.version, of: &self.input, sha256: &self.input_sha256 }
    }

    fn lines(&self, lines: &mut Lines) {
        let count = |name: &str| self.counts.get(name).copied().unwrap_or(0);
        let [rows, elements, occluders, stored] = ["rows", "elements", "occluders", "stored"].map(count);
        lines.add(
            "size",
            format!("{rows} rows of {elements} elements, {occluders} occluders, {stored} factors stored"),
        );
        let sky = self.options["sky"].as_bool().unwrap_or(false);
        lines.add_some("closure", closed(&self.closure, self.form_factor_error.row_max, sky));
        lines.add_some("form factors", errors(self));
        lines.add_some(
            "reciprocity",
            self.reciprocity.map(|defect| {
                format!("both orders of integration agree within {defect:.1e} (largest of a sample)")
            }),
        );
        lines.add_some("dropped", self.dropped_max.map(dropped));
        lines.add_some("enforced", enforced(self));
        lines.add_some("points", points(count("points"), self.point_closure_max));
        lines.add_some("time", (!self.timings.is_empty()).then(|| times(&self.timings)));
        self.warnings.iter().for_each(|warning| lines.add("warning", warning));
    }

    fn details(&self, lines: &mut Lines) {
        lines.add_some("title", self.title.clone());
        lines.add_some("peak memory", self.peak_memory_bytes.map(|bytes| Bytes(bytes.into()).to_string()));
        lines.add("options", format!("{:#}", self.options));
    }
}

/// How the rows close; `error` is the largest stated error of a row.
fn closed(closure: &Closure, error: Option<f64>, sky: bool) -> Option<String> {
    let most = closure.max?;
    let at = closure.worst_surface.as_ref().map(|surface| format!(" ({surface})")).unwrap_or_default();
    let mean = closure.mean.map(|mean| format!(", {mean:.1e} on average")).unwrap_or_default();
    let open = most > OPEN_SCENE_DEFECT.max(error.unwrap_or(0.0));
    let hint = match (open, sky) {
        (false, _) => "",
        (true, false) => "; the scene is open (--sky would add the sky), or backs of surfaces are in view",
        (true, true) => "; backs of surfaces are in view",
    };
    Some(format!("row sums differ from 1 by {most:.1e} at most{at}{mean}{hint}"))
}

fn errors(record: &ViewFactorsRecord) -> Option<String> {
    let error = &record.form_factor_error;
    let asked = error.tolerance.map(|t| format!(" (asked: {t:.1e})")).unwrap_or_default();
    let factor = error.max.map(|max| format!(", of a factor between elements {max:.1e}")).unwrap_or_default();
    Some(format!("estimated error of a row {:.1e} at most{factor}{asked}", error.row_max?))
}

fn stated(row: f64, factors: &ViewFactors) -> String {
    let factor = factors.errors.iter().fold(0.0, |most: f32, error| most.max(*error));
    format!("estimated error of a row {row:.1e} at most, of a factor {factor:.1e}")
}

fn dropped(most: f64) -> String {
    format!("factors below the threshold, {most:.1e} of a row at most")
}

fn enforced(record: &ViewFactorsRecord) -> Option<String> {
    let change = record.enforced.as_ref()?;
    let over =
        change.over_stated.map(|over| format!(", {over:.2} of its stated error at most")).unwrap_or_default();
    Some(format!(
        "row sums were off by {:.1e}; closing them changed a factor by {:.1e} and a row by {:.1e} at most{over}",
        change.closure_before?, change.largest?, change.row_max?
    ))
}

fn points(count: u64, closure: Option<f64>) -> Option<String> {
    let closure = closure?;
    Some(format!("{}, whose sums differ from 1 by {closure:.1e} at most", number(count, "point")))
}

/// What the arrays of a matrix tell.
pub(super) fn matrix(path: &Path) -> Result<String, Error> {
    let factors = ViewFactors::read_npz(path).map_err(|error| {
        let kind = if matches!(error, Read { .. }) { ErrorKind::Files } else { ErrorKind::Input };
        Error::new(kind, error)
    })?;
    let mut lines = Lines::default();
    let n = factors.len();
    lines.add("size", format!("{n} rows, {} of {} factors stored", factors.stored(), n * n));
    lines.add("area", format!("{:.6} m² in all", factors.surfaces.area.iter().sum::<f64>()));
    let error = largest(factors.surfaces.row_error.iter().copied());
    let sky = factors.surfaces.names.last().is_some_and(|name| name == SKY);
    lines.add_some("closure", closed(&matrix_closure(&factors), error, sky));
    lines.add_some("form factors", error.map(|error| stated(error, &factors)));
    let most = largest(factors.row_dropped.iter().copied()).filter(|&most| most > 0.0);
    lines.add_some("dropped", most.map(dropped));
    let count = factors.points.as_ref().map_or(0, |points| points.points.len() as u64);
    lines.add_some("points", points(count, point_closure(&factors)));
    Ok(lines.under(&path.display().to_string()))
}
