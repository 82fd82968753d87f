//! Maps: values over a grid in colours, with axes, title and colour bar, as a picture.

use std::io;

use plotters::chart::ChartBuilder;
use plotters::drawing::IntoDrawingArea;
use plotters::element::PathElement;
use plotters::prelude::{BitMapBackend, Color, RGBColor};
use plotters::style::colors::colormaps::{ColorMap, DerivedColorMap, ViridisRGB};

use super::Point;
use super::figure::{draw_axes, draw_title, failed, wrapped};
use super::scale::Scale;
use super::theme::{GROUND, INK, MARGIN, SMALL_TEXT_SIZE, TEXT_SIZE, TITLE_ROW, WIDTH, load_font, text};
use crate::Picture;

/// Pixels of the picture for one of the theme: maps are drawn at twice the size.
const PIXELS_A_THEME_PIXEL: i32 = 2;
/// Room beside the map, its longest sides and its least side, pixels of the theme.
const ROOM_LEFT: i32 = 84;
const ROOM_BELOW: i32 = 58;
pub(super) const BAR_WIDTH: i32 = 140;
const MOST_WIDTH: i32 = 376;
const MOST_HEIGHT: i32 = 520;
const LEAST_SIDE: i32 = 150;

/// The colours of a quantity beside a map.
pub(crate) struct ColourBar<'a> {
    /// Quantity and unit.
    pub(crate) label: &'a str,
    pub(crate) scale: Scale,
    /// Colour of a place from 0 to 1.
    pub(crate) colour: fn(f64) -> [u8; 3],
}

impl ColourBar<'_> {
    /// Draws the bar at the left of an area, `tall` pixels of the theme high, each `unit` pixels.
    ///
    /// # Errors
    /// What the library reports.
    pub(super) fn draw(&self, area: &Area<'_>, tall: i32, unit: i32) -> io::Result<()> {
        let mut chart = ChartBuilder::on(&area.split_vertically(tall.max(LEAST_SIDE) * unit).0)
            .margin_left(18 * unit)
            .margin_right(((area.dim_in_pixel().0 as i32 / unit - BAR_WIDTH).max(0) + 14) * unit)
            .right_y_label_area_size(84 * unit)
            .build_cartesian_2d(Scale::linear(0.0, 1.0), self.scale.clone())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .disable_x_axis()
            .disable_mesh()
            .y_desc(self.label)
            .y_labels(7)
            .set_all_tick_mark_size(5 * unit)
            .axis_style(INK)
            .label_style(text(SMALL_TEXT_SIZE, unit, INK))
            .axis_desc_style(text(TEXT_SIZE, unit, INK))
            .draw()
            .map_err(failed)?;
        let inside = chart.plotting_area().strip_coord_spec();
        let (wide, tall) = inside.dim_in_pixel();
        for y in 0..tall {
            let [r, g, b] = (self.colour)(1.0 - (f64::from(y) + 0.5) / f64::from(tall));
            for x in 0..wide {
                inside.draw_pixel((x as i32, y as i32), &RGBColor(r, g, b)).map_err(failed)?;
            }
        }
        Ok(())
    }
}

/// A map.
pub(crate) struct Heat<'a> {
    pub(crate) title: &'a str,
    pub(crate) across: (&'a str, Scale),
    pub(crate) up: (&'a str, Scale),
    /// Height over width of what is shown.
    pub(crate) aspect: f64,
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Colour of the cell in a column and a row, both counted from the beginnings of the axes.
    pub(crate) cell: &'a dyn Fn(usize, usize) -> [u8; 3],
    pub(crate) bar: ColourBar<'a>,
    /// Lines over the map.
    pub(crate) outline: &'a [[Point; 2]],
}

impl Heat<'_> {
    /// Draws the map.
    ///
    /// # Errors
    /// What the library reports.
    pub(crate) fn draw(&self) -> io::Result<Picture> {
        load_font()?;
        let title = wrapped(self.title, WIDTH - 2 * MARGIN)?;
        let aspect = if self.aspect.is_normal() { self.aspect.abs() } else { 1.0 };
        let wide = f64::from(MOST_WIDTH).min(f64::from(MOST_HEIGHT) / aspect);
        let [wide, tall] = [wide, wide * aspect].map(|side| (side.round() as i32).max(LEAST_SIDE));
        let top = 20 + TITLE_ROW * title.len() as i32 + 6;
        let (width, height) = (600, top + tall + ROOM_BELOW + 14);
        let (right, size) = (
            width - ROOM_LEFT - wide,
            [width, height].map(|side| (PIXELS_A_THEME_PIXEL * side).unsigned_abs()),
        );
        let mut pixels = vec![255; 3 * size[0] as usize * size[1] as usize];
        {
            let root = BitMapBackend::with_buffer(&mut pixels, (size[0], size[1])).into_drawing_area();
            root.fill(&GROUND).map_err(failed)?;
            draw_title(&root, &title, PIXELS_A_THEME_PIXEL).map_err(failed)?;
            let (map, bar) = root
                .split_vertically(top * PIXELS_A_THEME_PIXEL)
                .1
                .split_horizontally((width - right) * PIXELS_A_THEME_PIXEL);
            self.draw_map(&map)?;
            self.bar.draw(&bar, tall, PIXELS_A_THEME_PIXEL)?;
            root.present().map_err(failed)?;
        }
        Ok(Picture { width: size[0], height: size[1], pixels })
    }

    fn draw_map(&self, area: &Area<'_>) -> io::Result<()> {
        let (across, up) = (&self.across, &self.up);
        let mut chart = ChartBuilder::on(area)
            .margin_bottom(14 * PIXELS_A_THEME_PIXEL)
            .margin_left(14 * PIXELS_A_THEME_PIXEL)
            .x_label_area_size(ROOM_BELOW * PIXELS_A_THEME_PIXEL)
            .y_label_area_size((ROOM_LEFT - 14) * PIXELS_A_THEME_PIXEL)
            .build_cartesian_2d(across.1.clone(), up.1.clone())
            .map_err(failed)?;
        draw_axes(&mut chart, (across.0, up.0), PIXELS_A_THEME_PIXEL).map_err(failed)?;
        let inside = chart.plotting_area().strip_coord_spec();
        let (wide, tall) = inside.dim_in_pixel();
        for y in 0..tall.min(if self.rows * self.columns > 0 { tall } else { 0 }) {
            let row = cell_at(tall - 1 - y, tall, self.rows);
            for x in 0..wide {
                let [r, g, b] = (self.cell)(cell_at(x, wide, self.columns), row);
                inside.draw_pixel((x as i32, y as i32), &RGBColor(r, g, b)).map_err(failed)?;
            }
        }
        // Dark on a light edge, so that it stands out from every colour.
        for (colour, wide) in [(GROUND, 3), (INK, 1)] {
            let style = colour.stroke_width(wide * PIXELS_A_THEME_PIXEL.unsigned_abs());
            let lines = self.outline.iter().map(|line| PathElement::new(line.to_vec(), style));
            chart.draw_series(lines).map_err(failed)?;
        }
        Ok(())
    }
}

