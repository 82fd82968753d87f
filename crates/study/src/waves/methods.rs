//! Methods compared on one scene: what each makes of the fields, what it states of its error, how
//! far it is from the one that states the least, and what it takes.

use std::path::Path;
use std::time::Instant;

use fredholm_report::{
    FrequencyLine, METHODS_FORMAT, MapQuantity, MethodAtReceiver, MethodCurves, MethodRun, MethodsRecord,
    REPORT, ReportError, ReportModel, ReportPage, ReportPlot, ResultFolder, Timing, WaveRow, current_phasors,
    write_angle_plot, write_frequency_plot, write_methods,
};
use fredholm_scene::SceneError;
use fredholm_scene::waves::{Method as SceneMethod, Places, Settings, Shadows};

use super::files::stem;
use super::maps::{Component, Grid};
use super::model::{Receiver, scene_of};
use super::over_angle::OverAngle;
use super::over_frequency::{self, Levels, MOST_PICTURED, levels};
use super::study::doubts;
use super::{Model, Outcome};
use crate::error::{Error, ErrorKind};
use crate::size::Bytes;
use crate::stages::Stages;

/// All of them, the most exact ones last.
const ALL: [&str; 10] = [
    "thesis",
    "physical-optics",
    "physical-optics:edges",
    "iterated",
    "iterated:edges",
    "mfie",
    "dual-surface-mfie",
    "pmchwt",
    "efie",
    "cfie",
];
/// What sums all bounces of physical optics.
const SOLVER_OF_BOUNCES: &str = "gmres:restart=60";
/// Levels are compared where the reference is at most so far below its largest, as a ratio of
/// fields: 20 dB.
const COMPARED_DOWN_TO: f64 = 0.1;

/// A way to find the currents, whatever a scene says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveMethod {
    name: String,
    settings: Settings,
}

impl WaveMethod {
    /// The method that a text such as `physical-optics:edges` names.
    ///
    /// # Errors
    /// What is wrong with the text.
    ///
    /// # Examples
    /// ```
    /// use fredholm_study::WaveMethod;
    /// assert!(WaveMethod::parse("physical-optics:edges:bounces=3").is_ok());
    /// assert!(WaveMethod::parse("efie:order=1").is_ok());
    /// assert!(WaveMethod::parse("efie:edges").is_err());
    /// ```
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default();
        let mut settings = named(name)
            .ok_or_else(|| format!("there is no method `{name}`; known are iterated, {}", known()))?;
        let optics = settings.method == Some(SceneMethod::PhysicalOptics);
        let elements = settings.method.is_some_and(SceneMethod::is_boundary_elements);
        let summed = settings.bounces.is_some();
        for option in parts {
            match option {
                "order=0" | "order=1" if elements => settings.order = Some(u32::from(option == "order=1")),
                "edges" if optics => settings.edge_currents = Some(true),
                "radiated" if optics => settings.shadows = Some(Shadows::Radiated),
                "geometric" if optics => settings.shadows = Some(Shadows::Geometric),
                _ => {
                    let count = option.strip_prefix("bounces=").filter(|_| summed);
                    let count = count.and_then(|count| count.parse().ok()).filter(|&count| count > 0);
                    settings.bounces = Some(count.ok_or_else(|| not_an_option(name, option, &settings))?);
                }
            }
        }
        Ok(Self { name: text.to_owned(), settings })
    }

    /// All methods that there are, the most exact ones last.
    #[must_use]
    pub fn all() -> Vec<Self> {
        ALL.iter().filter_map(|text| Self::parse(text).ok()).collect()
    }

    /// The methods that texts name, each once; `all` stands for all of them.
    ///
    /// # Errors
    /// What is wrong with the first text that names none.
    pub fn list(texts: &[String]) -> Result<Vec<Self>, String> {
        let mut methods: Vec<Self> = Vec::new();
        for text in texts {
            let named = if text == "all" { Self::all() } else { vec![Self::parse(text)?] };
            for method in named {
                if !methods.contains(&method) {
                    methods.push(method);
                }
            }
        }
        Ok(methods)
    }

    /// The text that names it.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The settings of a scene with this method in place of its own.
    fn of(&self, scene: &Settings) -> Settings {
        let Settings { tolerance, max_iterations, sweep_accuracy, .. } = scene.clone();
        Settings { tolerance, max_iterations, sweep_accuracy, ..self.settings.clone() }
    }
}

