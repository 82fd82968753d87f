//! What an analysis of the matrix leaves: `spectrum.csv`, `spectrum.svg`, and `spectrum.json` last.
//!
//! Columns of the table: `band`, `matrix` (`reflection` is R F, `jacobi` J, `gauss_seidel` L₁,
//! `psi` Ψ, `theta` Θ), `index`, `re`, `im`. The plot shows the band of the largest radius:
//! eigenvalues in the plane, and their moduli in falling order.

use std::io::{self, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::csv::quoted;
use crate::number::Number;
use crate::plot::{Axis, Figure, Line, Panel, Part, Point, Span, write_svg};
use crate::{REPORT, ReportError, ReportPage, ResultFolder, Timing, reading};

/// Name of the format of `spectrum.json`.
pub const SPECTRUM_FORMAT: &str = "fredholm-spectrum-1";
/// The files of an analysis, in the order in which they are written.
pub const SPECTRUM_FILES: [&str; 3] = ["spectrum.csv", "spectrum.svg", "spectrum.json"];

/// Everything that an analysis found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct SpectrumRecord {
    /// [`SPECTRUM_FORMAT`].
    pub format: String,
    /// Version of the program.
    pub version: String,
    /// Path of the scene file.
    pub scene: String,
    /// SHA-256 of the scene file.
    pub scene_sha256: String,
    /// Number of unknowns in each band.
    pub unknowns: u64,
    /// `dense`, or `lanczos` where there are estimates only.
    pub method: String,
    /// A system a band.
    pub bands: Vec<BandSpectrum>,
    /// Times of the stages.
    pub timings: Vec<Timing>,
}

/// The system of one band. What was not computed is missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct BandSpectrum {
    /// Name of the band.
    pub band: String,
    /// Spectral radius of R F.
    #[serde(deserialize_with = "reading::number")]
    pub reflection_radius: f64,
    /// Spectral radius of Jacobi's iteration matrix.
    pub jacobi_radius: Option<f64>,
    /// Spectral radius of Gauss–Seidel's iteration matrix.
    #[serde(deserialize_with = "reading::number")]
    pub gauss_seidel_radius: f64,
    /// cond₂ of Φ = I − R F.
    pub condition_phi: Option<f64>,
    /// cond₂ of Ψ = H Φ.
    pub condition_psi: Option<f64>,
    /// cond₂ of Θ = H^½ Φ H^(−½).
    pub condition_theta: Option<f64>,
    /// Largest imaginary part among the eigenvalues of R F.
    pub largest_imaginary: Option<f64>,
    /// Whether Φ is an M-matrix.
    pub m_matrix: Option<bool>,
    /// Whether Ψ is a Stieltjes matrix.
    pub stieltjes: Option<bool>,
    /// Whether Φ is irreducible.
    pub irreducible: Option<bool>,
    /// Largest |ψ_ij − ψ_ji| over the largest |ψ_ij|.
    pub symmetry_defect: Option<f64>,
    /// Bounds of the field of values of Φ: real from, real to, imaginary on either side of 0.
    pub field_of_values: Option<[f64; 3]>,
    /// Eigenvalues by matrix.
    pub eigenvalues: Vec<Eigenvalues>,
}

/// Eigenvalues of one matrix.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Eigenvalues {
    /// Name of the matrix.
    pub matrix: String,
    /// Real and imaginary parts.
    pub values: Vec<[f64; 2]>,
}

/// Writes an analysis into a folder; with a title, `report.html` too.
///
/// # Errors
/// [`ReportError::Write`] with the path.
pub fn write_spectrum(
    folder: &ResultFolder,
    record: &SpectrumRecord,
    report: Option<&str>,
) -> Result<(), ReportError> {
    let [table, plot, json] = SPECTRUM_FILES;
    folder.write(table, |out| write_spectrum_csv(record, out))?;
    folder.write(plot, |out| write_spectrum_plot(record, out))?;
    if let Some(title) = report {
        folder.write(REPORT, |out| ReportPage::of_spectrum(title, record).write(out))?;
    }
    let record = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, record)?;
        writeln!(out)
    };
    folder.write(json, record).map(drop)
}

