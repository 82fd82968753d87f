//! Fields and cross-sections over an angle: `NAME.svg`, with levels over a straight axis, and polar
//! plots of the levels and of the values themselves.

use std::io::{self, Write};

use crate::plot::{Axis, Figure, Line, Panel, Part, Polar, Span, write_svg};

/// Levels further below the largest are at the lower edge, dB.
const DECIBELS_SHOWN: f64 = 80.0;

/// A quantity over an angle.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleQuantity {
    /// What it is called, such as `radar cross-section`.
    pub name: String,
    /// Unit of the levels, such as `dBsm`.
    pub level_unit: String,
    /// Unit of the values, such as `m²`.
    pub unit: String,
    /// The angle, such as `φ`.
    pub angle: String,
    /// Decibels of a decade of the values: 10 for powers and areas, 20 for fields.
    pub per_decade: f64,
}

impl AngleQuantity {
    /// The radar cross-section over an angle.
    #[must_use]
    pub fn cross_section(angle: &str) -> Self {
        Self {
            name: "radar cross-section σ".to_owned(),
            level_unit: "dBsm".to_owned(),
            unit: "m²".to_owned(),
            angle: angle.to_owned(),
            per_decade: 10.0,
        }
    }

    /// The gain of the sources and all that scatters, over an angle.
    #[must_use]
    pub fn gain(angle: &str) -> Self {
        Self {
            name: "gain".to_owned(),
            level_unit: "dBi".to_owned(),
            unit: "1".to_owned(),
            angle: angle.to_owned(),
            per_decade: 10.0,
        }
    }

    /// The amplitude f of a far field E = f e^{−jkr}/r, over an angle.
    #[must_use]
    pub fn amplitude(angle: &str) -> Self {
        Self {
            name: "far-field amplitude |f|".to_owned(),
            level_unit: "dB(V)".to_owned(),
            unit: "V".to_owned(),
            angle: angle.to_owned(),
            per_decade: 20.0,
        }
    }

    /// Whether a polar plot counts the angle clockwise from the top, as θ is from +z, rather than
    /// counter-clockwise from the right, as φ is from +x.
    #[must_use]
    pub fn is_from_top(&self) -> bool {
        self.angle == "θ"
    }

    /// The magnitude of the electric field over an angle.
    #[must_use]
    pub fn field(angle: &str) -> Self {
        Self {
            name: "|E|".to_owned(),
            level_unit: "dB(V/m)".to_owned(),
            unit: "V/m".to_owned(),
            angle: angle.to_owned(),
            per_decade: 20.0,
        }
    }
}

/// Writes lines of (angle in degrees, value) with their names.
///
/// # Errors
/// What `out` reports.
pub fn write_angle_plot(
    title: &str,
    quantity: &AngleQuantity,
    lines: &[(String, Vec<(f64, f64)>)],
    out: &mut dyn Write,
) -> io::Result<()> {
    let AngleQuantity { name, level_unit, unit, angle, per_decade } = quantity;
    let level = |value: f64| per_decade * value.log10();
    let mapped = |of: &dyn Fn(f64) -> f64| -> Vec<Line> {
        let line = |number: usize, (name, points): &(String, Vec<(f64, f64)>)| Line {
            shape: number % 3,
            ..Line::distinct(name, points.iter().map(|&(angle, value)| (angle, of(value))).collect(), number)
        };
        lines.iter().enumerate().map(|(number, named)| line(number, named)).collect()
    };
    let (across, up) = (format!("{angle}, degrees"), format!("{name}, {level_unit}"));
    let straight = Panel {
        reach: DECIBELS_SHOWN,
        ..Panel::new(Axis::new(&across, Span::Tight), Axis::new(&up, Span::Tight), mapped(&level))
    };
    let polar = |label: String, decibels: bool, lines: Vec<Line>| {
        Part::Polar(Polar { label, decibels, from_top: quantity.is_from_top(), lines })
    };
    let parts = vec![
        Part::Panel(straight),
        polar(format!("{up}, over {angle}"), true, mapped(&level)),
        polar(format!("{name}, {unit}, over {angle}"), false, mapped(&|value| value)),
    ];
    write_svg(&Figure { title: title.to_owned(), parts }, out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::{curves, texts};

    #[test]
    fn levels_and_values_are_drawn_over_the_angle() {
        for value in [f64::NAN, 0.0, 1e-9, 3.0] {
            let points = (0..20).map(|i| (f64::from(i), if i == 3 { value } else { 2.0 })).collect();
            let lines = [("E <z>".to_owned(), points)];
            let mut out = Vec::new();
            write_angle_plot("a & b", &AngleQuantity::cross_section("φ"), &lines, &mut out).unwrap();
            let text = String::from_utf8(out).unwrap();
            assert_eq!(curves(&text).len(), 3);
            assert!(!text.contains("NaN"));
            let texts = texts(&text);
            for label in ["radar cross-section σ, dBsm", "φ, degrees", "a &amp; b"] {
                assert!(texts.iter().any(|text| text == label), "{label}: {texts:?}");
            }
        }
    }
}
