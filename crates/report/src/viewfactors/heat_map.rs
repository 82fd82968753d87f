//! The matrix as a picture: row i from the top, column j from the left, the colour by log₁₀ F_ij,
//! with a bar of the decades beside it.
//!
//! Where there are more surfaces than pixels a pixel shows the largest factor of its block. Zero is
//! light grey.

use std::io;

use super::matrix::ViewFactors;
use crate::Picture;
use crate::plot::{ColourBar, Heat, Scale, viridis};

/// Most blocks along a side.
const MOST_BLOCKS_A_SIDE: usize = 752;
/// Decades shown below the largest factor.
const DECADES_SHOWN: i32 = 8;
/// Colour of zero.
const ZERO_COLOUR: [u8; 3] = [225, 225, 225];

/// Draws the matrix.
///
/// # Errors
/// What the drawing library reports.
pub fn heat_map(factors: &ViewFactors) -> io::Result<Picture> {
    let blocks = Blocks::new(factors);
    let (low, high) = decades(&blocks.values);
    let scale = Scale::decades(10.0_f64.powi(low), 10.0_f64.powi(high));
    let n = factors.len();
    let cell = |column: usize, row: usize| {
        // The axis upwards begins with the last row.
        let value = blocks.values[(blocks.count - 1 - row) * blocks.count + column];
        if value > 0.0 { viridis(scale.place(value)) } else { ZERO_COLOUR }
    };
    let patches = if n == 1 { "1 surface".to_owned() } else { format!("{n} surfaces") };
    Heat {
        title: &format!("View factors of {patches}; grey: none"),
        across: ("index j of the receiver", Scale::linear(0.0, n as f64)),
        up: ("index i of the emitter", Scale::linear(n as f64, 0.0)),
        aspect: 1.0,
        columns: blocks.count,
        rows: blocks.count,
        cell: &cell,
        bar: ColourBar { label: "view factor F(i→j)", scale: scale.clone(), colour: viridis },
        outline: &[],
    }
    .draw()
}

/// The largest factors of equal blocks.
struct Blocks {
    count: usize,
    values: Vec<f64>,
}

impl Blocks {
    fn new(factors: &ViewFactors) -> Self {
        let n = factors.len();
        let count = n.min(MOST_BLOCKS_A_SIDE);
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
        Self { count, values }
    }
}

/// Whole decades from the smallest, or the last of [`DECADES_SHOWN`], to the largest factor.
fn decades(values: &[f64]) -> (i32, i32) {
    let logs = || values.iter().filter(|&&value| value > 0.0).map(|value| value.log10());
    let high = logs().fold(f64::NEG_INFINITY, f64::max);
    if high == f64::NEG_INFINITY {
        return (-1, 0);
    }
    let high = high.ceil() as i32;
    let low = logs().fold(f64::INFINITY, f64::min).floor() as i32;
    (low.clamp(high - DECADES_SHOWN, high - 1), high)
}

#[cfg(test)]
mod tests {
    use super::super::matrix::SurfaceData;
    use super::*;
    use crate::plot::tests::found;

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

    #[test]
    fn entries_have_the_colour_of_their_decade_and_row_0_is_at_the_top() {
        let picture = heat_map(&factors(2, |i, j| [[0.0, 1.0], [1e-4, 1e-8]][i][j])).unwrap();
        let [none, one, middle, least] =
            [ZERO_COLOUR, viridis(1.0), viridis(0.5), viridis(0.0)].map(|colour| found(&picture, colour));
        assert!([none, one, middle, least].iter().all(|(count, _)| *count > 50_000));
        assert!(one.1.0 > none.1.0 + 100.0 && middle.1.1 > none.1.1 + 100.0);
    }

    #[test]
    fn a_block_shows_its_largest_entry() {
        let n = 2 * MOST_BLOCKS_A_SIDE;
        let picture = heat_map(&factors(n, |i, j| if (i, j) == (7, 101) { 1.0 } else { 1e-3 })).unwrap();
        assert!((1..100).contains(&(found(&picture, viridis(1.0)).0)));
        assert!(found(&picture, viridis(0.0)).0 > 100_000);
    }

    #[test]
    fn empty_and_blind_matrices_make_a_picture() {
        for n in [0, 1, 3] {
            let picture = heat_map(&factors(n, |_, _| 0.0)).unwrap();
            assert_eq!(picture.pixels.len(), 3 * (picture.width * picture.height) as usize);
        }
    }
}
