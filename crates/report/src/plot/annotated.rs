//! A picture with a title above it, the colours of a quantity beside it where it shows one, and
//! lines and numbers over it.

use std::io;

use plotters::drawing::IntoDrawingArea;
use plotters::element::{Circle, Text};
use plotters::prelude::{BitMapBackend, Color, RGBColor};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Point;
use super::figure::{draw_title, failed, width_of, wrapped};
use super::map::{Area, BAR_WIDTH, ColourBar};
use super::theme::{GROUND, INK, MARGIN, SMALL_TEXT_SIZE, TITLE_ROW, load_font, text};
use crate::camera::LEAST_WRITTEN_WIDTH;
use crate::{Picture, ReportError};

/// Shorter side of a picture for one pixel of the theme to be one of the picture.
const SHORTER_SIDE: u32 = 560;
/// Least height of the bar, pixels of the theme.
const LEAST_BAR_HEIGHT: i32 = 220;
/// Least width of the whole, pixels of the theme.
const LEAST_WIDTH: i32 = LEAST_WRITTEN_WIDTH as i32;
/// Height of a number, pixels of the theme.
const NUMBER_HEIGHT: f64 = 17.0;
/// Room between numbers, pixels of the theme.
const NUMBER_MARGIN: f64 = 3.0;
/// Length of a line from which it has a label, pixels of the theme.
const LEAST_LABELLED_LENGTH: f64 = 70.0;
/// Pixels of the theme between the points of the grid of numbers, across and down.
const NUMBER_SPACING: [f64; 2] = [92.0, 76.0];

/// Pixels of a picture of so many pixels that one of the theme has.
pub(crate) fn unit_of(width: u32, height: u32) -> i32 {
    i32::try_from((width.min(height) + SHORTER_SIDE / 2) / SHORTER_SIDE).unwrap_or(1).max(1)
}

/// Columns and rows of a grid of pixels that are far enough from each other for numbers.
pub(crate) fn number_grid(width: u32, height: u32) -> Vec<(u32, u32)> {
    let unit = f64::from(unit_of(width, height));
    let along = |side: u32, spacing: f64| {
        let count = (f64::from(side) / (spacing * unit)).floor().max(1.0);
        (0..count as u32).map(move |i| (f64::from(side) * (f64::from(i) + 0.5) / count) as u32)
    };
    let across: Vec<u32> = along(width, NUMBER_SPACING[0]).collect();
    along(height, NUMBER_SPACING[1]).flat_map(|y| across.iter().map(move |&x| (x, y))).collect()
}

/// A line of equal value, and its number.
pub(crate) struct Isoline {
    pub(crate) points: Vec<Point>,
    pub(crate) label: String,
}

/// The drawing. Places are in pixels of the picture from its upper left.
pub(crate) struct Annotated<'a> {
    pub(crate) title: &'a str,
    pub(crate) picture: &'a Picture,
    pub(crate) bar: Option<ColourBar<'a>>,
    pub(crate) isolines: &'a [Isoline],
    /// Points with their numbers.
    pub(crate) numbers: &'a [(Point, String)],
}

/// A place that is taken: left, upper, right and lower end.
type Taken = [f64; 4];