pub(super) type Area<'a> = plotters::drawing::DrawingArea<BitMapBackend<'a>, plotters::coord::Shift>;

/// The cell of a pixel.
fn cell_at(pixel: u32, of: u32, cells: usize) -> usize {
    (pixel as usize * cells / of.max(1) as usize).min(cells.saturating_sub(1))
}

fn bytes(RGBColor(r, g, b): RGBColor) -> [u8; 3] {
    [r, g, b]
}

/// Even in lightness, and readable without colour (S. van der Walt & N. Smith, "viridis", 2015).
pub(crate) fn viridis(place: f64) -> [u8; 3] {
    bytes(ViridisRGB::get_color(place.clamp(0.0, 1.0)))
}

/// Blue at 0, nearly white in the middle, red at 1.
pub(crate) fn diverging(place: f64) -> [u8; 3] {
    let colours = [RGBColor(33, 82, 166), RGBColor(245, 245, 245), RGBColor(178, 24, 43)];
    bytes(DerivedColorMap::new(&colours).get_color(place.clamp(0.0, 1.0)))
}

/// A ring of colours, 0 and 1 being the same, even in lightness on both halves (after "twilight",
/// B. Bai for Matplotlib, 2018).
pub(crate) fn twilight(place: f64) -> [u8; 3] {
    let colours = [
        RGBColor(226, 217, 226),
        RGBColor(158, 187, 201),
        RGBColor(98, 118, 186),
        RGBColor(90, 48, 146),
        RGBColor(47, 20, 55),
        RGBColor(125, 30, 76),
        RGBColor(178, 86, 82),
        RGBColor(204, 163, 137),
        RGBColor(226, 217, 226),
    ];
    bytes(DerivedColorMap::new(&colours).get_color(place.clamp(0.0, 1.0)))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// How many pixels have a colour, and the middle of them.
    pub(crate) fn found(picture: &Picture, colour: [u8; 3]) -> (usize, Point) {
        let wide = picture.width as usize;
        let at: Vec<usize> =
            (0..picture.pixels.len() / 3).filter(|at| picture.pixels[3 * at..3 * at + 3] == colour).collect();
        let mean = |of: fn(usize, usize) -> usize| {
            at.iter().map(|at| of(*at, wide) as f64).sum::<f64>() / at.len().max(1) as f64
        };
        (at.len(), (mean(|at, wide| at % wide), mean(|at, wide| at / wide)))
    }

    fn heat(cell: &dyn Fn(usize, usize) -> [u8; 3], outline: &[[Point; 2]], count: usize) -> Picture {
        let bar = ColourBar { label: "|E|, V/m", scale: Scale::linear(0.0, 1.0), colour: viridis };
        let axis = || Scale::linear(0.0, 2.0);
        let (across, up) = (("x, m", axis()), ("y, m", axis()));
        let size = (count, count);
        let (columns, rows) = size;
        Heat { title: "t", across, up, aspect: 1.0, columns, rows, cell, bar, outline }.draw().unwrap()
    }

    #[test]
    fn cells_and_lines_stand_where_the_axes_say() {
        let colour = |column: usize, row: usize| [200, 10 * column as u8, 10 * row as u8];
        let picture = heat(&colour, &[[(0.5, 1.5), (1.5, 1.5)]], 2);
        let [low, right, high] = [(0, 0), (1, 0), (0, 1)].map(|(c, r)| found(&picture, colour(c, r)));
        assert!(low.0 > 50_000 && right.1.0 > low.1.0 + 100.0 && high.1.1 < low.1.1 - 100.0);
        let line = found(&picture, [31, 35, 40]);
        assert!(line.0 > 0);
        // A line in the upper half covers pixels of the upper cells alone.
        assert!(high.0 < low.0 && low.0 == right.0, "{low:?} {right:?} {high:?}");
    }

    #[test]
    fn nothing_makes_a_picture() {
        let picture = heat(&|_, _| [0; 3], &[], 0);
        assert_eq!(picture.pixels.len(), 3 * (picture.width * picture.height) as usize);
    }

    #[test]
    fn colours_end_where_they_should() {
        assert_eq!(twilight(0.0), twilight(1.0));
        assert_ne!(twilight(0.0), twilight(0.5));
        assert_eq!((diverging(0.0), diverging(1.0)), ([33, 82, 166], [178, 24, 43]));
        assert_eq!(viridis(-1.0), viridis(0.0));
    }
}
