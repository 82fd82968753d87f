//! What all plots have in common: colours, sizes and the font.
//!
//! Sizes are in pixels of a drawing 600 pixels wide, where the smallest text has 15: on a phone 390
//! pixels wide that is 10, in a printed column of 86 mm 6 points. The lines of series have a
//! contrast of at least 3 : 1 to the light and to the dark ground (WCAG 2.1, criterion 1.4.11), and
//! the first of them come from a set that most colour-blind readers can tell apart (M. Okabe, K.
//! Ito, "Color universal design", 2008), darkened where need be.

use std::io;
use std::sync::OnceLock;

use plotters::prelude::{Color, IntoFont, RGBColor, TextStyle};
use plotters::style::{FontStyle, register_font};

/// Width of a drawing, pixels.
pub(super) const WIDTH: i32 = 600;
/// Border, pixels.
pub(super) const MARGIN: i32 = 14;
/// Height of a line of the title, pixels.
pub(super) const TITLE_ROW: i32 = 25;
/// Sizes of text, pixels.
pub(super) const TITLE_SIZE: i32 = 19;
pub(super) const TEXT_SIZE: i32 = 16;
pub(super) const SMALL_TEXT_SIZE: i32 = 15;

pub(super) const GROUND: RGBColor = RGBColor(255, 255, 255);
pub(super) const INK: RGBColor = RGBColor(31, 35, 40);
pub(super) const MUTED_INK: RGBColor = RGBColor(98, 104, 112);
pub(super) const GRID_COLOUR: RGBColor = RGBColor(222, 225, 229);

/// What the colours of this module become on a dark ground, on which thin lines in those for the
/// light one are hard to see: those of series have a contrast of at least 4.5 : 1 to it.
const DARK_COLOURS: [(RGBColor, &str); 15] = [
    (GROUND, "#16181d"),
    (INK, "#e6e8eb"),
    (MUTED_INK, "#a3a9b2"),
    (GRID_COLOUR, "#434954"),
    (DISTINCT_COLOURS[0], "#3d9bd8"),
    (DISTINCT_COLOURS[1], "#f07f2e"),
    (DISTINCT_COLOURS[2], "#2bbf94"),
    (DISTINCT_COLOURS[3], "#dd86b8"),
    (DISTINCT_COLOURS[4], "#d9a02a"),
    (DISTINCT_COLOURS[5], "#7cc8f0"),
    (DISTINCT_COLOURS[6], "#c29670"),
    (DISTINCT_COLOURS[7], "#a6a6a6"),
    (RED, "#f0645c"),
    (GREEN, "#46b765"),
    (BLUE, "#7d9ff5"),
];

/// The colours of bands of these names.
const RED: RGBColor = RGBColor(208, 52, 44);
const GREEN: RGBColor = RGBColor(34, 139, 62);
const BLUE: RGBColor = RGBColor(66, 112, 220);
const DISTINCT_COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 150, 108),
    RGBColor(196, 100, 155),
    RGBColor(176, 122, 0),
    RGBColor(42, 143, 196),
    RGBColor(155, 111, 78),
    RGBColor(118, 118, 118),
];

/// The font, by the name that SVG knows. Pictures take it from the program itself: DejaVu Sans
/// 2.37, cut down to the characters that plots use.
const FONT_FAMILY: &str = "sans-serif";
static FONT: &[u8] = include_bytes!("../../assets/plot-font.ttf");

/// Makes the font known to the library that draws, once.
pub(super) fn load_font() -> io::Result<()> {
    static LOADED: OnceLock<bool> = OnceLock::new();
    let loaded = *LOADED.get_or_init(|| register_font(FONT_FAMILY, FontStyle::Normal, FONT).is_ok());
    if loaded { Ok(()) } else { Err(io::Error::other("the font of the plots cannot be read")) }
}

/// A text of `size` pixels where a pixel has `unit` steps of the drawing.
pub(super) fn text(size: i32, unit: i32, colour: RGBColor) -> TextStyle<'static> {
    // The library takes the height of a line, 1.24 times the size.
    let mut style = TextStyle::from((FONT_FAMILY, 1.24 * f64::from(size * unit)).into_font());
    style.color = colour.to_backend_color();
    style
}