/// Writes the table of eigenvalues.
///
/// # Errors
/// What `out` reports.
pub fn write_spectrum_csv(record: &SpectrumRecord, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "band,matrix,index,re,im")?;
    for band in &record.bands {
        for Eigenvalues { matrix, values } in &band.eigenvalues {
            for (index, [re, im]) in values.iter().enumerate() {
                writeln!(out, "{},{matrix},{index},{},{}", quoted(&band.band), Number(*re), Number(*im))?;
            }
        }
    }
    Ok(())
}

/// Writes the plot of the band of the largest radius.
///
/// # Errors
/// What `out` reports.
pub fn write_spectrum_plot(record: &SpectrumRecord, out: &mut dyn Write) -> io::Result<()> {
    let Some(band) = record.widest() else {
        return write_svg(&Figure { title: "No bands".to_owned(), parts: Vec::new() }, out);
    };
    let panel = |across: &str, up: Axis, points: fn(&Eigenvalues) -> Vec<Point>| {
        let line = |(number, of): (usize, &Eigenvalues)| Line {
            joined: false,
            ..Line::distinct(&of.matrix.replace('_', "-"), points(of), number)
        };
        let lines = band.eigenvalues.iter().enumerate().map(line).collect();
        Part::Panel(Panel::new(Axis::new(across, Span::WithZero), up, lines))
    };
    let parts = vec![
        panel("real part of λ", Axis::new("imaginary part of λ", Span::WithZero), Eigenvalues::in_the_plane),
        panel("rank", Axis::new("modulus |λ|", Span::Decades), Eigenvalues::ranked),
    ];
    let title = format!(
        "{}, {}: eigenvalues, {} unknowns, {}",
        record.scene, band.band, record.unknowns, record.method
    );
    write_svg(&Figure { title, parts }, out)
}

impl SpectrumRecord {
    /// The band of the largest spectral radius.
    pub(crate) fn widest(&self) -> Option<&BandSpectrum> {
        self.bands.iter().max_by(|u, v| u.reflection_radius.total_cmp(&v.reflection_radius))
    }
}

impl Eigenvalues {
    /// Real and imaginary parts.
    pub(crate) fn in_the_plane(&self) -> Vec<Point> {
        self.values.iter().map(|&[re, im]| (re, im)).collect()
    }

    /// Ranks and moduli, the largest first.
    pub(crate) fn ranked(&self) -> Vec<Point> {
        let mut moduli: Vec<f64> = self.values.iter().map(|[re, im]| re.hypot(*im)).collect();
        moduli.sort_by(|u, v| v.total_cmp(u));
        moduli.into_iter().enumerate().map(|(rank, modulus)| ((rank + 1) as f64, modulus)).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::csv::tests::parse;
    use crate::xml::tests::tags;

    fn sample() -> SpectrumRecord {
        let eigenvalues =
            vec![Eigenvalues { matrix: "reflection".into(), values: vec![[0.5, 0.0], [-0.25, 1e-3]] }];
        let band = |name: &str| BandSpectrum {
            band: name.into(),
            eigenvalues: eigenvalues.clone(),
            ..BandSpectrum::default()
        };
        SpectrumRecord {
            format: SPECTRUM_FORMAT.into(),
            version: "0".into(),
            scene: "a.toml".into(),
            scene_sha256: String::new(),
            unknowns: 2,
            method: "dense".into(),
            bands: vec![band("r"), band("g, b")],
            timings: Vec::new(),
        }
    }

    #[test]
    fn every_eigenvalue_has_a_row() {
        let mut out = Vec::new();
        write_spectrum_csv(&sample(), &mut out).unwrap();
        let rows = parse(&String::from_utf8(out).unwrap());
        assert_eq!(rows.len(), 5);
        assert_eq!(rows[4], ["g, b", "reflection", "1", "-0.25", "0.001"]);
    }

    #[test]
    fn all_files_are_written_and_every_eigenvalue_is_a_dot_in_both_panels() {
        let folder = tempfile::tempdir().unwrap();
        write_spectrum(&ResultFolder::claim(folder.path()).unwrap(), &sample(), None).unwrap();
        let text = fs::read_to_string(folder.path().join("spectrum.svg")).unwrap();
        // One in the legend besides.
        assert_eq!(tags(&text).iter().filter(|(name, _)| name == "circle").count(), 5);
        let json = fs::read(folder.path().join("spectrum.json")).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
        assert!(json["bands"][0]["jacobi_radius"].is_null() && json["format"] == SPECTRUM_FORMAT);
    }
}
