//! A map of a field component over a grid, with its colour bar: magnitude, phase or real part.
//!
//! Row 0 of the grid is at the bottom of the picture. Magnitudes run from 0 to the largest, in the colours of the heat
//! map; real parts from −m to +m, blue over white to red; phases from −180° to 180° round a ring of hues.

use crate::Picture;
use crate::viewfactors::glyphs::{ADVANCE, HEIGHT, pixels};
use crate::viewfactors::heat_map::blend;

/// Longest side of the map, pixels, where the grid is smaller.
const SIDE: usize = 600;
/// Border, pixels.
const MARGIN: usize = 16;
/// Width of the bar, pixels.
const BAR: usize = 20;
/// Characters beside the bar.
const LABEL: usize = 9;
/// Ticks of the bar.
const TICKS: usize = 5;
const INK: [u8; 3] = [40, 40, 40];
/// Colour of what is no number.
const NOTHING: [u8; 3] = [225, 225, 225];

/// What of a complex number is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapQuantity {
    /// |c|.
    Magnitude,
    /// Argument, degrees.
    Phase,
    /// Real part.
    Real,
}

impl MapQuantity {
    /// All.
    pub const ALL: [Self; 3] = [Self::Magnitude, Self::Phase, Self::Real];

    /// The name in file names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Magnitude => "magnitude",
            Self::Phase => "phase",
            Self::Real => "real",
        }
    }

    fn of(self, [re, im]: [f64; 2]) -> f64 {
        match self {
            Self::Magnitude => re.hypot(im),
            Self::Phase => im.atan2(re).to_degrees(),
            Self::Real => re,
        }
    }

    fn range(self, values: &[f64]) -> [f64; 2] {
        let finite = values.iter().filter(|value| value.is_finite());
        let largest = finite.fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let largest = if largest > 0.0 { largest } else { 1.0 };
        match self {
            Self::Magnitude => [0.0, largest],
            Self::Phase => [-180.0, 180.0],
            Self::Real => [-largest, largest],
        }
    }

    fn colour(self, place: f64) -> [u8; 3] {
        match self {
            Self::Magnitude => blend(place),
            Self::Phase => hue(place),
            Self::Real => diverging(place),
        }
    }
}

/// Complex values (real, imaginary) over a grid: column fastest, `columns` a row.
#[derive(Clone, Copy, Debug)]
pub struct FieldMap<'a> {
    /// Points in a row.
    pub columns: usize,
    /// The values, row by row; a last row that is not full is left out.
    pub values: &'a [[f64; 2]],
}

impl FieldMap<'_> {
    /// Draws the map. Nothing to draw gives a picture of the bar alone.
    #[must_use]
    pub fn draw(&self, quantity: MapQuantity) -> Picture {
        let columns = self.columns.max(1);
        let rows = self.values.len() / columns;
        let values: Vec<f64> = self.values.iter().map(|&value| quantity.of(value)).collect();
        let range = quantity.range(&values);
        let cell = (SIDE / columns.max(rows).max(1)).max(1);
        let mut canvas = Canvas::new(columns * cell, (rows * cell).max(SIDE / 4));
        for y in 0..rows * cell {
            for x in 0..columns * cell {
                let value = values[(rows - 1 - y / cell) * columns + x / cell];
                let place = (value - range[0]) / (range[1] - range[0]);
                let colour = if place.is_finite() { quantity.colour(place) } else { NOTHING };
                canvas.set(MARGIN + x, MARGIN + y, colour);
            }
        }
        canvas.bar(quantity, range);
        canvas.finish()
    }
}

/// Blue at 0, white in the middle, red at 1.
fn diverging(place: f64) -> [u8; 3] {
    let t = 2.0 * place.clamp(0.0, 1.0) - 1.0;
    let end = if t < 0.0 { [33.0, 82.0, 166.0] } else { [178.0, 24.0, 43.0] };
    [0, 1, 2].map(|c| (245.0 + (end[c] - 245.0) * t.abs()).round() as u8)
}

