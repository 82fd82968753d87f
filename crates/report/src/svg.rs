//! The few SVG elements that a plot needs. Coordinates in pixels, y downwards.

use std::fmt::{Arguments, Write};

use crate::xml::escaped;

/// A point of the drawing.
pub(crate) type Point = (f64, f64);

/// A drawing under construction.
pub(crate) struct Svg(String);

impl Svg {
    /// A white drawing of the given width and height.
    pub(crate) fn new((width, height): Point) -> Self {
        let mut svg = Self(String::new());
        svg.put(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\" fill=\"#333333\">"
        ));
        svg.put(format_args!("<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"));
        svg
    }

    /// The finished text.
    pub(crate) fn finish(mut self) -> String {
        self.put(format_args!("</svg>"));
        self.0
    }

    /// Appends a line of markup. Writing to a `String` cannot fail.
    fn put(&mut self, markup: Arguments<'_>) {
        let _ = self.0.write_fmt(markup);
        self.0.push('\n');
    }

    /// A line; `style` holds its attributes.
    pub(crate) fn line(&mut self, (x1, y1): Point, (x2, y2): Point, style: &str) {
        self.put(format_args!("<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" {style}/>"));
    }

    /// The border of a rectangle.
    pub(crate) fn frame(&mut self, (x, y): Point, (width, height): Point) {
        self.put(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#888888\"/>"
        ));
    }

    /// A text; `style` holds its attributes.
    pub(crate) fn text(&mut self, (x, y): Point, style: &str, text: &str) {
        self.put(format_args!("<text x=\"{x:.2}\" y=\"{y:.2}\" {style}>{}</text>", escaped(text)));
    }

    /// A text that reads upwards, centred.
    pub(crate) fn upright(&mut self, (x, y): Point, text: &str) {
        let text = escaped(text);
        self.put(format_args!(
            "<text transform=\"translate({x} {y}) rotate(-90)\" text-anchor=\"middle\">{text}</text>"
        ));
    }

    /// A line through points.
    pub(crate) fn polyline(&mut self, points: &[Point], colour: &str) {
        let list: Vec<String> = points.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
        let list = list.join(" ");
        self.put(format_args!(
            "<polyline points=\"{list}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-linejoin=\"round\"/>"
        ));
    }

    /// A dot.
    pub(crate) fn dot(&mut self, (x, y): Point, colour: &str) {
        self.put(format_args!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"2.8\" fill=\"{colour}\"/>"));
    }
}
