//! A polar plot in decibels: angle counter-clockwise from the right, radius by level over 40 dB below the largest.

use std::io::{self, Write};

use crate::palette::line_colour;
use crate::svg::{Point, Svg};

/// Size of the drawing, pixels.
const SIZE: Point = (760.0, 640.0);
/// Centre of the plot, pixels.
const CENTRE: Point = (320.0, 340.0);
/// Radius of the plot, pixels.
const RADIUS: f64 = 260.0;
/// Level at the centre below that of the rim, dB.
const SPAN: f64 = 40.0;
/// Distance of the rings, dB.
const RING: f64 = 10.0;

/// Writes lines of (angle in degrees, level in dB) with their names. Levels that are not finite are drawn at the centre.
///
/// # Errors
/// What `out` reports.
pub fn write_polar_plot(
    title: &str,
    unit: &str,
    lines: &[(String, Vec<(f64, f64)>)],
    out: &mut dyn Write,
) -> io::Result<()> {
    let levels = lines.iter().flat_map(|(_, points)| points).map(|(_, level)| *level);
    let top = levels.filter(|level| level.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    let top = if top.is_finite() { (top / RING).ceil() * RING } else { 0.0 };
    let mut svg = Svg::new(SIZE);
    svg.text((30.0, 34.0), "font-size=\"16\"", title);
    grid(&mut svg, top, unit);
    let names: Vec<String> = lines.iter().map(|(name, _)| name.clone()).collect();
    for (i, (name, points)) in lines.iter().enumerate() {
        let colour = line_colour(&names, i);
        let drawn: Vec<Point> = points.iter().map(|&(angle, level)| place(angle, level - top)).collect();
        svg.polyline(&drawn, &colour);
        let y = 80.0 + 22.0 * i as f64;
        svg.line((620.0, y), (644.0, y), &format!("stroke=\"{colour}\" stroke-width=\"2\""));
        svg.text((650.0, y + 4.5), "font-size=\"12\"", name);
    }
    out.write_all(svg.finish().as_bytes())
}

/// Where an angle and a level relative to the rim stand.
fn place(degrees: f64, below: f64) -> Point {
    let radius = if below.is_finite() { RADIUS * (1.0 + below / SPAN).clamp(0.0, 1.0) } else { 0.0 };
    let (sin, cos) = degrees.to_radians().sin_cos();
    (CENTRE.0 + radius * cos, CENTRE.1 - radius * sin)
}

fn grid(svg: &mut Svg, top: f64, unit: &str) {
    let rings = (SPAN / RING) as i32;
    for ring in 1..=rings {
        let below = -SPAN + RING * f64::from(ring);
        let circle: Vec<Point> = (0..=120).map(|i| place(3.0 * f64::from(i), below)).collect();
        svg.polyline(&circle, "#dddddd");
        let at = place(80.0, below);
        let label = format!("{} {}", top + below, if ring == rings { unit } else { "" });
        svg.text((at.0 + 3.0, at.1 - 3.0), "font-size=\"11\" fill=\"#777777\"", label.trim());
    }
    for spoke in 0..12 {
        let degrees = 30.0 * f64::from(spoke);
        svg.line(CENTRE, place(degrees, 0.0), "stroke=\"#eeeeee\"");
        let (sin, cos) = degrees.to_radians().sin_cos();
        let at = (CENTRE.0 + (RADIUS + 18.0) * cos, CENTRE.1 - (RADIUS + 18.0) * sin + 4.5);
        svg.text(at, "text-anchor=\"middle\" font-size=\"12\"", &format!("{degrees}°"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xml::tests::tags;

    #[test]
    fn the_largest_level_is_within_a_ring_of_the_rim() {
        let (x, y) = place(90.0, 0.0);
        assert!((x - CENTRE.0).abs() < 1e-9 && (CENTRE.1 - y - RADIUS).abs() < 1e-9);
        assert_eq!(place(10.0, f64::NEG_INFINITY), CENTRE);
        assert_eq!(place(10.0, -100.0), CENTRE);
    }

    #[test]
    fn a_plot_is_well_formed_whatever_the_levels() {
        for level in [f64::NAN, f64::NEG_INFINITY, -3.0, 120.0] {
            let lines = [("E <z>".to_owned(), vec![(0.0, level), (90.0, -7.0), (180.0, level)])];
            let mut out = Vec::new();
            write_polar_plot("a & b", "dB", &lines, &mut out).unwrap();
            let text = String::from_utf8(out).unwrap();
            assert!(tags(&text).iter().filter(|(name, _)| name == "polyline").count() == 5);
            assert!(!text.contains("NaN"), "{text}");
        }
    }
}
