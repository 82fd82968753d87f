//! `converge.svg`: error of the irradiance against the size h of the elements, both logarithmic,
//! with slopes h, h² and h⁴.
//!
//! The error is that against the limit where a band has an order, and else the difference to the
//! finest level; the legend says which. An error of 0 is drawn at 10⁻¹⁷.

use std::io::{self, Write};

use super::record::{BandConvergence, RefinementRecord};
use crate::plot::{Axis, Figure, Line, Panel, Part, SMALLEST_ON_LOG_AXIS, Span, band_colours, write_svg};

/// Orders whose slopes are drawn, with their labels.
const SLOPES: [(f64, &str); 3] = [(1.0, "slope h"), (2.0, "slope h²"), (4.0, "slope h⁴")];

/// The levels of a band with the error that is drawn.
fn curve(band: &BandConvergence) -> Vec<(usize, f64)> {
    let errors = band.errors.iter().enumerate().filter_map(|(level, error)| Some((level, (*error)?)));
    if band.order.is_some() {
        return errors.collect();
    }
    // The finest level is the reference itself.
    let coarser = band.differences.len().saturating_sub(1);
    band.differences[..coarser].iter().copied().enumerate().collect()
}

/// Writes the plot of a study.
///
/// # Errors
/// What `out` reports.
pub fn write_refinement_plot(record: &RefinementRecord, out: &mut dyn Write) -> io::Result<()> {
    let names: Vec<String> = record.bands.iter().map(|band| band.band.clone()).collect();
    let line = |(band, colour): (&BandConvergence, _)| {
        let points = curve(band)
            .into_iter()
            .map(|(level, error)| (record.levels[level].h, error.max(SMALLEST_ON_LOG_AXIS)));
        let of = band.order.map_or_else(|| "to the finest".to_owned(), |order| format!("order {order:.2}"));
        Line::new(&format!("{}, {of}", band.band), points.filter(|(h, _)| *h > 0.0).collect(), colour)
    };
    let mut lines = slopes(record);
    lines.extend(record.bands.iter().zip(band_colours(&names)).map(line));
    let across = Axis::new("largest diameter h of an element, m", Span::Decades);
    let up = Axis::new("relative error (L2 over the faces)", Span::Decades);
    let title = format!("{}: {}, error of the irradiance", record.scene, record.discretisation);
    write_svg(&Figure { title, parts: vec![Part::Panel(Panel::new(across, up, lines))] }, out)
}

/// Lines of slope 1, 2 and 4 from the finest error of the first band that has one, as far up as
/// there are errors.
fn slopes(record: &RefinementRecord) -> Vec<Line> {
    let drawn = record.bands.iter().flat_map(curve).filter(|(_, error)| *error > SMALLEST_ON_LOG_AXIS);
    let finest = record.bands.iter().find_map(|band| curve(band).last().copied());
    let Some((level, error)) = finest.filter(|(_, error)| *error > SMALLEST_ON_LOG_AXIS) else {
        return Vec::new();
    };
    let (end, most) = (record.levels[level].h, drawn.map(|(_, error)| error).fold(error, f64::max));
    let slope = |(order, label): (f64, &str)| {
        let reach = (end * (most / error).powf(1.0 / order)).min(record.levels[0].h);
        Line::level(label, vec![(reach, error * (reach / end).powf(order)), (end, error)])
    };
    SLOPES.map(slope).into()
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::sample;
    use super::*;
    use crate::plot::tests::curves;

    fn svg(record: &RefinementRecord) -> String {
        let mut out = Vec::new();
        write_refinement_plot(record, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn the_slope_of_order_2_lies_on_the_curve() {
        let mut record = sample();
        record.bands.truncate(1);
        let errors = curve(&record.bands[0]);
        let slopes = slopes(&record);
        assert_eq!(slopes.len(), 3);
        let (h, error) = (record.levels[errors[0].0].h, errors[0].1);
        let upper = slopes[1].points[0];
        assert!((upper.0 / h - 1.0).abs() < 1e-9 && (upper.1 / error - 1.0).abs() < 1e-6, "{upper:?}");
        assert_eq!(curves(&svg(&record)).len(), 1);
    }

    #[test]
    fn nothing_to_show_still_makes_a_plot() {
        for record in [RefinementRecord::default(), sample()] {
            let text = svg(&record);
            assert!(text.contains("</svg>") && !text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}
