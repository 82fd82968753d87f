//! The pages of what is traced, of reference values, of spectra, and of matrices of view factors.

use fredholm_mesh::Mesh;

use super::model::{ElementValues, ReportModel};
use super::page::ReportPage;
use super::plot::{ReportAxis, ReportPlot, ReportSeries};
use super::run::surfaces;
use super::studies::{badges, provenance};
use super::table::{ReportCell, ReportColumn, ReportTable};
use crate::viewfactors::{bins, edge};
use crate::words::{count, number, percent};
use crate::{
    BandSpectrum, Field, Picture, ReferenceRecord, RunRecord, SpectrumRecord, ViewFactors, ViewFactorsRecord,
};

/// Most moduli of a matrix that are drawn.
const MOST_MODULI: usize = 2000;

impl<'a> ReportPage<'a> {
    /// The page of a scene traced by random paths.
    #[must_use]
    pub fn of_trace(
        title: &str,
        field: &Field<'a>,
        run: &'a RunRecord,
        model: ReportModel<'a>,
        picture: Option<&'a Picture>,
    ) -> Self {
        let counts = &run.counts;
        let lead = [
            "Random paths".to_owned(),
            count(counts.faces, "face", "faces"),
            count(counts.bands, "band", "bands"),
            run.solver.clone(),
        ];
        Self {
            title: title.to_owned(),
            lead: lead.join(" · "),
            badges: badges(&run.stop_reason, !run.partial, &run.warnings),
            bands: field.bands(),
            model: Some(model),
            picture,
            warnings: run.warnings.clone(),
            statements: trace_statements(run),
            tables: surfaces(field).into_iter().collect(),
            provenance: provenance(&run.version, &run.scene, &run.scene_sha256, &run.timings),
            options: run.options.clone(),
            version: run.version.clone(),
            ..Self::default()
        }
    }

    /// The page of reference values.
    #[must_use]
    pub fn of_reference(
        title: &str,
        field: &Field<'a>,
        record: &'a ReferenceRecord,
        model: ReportModel<'a>,
        picture: Option<&'a Picture>,
    ) -> Self {
        let lead = [
            "Reference values".to_owned(),
            count(record.faces as u64, "face", "faces"),
            format!("{} × {} pixels", record.pixels.width, record.pixels.height),
        ];
        Self {
            title: title.to_owned(),
            lead: lead.join(" · "),
            bands: field.bands(),
            model: Some(model),
            picture,
            statements: reference_statements(record),
            tables: surfaces(field).into_iter().collect(),
            provenance: provenance(&record.version, &record.scene, &record.scene_sha256, &record.timings),
            version: record.version.clone(),
            ..Self::default()
        }
    }

    /// The page of an analysis of the matrix.
    #[must_use]
    pub fn of_spectrum(title: &str, record: &'a SpectrumRecord) -> Self {
        let lead = [
            "Spectrum".to_owned(),
            count(record.unknowns, "unknown", "unknowns"),
            count(record.bands.len() as u64, "band", "bands"),
            record.method.clone(),
        ];
        Self {
            title: title.to_owned(),
            lead: lead.join(" · "),
            statements: spectrum_statements(record),
            plots: record.widest().map(moduli).into_iter().collect(),
            tables: vec![systems(record)],
            provenance: provenance(&record.version, &record.scene, &record.scene_sha256, &record.timings),
            version: record.version.clone(),
            ..Self::default()
        }
    }

    /// The page of a matrix of view factors, with its heat map.
    #[must_use]
    pub fn of_view_factors(
        factors: &ViewFactors,
        record: &'a ViewFactorsRecord,
        picture: Option<&'a Picture>,
    ) -> Self {
        let rows = factors.len() as u64;
        let points = factors.points.as_ref().map_or(0, |points| points.points.len() as u64);
        let mut lead = vec!["View factors".to_owned(), count(rows, "row", "rows")];
        lead.extend((points > 0).then(|| count(points, "point", "points")));
        Self {
            title: record.title.clone().unwrap_or_else(|| record.input.clone()),
            lead: lead.join(" · "),
            badges: badges("computed", true, &record.warnings).split_off(1),
            picture,
            picture_text: "The matrix, row by row, coloured by the logarithm of the factors".to_owned(),
            warnings: record.warnings.clone(),
            statements: view_factor_statements(record),
            plots: vec![closure(factors)],
            tables: vec![rows_table(factors)],
            provenance: provenance(&record.version, &record.input, &record.input_sha256, &record.timings),
            options: record.options.clone(),
            version: record.version.clone(),
            ..Self::default()
        }
    }
}

