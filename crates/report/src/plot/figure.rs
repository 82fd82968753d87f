//! Curves and bars over axes, one panel below the other, with a legend below them all.

use std::collections::BTreeSet;
use std::io::{self, Write};

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{BoldPoints, Ranged, ValueFormatter};
use plotters::element::{Circle, Cross, EmptyElement, PathElement, Rectangle, Text, TriangleMarker};
use plotters::prelude::{Color, DrawingArea, DrawingBackend, IntoDrawingArea, RGBColor, SVGBackend};
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::ShapeStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::scale::{Scale, Span};
use super::theme::{
    GRID_COLOUR, GROUND, INK, MARGIN, MUTED_INK, SMALL_TEXT_SIZE, TEXT_SIZE, TITLE_ROW, TITLE_SIZE, WIDTH,
    dark_style, load_font, text,
};
use super::{Point, Polar};

/// Steps of a pixel in an SVG: the library rounds to whole ones.
const STEPS_OF_A_PIXEL: i32 = 10;
/// Height of a row of the legend, pixels.
const LEGEND_ROW: i32 = TITLE_ROW;
/// Height of a panel with its labels, pixels.
const PANEL_HEIGHT: i32 = 340;
/// Room for the labels below a panel, and at least beside it, pixels; and that for the name of an
/// axis beside its numbers.
const ROOM_BELOW: i32 = 58;
const ROOM_BESIDE: i32 = 84;
const ROOM_OF_A_NAME: i32 = 38;
/// Numbers along the side of a panel, about.
const NUMBERS_BESIDE: usize = 8;
/// Width of a line in the legend, pixels.
const SWATCH_WIDTH: i32 = 28;
/// Most points of a line; longer ones are thinned evenly.
const MOST_POINTS: usize = 600;
/// Most points of a line that are marked one by one; of more, so many are marked.
const MOST_MARKED_POINTS: usize = 12;
/// Most entries of the legend; of more, evenly spaced ones are named.
const MOST_ENTRIES: usize = 40;
const NAMED_ENTRIES: usize = 12;

/// Quantity, unit and kind of an axis.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) label: String,
    pub(crate) span: Span,
}

impl Axis {
    pub(crate) fn new(label: &str, span: Span) -> Self {
        Self { label: label.to_owned(), span }
    }
}

/// A curve.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) name: String,
    /// What is not finite is left out.
    pub(crate) points: Vec<Point>,
    pub(crate) colour: RGBColor,
    /// The shape of its marks.
    pub(crate) shape: usize,
    /// Whether its points are joined.
    pub(crate) joined: bool,
    /// Whether it is dashed.
    pub(crate) dashed: bool,
}

impl Line {
    pub(crate) fn new(name: &str, points: Vec<Point>, colour: RGBColor) -> Self {
        Self { name: name.to_owned(), points, colour, shape: 0, joined: true, dashed: false }
    }

    /// One of many lines without an order.
    pub(crate) fn distinct(name: &str, points: Vec<Point>, number: usize) -> Self {
        let (colour, shape) = super::distinct(number);
        Self { shape, ..Self::new(name, points, colour) }
    }

    /// A line to compare with.
    pub(crate) fn level(name: &str, points: Vec<Point>) -> Self {
        Self { dashed: true, ..Self::new(name, points, MUTED_INK) }
    }

    /// The finite points as near as the axes have them: at most [`MOST_POINTS`] and the last.
    fn drawn(&self, across: &Scale, up: &Scale) -> Vec<Point> {
        let finite = self.points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
        let all: Vec<Point> = finite.map(|&(x, y)| (across.clamped(x), up.clamped(y))).collect();
        let stride = all.len().div_ceil(MOST_POINTS).max(1);
        let last = all.len().saturating_sub(1);
        all.into_iter().enumerate().filter(|(i, _)| i % stride == 0 || *i == last).map(|(_, p)| p).collect()
    }
}

/// A bar from 0 up to a height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bar {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) height: f64,
}

/// Curves and bars over a pair of axes.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    pub(crate) across: Axis,
    pub(crate) up: Axis,
    pub(crate) lines: Vec<Line>,
    pub(crate) bars: Vec<Bar>,
    /// Values further below the largest than this are at the lower edge.
    pub(crate) reach: f64,
}

impl Panel {
    pub(crate) fn new(across: Axis, up: Axis, lines: Vec<Line>) -> Self {
        Self { across, up, lines, bars: Vec::new(), reach: f64::INFINITY }
    }

