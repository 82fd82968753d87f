//! A polar plot: angle counter-clockwise from the right, or clockwise from the top, radius by level
//! or by value.

use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::element::{PathElement, Text};
use plotters::prelude::{Color, DrawingArea, DrawingBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Point;
use super::figure::{Drawn, Line, draw_line};
use super::scale::{Scale, round_step};
use super::theme::{GRID_COLOUR, INK, MUTED_INK, SMALL_TEXT_SIZE, TEXT_SIZE, text};

/// Levels so far below the rim and more stand at the centre, dB.
const DECIBELS_TO_CENTRE: f64 = 40.0;
/// Distance of the rings of levels, dB.
const RING_DISTANCE: f64 = 10.0;
/// Half the side of what is drawn where the rim has radius 1.
const HALF_SIDE: f64 = 1.2;
/// What the heading takes, with the room that parts it from what is above, pixels.
const HEADING_HEIGHT: i32 = 40;

/// Curves over an angle.
#[derive(Clone, Debug)]
pub(crate) struct Polar {
    /// Quantity and unit.
    pub(crate) label: String,
    /// Whether the values are levels in dB rather than from 0 upwards.
    pub(crate) decibels: bool,
    /// Whether angles run clockwise from the top rather than counter-clockwise from the right.
    pub(crate) from_top: bool,
    /// Angles in degrees, and values.
    pub(crate) lines: Vec<Line>,
}

impl Polar {
    /// Height of the part of a figure, pixels.
    pub(super) const HEIGHT: i32 = 552;

    /// The rings, from the centre to the rim.
    fn rings(&self) -> Vec<f64> {
        let values = self.lines.iter().flat_map(|line| &line.points).map(|point| point.1);
        let top = values.filter(|value| value.is_finite()).fold(f64::NEG_INFINITY, f64::max);
        if self.decibels {
            let rim = if top.is_finite() { (top / RING_DISTANCE).ceil() * RING_DISTANCE } else { 0.0 };
            return (0..=(DECIBELS_TO_CENTRE / RING_DISTANCE) as i32)
                .map(|i| rim - DECIBELS_TO_CENTRE + RING_DISTANCE * f64::from(i))
                .collect();
        }
        let top = if top > 0.0 { top } else { 1.0 };
        let step = round_step(top, 5.0);
        (0..=(top / step - 1e-9).ceil() as i32).map(|i| step * f64::from(i)).collect()
    }

    /// Where an angle and a share of the radius stand.
    fn place(&self, degrees: f64, share: f64) -> Point {
        let (sin, cos) = degrees.to_radians().sin_cos();
        if self.from_top { (share * sin, share * cos) } else { (share * cos, share * sin) }
    }

    pub(super) fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, unit: i32) -> Drawn<DB> {
        let heading = text(TEXT_SIZE, unit, INK).pos(Pos::new(HPos::Center, VPos::Top));
        let (width, height) = area.dim_in_pixel();
        let centre = i32::try_from(width / 2).unwrap_or(0);
        area.draw(&Text::new(self.label.as_str(), (centre, 18 * unit), heading))?;
        let below = area.split_vertically(HEADING_HEIGHT * unit).1;
        let side = height.saturating_sub((HEADING_HEIGHT * unit).unsigned_abs());
        let margin = width.saturating_sub(side) / 2;
        let scale = Scale::linear(-HALF_SIDE, HALF_SIDE);
        let mut chart = ChartBuilder::on(&below)
            .margin_left(margin)
            .margin_right(margin)
            .build_cartesian_2d(scale.clone(), scale)?;
        let rings = self.rings();
        let (centre, rim) = (rings[0], rings[rings.len() - 1]);
        let share = |value: f64| ((value - centre) / (rim - centre)).clamp(0.0, 1.0);
        let place = |degrees: f64, share: f64| self.place(degrees, share);
        let thin = GRID_COLOUR.stroke_width((unit / 2).max(1).unsigned_abs());
        for spoke in 0..12 {
            let degrees = 30.0 * f64::from(spoke);
            chart.draw_series([PathElement::new([place(degrees, 0.0), place(degrees, 1.0)], thin)])?;
            let style = text(SMALL_TEXT_SIZE, unit, INK).pos(Pos::new(HPos::Center, VPos::Center));
            chart.draw_series([Text::new(format!("{degrees}°"), place(degrees, 1.1), style)])?;
        }
        for &ring in &rings[1..] {
            let circle: Vec<Point> = (0..=120).map(|i| place(3.0 * f64::from(i), share(ring))).collect();
            chart.draw_series([PathElement::new(circle, thin)])?;
        }
        for line in &self.lines {
            let known = line.points.iter().filter(|(angle, value)| angle.is_finite() && !value.is_nan());
            let points: Vec<Point> = known.map(|&(angle, value)| place(angle, share(value))).collect();
            draw_line(&mut chart, line, &points)?;
        }
        for &ring in &rings[1..] {
            let style = text(SMALL_TEXT_SIZE, unit, MUTED_INK).pos(Pos::new(HPos::Left, VPos::Bottom));
            // In a sector that runs from the same spoke whichever way angles are counted.
            let degrees = if self.from_top { 15.0 } else { 75.0 };
            chart.draw_series([Text::new(crate::words::number(ring), place(degrees, share(ring)), style)])?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::Part;
    use super::super::figure::tests::{curves, drawn, texts};
    use super::*;

    fn polar(decibels: bool, values: &[f64]) -> Polar {
        let points = values.iter().enumerate().map(|(i, v)| (90.0 * i as f64, *v)).collect();
        let line = Line::distinct("E <z>", points, 0);
        Polar { label: "|E|, dB(V/m)".to_owned(), decibels, from_top: false, lines: vec![line] }
    }

    #[test]
    fn the_largest_value_is_within_a_ring_of_the_rim() {
        assert_eq!(polar(true, &[-3.0, 12.0]).rings(), [-20.0, -10.0, 0.0, 10.0, 20.0]);
        assert_eq!(polar(false, &[0.5, 1.7]).rings(), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(polar(false, &[0.0]).rings().last(), Some(&1.0));
    }

    #[test]
    fn angles_run_counter_clockwise_from_the_right() {
        let svg = drawn(vec![Part::Polar(polar(false, &[1.0, 1.0, 0.0]))]);
        let line = &curves(&svg)[0];
        let (right, top, centre) = (line[0], line[1], line[2]);
        assert!((right.1 - centre.1).abs() < 2.0 && (top.0 - centre.0).abs() < 2.0);
        assert!(right.0 > centre.0 && top.1 < centre.1);
        assert!(((right.0 - centre.0) / (centre.1 - top.1) - 1.0).abs() < 0.01, "circles are round");
        assert!(texts(&svg).iter().any(|text| text == "E &lt;z&gt;"));
    }

    #[test]
    fn angles_from_an_axis_run_clockwise_from_the_top() {
        let polar = Polar { from_top: true, ..polar(false, &[1.0, 1.0, 0.0]) };
        let svg = drawn(vec![Part::Polar(polar)]);
        let line = &curves(&svg)[0];
        let (top, right, centre) = (line[0], line[1], line[2]);
        assert!((right.1 - centre.1).abs() < 2.0 && (top.0 - centre.0).abs() < 2.0);
        assert!(right.0 > centre.0 && top.1 < centre.1);
    }

    #[test]
    fn a_plot_is_drawn_whatever_the_levels() {
        for level in [f64::NAN, f64::NEG_INFINITY, -3.0, 120.0] {
            let svg = drawn(vec![Part::Polar(polar(true, &[level, -7.0, level]))]);
            assert!(!svg.contains("NaN") && svg.ends_with("</svg>\n"));
        }
    }
}
