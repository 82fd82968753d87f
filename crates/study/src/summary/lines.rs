//! Text with labels, in the words of which summaries are made.

use std::fmt::Write;

use fredholm_report::Timing;

/// Columns that labels take.
const LABEL_COLUMNS: usize = 16;
/// Entries of a list that are told one by one.
pub(super) const MOST_ENTRIES_TOLD: usize = 8;

/// Lines with a label each.
#[derive(Debug, Default)]
pub struct Lines(String);

impl Lines {
    /// Adds a line; what has more lines is indented under its label.
    pub fn add(&mut self, label: &str, text: impl AsRef<str>) {
        let text = text.as_ref().replace('\n', &format!("\n{:1$}", "", LABEL_COLUMNS + 2));
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "  {label:<LABEL_COLUMNS$}{text}");
    }

    /// Adds a line where there is something to say.
    pub fn add_some(&mut self, label: &str, text: Option<String>) {
        if let Some(text) = text {
            self.add(label, text);
        }
    }

    /// Adds the lines of a table as they are.
    pub(super) fn table(&mut self, rows: impl IntoIterator<Item = String>) {
        for row in rows {
            let _ = writeln!(self.0, "  {}", row.trim_end());
        }
    }

    /// The lines under a heading.
    #[must_use]
    pub fn under(self, heading: &str) -> String {
        format!("{heading}\n{}", self.0)
    }
}

/// How many there are of a thing.
pub(super) fn number(count: u64, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// How many elements there are, and on what.
#[must_use]
pub fn extent(elements: u64, faces: u64, surfaces: u64) -> String {
    let [elements, faces, surfaces] =
        [(elements, "element"), (faces, "face"), (surfaces, "surface")].map(|(n, thing)| number(n, thing));
    format!("{elements} on {faces} of {surfaces}")
}

/// The stages and their times.
pub(super) fn times(timings: &[Timing]) -> String {
    let stages: Vec<_> = timings.iter().map(|t| format!("{} {:.2} s", t.stage, t.seconds)).collect();
    stages.join(", ")
}

/// A part as percent with two digits.
pub(super) fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    match percent.abs() {
        0.0 => "0 %".to_owned(),
        size if !(0.01..1e4).contains(&size) => format!("{percent:.1e} %"),
        size => {
            let digits = (1.0 - size.log10().floor()).clamp(0.0, 4.0);
            format!("{percent:.0$} %", digits as usize)
        }
    }
}

/// A value with four digits.
pub(super) fn value(number: f64) -> String {
    match number.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e5).contains(&size) => {
            let digits = (3.0 - size.log10().floor()).clamp(0.0, 7.0);
            format!("{number:.0$}", digits as usize)
        }
        _ => format!("{number:.3e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_values_have_few_digits() {
        let shares: [(f64, &str); 7] = [
            (0.0, "0 %"),
            (0.0123, "1.2 %"),
            (0.16, "16 %"),
            (0.5, "50 %"),
            (4.3e-3, "0.43 %"),
            (2e-9, "2.0e-7 %"),
            (214.0, "2.1e4 %"),
        ];
        for (part, text) in shares {
            assert_eq!(percent(part), text);
        }
        for (number, text) in
            [(3.216_54, "3.217"), (12_345.6, "12346"), (0.0, "0"), (1e-9, "1.000e-9"), (0.012_345, "0.01235")]
        {
            assert_eq!(value(number), text);
        }
    }

    #[test]
    fn further_lines_stand_under_the_first() {
        let mut lines = Lines::default();
        lines.add("label", "a\nb");
        assert_eq!(lines.under("head"), format!("head\n  label           a\n{:18}b\n", ""));
    }
}
