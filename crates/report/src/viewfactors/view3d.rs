//! View factors as text in the form that View3D writes: `View3D version format encl emit N`, the
//! areas, N rows of F, the emittances.
//!
//! View3D user manual, version 3.3, "View Factor Output File" (format 0). Numbers have all their
//! digits; readers split at blanks. Unknown emittances are written as 1, black. Points are not part
//! of the form.

use std::io::{self, Write};

use super::matrix::ViewFactors;
use crate::number::Number;

/// Characters of the first line, which View3D pads.
const HEADER: usize = 30;

impl ViewFactors {
    /// Writes the matrix as View3D does. `closed` says that closure was enforced.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write_view3d(&self, closed: bool, out: &mut dyn Write) -> io::Result<()> {
        let first = format!("View3D 3.3 0 {} 0 {}", u8::from(closed), self.len());
        writeln!(out, "{first:<HEADER$}")?;
        line(out, &self.surfaces.area)?;
        let mut row = vec![0.0; self.len()];
        for i in 0..self.len() {
            self.copy_row(i, &mut row);
            line(out, &row)?;
        }
        let black = vec![1.0; self.len()];
        line(out, self.surfaces.emissivity.as_ref().unwrap_or(&black))
    }
}

fn line(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    for (i, &value) in values.iter().enumerate() {
        write!(out, "{}{}", if i == 0 { "" } else { " " }, Number(value))?;
    }
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::super::matrix::tests::sample;

    #[test]
    fn the_text_reads_as_the_manual_says() {
        let factors = sample(None);
        let mut out = Vec::new();
        factors.write_view3d(true, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "View3D 3.3 0 1 0 3            ");
        let numbers =
            |line: &str| -> Vec<f64> { line.split(' ').map(|word| word.parse().unwrap()).collect() };
        assert_eq!(numbers(lines[1]), factors.surfaces.area);
        let mut row = [0.0; 3];
        for i in 0..3 {
            factors.copy_row(i, &mut row);
            assert_eq!(numbers(lines[2 + i]), row);
        }
        assert_eq!((numbers(lines[5]), lines.len()), (vec![0.9, 0.05, 1.0], 6));
    }
}
