//! Curves of a page.

use serde::{Serialize, Serializer};

/// An axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportAxis {
    /// Quantity and unit.
    pub label: String,
    /// Whether it is logarithmic at first.
    pub logarithmic: bool,
}

/// A line. Numbers that are not finite are gaps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportSeries {
    /// What it is called in the legend.
    pub name: String,
    /// A colour of CSS; none for one of the theme.
    pub colour: Option<String>,
    /// Whether it is a level to compare with rather than data.
    pub dashed: bool,
    /// Places across.
    #[serde(serialize_with = "finite")]
    pub x: Vec<f64>,
    /// Heights.
    #[serde(serialize_with = "finite")]
    pub y: Vec<f64>,
}

/// How a plot of levels over an angle is drawn round a circle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportPolar {
    /// Whether angles run clockwise from the top rather than counter-clockwise from the right.
    pub clockwise_from_top: bool,
    /// Decibels of a decade of the values: 10 for powers and areas, 20 for fields.
    pub per_decade: f64,
    /// Quantity and unit of the values themselves.
    pub linear: String,
}

/// A plot with one or more choices of what runs across.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportPlot {
    /// Heading.
    pub title: String,
    /// A sentence on what is seen.
    pub note: String,
    /// What may run across, with the lines over it.
    pub across: Vec<(ReportAxis, Vec<ReportSeries>)>,
    /// What is drawn upwards.
    pub up: ReportAxis,
    /// Whether and how it can be polar too: across are degrees then, and upwards levels.
    pub polar: Option<ReportPolar>,
}

impl ReportPlot {
    /// Whether there are two points to join.
    pub(super) fn is_worth_drawing(&self) -> bool {
        self.across.iter().flat_map(|(_, lines)| lines).any(|line| !line.dashed && line.x.len() > 1)
    }
}

/// A plot as the page reads it.
#[derive(Debug, Serialize)]
pub(super) struct DescribedPlot<'a> {
    id: String,
    x: Vec<&'a ReportAxis>,
    y: &'a ReportAxis,
    series: Vec<&'a [ReportSeries]>,
    polar: Option<&'a ReportPolar>,
}

impl<'a> DescribedPlot<'a> {
    pub(super) fn new(id: String, plot: &'a ReportPlot) -> Self {
        let (x, series) = plot.across.iter().map(|(axis, lines)| (axis, lines.as_slice())).unzip();
        Self { id, x, y: &plot.up, series, polar: plot.polar.as_ref() }
    }
}

fn finite<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
    out.collect_seq(values.iter().map(|value| Some(*value).filter(|value| value.is_finite())))
}