/// Values of faces, faces × bands, as quantities on the elements: one a band, or one where there is
/// one band.
#[must_use]
pub fn face_quantities(
    mesh: &Mesh,
    bands: &[String],
    values: &[f64],
    (name, symbol, unit): (&str, &str, &str),
) -> Vec<ElementValues> {
    let of = |(band, band_name): (usize, &String)| ElementValues {
        name: if bands.len() > 1 { format!("{name}, band {band_name}") } else { name.to_owned() },
        symbol: symbol.to_owned(),
        unit: unit.to_owned(),
        diverging: false,
        values: (0..mesh.len()).map(|leaf| values[mesh.face_of(leaf) * bands.len() + band]).collect(),
    };
    bands.iter().enumerate().map(of).collect()
}

fn trace_statements(run: &RunRecord) -> Vec<String> {
    let work = |name: &str| run.work.get(name).copied().unwrap_or(0);
    let mut said = Vec::new();
    said.extend(run.standard_error.map(|error| {
        format!(
            "The relative standard error of the irradiance is {} (L2 over the faces), after {} and {}.",
            percent(error),
            count(work("batches"), "batch", "batches"),
            count(work("paths"), "path", "paths"),
        )
    }));
    said.push(
        "Of every face the standard error is a quantity of its own in false colour; of a single element \
        none is stated."
            .to_owned(),
    );
    said
}

fn reference_statements(record: &ReferenceRecord) -> Vec<String> {
    let mut said = vec![
        format!(
            "The stated error of the irradiance is {} (L2 over the faces, the worst band), and {} of its own \
            value for the median face, after {}: standard error and form factors together, one standard \
            deviation.",
            percent(record.relative_error),
            percent(record.median_error),
            count(record.batches, "batch", "batches"),
        ),
        format!(
            "The standard error of a pixel is {} (L2 over the picture, the worst band).",
            percent(record.pixels.relative_error)
        ),
        format!("The values come from {}.", record.method),
    ];
    said.extend(record.conventions.iter().map(|convention| format!("Convention: {convention}.")));
    said
}

fn spectrum_statements(record: &SpectrumRecord) -> Vec<String> {
    let how = if record.method == "dense" {
        "All eigenvalues were computed by dense methods."
    } else {
        "Radii are estimates by the Lanczos process."
    };
    let widest = record.widest().map(|band| {
        format!(
            "The spectral radius of R F is {} in band {}, the largest of all bands: by so much an \
            iteration of Richardson's method reduces the error.",
            number(band.reflection_radius),
            band.band
        )
    });
    std::iter::once(how.to_owned()).chain(widest).collect()
}

/// Moduli of the eigenvalues of a band in falling order.
fn moduli(band: &BandSpectrum) -> ReportPlot {
    let line = |of: &crate::Eigenvalues| {
        let ranked = of.ranked();
        let stride = ranked.len().div_ceil(MOST_MODULI).max(1);
        let (x, y) = ranked.into_iter().step_by(stride).unzip();
        ReportSeries { name: of.matrix.clone(), colour: None, dashed: false, x, y }
    };
    ReportPlot {
        title: format!("Moduli of the eigenvalues, band {}", band.band),
        note: "Of every matrix in falling order. spectrum.csv has real and imaginary parts.".to_owned(),
        across: vec![(
            ReportAxis { label: "rank".to_owned(), logarithmic: false },
            band.eigenvalues.iter().map(line).collect(),
        )],
        up: ReportAxis { label: "modulus |λ|".to_owned(), logarithmic: true },
        polar: None,
    }
}

fn systems(record: &SpectrumRecord) -> ReportTable {
    let columns = [
        "Band",
        "Radius of R F",
        "Radius of Jacobi",
        "Radius of Gauss–Seidel",
        "cond Φ",
        "cond Ψ",
        "cond Θ",
        "Largest imaginary part",
    ];
    let row = |band: &BandSpectrum| {
        let numbers = [
            Some(band.reflection_radius),
            band.jacobi_radius,
            Some(band.gauss_seidel_radius),
            band.condition_phi,
            band.condition_psi,
            band.condition_theta,
            band.largest_imaginary,
        ];
        std::iter::once(ReportCell::Text(band.band.clone())).chain(numbers.map(ReportCell::Number)).collect()
    };
    ReportTable {
        title: "Systems".to_owned(),
        note: "Φ = I − R F, Ψ = H Φ and Θ = H^½ Φ H^(−½) with H = A R⁻¹; conditions in the 2-norm."
            .to_owned(),
        columns: columns.map(ReportColumn::new).into(),
        rows: record.bands.iter().map(row).collect(),
    }
}

fn view_factor_statements(record: &ViewFactorsRecord) -> Vec<String> {
    let mut said = Vec::new();
    said.extend(record.form_factor_error.row_max.map(|error| {
        let asked = record.form_factor_error.tolerance;
        let asked = asked.map(|t| format!(", {} asked for", number(t))).unwrap_or_default();
        format!("The factors of a row are off by about {} together at most{asked}.", number(error))
    }));
    said.extend(record.closure.max.map(|largest| {
        format!("Row sums differ from 1 by {} at most; openings count as well.", number(largest))
    }));
    said.extend(
        record
            .dropped_max
            .filter(|dropped| *dropped > 0.0)
            .map(|dropped| format!("The factors that a row dropped add up to {} at most.", number(dropped))),
    );
    said.extend(record.reciprocity.map(|violation| {
        format!("Aᵢ Fᵢⱼ = Aⱼ Fⱼᵢ holds within {} among the pairs that were checked.", number(violation))
    }));
    said.extend(record.enforced.as_ref().and_then(|change| change.row_max).map(|change| {
        format!("So that rows close, those were changed by {} together at most.", number(change))
    }));
    said
}

