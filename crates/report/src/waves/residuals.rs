//! The residual ‖b − x + K x‖₂/‖b‖₂ after every iteration or bounce: `residuals.csv` (columns
//! `frequency` in Hz, `iteration`, `residual`) and `residuals.svg`.

use std::io::{self, Write};

use crate::number::Number;
use crate::plot::{Axis, Figure, Line, Panel, Part, Span, write_svg};

/// The residuals at one frequency, from the start on.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveResiduals {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Relative residuals.
    pub values: Vec<f64>,
}

/// Writes the table.
///
/// # Errors
/// What `out` reports.
pub fn write_residuals_csv(residuals: &[WaveResiduals], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "frequency,iteration,residual")?;
    for WaveResiduals { frequency, values } in residuals {
        for (iteration, &value) in values.iter().enumerate() {
            writeln!(out, "{},{iteration},{}", Number(*frequency), Number(value))?;
        }
    }
    Ok(())
}

/// Writes the plot; `across` says what is counted.
///
/// # Errors
/// What `out` reports.
pub fn write_residuals_plot(
    title: &str,
    across: &str,
    residuals: &[WaveResiduals],
    out: &mut dyn Write,
) -> io::Result<()> {
    let line = |(number, WaveResiduals { frequency, values }): (usize, &WaveResiduals)| {
        let points = values.iter().enumerate().map(|(i, &value)| (i as f64, value)).collect();
        Line::distinct(&format!("{} MHz", frequency / 1e6), points, number)
    };
    let up = Axis::new("relative residual ‖b − x + K x‖ / ‖b‖", Span::Decades);
    let lines = residuals.iter().enumerate().map(line).collect();
    let panel = Panel::new(Axis::new(across, Span::WithZero), up, lines);
    write_svg(&Figure { title: title.to_owned(), parts: vec![Part::Panel(panel)] }, out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::curves;

    #[test]
    fn every_iteration_has_a_row_and_every_frequency_a_line() {
        let residuals = [
            WaveResiduals { frequency: 1e9, values: vec![1.0, 0.25, 0.0] },
            WaveResiduals { frequency: 2e9, values: vec![1.0, 0.5] },
        ];
        let (mut table, mut plot) = (Vec::new(), Vec::new());
        write_residuals_csv(&residuals, &mut table).unwrap();
        let table = String::from_utf8(table).unwrap();
        assert_eq!(table.lines().collect::<Vec<_>>()[2], "1000000000,1,0.25");
        assert_eq!(table.lines().count(), 6);
        write_residuals_plot("a & b", "bounces", &residuals, &mut plot).unwrap();
        let plot = String::from_utf8(plot).unwrap();
        assert_eq!(curves(&plot).len(), 2);
    }
}
