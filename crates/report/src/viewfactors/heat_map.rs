//! The matrix as a picture: row i from the top, column j from the left, the colour by log₁₀ F_ij, with a bar of the decades beside it.
//!
//! Where there are more surfaces than pixels a pixel shows the largest factor of its block. Zero is light grey. Colours: after "viridis"
//! (S. van der Walt & N. Smith, 2015), nine of its colours with straight lines between: even in lightness, and readable without colour.

use super::glyphs::{self, ADVANCE};
use super::matrix::ViewFactors;
use crate::Picture;

/// Longest side of the matrix, pixels.
const SIDE: usize = 768;
/// Longest side of an entry, pixels.
const CELL: usize = 48;
/// Border, pixels.
const MARGIN: usize = 16;
/// Width of the bar, pixels.
const BAR: usize = 20;
/// Least height of the bar, pixels.
const LEAST: usize = 160;
/// Decades shown below the largest factor.
const DECADES: i32 = 8;
/// Colour of zero.
const ZERO: [u8; 3] = [225, 225, 225];
const INK: [u8; 3] = [40, 40, 40];
const COLOURS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Draws the matrix.
#[must_use]
pub fn heat_map(factors: &ViewFactors) -> Picture {
    let blocks = Blocks::new(factors);
    let scale = Scale::new(&blocks.values);
    let mut canvas = Canvas::new(blocks.side());
    for y in 0..blocks.side() {
        for x in 0..blocks.side() {
            canvas.set(MARGIN + x, MARGIN + y, scale.colour(blocks.at(x, y)));
        }
    }
    canvas.bar(&scale);
    canvas.finish()
}

/// The largest factors of equal blocks.
struct Blocks {
    count: usize,
    cell: usize,
    values: Vec<f64>,
}

impl Blocks {
    fn new(factors: &ViewFactors) -> Self {
        let n = factors.len();
        let count = n.min(SIDE);
        let mut values = vec![0.0_f64; count * count];
        let mut row = vec![0.0; n];
        for i in 0..n {
            factors.copy_row(i, &mut row);
            let block = &mut values[i * count / n * count..];
            for (j, &factor) in row.iter().enumerate() {
                let value = &mut block[j * count / n];
                *value = value.max(factor);
            }
        }
        Self { count, cell: (SIDE / count.max(1)).clamp(1, CELL), values }
    }

    fn side(&self) -> usize {
        self.count * self.cell
    }

    fn at(&self, x: usize, y: usize) -> f64 {
        self.values[y / self.cell * self.count + x / self.cell]
    }
}

/// Whole decades from dark to bright.
struct Scale {
    low: i32,
    high: i32,
}

impl Scale {
    fn new(values: &[f64]) -> Self {
        let logs = || values.iter().filter(|&&value| value > 0.0).map(|value| value.log10());
        let high = logs().fold(f64::NEG_INFINITY, f64::max);
        if high == f64::NEG_INFINITY {
            return Self { low: -1, high: 0 };
        }
        let high = high.ceil() as i32;
        let low = logs().fold(f64::INFINITY, f64::min).floor() as i32;
        Self { low: low.clamp(high - DECADES, high - 1), high }
    }

    fn colour(&self, value: f64) -> [u8; 3] {
        if value > 0.0 {
            blend((value.log10() - f64::from(self.low)) / f64::from(self.high - self.low))
        } else {
            ZERO
        }
    }
}

/// Colour of a place from 0 to 1.
pub(crate) fn blend(place: f64) -> [u8; 3] {
    let at = place.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let below = (at as usize).min(COLOURS.len() - 2);
    let (share, from, to) = (at - below as f64, COLOURS[below], COLOURS[below + 1]);
    [0, 1, 2].map(|c| (f64::from(from[c]) * (1.0 - share) + f64::from(to[c]) * share).round() as u8)
}

/// A white picture under construction.
struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
    side: usize,
}

