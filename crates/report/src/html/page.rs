//! The page itself: a template whose places are filled.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::escape::json;
use super::model::{Described, ReportModel, write_model};
use super::plot::{DescribedPlot, ReportPlot};
use super::table::ReportTable;
use crate::Picture;
use crate::xml::escaped;

/// Name of the form of what a page carries.
const FORMAT: &str = "fredholm-report-1";
/// The page and the part with the model.
const PAGE: &str = include_str!("../../viewer/page.html");
const MODEL: &str = include_str!("../../viewer/model.html");
/// What makes the page move, as `npm run build` in crates/report/viewer bundles it.
const SCRIPT: &str = include_str!("../../viewer/dist/viewer.js");
const STYLE: &str = include_str!("../../viewer/dist/viewer.css");
const LICENCES: &str = include_str!("../../viewer/dist/LICENSES.txt");

/// What a result amounts to, in a word or two.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportBadge {
    /// The words.
    pub text: String,
    /// Whether all is well.
    pub good: bool,
}

/// A result as people look at it. Texts are plain: whatever stands in them is shown, never carried
/// out.
#[derive(Clone, Default)]
pub struct ReportPage<'a> {
    /// What it is called.
    pub title: String,
    /// What was done, in a line.
    pub lead: String,
    /// What it amounts to.
    pub badges: Vec<ReportBadge>,
    /// Names of the bands.
    pub bands: &'a [String],
    /// What is shown in three dimensions.
    pub model: Option<ReportModel<'a>>,
    /// What is shown where three dimensions cannot be.
    pub picture: Option<&'a Picture>,
    /// What the picture shows, for those who cannot see it; nothing for the scene from its camera.
    pub picture_text: String,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// How far the result can be trusted, in sentences.
    pub statements: Vec<String>,
    /// Curves.
    pub plots: Vec<ReportPlot>,
    /// Tables.
    pub tables: Vec<ReportTable>,
    /// What made it: names and values.
    pub provenance: Vec<(String, String)>,
    /// The complete options.
    pub options: Value,
    /// Version of the program.
    pub version: String,
}

/// What the page carries for its script.
#[derive(Serialize)]
struct Carried<'a> {
    format: &'static str,
    bands: &'a [String],
    /// Largest relative error of a number on an element, and the grain of positions, m.
    rounding: f64,
    grain: f64,
    model: Option<Described>,
    plots: Vec<DescribedPlot<'a>>,
}