    fn scales(&self) -> (Scale, Scale) {
        let points = || {
            let points = self.lines.iter().flat_map(|line| line.points.iter().copied());
            points.filter(|(x, y)| x.is_finite() && y.is_finite())
        };
        let bars = self.bars.iter();
        let across = points().map(|p| p.0).chain(bars.clone().flat_map(|bar| [bar.from, bar.to]));
        let top = points().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
        let up = points().map(|p| p.1.max(top - self.reach)).chain(bars.map(|bar| bar.height));
        let room = if self.up.span == Span::Tight { 0.05 } else { 0.0 };
        (Scale::holding(across, self.across.span), Scale::holding(up, self.up.span).widened(room))
    }
}

/// One of the parts of a figure, from the top.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    Panel(Panel),
    Polar(Polar),
}

impl Part {
    fn lines(&self) -> &[Line] {
        match self {
            Self::Panel(panel) => &panel.lines,
            Self::Polar(polar) => &polar.lines,
        }
    }

    fn height(&self) -> i32 {
        match self {
            Self::Panel(_) => PANEL_HEIGHT,
            Self::Polar(_) => Polar::HEIGHT,
        }
    }
}

/// A drawing.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    pub(crate) title: String,
    pub(crate) parts: Vec<Part>,
}

/// Writes a figure as SVG.
///
/// # Errors
/// What `out` reports.
pub(crate) fn write_svg(figure: &Figure, out: &mut dyn Write) -> io::Result<()> {
    load_font()?;
    let (title, legend) = (wrapped(&figure.title, WIDTH - 2 * MARGIN)?, Legend::new(figure)?);
    let top = MARGIN + TITLE_ROW * title.len() as i32 + 6;
    let beside = room_beside(figure)?;
    let parts: i32 = figure.parts.iter().map(Part::height).sum();
    let height = top + parts + LEGEND_ROW * legend.rows + MARGIN;
    let mut text = String::new();
    {
        let size = ((WIDTH * STEPS_OF_A_PIXEL).unsigned_abs(), (height * STEPS_OF_A_PIXEL).unsigned_abs());
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        draw(&root, figure, (&title, &legend), (top, beside)).map_err(failed)?;
        root.present().map_err(failed)?;
    }
    // Sizes in pixels, and the dark colours.
    let head = text.find('>').map_or(0, |at| at + 1);
    let (wide, tall) = (WIDTH * STEPS_OF_A_PIXEL, height * STEPS_OF_A_PIXEL);
    write!(
        out,
        "<svg width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {wide} {tall}\" \
        xmlns=\"http://www.w3.org/2000/svg\">\n{}",
        dark_style()
    )?;
    out.write_all(&text.as_bytes()[head..])
}

/// What the library reports as an error of writing.
pub(super) fn failed<E: std::error::Error>(error: E) -> io::Error {
    io::Error::other(error.to_string())
}

/// What a place in a drawing area reports.
pub(super) type Drawn<DB> =
    Result<(), plotters::drawing::DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn draw<DB: DrawingBackend>(
    root: &DrawingArea<DB, Shift>,
    figure: &Figure,
    (title, legend): (&[String], &Legend),
    (top, beside): (i32, i32),
) -> Drawn<DB> {
    root.fill(&GROUND)?;
    draw_title(root, title, STEPS_OF_A_PIXEL)?;
    let mut left = root.split_vertically(top * STEPS_OF_A_PIXEL).1;
    for part in &figure.parts {
        let (here, below) = left.split_vertically(part.height() * STEPS_OF_A_PIXEL);
        left = below;
        match part {
            Part::Panel(panel) => draw_panel(&here, panel, beside)?,
            Part::Polar(polar) => polar.draw(&here, STEPS_OF_A_PIXEL)?,
        }
    }
    legend.draw(&left)
}

/// Draws the lines of a title.
pub(super) fn draw_title<DB: DrawingBackend>(
    root: &DrawingArea<DB, Shift>,
    lines: &[String],
    unit: i32,
) -> Drawn<DB> {
    for (number, line) in (0..).zip(lines) {
        let style = text(TITLE_SIZE, unit, INK);
        root.draw(&Text::new(line.as_str(), (MARGIN * unit, (MARGIN + TITLE_ROW * number) * unit), style))?;
    }
    Ok(())
}

/// Room beside the panels of a figure for their widest numbers, pixels.
fn room_beside(figure: &Figure) -> io::Result<i32> {
    let mut room = ROOM_BESIDE;
    for part in &figure.parts {
        let Part::Panel(panel) = part else { continue };
        let (_, up) = panel.scales();
        for value in up.key_points(BoldPoints(NUMBERS_BESIDE)) {
            room = room.max(MARGIN + ROOM_OF_A_NAME + width_of(&up.format_ext(&value), SMALL_TEXT_SIZE)?);
        }
    }
    Ok(room)
}

