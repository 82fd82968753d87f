//! The files of a result folder. `run.json` is written last: where it stands, the folder is
//! complete.

use std::io;

use fredholm_report::{
    FieldMap, MapAxis, MapQuantity, REPORT, ReportError, ReportModel, ReportPage, ReportPlot, ResultFolder,
    Timing, WaveReport, WaveResiduals, WaveRow, current_phasors, scaled_frequencies, write_angle_plot,
    write_currents_vtu, write_far_csv, write_far_npz, write_frequency_plot, write_monostatic_csv,
    write_monostatic_npz, write_receivers_csv, write_receivers_npz, write_residuals_csv,
    write_residuals_plot,
};

use super::maps::{Component, Grid};
use super::model::{Method, Receiver};
use super::over_angle::OverAngle;
use super::over_frequency::{MOST_PICTURED, levels, plot};
use super::{Model, Outcome};

const LAST_FILE: &str = "run.json";
/// Most rows of a table that is written as text, some 600 bytes a row of fields.
const MOST_ROWS: usize = 50_000;

/// Writes all files.
pub(crate) fn write(
    folder: &ResultFolder,
    model: &Model,
    outcome: &Outcome,
    timings: &[Timing],
    report: bool,
) -> Result<(), ReportError> {
    let names: Vec<String> = model.receivers.iter().map(|receiver| receiver.name.clone()).collect();
    let put =
        |name: &str, fill: &dyn Fn(&mut dyn io::Write) -> io::Result<()>| folder.write(name, fill).map(drop);
    if is_table(outcome.near.len()) {
        put("receivers.csv", &|out| write_receivers_csv(&names, &outcome.near, out))?;
    }
    put("receivers.npz", &|out| write_receivers_npz(&outcome.near, out))?;
    match outcome.far.len() {
        0 => {}
        rows if is_table(rows) => put("far.csv", &|out| write_far_csv(&names, &outcome.far, out))?,
        _ => put("far.npz", &|out| write_far_npz(&outcome.far, out))?,
    }
    match outcome.monostatic.len() {
        0 => {}
        rows if is_table(rows) => {
            put("monostatic.csv", &|out| write_monostatic_csv(&names, &outcome.monostatic, out))?;
        }
        _ => put("monostatic.npz", &|out| write_monostatic_npz(&outcome.monostatic, out))?,
    }
    put("currents.vtu", &|out| write_currents_vtu(&model.geometry.mesh, &outcome.currents, out))?;
    residuals(folder, model, outcome)?;
    for (index, receiver) in model.receivers.iter().enumerate() {
        if model.bands.len() <= MOST_PICTURED {
            pictures(folder, model, outcome, (index, receiver))?;
        }
        if model.bands.len() > 1 {
            over_frequency(folder, model, outcome, (index, receiver))?;
        }
    }
    if report {
        page(folder, model, outcome, timings)?;
    }
    let record = outcome.record(model, timings);
    put(LAST_FILE, &|out| serde_json::to_writer_pretty(out, &record).map_err(io::Error::other))
}

/// Whether so many rows are written as text; more are arrays only.
pub(super) fn is_table(rows: usize) -> bool {
    rows <= MOST_ROWS
}

