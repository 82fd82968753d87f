//! The pages of what is more than one solution, or other than one: shooting, comparisons, studies
//! of convergence and cross-checks.

use fredholm_mesh::Mesh;

use super::model::{ElementValues, ReportModel};
use super::page::{ReportBadge, ReportPage};
use super::plot::{ReportAxis, ReportPlot, ReportSeries};
use super::run::{elements, level_line, surfaces, times};
use super::table::{ReportCell, ReportColumn, ReportTable};
use crate::words::{count, number, percent};
use crate::{
    BandConvergence, ComparisonCase, ComparisonRecord, ComparisonRun, CrosscheckRecord, CrosscheckRow, Field,
    Picture, RefinementRecord, ShootingRecord, Timing, WorstPlace,
};

/// Value that stands for 0 on a logarithmic axis.
const SMALLEST_ON_LOG_AXIS: f64 = 1e-17;
/// Classes of a histogram of scores, of width ½ from −5 to 5.
const HISTOGRAM_CLASSES: i32 = 20;

impl<'a> ReportPage<'a> {
    /// The page of progressive radiosity, with the field so far.
    #[must_use]
    pub fn of_shooting(
        title: &str,
        field: &Field<'a>,
        record: &'a ShootingRecord,
        model: ReportModel<'a>,
        picture: Option<&'a Picture>,
    ) -> Self {
        let shots = record.shots.len() as u64;
        let lead = [
            "Progressive radiosity".to_owned(),
            count(record.elements, "element", "elements"),
            count(shots, "shot", "shots"),
        ];
        Self {
            title: title.to_owned(),
            lead: lead.join(" · "),
            badges: badges(
                if record.reached { "share reached" } else { "share not reached" },
                record.reached,
                &record.warnings,
            ),
            bands: field.bands(),
            model: Some(model),
            picture,
            warnings: record.warnings.clone(),
            statements: shooting_statements(record),
            plots: vec![shooting(record)],
            tables: surfaces(field).into_iter().collect(),
            provenance: provenance(&record.version, &record.scene, &record.scene_sha256, &record.timings),
            options: record.options.clone(),
            version: record.version.clone(),
            ..Self::default()
        }
    }

    /// The page of a comparison of solvers.
    #[must_use]
    pub fn of_comparison(title: &str, record: &'a ComparisonRecord) -> Self {
        let runs = || record.cases.iter().flat_map(|case| &case.runs);
        let converged = runs().filter(|run| run.outcome == "converged").count();
        let lead = [
            "Comparison of solvers".to_owned(),
            count(record.unknowns, "unknown", "unknowns"),
            count(record.bands.len() as u64, "band", "bands"),
        ];
        let all = runs().count();
        Self {
            title: title.to_owned(),
            lead: lead.join(" · "),
            badges: badges(&format!("{converged} of {all} converged"), converged == all, &record.warnings),
            bands: &record.bands,
            warnings: record.warnings.clone(),
            statements: record.cases.iter().map(reference).collect(),
            plots: record.cases.iter().map(comparison).collect(),
            tables: vec![solvers(record)],
            provenance: provenance(&record.version, &record.scene, &record.scene_sha256, &record.timings),
            options: record.options.clone(),
            version: record.version.clone(),
            ..Self::default()
        }
    }

    /// The page of a study of convergence.
    #[must_use]
    pub fn of_refinement(title: &str, record: &'a RefinementRecord) -> Self {
        let levels = record.levels.len() as u64;
        let finest = record.levels.last().map_or(0, |level| level.elements);
        let lead = [
            "Convergence over meshes".to_owned(),
            count(levels, "mesh", "meshes"),
            format!("{} at last", count(finest, "element", "elements")),
            record.discretisation.clone(),
        ];
        let ordered = record.bands.iter().filter(|band| band.order.is_some()).count();
        let timings: Vec<Timing> = record
            .levels
            .iter()
            .map(|level| Timing { stage: format!("level {}", level.level), seconds: level.seconds })
            .collect();
        Self {
            title: title.to_owned(),
            lead: lead.join(" · "),
            badges: badges(
                &format!("{ordered} of {} with an order", count(record.bands.len() as u64, "band", "bands")),
                ordered == record.bands.len(),
                &record.warnings,
            ),
            warnings: record.warnings.clone(),
            statements: record.bands.iter().map(|band| format!("{}: {}.", band.band, band.verdict)).collect(),
            plots: vec![refinement(record)],
            tables: vec![levels_table(record)],
            provenance: provenance(&record.version, &record.scene, &record.scene_sha256, &timings),
            options: record.options.clone(),
            version: record.version.clone(),
            ..Self::default()
        }
    }