fn draw_panel<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, panel: &Panel, beside: i32) -> Drawn<DB> {
    let (across, up) = panel.scales();
    let mut chart = ChartBuilder::on(area)
        .margin_top(8 * STEPS_OF_A_PIXEL)
        .margin_left(MARGIN * STEPS_OF_A_PIXEL)
        .margin_right(2 * MARGIN * STEPS_OF_A_PIXEL)
        .x_label_area_size(ROOM_BELOW * STEPS_OF_A_PIXEL)
        .y_label_area_size((beside - MARGIN) * STEPS_OF_A_PIXEL)
        .build_cartesian_2d(across.clone(), up.clone())?;
    draw_axes(&mut chart, (&panel.across.label, &panel.up.label), STEPS_OF_A_PIXEL)?;
    let fill = super::distinct(0).0;
    for bar in &panel.bars {
        let inset = 0.07 * (bar.to - bar.from);
        let corners = [(bar.from + inset, 0.0), (bar.to - inset, bar.height)];
        chart.draw_series([Rectangle::new(corners, fill.filled())])?;
    }
    for line in &panel.lines {
        draw_line(&mut chart, line, &line.drawn(&across, &up))?;
    }
    Ok(())
}

type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<Scale, Scale>>;

/// Draws axes with their labels, and a grid.
pub(super) fn draw_axes<DB: DrawingBackend>(
    chart: &mut Chart<'_, DB>,
    (across, up): (&str, &str),
    unit: i32,
) -> Drawn<DB> {
    let width = (unit / 2).max(1).unsigned_abs();
    chart
        .configure_mesh()
        .x_desc(across)
        .y_desc(up)
        .x_labels(7)
        .y_labels(NUMBERS_BESIDE)
        .max_light_lines(0)
        .set_all_tick_mark_size(5 * unit)
        .bold_line_style(GRID_COLOUR.stroke_width(width))
        .light_line_style(plotters::style::TRANSPARENT)
        .axis_style(MUTED_INK.stroke_width(width))
        .label_style(text(SMALL_TEXT_SIZE, unit, INK))
        .axis_desc_style(text(TEXT_SIZE, unit, INK))
        .draw()
}

/// Draws a curve through points, marked where they are few or its shape tells it from others.
pub(super) fn draw_line<DB: DrawingBackend>(
    chart: &mut Chart<'_, DB>,
    line: &Line,
    points: &[Point],
) -> Drawn<DB> {
    let stroke = line.colour.stroke_width(2 * STEPS_OF_A_PIXEL.unsigned_abs() - 2);
    if line.joined && points.len() > 1 {
        if line.dashed {
            chart.draw_series(DashedLineSeries::new(
                points.iter().copied(),
                6 * STEPS_OF_A_PIXEL,
                5 * STEPS_OF_A_PIXEL,
                stroke,
            ))?;
        } else {
            chart.draw_series(LineSeries::new(points.iter().copied(), stroke))?;
        }
    }
    let every = points.len().div_ceil(MOST_MARKED_POINTS).max(1);
    let marked = !line.dashed && (!line.joined || points.len() <= MOST_MARKED_POINTS || line.shape > 0);
    let every = if line.joined { every } else { 1 };
    for &at in points.iter().step_by(every).filter(|_| marked) {
        mark(chart, at, line)?;
    }
    Ok(())
}

fn mark<DB: DrawingBackend>(chart: &mut Chart<'_, DB>, at: Point, line: &Line) -> Drawn<DB> {
    let (size, style) = (35 * STEPS_OF_A_PIXEL / 10, line.colour.filled());
    match line.shape {
        0 => chart.draw_series([Circle::new(at, size, style)])?,
        1 => chart.draw_series([TriangleMarker::new(at, 5 * STEPS_OF_A_PIXEL, style)])?,
        2 => chart.draw_series([Cross::new(at, 4 * STEPS_OF_A_PIXEL, crossed(line.colour))])?,
        _ => {
            let square = Rectangle::new([(-size, -size), (size, size)], style);
            chart.draw_series([EmptyElement::at(at) + square])?
        }
    };
    Ok(())
}

fn crossed(colour: RGBColor) -> ShapeStyle {
    colour.stroke_width(2 * STEPS_OF_A_PIXEL.unsigned_abs())
}

/// What the lines are called, below all of them.
struct Legend {
    entries: Vec<(Line, Point)>,
    rows: i32,
}

