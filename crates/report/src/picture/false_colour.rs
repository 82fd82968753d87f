//! The irradiance of what a camera sees in false colour, with a bar of round numbers, lines of
//! equal irradiance and numbers at points of the surfaces.
//!
//! Colours, lines and numbers are of one field, W/m²: the light of lamps at every pixel, and the
//! rest interpolated between elements, as in the usual picture ([`super::lit`]). The range holds
//! what is seen but for lamps, and but for the brightest and the darkest fiftieth of it. It begins
//! at 0, and is divided into equal steps; where the ends of the range are further apart than
//! [`LEAST_LOGARITHMIC_RATIO`] it is logarithmic, with steps of 1, 2 and 5 times powers of ten, as
//! tables of lighting have them. Lines run over one surface and end at its edges.

use fredholm_mesh::Vec3;

use super::lit::{LitView, Middle, Seen};
use super::{Lit, Picture};
use crate::plot::{Annotated, ColourBar, Grid, Isoline, Scale, number_grid, round_step, viridis};
use crate::tone::decode;
use crate::words::number;
use crate::{Camera, Eye, Field, ReportError};

/// Share of the pixels that the range of colours leaves out at either end.
const LEFT_OUT: f64 = 0.02;
/// Ratio of the ends of the range from which it is logarithmic, and the most of it.
const LEAST_LOGARITHMIC_RATIO: f64 = 100.0;
const MOST_RATIO: f64 = 1e4;
/// Steps of a range that is not logarithmic, at most.
const MOST_STEPS: f64 = 8.0;
/// Neighbours belong to one smooth surface up to this cosine of their normals, and up to this sine
/// of the angle between the surface and the line from one to the other.
const SMOOTH_COSINE: f64 = 0.766;
const SMOOTH_SINE: f64 = 0.65;

/// A picture in false colour.
#[derive(Clone, Debug)]
pub struct FalseColourPicture {
    /// The drawing, with title and bar.
    pub picture: Picture,
    /// The numbers in it, row by row.
    pub numbers: Vec<PictureNumber>,
}

/// The irradiance at a point that is seen through a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureNumber {
    /// Column and row of the pixel, from the upper left.
    pub pixel: [u32; 2],
    /// The element.
    pub element: usize,
    /// The point, m.
    pub point: Vec3,
    /// Irradiance there, in the band of the picture or in all bands together, W/m².
    pub irradiance: f64,
}

/// Draws the irradiance of a field in false colour, in one band or in all bands together. There is
/// none where [`LampLight::go_on`](super::LampLight::go_on) did not want it any more before it was
/// whole.
///
/// # Errors
/// As for [`render_lit`](crate::render_lit), and [`ReportError::Drawing`] where the plotting
/// library fails.
pub fn render_false_colour(
    field: &Field<'_>,
    camera: &Camera,
    lit: &Lit<'_>,
    (title, band): (&str, Option<usize>),
) -> Result<Option<FalseColourPicture>, ReportError> {
    let bands = field.bands();
    let weights: Vec<f64> =
        (0..bands.len()).map(|i| f64::from(u8::from(band.is_none_or(|band| band == i)))).collect();
    let eye = Eye::new(field.mesh(), camera)?;
    let view = LitView::of_irradiance(*field, &eye, lit, &weights)?;
    let Some(middles) = view.looked() else { return Ok(None) };
    let scale = Levels::of(field, &middles);
    let display = |colour: [f64; 3]| viridis(scale.scale.place(colour[0])).map(decode);
    let Some(shown) = view.shown(&middles, &display) else { return Ok(None) };
    let Camera { width, height, .. } = *camera;
    let picture = Picture { width, height, pixels: shown.into_flattened() };
    let isolines = isolines(field, &eye, &middles, &scale.lines);
    let numbers = numbers(&view, &eye);
    let label = match band.and_then(|band| bands.get(band)) {
        _ if bands.len() == 1 => "irradiance E, W/m²".to_owned(),
        Some(band) => format!("irradiance E in band {band}, W/m²"),
        None => "irradiance E of all bands together, W/m²".to_owned(),
    };
    let title = scale.told(&format!("{title}: {label}"));
    let labelled = numbers.iter().map(|found| {
        let [x, y] = found.pixel.map(|at| f64::from(at) + 0.5);
        ((x, y), number(found.irradiance))
    });
    let picture = Annotated {
        title: &title,
        picture: &picture,
        bar: Some(ColourBar { label: &label, scale: scale.scale.clone(), colour: viridis }),
        isolines: &isolines,
        numbers: &labelled.collect::<Vec<_>>(),
    }
    .drawn()?;
    Ok(Some(FalseColourPicture { picture, numbers }))
}

/// The range of the colours, and the values of the lines.
struct Levels {
    scale: Scale,
    lines: Vec<f64>,
    /// The least and the largest value that is seen, lamps left out.
    ends: [f64; 2],
}

