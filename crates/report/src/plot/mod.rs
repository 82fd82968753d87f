//! Plots of all kinds in one theme, drawn by the library plotters: curves, histograms and polar
//! plots as SVG whose text is text and which follows the light or dark scheme of the reader's
//! screen (a media query of CSS in the file), and maps with colour bars as PNG with a font of our
//! own.

mod annotated;
mod figure;
mod isolines;
mod map;
mod polar;
mod scale;
mod theme;

pub(crate) use annotated::{Annotated, Isoline, number_grid};
pub(crate) use figure::{Axis, Bar, Figure, Line, Panel, Part, write_svg};
pub(crate) use isolines::Grid;
pub(crate) use map::{ColourBar, Heat, diverging, twilight, viridis};
pub(crate) use polar::Polar;
pub(crate) use scale::{SMALLEST_ON_LOG_AXIS, Scale, Span, round_step};
pub(crate) use theme::{band_colours, distinct};

/// A point of a plot in its own quantities.
pub(crate) type Point = (f64, f64);

#[cfg(test)]
pub(crate) mod tests {
    pub(crate) use super::figure::tests::{bars, curves, texts};
    pub(crate) use super::map::tests::found;
}