fn known() -> String {
    let names = SceneMethod::ALL.map(SceneMethod::name);
    names.join(", ")
}

fn named(name: &str) -> Option<Settings> {
    let plain = |method| Settings { method: Some(method), edge_currents: Some(false), ..Settings::default() };
    if name == "iterated" {
        let (shadows, solver) = (Some(Shadows::Radiated), Some(SOLVER_OF_BOUNCES.to_owned()));
        return Some(Settings { shadows, solver, ..plain(SceneMethod::PhysicalOptics) });
    }
    let method = SceneMethod::ALL.into_iter().find(|method| method.name() == name)?;
    let bounces = (!method.is_equation()).then_some(1);
    Some(Settings { bounces, ..plain(method) })
}

fn not_an_option(name: &str, option: &str, settings: &Settings) -> String {
    let (optics, summed) = (settings.method == Some(SceneMethod::PhysicalOptics), settings.bounces.is_some());
    let elements = settings.method.is_some_and(SceneMethod::is_boundary_elements);
    let known = match (optics, summed) {
        _ if elements => "known are order=0 and order=1",
        (true, true) => "known are edges, radiated, geometric and bounces=N, N at least 1",
        (true, false) => "known are edges, radiated and geometric",
        (false, true) => "known is bounces=N, N at least 1",
        (false, false) => "it has none",
    };
    format!("`{option}` is no option of {name}; {known}")
}

/// What a method came to.
struct Done<'m> {
    method: &'m WaveMethod,
    model: Model,
    outcome: Outcome,
    seconds: f64,
}

impl Done<'_> {
    fn name(&self) -> &str {
        &self.method.name
    }

    /// The largest error that it states; infinite where it states none.
    fn stated(&self) -> f64 {
        let errors = self.outcome.stated_errors.iter().map(|error| error.relative);
        errors.max_by(f64::total_cmp).unwrap_or(f64::INFINITY)
    }

    /// The places of a receiver at a frequency: the scattered field at each, as real numbers.
    fn scattered(&self, index: usize, frequency: f64) -> Vec<Vec<f64>> {
        let here = |receiver: usize, of: f64| receiver == index && of.total_cmp(&frequency).is_eq();
        let Outcome { near, far, monostatic, .. } = &self.outcome;
        match &self.model.receivers[index].places {
            Places::Near { .. } => {
                let rows = near.iter().filter(|row| here(row.receiver, row.frequency));
                rows.map(|row| row.scattered[..6].to_vec()).collect()
            }
            Places::Far(_) => {
                let rows = far.iter().filter(|row| here(row.receiver, row.frequency));
                rows.map(|row| row.amplitude.to_vec()).collect()
            }
            Places::Monostatic(_) => {
                let rows = monostatic.iter().filter(|row| here(row.receiver, row.frequency));
                rows.map(|row| row.scattering.concat()).collect()
            }
        }
    }

    /// What it came to at every receiver and frequency, beside the reference.
    fn receivers(&self, reference: Option<&Self>) -> Vec<MethodAtReceiver> {
        let mut all = Vec::new();
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            for band in &self.model.bands {
                let frequency = band.wave.frequency();
                let stated =
                    self.outcome.stated_errors.iter().find(|error| {
                        error.receiver == index && error.frequency.total_cmp(&frequency).is_eq()
                    });
                let own = self.scattered(index, frequency);
                let exact = reference.map(|reference| reference.scattered(index, frequency));
                let compared = exact.map(|exact| compared(&own, &exact));
                all.push(MethodAtReceiver {
                    receiver: receiver.name.clone(),
                    frequency,
                    stated_error: stated.map(|error| error.relative),
                    difference: compared.and_then(|compared| compared.0),
                    level_difference: compared.and_then(|compared| compared.1),
                });
            }
        }
        all
    }
}