impl Canvas {
    fn new(side: usize) -> Self {
        let width = 3 * MARGIN + side + BAR + 6 * ADVANCE;
        let height = 2 * MARGIN + side.max(LEAST);
        Self { width, height, pixels: vec![255; 3 * width * height], side }
    }

    fn set(&mut self, x: usize, y: usize, colour: [u8; 3]) {
        let at = 3 * (y * self.width + x);
        self.pixels[at..at + 3].copy_from_slice(&colour);
    }

    fn bar(&mut self, scale: &Scale) {
        let (left, height) = (2 * MARGIN + self.side, self.height - 2 * MARGIN);
        for y in 0..height {
            let colour = blend(1.0 - (y as f64 + 0.5) / height as f64);
            (0..BAR).for_each(|x| self.set(left + x, MARGIN + y, colour));
        }
        for decade in scale.low..=scale.high {
            let place = f64::from(scale.high - decade) / f64::from(scale.high - scale.low);
            self.tick(left + BAR, MARGIN + (place * (height - 1) as f64).round() as usize, decade);
        }
    }

    fn tick(&mut self, left: usize, y: usize, decade: i32) {
        (0..ADVANCE / 2).for_each(|x| self.set(left + x, y, INK));
        let top = y - glyphs::HEIGHT / 2;
        for (x, dy) in glyphs::pixels(&format!("1e{decade}")) {
            self.set(left + ADVANCE + x, top + dy, INK);
        }
    }

    fn finish(self) -> Picture {
        // Sides are below a thousand pixels.
        let [width, height] = [self.width, self.height].map(|side| side as u32);
        Picture { width, height, pixels: self.pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::super::matrix::SurfaceData;
    use super::*;

    fn factors(n: usize, value: impl Fn(usize, usize) -> f64) -> ViewFactors {
        let surfaces = SurfaceData {
            names: vec![String::new(); n],
            area: vec![1.0; n],
            emissivity: None,
            row_error: vec![0.0; n],
        };
        ViewFactors::new(surfaces, None, |i, row, _| {
            row.iter_mut().enumerate().for_each(|(j, x)| *x = value(i, j));
        })
    }

    fn pixel(picture: &Picture, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * picture.width as usize + x);
        [0, 1, 2].map(|c| picture.pixels[at + c])
    }

    #[test]
    fn entries_have_the_colour_of_their_decade() {
        let picture = heat_map(&factors(2, |i, j| [[0.0, 1.0], [1e-4, 1e-8]][i][j]));
        let middle = |i: usize, j: usize| pixel(&picture, MARGIN + j * CELL + 20, MARGIN + i * CELL + 20);
        assert_eq!(
            [middle(0, 0), middle(0, 1), middle(1, 0), middle(1, 1)],
            [ZERO, COLOURS[8], COLOURS[4], COLOURS[0]]
        );
        let bar = |y| pixel(&picture, 2 * MARGIN + 2 * CELL + 3, y);
        let (top, bottom) = (bar(MARGIN), bar(picture.height as usize - MARGIN - 1));
        assert!((0..3).all(|c| top[c].abs_diff(COLOURS[8][c]) < 4 && bottom[c].abs_diff(COLOURS[0][c]) < 4));
    }

    #[test]
    fn a_block_shows_its_largest_entry() {
        let n = 2 * SIDE;
        let picture = heat_map(&factors(n, |i, j| if (i, j) == (7, 101) { 1.0 } else { 1e-3 }));
        assert_eq!(pixel(&picture, MARGIN + 50, MARGIN + 3), COLOURS[8]);
        assert_eq!(pixel(&picture, MARGIN + 51, MARGIN + 3), COLOURS[0]);
    }

    #[test]
    fn empty_and_blind_matrices_make_a_picture() {
        for n in [0, 1, 3] {
            let picture = heat_map(&factors(n, |_, _| 0.0));
            assert_eq!(picture.pixels.len(), 3 * (picture.width * picture.height) as usize);
        }
    }
}