    /// The page of a comparison of a deterministic with a stochastic solution: the scores of the
    /// faces on the elements.
    #[must_use]
    pub fn of_crosscheck(
        title: &str,
        record: &'a CrosscheckRecord,
        rows: &[CrosscheckRow],
        model: ReportModel<'a>,
        picture: Option<&'a Picture>,
    ) -> Self {
        let scores: Vec<f64> = rows.iter().map(|row| row.z).collect();
        Self {
            title: title.to_owned(),
            lead: format!("Cross-check · {} against {}", record.solver, record.method),
            badges: badges(&record.verdict, record.verdict == "agree", &[]),
            model: Some(model),
            picture,
            statements: crosscheck_statements(record),
            plots: vec![histogram(&scores)],
            tables: vec![worst(&record.worst)],
            provenance: provenance(&record.version, &record.scene, &record.scene_sha256, &record.timings),
            version: record.version.clone(),
            ..Self::default()
        }
    }
}

/// The scores of the faces in each band as quantities on the elements.
#[must_use]
pub fn face_scores(mesh: &Mesh, bands: &[String], rows: &[CrosscheckRow]) -> Vec<ElementValues> {
    let scores = |band: usize| {
        let mut of_face = vec![0.0; mesh.faces().len()];
        rows.iter().filter(|row| row.band == band).for_each(|row| of_face[row.face] = row.z);
        (0..mesh.len()).map(|leaf| of_face[mesh.face_of(leaf)]).collect()
    };
    let named = |(band, name): (usize, &String)| ElementValues {
        name: format!("Score, band {name}"),
        symbol: "z".to_owned(),
        unit: String::new(),
        diverging: true,
        values: scores(band),
    };
    bands.iter().enumerate().map(named).collect()
}

pub(super) fn badges(text: &str, good: bool, warnings: &[String]) -> Vec<ReportBadge> {
    let warned = warnings.len() as u64;
    let warned =
        (warned > 0).then(|| ReportBadge { text: count(warned, "warning", "warnings"), good: false });
    std::iter::once(ReportBadge { text: text.to_owned(), good }).chain(warned).collect()
}