impl Legend {
    fn new(figure: &Figure) -> io::Result<Self> {
        let mut seen = BTreeSet::new();
        let all = figure.parts.iter().flat_map(Part::lines);
        let mut named: Vec<Line> = all
            .filter(|line| !line.name.is_empty() && seen.insert(line.name.clone()))
            .map(|line| Line { points: Vec::new(), ..line.clone() })
            .collect();
        if named.len() > MOST_ENTRIES {
            // What is compared with keeps its name.
            let (levels, lines): (Vec<Line>, Vec<Line>) = named.into_iter().partition(|line| line.dashed);
            let (count, last, named_of) = (lines.len(), lines.len().saturating_sub(1), lines);
            named = (0..NAMED_ENTRIES)
                .filter_map(|i| named_of.get(i * last / (NAMED_ENTRIES - 1)).cloned())
                .collect();
            let rest = format!("and so on: {count} lines");
            named.push(Line { joined: false, ..Line::level(&rest, Vec::new()) });
            named.extend(levels);
        }
        let (mut x, mut rows, mut entries) = (MARGIN, 0, Vec::new());
        for line in named {
            let wide = SWATCH_WIDTH + 8 + width_of(&line.name, SMALL_TEXT_SIZE)? + 22;
            if rows == 0 || x + wide > WIDTH {
                (x, rows) = (MARGIN, rows + 1);
            }
            entries.push((line, (f64::from(x), f64::from(rows - 1))));
            x += wide;
        }
        Ok(Self { entries, rows })
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        for (line, (x, row)) in &self.entries {
            let (x, y) = (
                *x as i32 * STEPS_OF_A_PIXEL,
                (*row as i32 * LEGEND_ROW + LEGEND_ROW / 2) * STEPS_OF_A_PIXEL,
            );
            let (end, stroke) = (
                x + SWATCH_WIDTH * STEPS_OF_A_PIXEL,
                line.colour.stroke_width(25 * STEPS_OF_A_PIXEL.unsigned_abs() / 10),
            );
            let middle = (x + SWATCH_WIDTH * STEPS_OF_A_PIXEL / 2, y);
            if line.dashed && line.joined {
                for part in [0, 11, 22] {
                    let from = x + part * STEPS_OF_A_PIXEL;
                    area.draw(&PathElement::new(
                        [(from, y), ((from + 6 * STEPS_OF_A_PIXEL).min(end), y)],
                        stroke,
                    ))?;
                }
            } else if line.joined {
                area.draw(&PathElement::new([(x, y), (end, y)], stroke))?;
            }
            let (size, style) = (35 * STEPS_OF_A_PIXEL / 10, line.colour.filled());
            let (mx, my) = middle;
            match line.shape {
                _ if line.dashed => {}
                0 if line.joined => {}
                0 => area.draw(&Circle::new(middle, size, style))?,
                1 => area.draw(&TriangleMarker::new(middle, 5 * STEPS_OF_A_PIXEL, style))?,
                2 => area.draw(&Cross::new(middle, 4 * STEPS_OF_A_PIXEL, crossed(line.colour)))?,
                _ => area.draw(&Rectangle::new([(mx - size, my - size), (mx + size, my + size)], style))?,
            }
            let style = text(SMALL_TEXT_SIZE, STEPS_OF_A_PIXEL, INK).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(line.name.as_str(), (end + 8 * STEPS_OF_A_PIXEL, y), style))?;
        }
        Ok(())
    }
}

/// Width of a text, pixels.
pub(super) fn width_of(words: &str, size: i32) -> io::Result<i32> {
    let (wide, _) = text(size, STEPS_OF_A_PIXEL, INK).font.box_size(words).map_err(failed)?;
    Ok(i32::try_from(wide).unwrap_or(i32::MAX) / STEPS_OF_A_PIXEL)
}