impl Annotated<'_> {
    /// Draws it.
    ///
    /// # Errors
    /// [`ReportError::Drawing`] where the plotting library fails.
    pub(crate) fn drawn(&self) -> Result<Picture, ReportError> {
        self.draw().map_err(|error| ReportError::Drawing { why: error.to_string() })
    }

    fn draw(&self) -> io::Result<Picture> {
        load_font()?;
        let Picture { width, height, .. } = *self.picture;
        let unit = unit_of(width, height);
        let [wide, tall] = [width, height].map(|side| i32::try_from(side).unwrap_or(i32::MAX / 4));
        let beside = if self.bar.is_some() { BAR_WIDTH } else { MARGIN };
        let full = (wide + (MARGIN + beside) * unit).max(LEAST_WIDTH * unit);
        let title = wrapped(self.title, full / unit - 2 * MARGIN)?;
        let top = (MARGIN + TITLE_ROW * title.len() as i32 + 6) * unit;
        let least = if self.bar.is_some() { LEAST_BAR_HEIGHT * unit } else { 0 };
        let size = [full, top + tall.max(least) + MARGIN * unit].map(i32::unsigned_abs);
        let mut pixels = vec![255; 3 * size[0] as usize * size[1] as usize];
        let mut lined = self.picture.pixels.clone();
        self.draw_lines(&mut lined, f64::from(unit));
        for (y, row) in lined.chunks_exact(3 * width as usize).enumerate() {
            let at = 3 * ((top as usize + y) * size[0] as usize + (MARGIN * unit) as usize);
            pixels[at..at + row.len()].copy_from_slice(row);
        }
        {
            let root = BitMapBackend::with_buffer(&mut pixels, (size[0], size[1])).into_drawing_area();
            draw_title(&root, &title, unit).map_err(failed)?;
            let below = root.split_vertically(top).1;
            let (left, right) = below.split_horizontally(MARGIN * unit + wide);
            if let Some(bar) = &self.bar {
                bar.draw(&right, tall / unit, unit)?;
            }
            let over = left.split_horizontally(MARGIN * unit).1;
            self.draw_numbers(&over, unit)?;
            root.present().map_err(failed)?;
        }
        Ok(Picture { width: size[0], height: size[1], pixels })
    }

    /// Draws the lines into the pixels of the picture, dark on a light edge, so that they stand out
    /// from every colour. A pixel is covered as far as its middle lies in the line.
    fn draw_lines(&self, pixels: &mut [u8], unit: f64) {
        let (width, height) = (self.picture.width as usize, self.picture.height as usize);
        for (RGBColor(r, g, b), strength, half) in [(GROUND, 0.6, 1.5 * unit), (INK, 1.0, 0.6 * unit)] {
            let mut covered = vec![0.0_f64; width * height];
            for pair in self.isolines.iter().flat_map(|line| line.points.windows(2)) {
                cover(&mut covered, (width, height), (pair[0], pair[1]), half);
            }
            for (pixel, share) in pixels.chunks_exact_mut(3).zip(covered) {
                let share = strength * share;
                for (own, over) in pixel.iter_mut().zip([r, g, b]) {
                    *own = (f64::from(*own) * (1.0 - share) + f64::from(over) * share).round() as u8;
                }
            }
        }
    }

    fn draw_numbers(&self, area: &Area<'_>, unit: i32) -> io::Result<()> {
        let mut taken = Vec::new();
        for (at, number) in self.numbers {
            let (x, y) = whole(*at);
            for (colour, size) in [(GROUND, 3), (INK, 2)] {
                area.draw(&Circle::new((x, y), size * unit, colour.filled())).map_err(failed)?;
            }
            let above = (at.0, at.1 - 12.0 * f64::from(unit));
            taken.push(Self::room(above, number, unit)?);
            taken.push([at.0 - 3.0, at.1 - 3.0, at.0 + 3.0, at.1 + 3.0]);
            lettered(area, whole(above), number, unit, INK)?;
        }
        for line in self.isolines {
            if length(&line.points) < LEAST_LABELLED_LENGTH * f64::from(unit) {
                continue;
            }
            for at in candidates(&line.points) {
                let room = Self::room(at, &line.label, unit)?;
                if self.holds(room) && taken.iter().all(|other| is_apart(room, *other)) {
                    taken.push(room);
                    lettered(area, whole(at), &line.label, unit, LABEL_COLOUR)?;
                    break;
                }
            }
        }
        Ok(())
    }

    /// What a number around a place takes.
    fn room((x, y): Point, number: &str, unit: i32) -> io::Result<Taken> {
        let half = [
            0.5 * f64::from(width_of(number, SMALL_TEXT_SIZE)?) + NUMBER_MARGIN,
            0.5 * NUMBER_HEIGHT + NUMBER_MARGIN,
        ];
        let [wide, tall] = half.map(|side| side * f64::from(unit));
        Ok([x - wide, y - tall, x + wide, y + tall])
    }

    /// Whether a place lies in the picture.
    fn holds(&self, [left, top, right, low]: Taken) -> bool {
        left >= 0.0
            && top >= 0.0
            && right <= f64::from(self.picture.width)
            && low <= f64::from(self.picture.height)
    }
}