pub(super) fn provenance(
    version: &str,
    scene: &str,
    sha256: &str,
    timings: &[Timing],
) -> Vec<(String, String)> {
    let time = if timings.is_empty() { String::new() } else { times(timings) };
    let known = [
        ("Program", format!("Fredholm {version}")),
        ("Scene", scene.to_owned()),
        ("SHA-256 of the scene", sha256.to_owned()),
        ("Time", time),
    ];
    known
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn axis(label: &str, logarithmic: bool) -> ReportAxis {
    ReportAxis { label: label.to_owned(), logarithmic }
}

fn line(name: &str, x: Vec<f64>, y: Vec<f64>) -> ReportSeries {
    ReportSeries { name: name.to_owned(), colour: None, dashed: false, x, y }
}

fn numbers(values: &[u64]) -> Vec<f64> {
    values.iter().map(|&value| value as f64).collect()
}

fn shooting_statements(record: &ShootingRecord) -> Vec<String> {
    let share = record.shots.last().map_or(0.0, |shot| shot.distributed);
    let mut said = vec![format!(
        "At least {} of the power of the solution has been shot, in the slowest band.",
        percent(share)
    )];
    said.extend(record.mesh_error.as_ref().map(|error| elements(error, &record.bands)));
    said.push(format!(
        "A form factor of the columns that were computed is off by about {} at most.",
        number(record.form_factor_error)
    ));
    said
}

fn shooting(record: &ShootingRecord) -> ReportPlot {
    let left: Vec<f64> =
        record.shots.iter().map(|shot| (1.0 - shot.distributed).max(SMALLEST_ON_LOG_AXIS)).collect();
    let over = |label: &str, across: Vec<f64>| {
        (axis(label, false), vec![line("still to be shot", across, left.clone())])
    };
    let of = |value: &dyn Fn(&crate::Shot) -> f64| record.shots.iter().map(value).collect();
    ReportPlot {
        title: "Progress".to_owned(),
        note: "The share of the power of the solution that is still to be shot, at most.".to_owned(),
        across: vec![
            over("shots", (1..=record.shots.len()).map(|shot| shot as f64).collect()),
            over("seconds", of(&|shot| shot.seconds)),
            over("columns computed", of(&|shot| shot.columns as f64)),
        ],
        up: axis("share still to be shot", true),
        polar: None,
    }
}

fn reference(case: &ComparisonCase) -> String {
    format!(
        "With a largest reflectance of {}, errors are measured against {}, whose residual is {}.",
        number(case.reflectance),
        case.reference,
        number(case.reference_residual)
    )
}

fn comparison(case: &ComparisonCase) -> ReportPlot {
    let ran = || case.runs.iter().filter(|run| run.history.residual.len() > 1);
    let over = |label: &str, across: &dyn Fn(&ComparisonRun) -> Vec<f64>| {
        let lines = ran().map(|run| line(&run.solver, across(run), run.history.residual.clone()));
        (axis(label, false), lines.collect())
    };
    let steps = |run: &ComparisonRun| (0..run.history.residual.len()).map(|step| step as f64).collect();
    ReportPlot {
        title: format!("Residuals, largest reflectance {}", number(case.reflectance)),
        note: "The relative residual ‖b − A x‖₂/‖b‖₂ of the worst band. Point at a line to see it alone."
            .to_owned(),
        across: vec![
            over("stored entries read", &|run| numbers(&run.history.entries)),
            over("seconds", &|run| run.history.seconds.clone()),
            over("iterations", &steps),
        ],
        up: axis("relative residual", true),
        polar: None,
    }
}

fn solvers(record: &ComparisonRecord) -> ReportTable {
    let columns = [
        "Solver",
        "Outcome",
        "Largest reflectance",
        "Iterations",
        "Entries read",
        "Seconds",
        "Residual",
        "Error",
    ];
    let row = |case: &ComparisonCase, run: &ComparisonRun| {
        let outcome =
            run.reason.as_ref().map_or_else(|| run.outcome.clone(), |why| format!("{}: {why}", run.outcome));
        let refused = run.outcome == "refused";
        let numbers = [
            case.reflectance,
            run.iterations as f64,
            run.entries as f64,
            run.seconds,
            run.residual,
            run.error,
        ];
        let numbers = numbers.into_iter().enumerate();
        let cells = numbers.map(|(i, value)| ReportCell::Number((i == 0 || !refused).then_some(value)));
        [run.solver.clone(), outcome].map(ReportCell::Text).into_iter().chain(cells).collect()
    };
    ReportTable {
        title: "Solvers".to_owned(),
        note: "Residual and error ‖x − x*‖₂/‖x*‖₂ in the worst band at the end.".to_owned(),
        columns: columns.map(ReportColumn::new).into(),
        rows: record.cases.iter().flat_map(|case| case.runs.iter().map(move |run| row(case, run))).collect(),
    }
}

fn refinement(record: &RefinementRecord) -> ReportPlot {
    let sizes = |levels: &[usize]| levels.iter().map(|&level| record.levels[level].h).collect();
    let curve = |band: &BandConvergence| {
        let of_limit = band.errors.iter().enumerate().filter_map(|(level, error)| Some((level, (*error)?)));
        // The finest level is the reference of the differences.
        let coarser = band.differences.len().saturating_sub(1);
        let differences = band.differences.iter().copied().enumerate().take(coarser);
        let (levels, errors): (Vec<usize>, Vec<f64>) =
            if band.order.is_some() { of_limit.unzip() } else { differences.unzip() };
        let errors = errors.into_iter().map(|error| error.max(SMALLEST_ON_LOG_AXIS)).collect();
        line(&band.band, sizes(&levels), errors)
    };
    ReportPlot {
        title: "Error over the size of the elements".to_owned(),
        note: "‖E − E*‖/‖E*‖ over the faces: against the limit by Richardson \
            where a band has an order, else against the finest mesh."
            .to_owned(),
        across: vec![(
            axis("largest diameter h of an element, m", true),
            record.bands.iter().map(curve).collect(),
        )],
        up: axis("relative error of the irradiance", true),
        polar: None,
    }
}

fn levels_table(record: &RefinementRecord) -> ReportTable {
    let columns = ["Level", "Elements", "Unknowns", "h, m", "Seconds", "Row error of form factors"];
    let row = |level: &crate::RefinementLevel| {
        let known =
            [level.level as f64, level.elements as f64, level.unknowns as f64, level.h, level.seconds]
                .map(Some);
        known.into_iter().chain([level.row_error]).map(ReportCell::Number).collect()
    };
    ReportTable {
        title: "Meshes".to_owned(),
        note: "Each mesh is twice as fine as the one before.".to_owned(),
        columns: columns.map(ReportColumn::new).into(),
        rows: record.levels.iter().map(row).collect(),
    }
}

fn crosscheck_statements(record: &CrosscheckRecord) -> Vec<String> {
    let mut said = vec![
        record.headline() + ".",
        format!(
            "The level of significance is {} ({} for many tests); the relative \
                standard error of the paths is {} (L2 over the faces) after {}.",
            number(record.significance),
            record.correction,
            percent(record.relative_error),
            count(record.batches, "batch", "batches"),
        ),
    ];
    if let Some(power) = &record.power {
        let found = [
            ("the mean over everything", power.whole),
            ("the mean over a surface", power.surface),
            ("a face", power.face),
        ];
        let parts: Vec<String> =
            found.iter().filter_map(|(of, share)| Some(format!("{} in {of}", percent((*share)?)))).collect();
        if !parts.is_empty() {
            said.push(format!(
                "Found nine times out of ten would have been a deviation of {}.",
                parts.join(", ")
            ));
        }
    }
    said
}

/// How many scores fall into classes of width ½, beside what the normal distribution leads to
/// expect.
fn histogram(scores: &[f64]) -> ReportPlot {
    let centre = |class: i32| 0.5 * f64::from(class - HISTOGRAM_CLASSES / 2) + 0.25;
    let classes: Vec<f64> = (0..HISTOGRAM_CLASSES).map(centre).collect();
    let inside = |middle: f64| scores.iter().filter(|z| (**z - middle).abs() <= 0.25).count() as f64;
    let expected = |z: f64| 0.5 * scores.len() as f64 * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
    let mut normal = level_line("normal distribution", 0.0, [0.0; 2]);
    normal.x.clone_from(&classes);
    normal.y = classes.iter().map(|&z| expected(z)).collect();
    let found = line("faces and bands", classes.clone(), classes.iter().map(|&z| inside(z)).collect());
    ReportPlot {
        title: "Scores".to_owned(),
        note: "Where both solutions are right, the scores z of the \
            differences are normally distributed. Classes of width ½."
            .to_owned(),
        across: vec![(axis("z", false), vec![found, normal])],
        up: axis("number", false),
        polar: None,
    }
}

fn worst(places: &[WorstPlace]) -> ReportTable {
    let columns = ["Kind", "Surface", "Band", "Face", "z", "Relative difference"];
    let row = |place: &WorstPlace| {
        let words = [&place.kind, &place.surface, &place.band].map(|text| ReportCell::Text(text.clone()));
        let numbers =
            [place.face as f64, place.z, place.relative].map(|value| ReportCell::Number(Some(value)));
        words.into_iter().chain(numbers).collect()
    };
    ReportTable {
        title: "Places farthest apart".to_owned(),
        note: "z is the difference over its standard error.".to_owned(),
        columns: columns.map(ReportColumn::new).into(),
        rows: places.iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{names, sample};

    fn row(face: usize, band: usize, z: f64) -> CrosscheckRow {
        let (deterministic, stochastic) = ([1.0, 0.1], [1.0, 0.1]);
        CrosscheckRow { face, band, deterministic, stochastic, z, p: 0.5, significant: false }
    }

    #[test]
    fn scores_stand_on_the_elements_of_their_faces() {
        let rows = [row(0, 0, 1.0), row(2, 0, -2.0), row(2, 1, 3.0)];
        let found = face_scores(&sample(), &names(&["r", "g"]), &rows);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].values, [1.0, 0.0, -2.0]);
        assert_eq!(found[1].values, [0.0, 0.0, 3.0]);
        assert!(found.iter().all(|values| values.diverging));
    }

    #[test]
    fn the_histogram_counts_every_score_within_its_range() {
        let scores = [-4.9, -0.1, 0.1, 0.2, 4.8, 7.0];
        let plot = histogram(&scores);
        let [found, normal] = &plot.across[0].1[..] else { panic!("two lines") };
        assert!((found.y.iter().sum::<f64>() - 5.0).abs() < 1e-12);
        assert!((found.y[HISTOGRAM_CLASSES as usize / 2] - 2.0).abs() < 1e-12);
        assert!((normal.y.iter().sum::<f64>() - 6.0).abs() < 1e-3);
    }
}
