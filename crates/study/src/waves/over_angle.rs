//! Quantities over an angle: what the plot of a receiver shows, as a file and on the page.
//!
//! Directions that step through one angle are one cut. Of a grid of directions there is a cut for
//! each of the values of the angle that has fewer, of many [`MOST_CUTS`] evenly spaced ones.

use fredholm_report::{
    AngleQuantity, FarRow, MonostaticRow, ReportAxis, ReportPlot, ReportPolar, ReportSeries, WaveRow,
};
use fredholm_scene::waves::{Layout, Places};

use super::Outcome;
use super::model::Receiver;

/// Levels further below the largest are left out of the plot of the page, dB.
const DECIBELS_SHOWN: f64 = 80.0;
/// Most cuts of one plot.
const MOST_CUTS: usize = 4;

/// The name of a line, and its angles (degrees) with values.
type NamedLine = (String, Vec<(f64, f64)>);

/// Lines over an angle.
pub(super) struct OverAngle {
    pub(super) title: String,
    pub(super) quantity: AngleQuantity,
    pub(super) lines: Vec<NamedLine>,
}

/// A quantity in directions: what makes it of the angle, and its parts with a value a direction.
type Parts = (fn(&str) -> AngleQuantity, Vec<(&'static str, Vec<f64>)>);

impl OverAngle {
    /// What a receiver has over an angle at a frequency (Hz), under a name; none at points that are
    /// not on a circle, and where there is no number.
    pub(super) fn of(
        outcome: &Outcome,
        (index, receiver): (usize, &Receiver),
        frequency: f64,
        name: &str,
    ) -> Option<Self> {
        match &receiver.places {
            Places::Near { layout: Layout::Circle(degrees), .. } => {
                let here = |row: &&WaveRow| row.receiver == index && same(row.frequency, frequency);
                let rows: Vec<&WaveRow> = outcome.near.iter().filter(here).collect();
                Some(circle(degrees, &rows, name))
            }
            Places::Near { .. } => None,
            Places::Far(angles) => {
                let here = |row: &&FarRow| row.receiver == index && same(row.frequency, frequency);
                let rows: Vec<&FarRow> = outcome.far.iter().filter(here).collect();
                in_directions(angles, &far(&rows), name)
            }
            Places::Monostatic(angles) => {
                let rows = outcome.monostatic.iter();
                let rows = rows.filter(|row| row.receiver == index && same(row.frequency, frequency));
                let sections: Vec<[f64; 4]> = rows.map(MonostaticRow::cross_sections).collect();
                let part = |part: usize| sections.iter().map(|sections| sections[part]).collect();
                let parts = [("σ θθ", 0), ("σ φφ", 3), ("σ φθ", 1)].map(|(name, at)| (name, part(at)));
                in_directions(angles, &(AngleQuantity::cross_section, parts.into()), name)
            }
        }
    }

    /// The same as a plot of the page: levels over a straight axis, and polar.
    pub(super) fn plot(&self) -> ReportPlot {
        let AngleQuantity { name, level_unit, unit, angle, per_decade } = &self.quantity;
        let levels =
            |points: &[(f64, f64)]| points.iter().map(|point| per_decade * point.1.log10()).collect();
        let all: Vec<Vec<f64>> = self.lines.iter().map(|(_, points)| levels(points)).collect();
        let finite = all.iter().flatten().copied().filter(|level| level.is_finite());
        let least = finite.fold(f64::NEG_INFINITY, f64::max) - DECIBELS_SHOWN;
        // What is nothing but rounding would set the scale.
        let shown = |level: f64| if level >= least { level } else { f64::NAN };
        let line = |((name, points), levels): (&NamedLine, Vec<f64>)| ReportSeries {
            name: name.clone(),
            colour: None,
            dashed: false,
            x: points.iter().map(|point| point.0).collect(),
            y: levels.into_iter().map(shown).collect(),
        };
        let axis = |label: String| ReportAxis { label, logarithmic: false };
        ReportPlot {
            title: self.title.clone(),
            note: format!("Levels in {level_unit}, over a straight axis or polar."),
            across: vec![(axis(format!("{angle}, degrees")), self.lines.iter().zip(all).map(line).collect())],
            up: axis(format!("{name}, {level_unit}")),
            polar: Some(ReportPolar {
                clockwise_from_top: self.quantity.is_from_top(),
                per_decade: *per_decade,
                linear: format!("{name}, {unit}"),
            }),
        }
    }
}

/// |E| of the scattered and the total field on a circle.
fn circle(degrees: &[f64], rows: &[&WaveRow], name: &str) -> OverAngle {
    let line = |name: &str, of: &dyn Fn(&WaveRow) -> [f64; 12]| {
        let size = |row: &&WaveRow| of(row)[..6].iter().map(|x| x * x).sum::<f64>().sqrt();
        (name.to_owned(), degrees.iter().copied().zip(rows.iter().map(size)).collect())
    };
    OverAngle {
        title: format!("{name}: magnitude of E"),
        quantity: AngleQuantity::field("angle"),
        lines: vec![line("scattered field", &|row| row.scattered), line("total field", &WaveRow::total)],
    }
}

/// Cross-sections where one plane wave is incident; else the gain of sources whose power is known;
/// else amplitudes, with the sources in where these are at places.
fn far(rows: &[&FarRow]) -> Parts {
    let sections: Vec<[f64; 2]> = rows.iter().filter_map(|row| row.cross_section).collect();
    if sections.len() == rows.len() {
        let part = |part: usize| sections.iter().map(|section| section[part]).collect();
        return (AngleQuantity::cross_section, vec![("received θ", part(0)), ("received φ", part(1))]);
    }
    let gains: Vec<f64> = rows.iter().filter_map(|row| row.total.map(|total| total.gain)).collect();
    if gains.len() == rows.len() && gains.iter().all(|gain| gain.is_finite()) {
        return (AngleQuantity::gain, vec![("gain", gains)]);
    }
    let amplitude = |row: &&FarRow| row.total.map_or(row.amplitude, |total| total.amplitude);
    let part = |part: usize| {
        let size = |row: &&FarRow| amplitude(row)[2 * part].hypot(amplitude(row)[2 * part + 1]);
        rows.iter().map(size).collect()
    };
    (AngleQuantity::amplitude, vec![("along θ", part(0)), ("along φ", part(1))])
}

/// A quantity in directions (θ and φ, degrees), a line a cut.
fn in_directions(angles: &[[f64; 2]], (quantity, parts): &Parts, name: &str) -> Option<OverAngle> {
    angles.first()?;
    if parts.iter().all(|(_, values)| values.len() != angles.len()) {
        return None;
    }
    let Cuts { along, held, of } = Cuts::of(angles);
    let (angle, other) = if along == 1 { ("φ", "θ") } else { ("θ", "φ") };
    let quantity = quantity(angle);
    let single = held.len() == 1;
    let mut lines = Vec::new();
    for value in &held {
        for (part, values) in parts {
            let cut = angles.iter().zip(values).filter(|(angles, _)| same(angles[1 - along], *value));
            let points = cut.map(|(angles, value)| (angles[along], *value)).collect();
            let label =
                if single { (*part).to_owned() } else { format!("{part}, {other} {}°", fixed(*value)) };
            lines.push((label, points));
        }
    }
    let place = match held.as_slice() {
        [value] => format!(" at {other} = {}°", fixed(*value)),
        cuts if cuts.len() < of => format!(", {} of {of} cuts", cuts.len()),
        _ => String::new(),
    };
    Some(OverAngle { title: format!("{name}: {} over {angle}{place}", quantity.name), quantity, lines })
}

/// How directions are cut.
struct Cuts {
    /// Which angle the cuts run along: 0 for θ, 1 for φ.
    along: usize,
    /// The other angle of the cuts that are shown, degrees.
    held: Vec<f64>,
    /// How many cuts there are.
    of: usize,
}

impl Cuts {
    fn of(angles: &[[f64; 2]]) -> Self {
        let distinct = |which: usize| {
            let mut found: Vec<f64> = angles.iter().map(|angles| angles[which]).collect();
            found.sort_unstable_by(f64::total_cmp);
            found.dedup_by(|a, b| same(*a, *b));
            found
        };
        let [theta, phi] = [distinct(0), distinct(1)];
        let along = usize::from(theta.len() == 1 || (phi.len() > 1 && phi.len() > theta.len()));
        let all = if along == 1 { theta } else { phi };
        let of = all.len();
        let shown = of.min(MOST_CUTS);
        Self { along, held: (0..shown).map(|i| all[i * of / shown]).collect(), of }
    }
}

fn same(a: f64, b: f64) -> bool {
    a.total_cmp(&b).is_eq()
}

/// An angle with the decimals it needs, five at most.
fn fixed(degrees: f64) -> String {
    let text = format!("{degrees:.5}");
    text.trim_end_matches('0').trim_end_matches('.').replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(thetas: &[f64], phis: &[f64]) -> Vec<[f64; 2]> {
        thetas.iter().flat_map(|theta| phis.iter().map(move |phi| [*theta, *phi])).collect()
    }

    fn over(angles: &[[f64; 2]]) -> OverAngle {
        let values = angles.iter().map(|[theta, phi]| theta + 1000.0 * phi).collect();
        let parts: Parts = (AngleQuantity::gain, vec![("gain", values)]);
        in_directions(angles, &parts, "far").unwrap()
    }

    #[test]
    fn one_cut_is_one_line_over_the_angle_that_changes() {
        let found = over(&grid(&[90.0], &[0.0, 10.0, 20.0]));
        assert_eq!(
            (found.title.as_str(), found.quantity.angle.as_str()),
            ("far: gain over φ at θ = 90°", "φ")
        );
        let points = vec![(0.0, 90.0), (10.0, 10_090.0), (20.0, 20_090.0)];
        assert_eq!(found.lines, [("gain".to_owned(), points)]);
        let found = over(&grid(&[0.0, 5.0], &[-30.0]));
        assert_eq!(found.title, "far: gain over θ at φ = −30°");
        assert_eq!(found.lines[0].1, [(0.0, -30_000.0), (5.0, -29_995.0)]);
    }

    #[test]
    fn a_grid_has_a_line_a_cut() {
        let thetas: Vec<f64> = (0..19).map(|i| 10.0 * f64::from(i)).collect();
        let found = over(&grid(&thetas, &[0.0, 90.0]));
        assert_eq!(found.title, "far: gain over θ");
        let names: Vec<&str> = found.lines.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["gain, φ 0°", "gain, φ 90°"]);
        assert!(found.lines.iter().all(|(_, points)| points.len() == 19));
        assert_eq!(found.lines[1].1[3], (30.0, 90_030.0));
        let phis: Vec<f64> = (0..8).map(|i| 45.0 * f64::from(i)).collect();
        let found = over(&grid(&thetas, &phis));
        assert_eq!(found.title, "far: gain over θ, 4 of 8 cuts");
        assert!(found.lines[2].0.ends_with("φ 180°"));
    }

    #[test]
    fn of_far_fields_the_quantity_that_is_known_is_shown() {
        let row = FarRow {
            receiver: 0,
            index: 0,
            theta_degrees: 0.0,
            phi_degrees: 0.0,
            frequency: 1e9,
            amplitude: [3.0, 4.0, 0.0, 1.0],
            cross_section: None,
            total: None,
        };
        let (quantity, parts) = far(&[&row]);
        assert_eq!(quantity("θ").level_unit, "dB(V)");
        assert_eq!(parts, [("along θ", vec![5.0]), ("along φ", vec![1.0])]);
        let lit = FarRow { cross_section: Some([2.0, 0.5]), ..row };
        assert_eq!(far(&[&lit]).1[0], ("received θ", vec![2.0]));
    }
}
