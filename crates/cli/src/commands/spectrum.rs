//! `fredholm spectrum`.

use std::path::Path;

use fredholm_report::{BandSpectrum, SPECTRUM_FILES, SpectrumRecord};
use fredholm_study::Error;

use crate::args::SpectrumArgs;
use crate::ending::Ending;
use crate::output;
use crate::start::Start;
use crate::summary::Lines;

/// Analyses the matrix of a scene.
pub(crate) fn spectrum(args: &SpectrumArgs) -> Result<Ending, Error> {
    let start = Start {
        scene: &args.scene,
        output: args.output.as_ref(),
        verb: "spectrum",
        threads: args.threads,
        memory: args.memory,
        log: args.log,
    };
    start.run(|folder, terminal| {
        let (record, ended) = fredholm_study::spectrum(&args.scene, &args.options(), folder, terminal)?;
        if !args.log.quiet {
            print(folder.path(), &record)?;
        }
        Ok(ended.into())
    })
}

/// Bands that are shown.
const BANDS: usize = 8;

/// Prints what was found in each band.
fn print(folder: &Path, record: &SpectrumRecord) -> Result<(), Error> {
    let mut lines = Lines::default();
    lines.add("plot", folder.join(SPECTRUM_FILES[1]).display().to_string());
    lines.add("unknowns", format!("{} in each band, {} methods", record.unknowns, record.method));
    record.bands.iter().take(BANDS).for_each(|band| described(band, &mut lines));
    if record.bands.len() > BANDS {
        lines.add("", format!("and {} bands more: see {}", record.bands.len() - BANDS, SPECTRUM_FILES[2]));
    }
    output::print(&lines.under(&format!("{} → {}", record.scene, folder.display())))
}

fn described(band: &BandSpectrum, lines: &mut Lines) {
    let jacobi = band.jacobi_radius.map(|radius| format!(", ρ(J) {radius:.6}")).unwrap_or_default();
    lines.add(
        &band.band,
        format!("ρ(RF) {:.6}{jacobi}, ρ(L₁) {:.6}", band.reflection_radius, band.gauss_seidel_radius),
    );
    let conditions = [("Φ", band.condition_phi), ("Ψ", band.condition_psi), ("Θ", band.condition_theta)];
    let conditions = conditions.into_iter().filter_map(|(name, value)| Some(format!("{name} {:.4}", value?)));
    lines.add("  cond₂", conditions.collect::<Vec<_>>().join(", "));
    let told = |name: &str, value: Option<bool>| {
        value.map(|yes| format!("{name}: {}", if yes { "yes" } else { "no" }))
    };
    let properties = [
        told("M-matrix", band.m_matrix),
        told("Stieltjes", band.stieltjes),
        told("irreducible", band.irreducible),
        band.symmetry_defect.map(|defect| format!("symmetry defect of Ψ {defect:.1e}")),
        band.largest_imaginary.map(|imaginary| format!("largest imaginary part {imaginary:.1e}")),
    ];
    let properties: Vec<String> = properties.into_iter().flatten().collect();
    lines.add_some("  properties", (!properties.is_empty()).then(|| properties.join(", ")));
    let field =
        band.field_of_values.map(|[low, high, across]| format!("{low:.4} … {high:.4}, ± {across:.4} i"));
    lines.add_some("  values in", field);
}
