//! Sweeps: levels of every receiver over the frequency.

use fredholm_report::{FrequencyLine, ReportAxis, ReportPlot, ReportSeries};
use fredholm_scene::waves::Places;

use super::model::Receiver;
use super::{Model, Outcome};

/// Most frequencies of which every one has its own pictures.
pub(super) const MOST_PICTURED: usize = 8;
/// Most points or directions of a receiver that have a line each; of more, the largest is drawn.
const MOST_LINES: usize = 4;

/// The levels of a receiver: what they are, their unit, and a line each.
pub(super) struct Levels {
    pub(super) quantity: &'static str,
    pub(super) unit: &'static str,
    pub(super) lines: Vec<FrequencyLine>,
    /// √σ of all polarisations together (m) in every direction at every frequency, and how many
    /// directions there are; none at points, nor in few directions.
    pub(super) map: Option<(usize, Vec<[f64; 2]>)>,
}

/// A quantity at every place and frequency: its name, and values by frequency, then by place.
type Table = (&'static str, Vec<Vec<f64>>);

/// The levels of a receiver over the frequencies of the scene.
pub(super) fn levels(model: &Model, outcome: &Outcome, index: usize, receiver: &Receiver) -> Option<Levels> {
    let frequencies: Vec<u64> = model.bands.iter().map(|band| band.wave.frequency().to_bits()).collect();
    let table = |name: &'static str, rows: Vec<(f64, f64)>| -> Table {
        let at = |&bits: &u64| rows.iter().filter(|row| row.0.to_bits() == bits).map(|row| row.1).collect();
        (name, frequencies.iter().map(at).collect())
    };
    let (quantity, unit, tables) = match &receiver.places {
        Places::Near { .. } => {
            let rows = outcome.near.iter().filter(|row| row.receiver == index);
            let square = |e: &[f64; 12]| e[..6].iter().map(|x| x * x).sum::<f64>();
            let (scattered, total) = rows
                .map(|row| ((row.frequency, square(&row.scattered)), (row.frequency, square(&row.total()))))
                .unzip();
            ("|E|", "dB(V/m)", vec![table("scattered", scattered), table("total", total)])
        }
        Places::Far(_) => {
            let rows = || outcome.far.iter().filter(|row| row.receiver == index);
            let part = |part: usize| -> Vec<(f64, f64)> {
                rows().filter_map(|row| Some((row.frequency, row.cross_section?[part]))).collect()
            };
            let gains = rows().filter_map(|row| Some((row.frequency, row.total?.gain)));
            let gains: Vec<(f64, f64)> = gains.filter(|(_, gain)| gain.is_finite()).collect();
            if gains.is_empty() {
                let tables = vec![table("θ", part(0)), table("φ", part(1))];
                ("radar cross-section", "dBsm", tables)
            } else {
                ("gain", "dBi", vec![table("gain", gains)])
            }
        }
        Places::Monostatic(_) => {
            let rows = || outcome.monostatic.iter().filter(|row| row.receiver == index);
            let part = |part: usize| -> Vec<(f64, f64)> {
                rows().map(|row| (row.frequency, row.cross_sections()[part])).collect()
            };
            let tables = vec![table("θθ", part(0)), table("φφ", part(3)), table("φθ", part(1))];
            ("radar cross-section", "dBsm", tables)
        }
    };
    let lines: Vec<FrequencyLine> = tables.iter().flat_map(|table| lines(table, &receiver.places)).collect();
    let any = lines.iter().flat_map(|line| &line.levels).any(|level| level.is_finite());
    let sections = receiver.places_are_directions() && unit == "dBsm";
    let map = if sections { map(&tables) } else { None };
    any.then_some(Levels { quantity, unit, lines, map })
}

/// Rows of √(sum of cross-sections) over the directions, where there are too many for lines.
fn map(tables: &[Table]) -> Option<(usize, Vec<[f64; 2]>)> {
    let (_, first) = tables.first()?;
    let columns = first.first()?.len();
    let root = |frequency: usize, place: usize| {
        let all = tables.iter().filter_map(|(_, values)| values.get(frequency)?.get(place));
        [all.sum::<f64>().sqrt(), 0.0]
    };
    let rows = (0..first.len()).flat_map(|frequency| (0..columns).map(move |place| (frequency, place)));
    (columns > MOST_LINES).then(|| (columns, rows.map(|(f, place)| root(f, place)).collect()))
}

/// A line a place, or one of the largest over many places.
fn lines((name, values): &Table, places: &Places) -> Vec<FrequencyLine> {
    let decibels = |value: f64| 10.0 * value.log10();
    let count = values.first().map_or(0, Vec::len);
    if count > MOST_LINES {
        let largest = |row: &Vec<f64>| decibels(row.iter().copied().fold(0.0, f64::max));
        let levels = values.iter().map(largest).collect();
        return vec![FrequencyLine { name: format!("{name}, largest"), levels }];
    }
    let line = |place: usize| {
        let levels = values.iter().map(|row| row.get(place).map_or(f64::NAN, |v| decibels(*v))).collect();
        FrequencyLine { name: format!("{name}{}", label(places, place, count)), levels }
    };
    (0..count).map(line).collect()
}

/// Which place it is, where there are several.
fn label(places: &Places, place: usize, count: usize) -> String {
    match places {
        _ if count == 1 => String::new(),
        Places::Near { .. } => format!(", point {place}"),
        Places::Far(angles) | Places::Monostatic(angles) => {
            let [theta, phi] = angles.get(place).copied().unwrap_or_default();
            format!(", θ {theta}° φ {phi}°")
        }
    }
}

/// The same as a plot of the page.
pub(super) fn plot(model: &Model, receiver: &Receiver, levels: &Levels) -> ReportPlot {
    let frequencies: Vec<f64> = model.bands.iter().map(|band| band.wave.frequency() / 1e6).collect();
    let line = |line: &FrequencyLine| ReportSeries {
        name: line.name.clone(),
        colour: None,
        dashed: false,
        x: frequencies.clone(),
        y: line.levels.clone(),
    };
    let axis = |label: &str| ReportAxis { label: label.to_owned(), logarithmic: false };
    ReportPlot {
        title: format!("{} over frequency: {}", receiver.name, levels.quantity),
        note: format!("Levels in {}.", levels.unit),
        across: vec![(axis("frequency, MHz"), levels.lines.iter().map(line).collect())],
        up: axis(levels.unit),
        polar: None,
    }
}