/// The rules of CSS that turn a light drawing into a dark one, on screens that ask for it.
pub(super) fn dark_style() -> String {
    let rule = |(light, dark): &(RGBColor, &str)| {
        let RGBColor(r, g, b) = light;
        let light = format!("#{r:02X}{g:02X}{b:02X}");
        format!("[fill=\"{light}\"]{{fill:{dark}}}[stroke=\"{light}\"]{{stroke:{dark}}}")
    };
    let rules: String = DARK_COLOURS.iter().map(rule).collect();
    format!("<style>@media screen and (prefers-color-scheme:dark){{{rules}}}</style>")
}

/// A colour for each of the names: red, green and blue for bands of these names, distinct ones for
/// a few, and from blue to red in their order for many.
pub(crate) fn band_colours(names: &[String]) -> Vec<RGBColor> {
    let colour = |(number, name): (usize, &String)| match name.to_ascii_lowercase().as_str() {
        "r" | "red" => RED,
        "g" | "green" => GREEN,
        "b" | "blue" => BLUE,
        _ if names.len() <= DISTINCT_COLOURS.len() => DISTINCT_COLOURS[number],
        _ => ramp(number as f64 / (names.len() - 1) as f64),
    };
    names.iter().enumerate().map(colour).collect()
}

/// The colour of one of many things without an order, and which shape marks it.
pub(crate) fn distinct(number: usize) -> (RGBColor, usize) {
    (DISTINCT_COLOURS[number % DISTINCT_COLOURS.len()], number / DISTINCT_COLOURS.len())
}

/// From blue at 0 through green to red at 1.
fn ramp(t: f64) -> RGBColor {
    let hue = 240.0 * (1.0 - t);
    let channel = |offset: f64| {
        let distance = ((hue - offset + 540.0) % 360.0 - 180.0).abs();
        40.0 + 170.0 * (2.0 - distance / 60.0).clamp(0.0, 1.0)
    };
    let [r, g, b] = [channel(0.0), channel(120.0), channel(240.0)];
    // Of one brightness, so that every line stands out from either ground.
    let scale = 0.46
        / (0.2126 * (r / 255.0).powf(2.2) + 0.7152 * (g / 255.0).powf(2.2) + 0.0722 * (b / 255.0).powf(2.2))
            .powf(1.0 / 2.2);
    let [r, g, b] = [r, g, b].map(|c| (c * scale + 60.0 * (scale - 1.0).max(0.0)).min(255.0) as u8);
    RGBColor(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Relative luminance (WCAG 2.1).
    fn luminance(RGBColor(r, g, b): RGBColor) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
    }

    #[test]
    fn bands_have_colours_of_their_own_that_stand_out_from_both_grounds() {
        let (light, dark) = (luminance(GROUND), luminance(RGBColor(0x16, 0x18, 0x1d)));
        let mut cases: Vec<Vec<String>> =
            [1, 8, 9, 40].map(|count| (0..count).map(|i| format!("{i}")).collect()).into();
        cases.push(["r", "g", "b"].map(str::to_owned).into());
        for bands in cases {
            let colours = band_colours(&bands);
            let different: BTreeSet<_> = colours.iter().map(|RGBColor(r, g, b)| (*r, *g, *b)).collect();
            assert_eq!(different.len(), bands.len());
            for colour in colours {
                let found = luminance(colour);
                let contrasts = [(light + 0.05) / (found + 0.05), (found + 0.05) / (dark + 0.05)];
                assert!(contrasts.iter().all(|c| *c >= 3.0), "{colour:?} {contrasts:?}");
            }
        }
    }

    #[test]
    fn every_colour_of_the_theme_has_a_dark_one() {
        let style = dark_style();
        assert!(style.contains("[fill=\"#FFFFFF\"]{fill:#16181d}") && style.contains("stroke:#434954"));
        let dark = luminance(RGBColor(0x16, 0x18, 0x1d));
        for (light, found) in &DARK_COLOURS[4..] {
            let channel = |at: usize| u8::from_str_radix(&found[at..at + 2], 16).unwrap();
            let contrast = (luminance(RGBColor(channel(1), channel(3), channel(5))) + 0.05) / (dark + 0.05);
            assert!(contrast >= 4.5, "{light:?} {found} {contrast}");
        }
    }
}