/// The levels of a receiver over the frequencies.
fn over_frequency(
    folder: &ResultFolder,
    model: &Model,
    outcome: &Outcome,
    (index, receiver): (usize, &Receiver),
) -> Result<(), ReportError> {
    let Some(levels) = levels(model, outcome, index, receiver) else { return Ok(()) };
    let frequencies: Vec<f64> = model.bands.iter().map(|band| band.wave.frequency()).collect();
    let title = format!("{}: {}", receiver.name, levels.quantity);
    if let Some((columns, values)) = &levels.map {
        let (scaled, unit) = scaled_frequencies(&frequencies);
        let ends = |values: &[f64]| values.first().copied().zip(values.last().copied()).unwrap_or((0.0, 1.0));
        let (angle, degrees) = receiver.angles();
        let axis = |label: String, (from, to): (f64, f64)| MapAxis { label, from, to };
        let map = FieldMap {
            title: &title,
            quantity: ("√σ", "m"),
            axes: [
                axis(format!("{angle}, degrees"), ends(&degrees)),
                axis(format!("frequency, {unit}"), ends(&scaled)),
            ],
            aspect: None,
            columns: *columns,
            values,
            outline: &[],
        };
        let draw = |out: &mut dyn io::Write| map.draw(MapQuantity::Magnitude)?.write_png(out);
        folder.write(&format!("{}_over_frequency.png", receiver.name), draw)?;
    }
    let up = format!("{}, {}", levels.quantity, levels.unit);
    let draw = |out: &mut dyn io::Write| write_frequency_plot(&title, &up, &frequencies, &levels.lines, out);
    folder.write(&format!("{}_over_frequency.svg", receiver.name), draw).map(drop)
}

/// `report.html`: the surface currents in three dimensions, and the cross-sections over angles.
fn page(
    folder: &ResultFolder,
    model: &Model,
    outcome: &Outcome,
    timings: &[Timing],
) -> Result<(), ReportError> {
    let mesh = &model.geometry.mesh;
    let shown = outcome.currents.len().min(MOST_PICTURED);
    let phasors = current_phasors(mesh, &outcome.currents[..shown]);
    let shown = ReportModel { phasors: &phasors, ..ReportModel::bare(mesh) };
    let seconds: f64 = timings.iter().map(|timing| timing.seconds).sum();
    let known = [
        ("Program", format!("Fredholm {}", env!("CARGO_PKG_VERSION"))),
        ("Scene", model.path().display().to_string()),
        ("Method", model.method_in_words()),
        ("Solution", model.method.name()),
        ("Time", format!("{seconds:.2} s")),
    ];
    let report = WaveReport {
        title: title(model),
        method: model.method_in_words(),
        across: across(model).to_owned(),
        warnings: model.warnings.clone(),
        statements: statements(model, outcome),
        plots: curves(model, outcome),
        provenance: known.map(|(name, value)| (name.to_owned(), value)).into(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        ..WaveReport::default()
    };
    let page = ReportPage::of_waves(report, shown, &histories(outcome));
    folder.write(REPORT, |out| page.write(out)).map(drop)
}

/// What is known of the errors, in words.
fn statements(model: &Model, outcome: &Outcome) -> Vec<String> {
    let solved = outcome.solved.iter().filter_map(|solved| {
        let (last, ended) = (solved.residuals.last()?, if solved.converged() { "met" } else { "not met" });
        let megahertz = solved.frequency / 1e6;
        Some(format!("At {megahertz} MHz the residual is {last:.1e}; what was asked for is {ended}."))
    });
    let sources =
        [("the size of the facets", &outcome.mesh_errors), ("physical optics itself", &outcome.form_errors)];
    let estimated = sources.into_iter().flat_map(|(source, errors)| {
        errors.iter().map(move |error| {
            let (name, megahertz) = (&model.receivers[error.receiver].name, error.frequency / 1e6);
            let percent = 100.0 * error.relative;
            format!("E at {name}, {megahertz} MHz, is off by about {percent:.2} % through {source}.")
        })
    });
    let stated = outcome.stated_errors.iter().map(|error| {
        let (name, megahertz) = (&model.receivers[error.receiver].name, error.frequency / 1e6);
        let percent = 100.0 * error.relative;
        format!("The error of E at {name}, {megahertz} MHz, is stated to be below {percent:.2} %.")
    });
    let reason = model.reason.iter().map(|reason| format!("The method was chosen: {reason}."));
    reason.chain(solved).chain(stated).chain(estimated).collect()
}

/// Curves of all receivers over the angle that is stepped through, and over the frequency.
fn curves(model: &Model, outcome: &Outcome) -> Vec<ReportPlot> {
    let mut plots = Vec::new();
    for (index, receiver) in model.receivers.iter().enumerate() {
        if model.bands.len() > 1 {
            let levels = levels(model, outcome, index, receiver);
            plots.extend(levels.map(|levels| plot(model, receiver, &levels)));
        }
        for band in model.bands.iter().filter(|_| model.bands.len() <= MOST_PICTURED) {
            let frequency = band.wave.frequency();
            let name = format!("{}, {} MHz", receiver.name, frequency / 1e6);
            let over = OverAngle::of(outcome, (index, receiver), frequency, &name);
            plots.extend(over.map(|over| over.plot()));
        }
    }
    plots
}

/// The residuals of all frequencies that have any.
fn histories(outcome: &Outcome) -> Vec<WaveResiduals> {
    let known = outcome.solved.iter().filter(|solved| !solved.residuals.is_empty());
    known
        .map(|solved| WaveResiduals { frequency: solved.frequency, values: solved.residuals.clone() })
        .collect()
}

/// What a history runs along.
fn across(model: &Model) -> &'static str {
    if let Method::Bounces(_) = model.method { "bounces" } else { "iterations" }
}