/// A title in lines that fit `room` pixels; of a word that is longer than a line the end is kept.
pub(super) fn wrapped(title: &str, room: i32) -> io::Result<Vec<String>> {
    let mut lines: Vec<String> = Vec::new();
    for word in title.split_whitespace() {
        let mut word = word.to_owned();
        while width_of(&word, TITLE_SIZE)? > room {
            word = std::iter::once('…')
                .chain(word.chars().skip(if word.starts_with('…') { 2 } else { 4 }))
                .collect();
        }
        match lines.last_mut() {
            Some(line) if width_of(&format!("{line} {word}"), TITLE_SIZE)? <= room => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    Ok(lines)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::xml::tests::{attribute, tags};

    /// The texts of a drawing.
    pub(crate) fn texts(svg: &str) -> Vec<String> {
        let parts = svg.split("<text ").skip(1);
        parts.map(|part| part.split_once(">\n").unwrap().1.split('\n').next().unwrap().to_owned()).collect()
    }

    /// The curves: what is as wide as they are, and none to compare with.
    pub(crate) fn curves(svg: &str) -> Vec<Vec<Point>> {
        let RGBColor(r, g, b) = MUTED_INK;
        let level = format!("#{r:02X}{g:02X}{b:02X}");
        let own = |tag: &str| attribute(tag, "stroke-width") == "18" && attribute(tag, "stroke") != level;
        let lines = tags(svg).into_iter().filter(|(name, tag)| name == "polyline" && own(tag));
        let place = |pair: &str| {
            let (x, y) = pair.split_once(',').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        };
        lines.map(|(_, tag)| attribute(&tag, "points").split_whitespace().map(place).collect()).collect()
    }

    /// The heights of the bars.
    pub(crate) fn bars(svg: &str) -> Vec<f64> {
        let RGBColor(r, g, b) = crate::plot::distinct(0).0;
        let colour = format!("#{r:02X}{g:02X}{b:02X}");
        let own = tags(svg).into_iter().filter(|(name, _)| name == "rect");
        let own = own.filter(|(_, tag)| attribute(tag, "fill") == colour);
        own.map(|(_, tag)| attribute(&tag, "height").parse().unwrap()).collect()
    }

    pub(crate) fn drawn(parts: Vec<Part>) -> String {
        let mut out = Vec::new();
        write_svg(&Figure { title: "a < b".to_owned(), parts }, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    fn panel(span: Span, points: Vec<Point>) -> String {
        let colour = RGBColor(1, 2, 3);
        let axes = (Axis::new("x, m", Span::WithZero), Axis::new("y, W", span));
        drawn(vec![Part::Panel(Panel::new(axes.0, axes.1, vec![Line::new("one", points, colour)]))])
    }

    #[test]
    fn the_slope_is_constant_on_a_logarithmic_axis() {
        let svg = panel(Span::Decades, (0..11).map(|i| (f64::from(i), 10.0_f64.powi(-i))).collect());
        let line = &curves(&svg)[0];
        let step = |i: usize| (line[i].0 - line[i - 1].0, line[i].1 - line[i - 1].1);
        assert!(
            (1..11).all(|i| (step(i).0 - step(1).0).abs() <= 1.0 && (step(i).1 - step(1).1).abs() <= 1.0)
        );
        assert!(step(1).0 > 0.0 && step(1).1 > 0.0);
        let texts = texts(&svg);
        for label in ["a &lt; b", "x, m", "y, W", "one", "10⁻⁸"] {
            assert!(texts.iter().any(|text| text == label), "{label}: {texts:?}");
        }
    }

    #[test]
    fn odd_values_make_a_plot() {
        for points in [vec![], vec![(1.0, f64::NAN)], vec![(0.0, 0.0)], vec![(1.0, -0.25), (2.0, 0.5)]] {
            for span in [Span::WithZero, Span::Tight, Span::Decades] {
                let svg = panel(span, points.clone());
                assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
            }
        }
        let svg = panel(Span::WithZero, (0..10_000).map(|i| (f64::from(i), 1.0)).collect());
        assert!((MOST_POINTS / 2..2 * MOST_POINTS).contains(&curves(&svg)[0].len()));
    }

    #[test]
    fn titles_and_legends_stay_inside() {
        let title = "scenes/a.toml: 12 unknowns with a reflectance up to 0.99, and something more";
        let lines = wrapped(title, WIDTH - 2 * MARGIN).unwrap();
        assert!(lines.len() > 1 && lines.join(" ") == title);
        let long = wrapped(&"x".repeat(500), WIDTH - 2 * MARGIN).unwrap();
        assert!(long.len() == 1 && long[0].starts_with('…'));
        assert!(width_of(&long[0], TITLE_SIZE).unwrap() <= WIDTH - 2 * MARGIN);
        let line = |i: usize| Line::distinct(&format!("line {i}"), vec![(0.0, 1.0)], i);
        let axis = || Axis::new("x", Span::WithZero);
        let figure = |count| Figure {
            title: String::new(),
            parts: vec![Part::Panel(Panel::new(axis(), axis(), (0..count).map(line).collect()))],
        };
        let legend = Legend::new(&figure(27)).unwrap();
        assert_eq!(legend.entries.len(), 27);
        assert_eq!(Legend::new(&figure(76)).unwrap().entries.len(), NAMED_ENTRIES + 1);
    }
}
