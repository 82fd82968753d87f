//! From the system to what is told of it.

use fredholm_direct::{Spectrum, spectrum};
use fredholm_iterative::{gauss_seidel_radius, ritz_values};
use fredholm_linop::SecondKind;
use fredholm_report::{BandSpectrum, Eigenvalues};

use crate::error::{Error, ErrorKind};
use crate::solution::solve_failure;
use crate::stages::Stages;

/// All there is, by dense methods.
pub(super) fn exact(
    system: &SecondKind<'_, f64>,
    bands: &[String],
    stages: &mut Stages,
) -> Result<Vec<BandSpectrum>, Error> {
    let mut found = Vec::new();
    for (rhs, band) in bands.iter().enumerate() {
        let work = || spectrum(system, rhs).map_err(|error| Error::new(ErrorKind::NotConverged, error));
        found.push(told(band, &stages.run(&format!("spectrum of {band}"), work)?));
    }
    Ok(found)
}

fn told(band: &str, found: &Spectrum) -> BandSpectrum {
    let complex =
        [("reflection", &found.reflection), ("jacobi", &found.jacobi), ("gauss_seidel", &found.gauss_seidel)];
    let eigenvalues = complex.map(|(matrix, values)| Eigenvalues {
        matrix: matrix.to_owned(),
        values: values.iter().map(|value| [value.re, value.im]).collect(),
    });
    let real = [("psi", &found.psi), ("theta", &found.theta)].map(|(matrix, values)| list(matrix, values));
    BandSpectrum {
        band: band.to_owned(),
        reflection_radius: found.reflection_radius(),
        jacobi_radius: Some(found.jacobi_radius()),
        gauss_seidel_radius: found.gauss_seidel_radius(),
        condition_phi: Some(found.condition_phi),
        condition_psi: found.condition_psi(),
        condition_theta: found.condition_theta(),
        largest_imaginary: Some(found.reflection.iter().map(|value| value.im.abs()).fold(0.0, f64::max)),
        m_matrix: Some(found.m_matrix),
        stieltjes: Some(found.stieltjes()),
        irreducible: Some(found.irreducible),
        symmetry_defect: Some(found.symmetry_defect),
        field_of_values: Some(found.field_of_values),
        eigenvalues: eigenvalues.into_iter().chain(real).collect(),
    }
}

fn list(matrix: &str, values: &[f64]) -> Eigenvalues {
    Eigenvalues { matrix: matrix.to_owned(), values: values.iter().map(|&value| [value, 0.0]).collect() }
}

/// What sweeps and the Lanczos process tell: the extreme eigenvalues of Θ, which are those of I − R
/// F, and the radius of Gauss–Seidel.
pub(super) fn estimated(
    system: &SecondKind<'_, f64>,
    bands: &[String],
    steps: usize,
    stages: &mut Stages,
) -> Result<Vec<BandSpectrum>, Error> {
    let watch = stages.watch;
    let ritz = stages.run("Lanczos process", || ritz_values(system, steps, watch).map_err(solve_failure))?;
    let radii = stages.run("sweeps", || gauss_seidel_radius(system, steps, watch).map_err(solve_failure))?;
    stages.check()?;
    Ok(bands
        .iter()
        .zip(ritz.iter().zip(radii))
        .map(|(band, (ritz, radius))| estimate(band, ritz, radius))
        .collect())
}

fn estimate(band: &str, ritz: &[f64], gauss_seidel_radius: f64) -> BandSpectrum {
    let (low, high) = (ritz.first().copied().unwrap_or(1.0), ritz.last().copied().unwrap_or(1.0));
    let reflection: Vec<f64> = ritz.iter().map(|value| 1.0 - value).collect();
    BandSpectrum {
        band: band.to_owned(),
        reflection_radius: reflection.iter().map(|value| value.abs()).fold(0.0, f64::max),
        gauss_seidel_radius,
        condition_theta: (low > 0.0).then_some(high / low),
        eigenvalues: vec![list("reflection", &reflection), list("theta", ritz)],
        ..BandSpectrum::default()
    }
}
