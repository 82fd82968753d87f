//! A map of a field component over a grid, with axes and colour bar: magnitude, phase or real part.
//!
//! Row 0 of the grid is at the bottom of the picture. Magnitudes run from 0 to the largest, in the
//! colours of the heat map; real parts from −m to +m, blue over white to red; phases from −180° to
//! 180° round a ring of colours.

use std::io;

use crate::Picture;
use crate::plot::{ColourBar, Heat, Scale, diverging, twilight, viridis};

/// Colour of what is no number.
const NO_NUMBER_COLOUR: [u8; 3] = [225, 225, 225];

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

    fn bar(self, values: &[f64]) -> (Scale, fn(f64) -> [u8; 3]) {
        let finite = values.iter().filter(|value| value.is_finite());
        let largest = finite.fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let largest = if largest > 0.0 { largest } else { 1.0 };
        match self {
            Self::Magnitude => (Scale::linear(0.0, largest), viridis),
            Self::Phase => (Scale::with_ticks(-180.0, 180.0, &[-180.0, -90.0, 0.0, 90.0, 180.0]), twilight),
            Self::Real => (Scale::linear(-largest, largest), diverging),
        }
    }
}

/// An axis of a map: what runs along it, and the values in the middle of its first and last cell.
#[derive(Clone, Debug, PartialEq)]
pub struct MapAxis {
    /// Quantity and unit.
    pub label: String,
    /// At the first point.
    pub from: f64,
    /// At the last point.
    pub to: f64,
}

impl MapAxis {
    /// The axis of so many cells, from edge to edge.
    fn scale(&self, cells: usize) -> Scale {
        let half = 0.5 * (self.to - self.from) / cells.saturating_sub(1).max(1) as f64;
        Scale::linear(self.from - half, self.to + half)
    }
}

/// Complex values (real, imaginary) over a grid: column fastest, `columns` a row.
#[derive(Clone, Debug)]
pub struct FieldMap<'a> {
    /// What it shows.
    pub title: &'a str,
    /// The symbol of the quantity, such as `Ez`, and its unit.
    pub quantity: (&'a str, &'a str),
    /// Along a row, and from row to row.
    pub axes: [MapAxis; 2],
    /// Height over width of the map; none where the axes have different units.
    pub aspect: Option<f64>,
    /// Points in a row.
    pub columns: usize,
    /// The values, row by row; a last row that is not full is left out.
    pub values: &'a [[f64; 2]],
    /// Outlines of bodies, in the units of the axes.
    pub outline: &'a [[(f64, f64); 2]],
}

impl FieldMap<'_> {
    /// Draws the map. Nothing to draw gives a picture of axes and bar alone.
    ///
    /// # Errors
    /// What the drawing library reports.
    pub fn draw(&self, quantity: MapQuantity) -> io::Result<Picture> {
        let columns = self.columns.max(1);
        let rows = self.values.len() / columns;
        let values: Vec<f64> = self.values.iter().map(|&value| quantity.of(value)).collect();
        let (scale, colour) = quantity.bar(&values);
        let cell = |column: usize, row: usize| {
            let place = scale.place(values[row * columns + column]);
            if place.is_finite() { colour(place) } else { NO_NUMBER_COLOUR }
        };
        let (symbol, unit) = self.quantity;
        let label = match quantity {
            MapQuantity::Magnitude => format!("|{symbol}|, {unit}"),
            MapQuantity::Phase => format!("phase of {symbol}, degrees"),
            MapQuantity::Real => format!("real part of {symbol}, {unit}"),
        };
        let [across, up] = &self.axes;
        let (across_scale, up_scale) = (across.scale(columns), up.scale(rows));
        Heat {
            title: self.title,
            across: (&across.label, across_scale),
            up: (&up.label, up_scale),
            aspect: self.aspect.unwrap_or(1.0),
            columns: if rows > 0 { columns } else { 0 },
            rows,
            cell: &cell,
            bar: ColourBar { label: &label, scale: scale.clone(), colour },
            outline: self.outline,
        }
        .draw()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::found;

    fn map(columns: usize, values: &[[f64; 2]], quantity: MapQuantity) -> Picture {
        let axis = || MapAxis { label: "x, m".to_owned(), from: 0.0, to: 1.0 };
        let (axes, outline) = ([axis(), axis()], [[(0.0, 0.0), (0.0, 1.0)]]);
        let quantity_of = ("Ez", "V/m");
        FieldMap {
            title: "t",
            quantity: quantity_of,
            axes,
            aspect: Some(1.0),
            columns,
            values,
            outline: &outline,
        }
        .draw(quantity)
        .unwrap()
    }

    #[test]
    fn the_first_row_is_at_the_bottom() {
        let values = [[0.0, 0.0], [0.0, 0.0], [3.0, 4.0], [0.0, 0.0]];
        let picture = map(2, &values, MapQuantity::Magnitude);
        let (high, low) = (found(&picture, viridis(1.0)), found(&picture, viridis(0.0)));
        assert!(high.0 > 50_000 && low.0 > 2 * high.0 && high.1.1 < low.1.1);
    }

    #[test]
    fn real_parts_are_centred() {
        let picture = map(2, &[[-2.0, 0.0], [1.0, 7.0]], MapQuantity::Real);
        assert!(found(&picture, diverging(0.0)).0 > 50_000 && found(&picture, diverging(0.75)).0 > 50_000);
    }

    #[test]
    fn empty_maps_make_a_picture() {
        for columns in [0, 3] {
            let picture = map(columns, &[], MapQuantity::Phase);
            assert_eq!(picture.pixels.len(), 3 * (picture.width * picture.height) as usize);
        }
    }
}