impl ReportPage<'_> {
    /// Writes the page: one file that needs no other and no network.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        filled(PAGE, out, &|place, out| match place {
            "hash" => write!(out, "sha256-{}", STANDARD.encode(Sha256::digest(SCRIPT))),
            "generator" => write!(out, "Fredholm {}", escaped(&self.version)),
            "title" => write!(out, "{}", escaped(&self.title)),
            "lead" => write!(out, "{}", escaped(&self.lead)),
            "style" => out.write_all(STYLE.trim().as_bytes()),
            "script" => out.write_all(SCRIPT.as_bytes()),
            "badges" => self.write_badges(out),
            "body" => self.write_body(out),
            "footer" => self.write_footer(out),
            "data" => self.write_data(out),
            _ => Ok(()),
        })
    }

    fn write_badges(&self, out: &mut dyn Write) -> io::Result<()> {
        self.badges.iter().try_for_each(|ReportBadge { text, good }| {
            let class = if *good { "badge" } else { "badge warn" };
            write!(out, "<a class=\"{class}\" href=\"#trust\">{}</a>", escaped(text))
        })
    }

    fn write_body(&self, out: &mut dyn Write) -> io::Result<()> {
        match (&self.model, self.picture) {
            (Some(_), _) => filled(MODEL, out, &|_, out| self.write_picture(out))?,
            (None, Some(_)) => {
                write!(out, "<section class=\"still\">")?;
                self.write_picture(out)?;
                writeln!(out, "</section>")?;
            }
            (None, None) => {}
        }
        self.write_trust(out)?;
        for (i, plot) in self.drawn().enumerate() {
            write!(out, "<section id=\"plot-{i}\" class=\"plot\"><h2>{}</h2>", escaped(&plot.title))?;
            writeln!(out, "<p>{}</p></section>", escaped(&plot.note))?;
        }
        self.tables.iter().try_for_each(|table| table.write(out))?;
        self.write_provenance(out)
    }

    fn drawn(&self) -> impl Iterator<Item = &ReportPlot> {
        self.plots.iter().filter(|plot| plot.is_worth_drawing())
    }

    fn write_picture(&self, out: &mut dyn Write) -> io::Result<()> {
        let Some(picture) = self.picture else { return Ok(()) };
        let text = match self.picture_text.as_str() {
            "" => "The scene from its camera",
            text => text,
        };
        let text = escaped(text);
        write!(out, "<img class=\"picture\" alt=\"{text}\" src=\"data:image/png;base64,")?;
        let mut encoder = EncoderWriter::new(&mut *out, &STANDARD);
        picture.write_png(&mut encoder)?;
        encoder.finish()?;
        drop(encoder);
        writeln!(out, "\">")
    }

    fn write_trust(&self, out: &mut dyn Write) -> io::Result<()> {
        if !self.warnings.is_empty() {
            writeln!(out, "<section class=\"warnings\"><h2>Warnings</h2>")?;
            write_list(&self.warnings, out)?;
            writeln!(out, "</section>")?;
        }
        if self.statements.is_empty() {
            return Ok(());
        }
        writeln!(out, "<section id=\"trust\"><h2>How far to trust it</h2>")?;
        write_list(&self.statements, out)?;
        writeln!(out, "</section>")
    }

    fn write_provenance(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "<section><h2>What made it</h2><dl>")?;
        for (name, value) in &self.provenance {
            writeln!(out, "<dt>{}</dt><dd>{}</dd>", escaped(name), escaped(value))?;
        }
        writeln!(out, "</dl>")?;
        if !self.options.is_null() {
            let options = serde_json::to_string_pretty(&self.options)?;
            writeln!(out, "<details><summary>All options</summary><pre>{}</pre></details>", lines(&options))?;
        }
        writeln!(out, "</section>")
    }

    fn write_footer(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "Written by Fredholm {}. The page needs no network.", escaped(&self.version))?;
        let licences = lines(LICENCES);
        write!(
            out,
            "<details><summary>Licences of what draws the page</summary><pre>{licences}</pre></details>"
        )
    }

    fn write_data(&self, out: &mut dyn Write) -> io::Result<()> {
        let model = self.model.as_ref().map(|model| write_model(model, out)).transpose()?;
        let (rounding, grain) = model.as_ref().map_or((0.0, 0.0), |model| (model.error(), model.grain()));
        let described = |(i, plot)| DescribedPlot::new(format!("plot-{i}"), plot);
        let plots = self.drawn().enumerate().map(described).collect();
        let carried = Carried { format: FORMAT, bands: self.bands, rounding, grain, model, plots };
        write!(out, "<script type=\"application/json\" id=\"page\">{}</script>", json(&carried)?)
    }
}

/// A text of several lines.
fn lines(text: &str) -> String {
    text.lines().map(escaped).collect::<Vec<_>>().join("\n")
}

fn write_list(sentences: &[String], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "<ul class=\"statements\">")?;
    sentences.iter().try_for_each(|sentence| writeln!(out, "<li>{}</li>", escaped(sentence)))?;
    writeln!(out, "</ul>")
}

/// Writes a template with its places, `{{name}}`, filled.
fn filled(
    template: &str,
    out: &mut dyn Write,
    fill: &dyn Fn(&str, &mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        out.write_all(before.as_bytes())?;
        let (place, next) = after.split_once("}}").unwrap_or((after, ""));
        fill(place, out)?;
        rest = next;
    }
    out.write_all(rest.as_bytes())
}