/// The hue at a place of the ring, 0 and 1 being the same.
fn hue(place: f64) -> [u8; 3] {
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| {
        let wave = (std::f64::consts::TAU * (place - shift)).cos();
        (128.0 + 110.0 * wave).round() as u8
    })
}

/// A white picture under construction.
struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
    map: [usize; 2],
}

impl Canvas {
    fn new(map_width: usize, map_height: usize) -> Self {
        let width = 3 * MARGIN + map_width + BAR + LABEL * ADVANCE + ADVANCE;
        let height = 2 * MARGIN + map_height;
        Self { width, height, pixels: vec![255; 3 * width * height], map: [map_width, map_height] }
    }

    fn set(&mut self, x: usize, y: usize, colour: [u8; 3]) {
        let at = 3 * (y * self.width + x);
        self.pixels[at..at + 3].copy_from_slice(&colour);
    }

    fn bar(&mut self, quantity: MapQuantity, range: [f64; 2]) {
        let (left, height) = (2 * MARGIN + self.map[0], self.map[1]);
        for y in 0..height {
            let colour = quantity.colour(1.0 - (y as f64 + 0.5) / height as f64);
            (0..BAR).for_each(|x| self.set(left + x, MARGIN + y, colour));
        }
        for tick in 0..TICKS {
            let share = tick as f64 / (TICKS - 1) as f64;
            let y = MARGIN + ((1.0 - share) * (height - 1) as f64).round() as usize;
            (0..ADVANCE / 2).for_each(|x| self.set(left + BAR + x, y, INK));
            let text = label(range[0] + share * (range[1] - range[0]));
            for (x, dy) in pixels(&text) {
                self.set(left + BAR + ADVANCE + x, y - HEIGHT / 2 + dy, INK);
            }
        }
    }

    fn finish(self) -> Picture {
        let [width, height] = [self.width, self.height].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        Picture { width, height, pixels: self.pixels }
    }
}

/// A number in the few characters there are glyphs for: integers, or three digits and an exponent without a point.
fn label(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.fract() == 0.0 && value.abs() < 1e6 {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32 - 2;
    format!("{}e{exponent}", (value / 10.0_f64.powi(exponent)).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(picture: &Picture, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * picture.width as usize + x);
        [0, 1, 2].map(|c| picture.pixels[at + c])
    }

    #[test]
    fn the_first_row_is_at_the_bottom() {
        let values = [[0.0, 0.0], [0.0, 0.0], [3.0, 4.0], [0.0, 0.0]];
        let picture = FieldMap { columns: 2, values: &values }.draw(MapQuantity::Magnitude);
        assert_eq!(pixel(&picture, MARGIN + 5, MARGIN + 5), blend(1.0));
        assert_eq!(pixel(&picture, MARGIN + 5, MARGIN + SIDE - 5), blend(0.0));
    }

    #[test]
    fn phases_close_the_ring_and_real_parts_are_centred() {
        assert_eq!(hue(0.0), hue(1.0));
        assert_ne!(hue(0.0), hue(0.5));
        let values = [[-2.0, 0.0], [1.0, 7.0]];
        let picture = FieldMap { columns: 2, values: &values }.draw(MapQuantity::Real);
        assert_eq!(pixel(&picture, MARGIN + 5, MARGIN + 5), diverging(0.0));
        assert_eq!(pixel(&picture, MARGIN + SIDE - 5, MARGIN + 5), diverging(0.75));
    }

    #[test]
    fn labels_read_back() {
        for value in [0.0, -180.0, 90.0, 0.00123, -2.71, 5.0e7, 1e-9] {
            let read: f64 = label(value).parse().unwrap();
            assert!((read - value).abs() <= 0.005 * value.abs(), "{value} {read}");
            assert!(label(value).len() <= LABEL);
        }
    }

    #[test]
    fn empty_maps_make_a_picture() {
        for columns in [0, 3] {
            let picture = FieldMap { columns, values: &[] }.draw(MapQuantity::Phase);
            assert_eq!(picture.pixels.len(), 3 * (picture.width * picture.height) as usize);
        }
    }
}