impl Levels {
    fn of(field: &Field<'_>, middles: &[Middle]) -> Self {
        let of = |lamps: bool| {
            let seen = middles.iter().filter_map(|middle| Some((middle.leaf()?, middle.colour[0])));
            let of = seen.filter(|(leaf, _)| field.emits(*leaf) == lamps);
            of.map(|(_, value)| f64::from(value)).collect::<Vec<_>>()
        };
        let mut values = of(false);
        if values.is_empty() {
            values = of(true);
        }
        values.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| values.get((share * values.len() as f64) as usize).copied();
        let at = |share: f64| at(share).or(values.last().copied()).unwrap_or(0.0);
        let [low, high] = [at(LEFT_OUT), at(1.0 - LEFT_OUT)];
        let ends = [at(0.0), at(1.0)];
        if low > 0.0 && high > LEAST_LOGARITHMIC_RATIO * low {
            let low = low.max(high / MOST_RATIO);
            let first = one_two_five().take_while(|v| *v <= low * (1.0 + 1e-9)).last().unwrap_or(low);
            let last = one_two_five().find(|v| *v >= high * (1.0 - 1e-9)).unwrap_or(high);
            let levels: Vec<f64> =
                one_two_five().skip_while(|v| *v < first).take_while(|v| *v <= last).collect();
            return Self { scale: Scale::decades_with_ticks(first, last, &levels), lines: levels, ends };
        }
        if high <= 0.0 {
            return Self { scale: Scale::linear(0.0, 1.0), lines: Vec::new(), ends };
        }
        let step = round_step(high, MOST_STEPS);
        let count = (high / step - 1e-9).ceil() as i32;
        let levels: Vec<f64> = (0..=count).map(|i| step * f64::from(i)).collect();
        Self { scale: Scale::with_ticks(0.0, step * f64::from(count), &levels), lines: levels, ends }
    }

    /// A title, with what lies beyond the bar.
    fn told(&self, title: &str) -> String {
        let [low, high] = self.ends;
        let (first, last) = (self.lines.first(), self.lines.last());
        let below = first.filter(|first| low < **first).map(|_| format!("down to {}", number(low)));
        let above = last.filter(|last| high > **last).map(|_| format!("up to {}", number(high)));
        let beyond: Vec<String> = below.into_iter().chain(above).collect();
        if beyond.is_empty() { title.to_owned() } else { format!("{title} ({} seen)", beyond.join(", ")) }
    }
}

/// 1, 2 and 5 times all powers of ten.
fn one_two_five() -> impl Iterator<Item = f64> {
    (-300..300).flat_map(|power| [1.0, 2.0, 5.0].map(|m| m * 10.0_f64.powi(power)))
}

/// Lines of equal irradiance, in pixels from the upper left.
fn isolines(field: &Field<'_>, eye: &Eye, middles: &[Middle], levels: &[f64]) -> Vec<Isoline> {
    let mesh = field.mesh();
    let columns = eye.camera().width as usize;
    let values: Vec<f64> = middles.iter().map(|middle| f64::from(middle.colour[0])).collect();
    let points: Vec<Vec3> =
        (0..middles.len()).map(|at| seen(eye, at).map_or(Vec3::ZERO, |(_, point)| point)).collect();
    let joined = |a: usize, b: usize| {
        let (Some(p), Some(q)) = (middles[a].leaf(), middles[b].leaf()) else { return false };
        let [n, m] = [p, q].map(|leaf| mesh.patch(leaf).normal());
        let line = points[b] - points[a];
        mesh.surface_of(p) == mesh.surface_of(q)
            && n.dot(m) > SMOOTH_COSINE
            && line.dot(n).abs() <= SMOOTH_SINE * line.length()
    };
    let grid = Grid { values: &values, columns, joined: &joined };
    let shifted = |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x + 0.5, y + 0.5)).collect();
    let of = |&level: &f64| {
        let lines = grid.isolines(level).into_iter();
        lines.map(move |points| Isoline { points: shifted(points), label: number(level) })
    };
    levels.iter().filter(|level| **level > 0.0).flat_map(of).collect()
}

/// What is seen through the middle of a pixel.
fn seen(eye: &Eye, at: usize) -> Seen {
    let columns = eye.camera().width as usize;
    eye.hit((at % columns) as f64 + 0.5, (at / columns) as f64 + 0.5)
}

/// The irradiance at the points of a grid of pixels.
fn numbers(view: &LitView<'_>, eye: &Eye) -> Vec<PictureNumber> {
    let Camera { width, height, .. } = *eye.camera();
    let grid = number_grid(width, height);
    let samples: Vec<Seen> = grid.iter().map(|(x, y)| seen(eye, (y * width + x) as usize)).collect();
    let colours = view.colours(&samples);
    let found = grid.iter().zip(samples).zip(colours).filter_map(|((&(x, y), sample), colour)| {
        let (element, point) = sample?;
        Some(PictureNumber { pixel: [x, y], element, point, irradiance: colour[0] })
    });
    found.collect()
}
