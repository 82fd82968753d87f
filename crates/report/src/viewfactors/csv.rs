//! View factors as a table: a row a surface, a column a surface.
//!
//! Columns: `name`, `area` (m²), `emissivity` (empty where unknown), `row_sum`, `row_error`,
//! `row_dropped`, then F to every surface, under its name. Points follow in rows of their own, with
//! an empty area.

use std::io::{self, Write};

use super::matrix::ViewFactors;
use crate::csv::{numbers, quoted};
use crate::number::Number;

const COLUMNS: &str = "name,area,emissivity,row_sum,row_error,row_dropped";

impl ViewFactors {
    /// Writes the matrix as comma-separated values.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        write!(out, "{COLUMNS}")?;
        self.surfaces.names.iter().try_for_each(|name| write!(out, ",{}", quoted(name)))?;
        writeln!(out)?;
        let mut row = vec![0.0; self.len()];
        for (i, name) in self.surfaces.names.iter().enumerate() {
            self.copy_row(i, &mut row);
            let emissivity = self.surfaces.emissivity.as_ref().map(|of| Number(of[i]).to_string());
            write!(
                out,
                "{},{},{}",
                quoted(name),
                Number(self.surfaces.area[i]),
                emissivity.unwrap_or_default()
            )?;
            numbers(out, [self.row_sums[i], self.surfaces.row_error[i], self.row_dropped[i]])?;
            numbers(out, row.iter().copied())?;
            writeln!(out)?;
        }
        self.write_points(out)
    }

    fn write_points(&self, out: &mut dyn Write) -> io::Result<()> {
        let Some(points) = &self.points else { return Ok(()) };
        for (k, row) in points.factors.chunks(self.len().max(1)).enumerate() {
            write!(out, "point/{},,,{},,", k + 1, Number(row.iter().sum()))?;
            numbers(out, row.iter().copied())?;
            writeln!(out)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::matrix::tests::sample;
    use crate::csv::tests::{parse, values};

    #[test]
    fn the_table_holds_every_number() {
        let factors = sample(None);
        let mut out = Vec::new();
        factors.write_csv(&mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(
            (rows.len(), rows[0][6].as_str(), rows[1][0].as_str()),
            (6, "Wände, \"alle\"", "Wände, \"alle\"")
        );
        let mut row = [0.0; 3];
        for i in 0..3 {
            factors.copy_row(i, &mut row);
            assert_eq!(values(&rows[i + 1], 6), row);
            assert_eq!(
                values(&rows[i + 1], 1)[..2],
                [factors.surfaces.area[i], factors.surfaces.emissivity.as_ref().unwrap()[i]]
            );
        }
        assert_eq!(values(&rows[5], 6), [1.0 / 7.0, 0.0, 1e-20]);
        assert!(rows.iter().all(|row| row.len() == 9));
    }
}