/// ‖f − g‖/‖g‖ over all places, and the largest difference of the levels, dB; none where there is
/// nothing to compare with.
fn compared(own: &[Vec<f64>], exact: &[Vec<f64>]) -> (Option<f64>, Option<f64>) {
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let gap = |(f, g): (&Vec<f64>, &Vec<f64>)| f.iter().zip(g).map(|(f, g)| (f - g).powi(2)).sum::<f64>();
    let (off, all) =
        (own.iter().zip(exact).map(gap).sum::<f64>(), exact.iter().map(|g| square(g)).sum::<f64>());
    let largest = exact.iter().map(|g| square(g)).fold(0.0, f64::max);
    let seen = own.iter().zip(exact).filter(|(_, g)| square(g) >= COMPARED_DOWN_TO.powi(2) * largest);
    let levels = seen.map(|(f, g)| 10.0 * (square(f) / square(g)).log10().abs());
    let known = |value: f64| value.is_finite().then_some(value);
    (known((off / all).sqrt()), levels.max_by(f64::total_cmp).and_then(known))
}

/// Runs the methods on a scene and writes what they came to; returns the record, and whether every
/// residual was met.
pub(super) fn compare(
    path: &Path,
    (methods, memory, report): (&[WaveMethod], Option<Bytes>, bool),
    folder: &ResultFolder,
    stages: &mut Stages,
) -> Result<(MethodsRecord, bool), Error> {
    // What is wrong with the scene itself is no reason of a method.
    stages.run("scene", || scene_of(path, memory))?;
    let (mut done, mut refused): (Vec<Done>, Vec<(&WaveMethod, Error)>) = (Vec::new(), Vec::new());
    let mut record = MethodsRecord::default();
    for method in methods {
        let mut part = stages.part(&method.name);
        let started = Instant::now();
        let found = run(path, memory, method, (&mut part, &mut record.warnings));
        let named =
            |timing: &Timing| Timing { stage: format!("{}: {}", method.name, timing.stage), ..*timing };
        record.timings.extend(part.timings().iter().map(named));
        match found {
            Ok((model, outcome)) => {
                done.push(Done { method, model, outcome, seconds: started.elapsed().as_secs_f64() });
                stages.begin_saving()?;
            }
            Err(error) if error.kind() == ErrorKind::Interrupted && !done.is_empty() => {
                record.partial = true;
                break;
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => return Err(error),
            Err(error) => {
                stages.watch.warn(&format!("{} is left out: {}", method.name, reason(&error)));
                refused.push((method, error));
            }
        }
        record.partial = stages.is_cancelled() && done.len() + refused.len() < methods.len();
        if record.partial {
            break;
        }
    }
    let Some(reference) = most_exact(&done) else {
        let nothing = || Error::new(ErrorKind::Input, "no method is asked for");
        return Err(refused.into_iter().next().map_or_else(nothing, |(_, error)| error));
    };
    let model = &done[reference].model;
    METHODS_FORMAT.clone_into(&mut record.format);
    env!("CARGO_PKG_VERSION").clone_into(&mut record.version);
    record.scene = model.path().display().to_string();
    model.scene.sha256().clone_into(&mut record.scene_sha256);
    done[reference].name().clone_into(&mut record.reference);
    for method in methods {
        let own = done.iter().position(|done| done.method == method);
        let why = refused.iter().find(|(refused, _)| *refused == method);
        record.methods.extend(own.map(|own| ran(&done, own, reference)));
        record.methods.extend(why.map(|(_, error)| MethodRun {
            method: method.name.clone(),
            outcome: "refused".to_owned(),
            reason: Some(reason(error)),
            ..MethodRun::default()
        }));
    }
    let seen = Seen { done: &done, reference };
    stages.run("results", || seen.write(folder, &record, report).map_err(crate::solve::report_failure))?;
    Ok((record, done.iter().all(|done| done.outcome.converged())))
}

fn run(
    path: &Path,
    memory: Option<Bytes>,
    method: &WaveMethod,
    (stages, warnings): (&mut Stages, &mut Vec<String>),
) -> Result<(Model, Outcome), Error> {
    let model = stages.run("scene", || Model::load_with(path, memory, &|scene| method.of(scene)))?;
    stages.tell(&model.plan, model.limit);
    let outcome = super::compute(&model, stages)?;
    // What is remarkable about the scene is told by each method.
    let own = doubts(&model, &outcome).into_iter().map(|doubt| format!("{}: {doubt}", method.name));
    for warning in model.warnings.iter().cloned().chain(own) {
        if !warnings.contains(&warning) {
            stages.watch.warn(&warning);
            warnings.push(warning);
        }
    }
    Ok((model, outcome))
}

/// What was wrong in a line: the text of the scene and the help are of no use in a table.
fn reason(error: &Error) -> String {
    let cause = error.cause();
    let text = match cause.downcast_ref::<SceneError>() {
        Some(error) => error.what().to_owned(),
        None => cause.to_string(),
    };
    text.lines().next().unwrap_or_default().to_owned()
}

/// The method that states the least error; of those that state none the last in the list of all.
fn most_exact(done: &[Done<'_>]) -> Option<usize> {
    let rank = |at: usize| ALL.iter().position(|name| *name == done[at].name()).unwrap_or(0);
    let unmet = |at: usize| !done[at].outcome.converged();
    (0..done.len()).min_by(|&a, &b| {
        let stated = done[a].stated().total_cmp(&done[b].stated());
        unmet(a).cmp(&unmet(b)).then(stated).then(rank(b).cmp(&rank(a)))
    })
}

fn ran(done: &[Done<'_>], own: usize, reference: usize) -> MethodRun {
    let Done { method, model, outcome, seconds } = &done[own];
    MethodRun {
        method: method.name.clone(),
        outcome: if outcome.converged() { "done" } else { "not converged" }.to_owned(),
        reason: None,
        solution: model.method.name(),
        facets: model.geometry.mesh.len() as u64,
        seconds: *seconds,
        receivers: done[own].receivers((own != reference).then(|| &done[reference])),
    }
}

/// What is drawn of all methods.
struct Seen<'a> {
    done: &'a [Done<'a>],
    reference: usize,
}

impl Seen<'_> {
    fn reference(&self) -> &Done<'_> {
        &self.done[self.reference]
    }

    /// Pictures, tables, page; the record last.
    fn write(&self, folder: &ResultFolder, record: &MethodsRecord, report: bool) -> Result<(), ReportError> {
        let (mut curves, mut plots) = (Vec::new(), Vec::new());
        let model = &self.reference().model;
        for (index, receiver) in model.receivers.iter().enumerate() {
            for band in model.bands.iter().filter(|_| model.bands.len() <= MOST_PICTURED) {
                let frequency = band.wave.frequency();
                self.maps(folder, (index, receiver), frequency)?;
                if let Some(over) = self.over_angle((index, receiver), frequency) {
                    let OverAngle { title, quantity, lines } = &over;
                    let name = format!("{}.svg", stem(model, receiver, frequency));
                    folder.write(&name, |out| write_angle_plot(title, quantity, lines, out))?;
                    plots.push(over.plot());
                    let OverAngle { quantity, lines, .. } = over;
                    curves.push(MethodCurves { receiver: receiver.name.clone(), frequency, quantity, lines });
                }
            }
            plots.extend(self.over_frequency(folder, (index, receiver))?);
        }
        if report {
            self.page(folder, record, plots)?;
        }
        write_methods(folder, record, &curves)
    }

    /// One line a method: where there are several parts, that in which the reference is largest. On
    /// a circle it is the scattered field.
    fn over_angle(&self, receiver: (usize, &Receiver), frequency: f64) -> Option<OverAngle> {
        let name = format!("{}, {} MHz", receiver.1.name, frequency / 1e6);
        let of = |done: &Done<'_>| OverAngle::of(&done.outcome, receiver, frequency, &name);
        let exact = of(self.reference())?;
        let peak = |(_, points): &(String, Vec<(f64, f64)>)| points.iter().map(|p| p.1).fold(0.0, f64::max);
        let peaks: Vec<f64> = exact.lines.iter().map(peak).collect();
        let scattered = receiver.1.places_are_directions();
        let part = if scattered { largest(&peaks)? } else { 0 };
        let title = format!("{}, {}", exact.title, exact.lines.get(part)?.0);
        let line = |done: &Done<'_>| {
            let own = of(done).filter(|own| own.quantity == exact.quantity)?;
            Some((done.name().to_owned(), own.lines.into_iter().nth(part)?.1))
        };
        let lines = self.done.iter().filter_map(line).collect();
        Some(OverAngle { title, quantity: exact.quantity.clone(), lines })
    }

    /// The levels of all methods over the frequency, where there are several.
    fn over_frequency(
        &self,
        folder: &ResultFolder,
        (index, receiver): (usize, &Receiver),
    ) -> Result<Option<ReportPlot>, ReportError> {
        let model = &self.reference().model;
        let of = |done: &Done<'_>| levels(&done.model, &done.outcome, index, receiver);
        let Some(exact) = of(self.reference()).filter(|_| model.bands.len() > 1) else { return Ok(None) };
        let peak = |line: &FrequencyLine| line.levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let peaks: Vec<f64> = exact.lines.iter().map(peak).collect();
        let Some(part) = largest(&peaks) else { return Ok(None) };
        let line = |done: &Done<'_>| {
            let levels = of(done)?.lines.into_iter().nth(part)?.levels;
            Some(FrequencyLine { name: done.name().to_owned(), levels })
        };
        let lines: Vec<FrequencyLine> = self.done.iter().filter_map(line).collect();
        let frequencies: Vec<f64> = model.bands.iter().map(|band| band.wave.frequency()).collect();
        let (up, title) = (
            format!("{}, {}", exact.quantity, exact.unit),
            format!("{}: {}, {}", receiver.name, exact.quantity, exact.lines[part].name),
        );
        let draw =
            |out: &mut dyn std::io::Write| write_frequency_plot(&title, &up, &frequencies, &lines, out);
        folder.write(&format!("{}_over_frequency.svg", receiver.name), draw)?;
        Ok(Some(over_frequency::plot(model, receiver, &Levels { lines, map: None, ..exact })))
    }

    /// Of each method the magnitude of the component that is strongest in the reference, and that
    /// of its difference.
    fn maps(
        &self,
        folder: &ResultFolder,
        (index, receiver): (usize, &Receiver),
        frequency: f64,
    ) -> Result<(), ReportError> {
        let Some(grid) = Grid::of(receiver, &self.reference().model.geometry.mesh) else { return Ok(()) };
        let rows = |done: &'_ Done<'_>| -> Vec<WaveRow> {
            let here = |row: &&WaveRow| row.receiver == index && row.frequency.total_cmp(&frequency).is_eq();
            done.outcome.near.iter().filter(here).cloned().collect()
        };
        let exact = rows(self.reference());
        let component = Component::strongest(&exact.iter().collect::<Vec<_>>());
        let of = |rows: &[WaveRow]| -> Vec<[f64; 2]> { rows.iter().map(|row| component.of(row)).collect() };
        let exact = of(&exact);
        let place = format!("{}, {} MHz", receiver.name, frequency / 1e6);
        let stem = stem(&self.reference().model, receiver, frequency);
        for (at, done) in self.done.iter().enumerate() {
            let own = of(&rows(done));
            let draw = |kind: &str, title: &str, values: &[[f64; 2]]| {
                let file = format!("{stem}_{}_{}_{kind}.png", file_name(done.name()), component.name());
                let map = grid.map(title, component, values);
                folder.write(&file, |out| map.draw(MapQuantity::Magnitude)?.write_png(out)).map(drop)
            };
            draw("magnitude", &format!("Total field at {place}: {}", done.name()), &own)?;
            if at != self.reference {
                let less = |(a, b): (&[f64; 2], &[f64; 2])| [a[0] - b[0], a[1] - b[1]];
                let gap: Vec<[f64; 2]> = own.iter().zip(&exact).map(less).collect();
                let title = format!("Field at {place}: {} less {}", done.name(), self.reference().name());
                draw("difference", &title, &gap)?;
            }
        }
        Ok(())
    }

    /// `report.html`: the currents of the reference, the curves and the table of all.
    fn page(
        &self,
        folder: &ResultFolder,
        record: &MethodsRecord,
        plots: Vec<ReportPlot>,
    ) -> Result<(), ReportError> {
        let Done { model, outcome, .. } = self.reference();
        let mesh = &model.geometry.mesh;
        let shown = outcome.currents.len().min(MOST_PICTURED);
        let phasors = current_phasors(mesh, &outcome.currents[..shown]);
        let shown = ReportModel { phasors: &phasors, ..ReportModel::bare(mesh) };
        let title = model.scene.title().map_or_else(|| record.scene.clone(), str::to_owned);
        let page = ReportPage::of_methods(&title, record, plots, Some(shown));
        folder.write(REPORT, |out| page.write(out)).map(drop)
    }
}

