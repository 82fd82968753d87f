//! `converge.svg`: error of the irradiance against the size h of the elements, both logarithmic, with slopes h, h² and h⁴.
//!
//! The error is that against the limit where a band has an order, and else, dashed, the difference to the finest level. An error of 0 is
//! drawn at 10⁻¹⁷.

use std::io::{self, Write};

use super::record::{BandConvergence, RefinementRecord};
use crate::axis::Decades;
use crate::palette::line_colour;
use crate::svg::{Point, Svg};

/// Error that stands for 0.
const FLOOR: f64 = 1e-17;
/// Orders whose slopes are drawn, with their labels.
const SLOPES: [(f64, &str); 3] = [(1.0, "h"), (2.0, "h²"), (4.0, "h⁴")];
/// Most entries of the legend; of more bands, the first ones are named.
const ENTRIES: usize = 13;
/// Size of the drawing, pixels.
const SIZE: Point = (760.0, 500.0);
/// Upper left corner and size of the panel, pixels.
const CORNER: Point = (86.0, 56.0);
const PANEL: Point = (490.0, 370.0);
/// Left edge of the legend, pixels.
const LEGEND: f64 = 596.0;

/// Both axes.
struct Panel {
    across: Decades,
    up: Decades,
}

impl Panel {
    fn new(record: &RefinementRecord) -> Self {
        let errors = record.bands.iter().flat_map(curve).map(|(_, error)| error.max(FLOOR));
        let sizes = record.levels.iter().map(|level| level.h).filter(|h| *h > 0.0);
        Self { across: Decades::new(sizes), up: Decades::new(errors) }
    }

    fn point(&self, h: f64, error: f64) -> Point {
        let (x, y) = (self.across.place(h), self.up.place(error.max(FLOOR)));
        (CORNER.0 + PANEL.0 * x, CORNER.1 + PANEL.1 * (1.0 - y))
    }
}

/// The levels of a band with the error that is drawn.
fn curve(band: &BandConvergence) -> Vec<(usize, f64)> {
    let errors = band.errors.iter().enumerate().filter_map(|(level, error)| Some((level, (*error)?)));
    if band.order.is_some() {
        return errors.collect();
    }
    // The finest level is the reference itself.
    let coarser = band.differences.len().saturating_sub(1);
    band.differences[..coarser].iter().copied().enumerate().collect()
}

/// Writes the plot of a study.
///
/// # Errors
/// What `out` reports.
pub fn write_refinement_plot(record: &RefinementRecord, out: &mut dyn Write) -> io::Result<()> {
    let panel = Panel::new(record);
    let mut svg = Svg::new(SIZE);
    let title = format!("{}: {}, error of the irradiance", record.scene, record.discretisation);
    svg.text((CORNER.0, 32.0), "font-size=\"16\"", &title);
    draw_frame(&mut svg, &panel);
    draw_slopes(&mut svg, &panel, record);
    let names: Vec<String> = record.bands.iter().map(|band| band.band.clone()).collect();
    for (at, band) in record.bands.iter().enumerate() {
        draw_curve(&mut svg, &panel, record, band, &line_colour(&names, at));
    }
    draw_legend(&mut svg, record, &names);
    out.write_all(svg.finish().as_bytes())
}

fn draw_frame(svg: &mut Svg, panel: &Panel) {
    let (right, bottom) = (CORNER.0 + PANEL.0, CORNER.1 + PANEL.1);
    for (place, label) in panel.up.ticks() {
        let y = bottom - PANEL.1 * place;
        svg.line((CORNER.0, y), (right, y), "stroke=\"#e4e4e4\"");
        svg.text((CORNER.0 - 8.0, y + 4.5), "text-anchor=\"end\"", &label);
    }
    for (place, label) in panel.across.ticks() {
        let x = CORNER.0 + PANEL.0 * place;
        svg.line((x, CORNER.1), (x, bottom), "stroke=\"#e4e4e4\"");
        svg.text((x, bottom + 20.0), "text-anchor=\"middle\"", &label);
    }
    svg.frame(CORNER, PANEL);
    svg.text((CORNER.0 + 0.5 * PANEL.0, bottom + 44.0), "text-anchor=\"middle\"", "largest element h, m");
    svg.upright(
        (CORNER.0 - 54.0, CORNER.1 + 0.5 * PANEL.1),
        "relative error of the irradiance (L2 over the faces)",
    );
}