/// Colour of the labels of lines, told apart from the numbers of points.
const LABEL_COLOUR: RGBColor = RGBColor(150, 30, 30);

/// Writes a number around a place, on a light edge.
fn lettered(area: &Area<'_>, (x, y): (i32, i32), number: &str, unit: i32, ink: RGBColor) -> io::Result<()> {
    let style = |colour| text(SMALL_TEXT_SIZE, unit, colour).pos(Pos::new(HPos::Center, VPos::Center));
    let around = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
    for (dx, dy) in around {
        let at = (x + dx * unit, y + dy * unit);
        area.draw(&Text::new(number, at, style(GROUND))).map_err(failed)?;
    }
    area.draw(&Text::new(number, (x, y), style(ink))).map_err(failed)
}

/// Marks how far the pixels about a segment are within so many of it.
fn cover(
    covered: &mut [f64],
    (width, height): (usize, usize),
    ((ax, ay), (bx, by)): (Point, Point),
    half: f64,
) {
    let range = |a: f64, b: f64, count: usize| {
        let (low, high) = (a.min(b) - half - 1.0, a.max(b) + half + 1.0);
        (low.max(0.0) as usize)..(high.max(0.0) as usize).min(count)
    };
    let (dx, dy) = (bx - ax, by - ay);
    let length = (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
    for y in range(ay, by, height) {
        for x in range(ax, bx, width) {
            let (px, py) = (x as f64 + 0.5 - ax, y as f64 + 0.5 - ay);
            let along = ((px * dx + py * dy) / length).clamp(0.0, 1.0);
            let share = (half + 0.5 - (px - along * dx).hypot(py - along * dy)).clamp(0.0, 1.0);
            let own = &mut covered[y * width + x];
            *own = own.max(share);
        }
    }
}

fn whole((x, y): Point) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

fn length(points: &[Point]) -> f64 {
    points.windows(2).map(|pair| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1)).sum()
}

/// Places for the label of a line, the best first: from its middle to its ends.
fn candidates(points: &[Point]) -> impl Iterator<Item = Point> {
    let parts = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9];
    parts.into_iter().map(|part| points[(part * (points.len() - 1) as f64) as usize])
}

fn is_apart(a: Taken, b: Taken) -> bool {
    a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1]
}

#[cfg(test)]
mod tests {
    use super::super::map::tests::found;
    use super::super::{Scale, viridis};
    use super::*;

    fn drawn(width: u32, height: u32, isolines: &[Isoline], numbers: &[(Point, String)]) -> Picture {
        let pixels = [90, 150, 210].repeat((width * height) as usize);
        let picture = Picture { width, height, pixels };
        let bar = ColourBar { label: "E, W/m²", scale: Scale::linear(0.0, 5.0), colour: viridis };
        Annotated { title: "a room", picture: &picture, bar: Some(bar), isolines, numbers }.draw().unwrap()
    }

    #[test]
    fn the_picture_stays_as_it_is_but_for_what_is_drawn_over_it() {
        let bare = drawn(700, 500, &[], &[]);
        assert_eq!(found(&bare, [90, 150, 210]).0, 700 * 500);
        let line = Isoline { points: vec![(10.0, 250.0), (690.0, 250.0)], label: "2".to_owned() };
        let with = drawn(700, 500, &[line], &[((350.0, 100.0), "1.23".to_owned())]);
        let covered = 700 * 500 - found(&with, [90, 150, 210]).0;
        assert!((2 * 680..4 * 680 + 1500).contains(&covered), "{covered}");
        assert!(found(&with, [150, 30, 30]).0 > 5, "the line is labelled");
    }

    #[test]
    fn small_pictures_have_a_bar_and_a_title_all_the_same() {
        for (width, height) in [(1, 1), (64, 48), (2000, 1200)] {
            let picture = drawn(width, height, &[], &[]);
            assert_eq!(picture.pixels.len(), 3 * (picture.width * picture.height) as usize);
            assert!(picture.width > width + 100 && picture.height > 200);
            assert!(!number_grid(width, height).is_empty());
            assert!(number_grid(width, height).iter().all(|(x, y)| *x < width && *y < height));
        }
    }
}