/// The first of the largest.
fn largest(values: &[f64]) -> Option<usize> {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b]).then(b.cmp(&a)))
}

/// A name with nothing in it that file systems mind.
fn file_name(method: &str) -> String {
    method.replace([':', '='], "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_name_methods_with_their_options() {
        assert_eq!(WaveMethod::all().len(), ALL.len());
        let twice = WaveMethod::list(&["efie", "all", "efie"].map(str::to_owned)).unwrap();
        assert_eq!((twice.len(), twice[0].name()), (ALL.len(), "efie"));
        let edges = WaveMethod::parse("physical-optics:edges:radiated:bounces=3").unwrap().settings;
        assert_eq!((edges.edge_currents, edges.bounces), (Some(true), Some(3)));
        assert_eq!((edges.shadows, edges.solver), (Some(Shadows::Radiated), None));
        let iterated = WaveMethod::parse("iterated").unwrap().settings;
        assert_eq!((iterated.method, iterated.bounces), (Some(SceneMethod::PhysicalOptics), None));
        assert!(iterated.solver.is_some_and(|solver| solver.starts_with("gmres")));
        let tolerance = Settings { tolerance: Some(1e-3), bounces: Some(9), ..Settings::default() };
        let efie = WaveMethod::parse("efie").unwrap().of(&tolerance);
        assert_eq!((efie.method, efie.tolerance, efie.bounces), (Some(SceneMethod::Efie), Some(1e-3), None));
    }

    #[test]
    fn wrong_texts_say_what_is_known() {
        let said = |text: &str| WaveMethod::parse(text).unwrap_err();
        assert!(said("magic").contains("known are iterated, physical-optics"), "{}", said("magic"));
        assert!(said("efie:edges").contains("known are order=0 and order=1"), "{}", said("efie:edges"));
        assert!(said("mfie:order=1").contains("it has none"), "{}", said("mfie:order=1"));
        assert!(said("iterated:bounces=2").contains("known are edges, radiated and geometric"));
        assert!(said("physical-optics:bounces=0").contains("bounces=N, N at least 1"));
        assert!(said("thesis:edges").contains("known is bounces=N"));
    }

    #[test]
    fn fields_and_levels_are_compared_over_all_places() {
        let exact = [vec![3.0, 4.0], vec![0.0, 0.1]];
        assert_eq!(compared(&exact, &exact), (Some(0.0), Some(0.0)));
        // The second place is 34 dB down: it counts in the field, not in the levels.
        let (field, level) = compared(&[vec![6.0, 8.0], vec![0.0, 0.2]], &exact);
        assert!(
            (field.unwrap() - 1.0).abs() < 1e-12 && (level.unwrap() - 20.0 * 2.0_f64.log10()).abs() < 1e-12
        );
        assert_eq!(compared(&[vec![1.0, 0.0]], &[vec![0.0, 0.0]]), (None, None));
    }
}
