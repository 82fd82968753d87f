//! The record of a result of waves.

use fredholm_report::Timing;
use serde_json::Value;

use super::lines::{Lines, MOST_ENTRIES_TOLD, percent, times};
use super::{Made, Summarise};

/// The format of the record.
pub(crate) const RECORD_FORMAT: &str = "fredholm-waves-run/1";
/// Frequencies that are told one by one in a line.
const IN_A_LINE: usize = 4;

/// Frequencies (Hz) in words, many of them by their range.
#[must_use]
pub fn frequencies(all: &[f64]) -> String {
    let megahertz = |f: &f64| format!("{} MHz", f / 1e6);
    match all {
        [first, .., last] if all.len() > IN_A_LINE => {
            format!("{} from {} to {}", all.len(), megahertz(first), megahertz(last))
        }
        few => few.iter().map(megahertz).collect::<Vec<_>>().join(", "),
    }
}

/// The record of fields, as `run.json` has it.
pub struct WaveRecord<'a>(pub &'a Value);

impl WaveRecord<'_> {
    fn text(&self, key: &str) -> Option<&str> {
        self.0[key].as_str()
    }

    fn list(&self, key: &str) -> &[Value] {
        self.0[key].as_array().map_or(&[], Vec::as_slice)
    }

    fn method(&self) -> String {
        let shadows = self.text("shadows").map(|name| format!("{name} shadows"));
        // The lowest order is what is expected.
        let order = self.0["order"].as_u64().filter(|&order| order > 0);
        let order = order.map(|order| format!("functions of order {order}"));
        let edges = self.0["edge_currents"].as_bool().unwrap_or(false).then(|| "edge currents".to_owned());
        let [method, solution] = ["method", "solution"].map(|key| self.text(key).map(str::to_owned));
        [method, order, shadows, edges, solution].into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

impl Summarise for WaveRecord<'_> {
    fn made(&self) -> Made<'_> {
        let version = self.text("program").unwrap_or_default();
        Made {
            version: version.strip_prefix("fredholm ").unwrap_or(version),
            of: self.text("scene").unwrap_or_default(),
            sha256: self.text("scene_sha256").unwrap_or_default(),
        }
    }

    fn lines(&self, lines: &mut Lines) {
        for (label, key) in ERROR_LABELS {
            let all = self.list(key);
            all.iter()
                .take(MOST_ENTRIES_TOLD)
                .for_each(|error| lines.add(label, at_receiver(error, "relative")));
            lines.add_some("", more(all.len()));
        }
        lines.add("method", self.method());
        lines.add_some("chosen", self.text("chosen_because").map(str::to_owned));
        let found = self.list("frequencies");
        if found.len() > MOST_ENTRIES_TOLD {
            lines.add("frequencies", sweep(found));
        }
        for found in found.iter().filter(|_| found.len() <= MOST_ENTRIES_TOLD) {
            let ending = last_residual(found).map_or_else(String::new, |residual| {
                let count = found["residuals"].as_array().map_or(0, Vec::len) - 1;
                let missed = found["converged"] == Value::Bool(false);
                let missed = if missed { ", more than was asked for" } else { "" };
                format!(", residual {residual:.1e} after {count} iterations{missed}")
            });
            lines.add(&megahertz(found), format!("{} facets{ending}", found["facets"]));
        }
        lines.add_some("interpolated", interpolated(&self.0["interpolated"]));
        for power in self.list("power").iter().take(MOST_ENTRIES_TOLD) {
            let ratio = power["ratio"].as_f64().unwrap_or_default();
            let absorbed = power["absorbed_w"].as_f64().unwrap_or_default();
            let done = if absorbed > 0.0 {
                let share = absorbed / power["supplied_w"].as_f64().unwrap_or(f64::NAN);
                format!("radiated or absorbed ({share:.4} absorbed)")
            } else {
                "radiated".to_owned()
            };
            let text = format!("{ratio:.4} of what the sources give is {done}, {}", megahertz(power));
            lines.add("power", text);
        }
        let all = self.list("reciprocity");
        all.iter()
            .take(MOST_ENTRIES_TOLD)
            .for_each(|found| lines.add("reciprocity", at_receiver(found, "defect")));
        self.list("warnings").iter().filter_map(Value::as_str).for_each(|text| lines.add("warning", text));
    }

    fn details(&self, lines: &mut Lines) {
        lines.add_some("title", self.text("title").map(str::to_owned));
        let receivers: Vec<&str> = self.list("receivers").iter().filter_map(Value::as_str).collect();
        lines.add_some("receivers", (!receivers.is_empty()).then(|| receivers.join(", ")));
        let timings: Vec<Timing> = serde_json::from_value(self.0["timings"].clone()).unwrap_or_default();
        lines.add("time", times(&timings));
    }
}

/// Labels of the errors that a record has, and their keys.
const ERROR_LABELS: [(&str, &str); 3] = [
    ("stated error", "stated_errors"),
    ("mesh error", "estimated_mesh_errors"),
    ("form error", "estimated_form_errors"),
];

fn megahertz(found: &Value) -> String {
    format!("{} MHz", found["frequency_hz"].as_f64().unwrap_or_default() / 1e6)
}

/// A relative error of a receiver at a frequency.
fn at_receiver(found: &Value, key: &str) -> String {
    let relative = found[key].as_f64().unwrap_or(f64::NAN);
    let name = found["receiver"].as_str().unwrap_or_default();
    format!("{} at {name}, {}", percent(relative), megahertz(found))
}

fn more(count: usize) -> Option<String> {
    (count > MOST_ENTRIES_TOLD).then(|| format!("and {} more: see run.json", count - MOST_ENTRIES_TOLD))
}

fn last_residual(found: &Value) -> Option<f64> {
    found["residuals"].as_array()?.last()?.as_f64()
}

/// How many frequencies of a sweep were interpolated between the others, and how exactly.
fn interpolated(record: &Value) -> Option<String> {
    let [computed, all] = ["computed", "frequencies"].map(|key| record[key].as_u64());
    let (computed, all, relative) = (computed?, all?, record["relative"].as_f64()?);
    let between = all.saturating_sub(computed);
    Some(format!(
        "{between} of {all} frequencies, to {} of a receiver's field over the sweep",
        percent(relative)
    ))
}

/// What is to be said of many frequencies together.
fn sweep(all: &[Value]) -> String {
    let values: Vec<f64> = all.iter().filter_map(|one| one["frequency_hz"].as_f64()).collect();
    let facets = all.first().map_or(0, |found| found["facets"].as_u64().unwrap_or_default());
    let worst = all.iter().filter_map(last_residual).reduce(f64::max);
    let ending = worst.map_or(String::new(), |residual| format!(", residuals up to {residual:.1e}"));
    format!("{}, {facets} facets{ending}", frequencies(&values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A sweep says how many of its frequencies were not computed; other runs say nothing.
    #[test]
    fn interpolated_frequencies_are_told() {
        let record = json!({ "computed": 21, "frequencies": 61, "relative": 4.2e-3 });
        let told = interpolated(&record).unwrap();
        assert_eq!(told, "40 of 61 frequencies, to 0.42 % of a receiver's field over the sweep");
        assert_eq!(interpolated(&Value::Null), None);
    }
}
