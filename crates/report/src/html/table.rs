//! Tables of a page. They stand in the page itself, so that they are read and printed without
//! scripts.

use std::io::{self, Write};

use crate::number::Number;
use crate::words;
use crate::xml::escaped;

/// Most rows of a table that are written.
const MOST_ROWS: usize = 1000;

/// A column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReportColumn {
    /// Quantity and unit.
    pub title: String,
    /// Which mean over a surface it shows for the band that is chosen in the page: `irradiance` or
    /// `radiosity`.
    pub of_band: Option<&'static str>,
}

impl ReportColumn {
    /// A column that shows the same whatever is chosen.
    #[must_use]
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), of_band: None }
    }
}

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub enum ReportCell {
    /// Words.
    Text(String),
    /// A number; none where it is not known.
    Number(Option<f64>),
}

/// A table whose rows can be put in order.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportTable {
    /// Heading.
    pub title: String,
    /// A sentence on what the numbers are.
    pub note: String,
    /// Columns.
    pub columns: Vec<ReportColumn>,
    /// Rows, of as many cells as there are columns.
    pub rows: Vec<Vec<ReportCell>>,
}

impl ReportTable {
    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "<section><h2>{}</h2><p>{}</p>", escaped(&self.title), escaped(&self.note))?;
        writeln!(out, "<div class=\"scroll\"><table class=\"sortable\"><thead><tr>")?;
        for (i, column) in self.columns.iter().enumerate() {
            let class = if self.is_text(i) { " class=\"text\"" } else { "" };
            let band = column.of_band.map(|name| format!(" data-of=\"{name}\"")).unwrap_or_default();
            write!(out, "<th scope=\"col\"{class}{band}>{}</th>", escaped(&column.title))?;
        }
        writeln!(out, "</tr></thead><tbody>")?;
        for (number, row) in self.rows.iter().take(MOST_ROWS).enumerate() {
            write!(out, "<tr data-row=\"{number}\">")?;
            row.iter().try_for_each(|cell| write_cell(cell, out))?;
            writeln!(out, "</tr>")?;
        }
        writeln!(out, "</tbody></table></div>")?;
        if let Some(left @ 1..) = self.rows.len().checked_sub(MOST_ROWS) {
            let left = words::count(left as u64, "further row is", "further rows are");
            writeln!(out, "<p class=\"hint\">{left} in the table of the result folder only.</p>")?;
        }
        writeln!(out, "</section>")
    }

    fn is_text(&self, column: usize) -> bool {
        self.rows.first().is_some_and(|row| matches!(row.get(column), Some(ReportCell::Text(_))))
    }
}

fn write_cell(cell: &ReportCell, out: &mut dyn Write) -> io::Result<()> {
    match cell {
        ReportCell::Text(text) => write!(out, "<td class=\"text\">{}</td>", escaped(text)),
        ReportCell::Number(Some(value)) if value.is_finite() => {
            write!(out, "<td data-value=\"{}\">{}</td>", Number(*value), words::number(*value))
        }
        ReportCell::Number(_) => write!(out, "<td data-value=\"\">–</td>"),
    }
}