/// How many rows close how well.
fn closure(factors: &ViewFactors) -> ReportPlot {
    let defects: Vec<f64> =
        factors.defects().into_iter().map(|defect| defect.max(crate::plot::SMALLEST_ON_LOG_AXIS)).collect();
    let found = bins(&defects);
    let all = found.first().zip(found.last()).map(|(first, last)| first.0..=last.0);
    let rows = |bin: i32| found.iter().find(|(own, _)| *own == bin).map_or(0.0, |(_, rows)| *rows as f64);
    let (x, y) = all.into_iter().flatten().map(|bin| ((edge(bin) * edge(bin + 1)).sqrt(), rows(bin))).unzip();
    let line = ReportSeries { name: "rows".to_owned(), colour: None, dashed: false, x, y };
    ReportPlot {
        title: "Closure".to_owned(),
        note: "How many rows have a sum so far from 1, in classes of half a decade.".to_owned(),
        across: vec![(ReportAxis { label: "|Σ F − 1| of a row".to_owned(), logarithmic: true }, vec![line])],
        up: ReportAxis { label: "rows".to_owned(), logarithmic: false },
        polar: None,
    }
}

fn rows_table(factors: &ViewFactors) -> ReportTable {
    let columns = ["Row", "Area, m²", "Emissivity", "Σ F", "Stated error of Σ F", "Dropped"];
    let of = &factors.surfaces;
    let row = |i: usize| {
        let emissivity = of.emissivity.as_ref().map(|values| values[i]);
        let numbers = [
            Some(of.area[i]),
            emissivity,
            Some(factors.row_sums[i]),
            Some(of.row_error[i]),
            Some(factors.row_dropped[i]),
        ];
        std::iter::once(ReportCell::Text(of.names[i].clone()))
            .chain(numbers.map(ReportCell::Number))
            .collect()
    };
    ReportTable {
        title: "Rows".to_owned(),
        note: "Sums of the factors of every row.".to_owned(),
        columns: columns.map(ReportColumn::new).into(),
        rows: (0..factors.len()).map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{names, sample};
    use crate::{Eigenvalues, SurfaceData};

    #[test]
    fn quantities_of_faces_stand_on_their_elements() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let found = face_quantities(&mesh, &bands, &values, ("Error", "s", "W/m²"));
        assert_eq!(found[0].values, [1.0, 3.0, 5.0]);
        assert_eq!((found[1].name.as_str(), &found[1].values[..]), ("Error, band g", &[2.0, 4.0, 6.0][..]));
    }

    #[test]
    fn a_spectrum_has_its_moduli_and_its_systems() {
        let eigenvalues =
            vec![Eigenvalues { matrix: "theta".to_owned(), values: vec![[0.0, 0.5], [0.6, 0.8]] }];
        let band = BandSpectrum { band: "g".to_owned(), eigenvalues, ..BandSpectrum::default() };
        let record = SpectrumRecord { bands: vec![band], unknowns: 2, ..SpectrumRecord::default() };
        let page = ReportPage::of_spectrum("room", &record);
        assert_eq!(page.plots[0].across[0].1[0].y, [1.0, 0.5]);
        assert_eq!((page.tables[0].rows.len(), page.tables[0].rows[0].len()), (1, 8));
        let mut out = Vec::new();
        page.write(&mut out).unwrap();
        assert!(String::from_utf8(out).unwrap().contains("Moduli of the eigenvalues, band g"));
    }

    #[test]
    fn a_matrix_has_its_rows_and_its_closure() {
        let surfaces = SurfaceData {
            names: vec!["a".to_owned(), "b".to_owned()],
            area: vec![1.0; 2],
            emissivity: None,
            row_error: vec![0.0; 2],
        };
        let factors = ViewFactors::new(surfaces, None, |i, row, _| {
            row.fill(0.0);
            row[1 - i] = if i == 0 { 0.9 } else { 0.999 };
        });
        let record = ViewFactorsRecord { input: "two.obj".to_owned(), ..ViewFactorsRecord::default() };
        let page = ReportPage::of_view_factors(&factors, &record, None);
        assert_eq!(page.lead, "View factors · 2 rows");
        let rows = &page.plots[0].across[0].1[0].y;
        assert!((rows.iter().sum::<f64>() - 2.0).abs() < 1e-12 && rows.len() > 2, "{rows:?}");
        assert_eq!(page.tables[0].rows[1][0], ReportCell::Text("b".to_owned()));
    }
}