/// The title of a scene, or its file.
fn title(model: &Model) -> String {
    model.scene.title().map_or_else(|| model.path().display().to_string(), str::to_owned)
}

/// The residual after every iteration or bounce, where there is any.
fn residuals(folder: &ResultFolder, model: &Model, outcome: &Outcome) -> Result<(), ReportError> {
    let lines = histories(outcome);
    if lines.is_empty() {
        return Ok(());
    }
    folder.write("residuals.csv", |out| write_residuals_csv(&lines, out))?;
    let title = format!("{}: residuals of {}", title(model), model.method.name());
    let draw = |out: &mut dyn io::Write| write_residuals_plot(&title, across(model), &lines, out);
    folder.write("residuals.svg", draw).map(drop)
}

/// What the names of the pictures of a receiver at a frequency begin with.
pub(super) fn stem(model: &Model, receiver: &Receiver, frequency: f64) -> String {
    if model.bands.len() > 1 {
        format!("{}_{}MHz", receiver.name, frequency / 1e6)
    } else {
        receiver.name.clone()
    }
}

/// The plots and maps of one receiver.
fn pictures(
    folder: &ResultFolder,
    model: &Model,
    outcome: &Outcome,
    (index, receiver): (usize, &Receiver),
) -> Result<(), ReportError> {
    for band in &model.bands {
        let frequency = band.wave.frequency();
        let stem = stem(model, receiver, frequency);
        let here = |row: &&WaveRow| row.receiver == index && row.frequency.total_cmp(&frequency).is_eq();
        let rows: Vec<&WaveRow> = outcome.near.iter().filter(here).collect();
        if let Some(grid) = Grid::of(receiver, &model.geometry.mesh) {
            let title = format!("{}, {} MHz", receiver.name, frequency / 1e6);
            maps(folder, (&stem, &title), &rows, &grid)?;
        }
        if let Some(over) = OverAngle::of(outcome, (index, receiver), frequency, &stem) {
            let OverAngle { title, quantity, lines } = &over;
            folder.write(&format!("{stem}.svg"), |out| write_angle_plot(title, quantity, lines, out))?;
        }
    }
    Ok(())
}

/// The strongest component of E, total field: magnitude, phase and real part.
fn maps(
    folder: &ResultFolder,
    (stem, place): (&str, &str),
    rows: &[&WaveRow],
    grid: &Grid,
) -> Result<(), ReportError> {
    let component = Component::strongest(rows);
    let values: Vec<[f64; 2]> = rows.iter().map(|row| component.of(row)).collect();
    let title = format!("Total field at {place}");
    let map = grid.map(&title, component, &values);
    for quantity in MapQuantity::ALL {
        let name = format!("{stem}_{}_{}.png", component.name(), quantity.name());
        folder.write(&name, |out| map.draw(quantity)?.write_png(out))?;
    }
    Ok(())
}