/// Lines of slope 1, 2 and 4 from the finest error of the first band that has one, as far up as there are errors.
fn draw_slopes(svg: &mut Svg, panel: &Panel, record: &RefinementRecord) {
    let drawn = || record.bands.iter().flat_map(curve).filter(|(_, error)| *error > FLOOR);
    let finest = record.bands.iter().find_map(|band| curve(band).last().copied());
    let Some((level, error)) = finest.filter(|(_, error)| *error > FLOOR) else { return };
    let (end, most) = (record.levels[level].h, drawn().map(|(_, error)| error).fold(error, f64::max));
    for (order, label) in SLOPES {
        let reach = (end * (most / error).powf(1.0 / order)).min(record.levels[0].h);
        let from = panel.point(reach, error * (reach / end).powf(order));
        svg.line(from, panel.point(end, error), "stroke=\"#999999\" stroke-dasharray=\"5 4\"");
        svg.text((from.0 + 5.0, from.1 - 5.0), "font-size=\"12\" fill=\"#777777\"", label);
    }
}

fn draw_curve(svg: &mut Svg, panel: &Panel, record: &RefinementRecord, band: &BandConvergence, colour: &str) {
    let place = |(level, error): (usize, f64)| panel.point(record.levels[level].h, error);
    let points: Vec<Point> = curve(band).into_iter().map(place).collect();
    if band.order.is_some() {
        svg.polyline(&points, colour);
    } else {
        for pair in points.windows(2) {
            let style = format!("stroke=\"{colour}\" stroke-width=\"1.8\" stroke-dasharray=\"2 3\"");
            svg.line(pair[0], pair[1], &style);
        }
    }
    for point in points {
        svg.dot(point, colour);
    }
}

fn draw_legend(svg: &mut Svg, record: &RefinementRecord, names: &[String]) {
    let row = |entry: usize| CORNER.1 + 14.0 + 26.0 * entry as f64;
    for (entry, band) in record.bands.iter().take(ENTRIES).enumerate() {
        let style = format!("stroke=\"{}\" stroke-width=\"2.5\"", line_colour(names, entry));
        svg.line((LEGEND, row(entry)), (LEGEND + 22.0, row(entry)), &style);
        let order = band.order.map_or_else(String::new, |order| format!(", order {order:.2}"));
        let name: String = band.band.chars().take(9).collect();
        svg.text((LEGEND + 30.0, row(entry) + 4.5), "", &format!("{name}{order}"));
    }
    if names.len() > ENTRIES {
        svg.text((LEGEND, row(ENTRIES) + 4.5), "", &format!("{} bands", names.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::xml::tests::{attribute, tags};

    fn svg(record: &RefinementRecord) -> String {
        let mut out = Vec::new();
        write_refinement_plot(record, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn the_slope_of_order_2_lies_on_the_curve() {
        let mut record = sample();
        record.bands.truncate(1);
        let text = svg(&record);
        let found = tags(&text);
        let (_, line) = found.iter().find(|(name, _)| name == "polyline").unwrap();
        let points = attribute(line, "points");
        let ends = [points.split(' ').next().unwrap(), points.split(' ').next_back().unwrap()];
        let slope = |(_, tag): &&(String, String)| {
            let at = |key| attribute(tag, key).to_owned();
            ends == [format!("{},{}", at("x1"), at("y1")), format!("{},{}", at("x2"), at("y2"))]
                .each_ref()
                .map(String::as_str)
        };
        let lines = || found.iter().filter(|(name, tag)| name == "line" && tag.contains("5 4"));
        assert_eq!((lines().count(), lines().filter(slope).count()), (3, 1));
    }

    #[test]
    fn nothing_to_show_still_makes_a_plot() {
        for record in [RefinementRecord::default(), sample()] {
            let text = svg(&record);
            assert!(text.contains("</svg>") && !text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}
