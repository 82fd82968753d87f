//! The stated error of the irradiance of the faces: what constants on elements miss, and what the
//! form factors lose or add.
//!
//! Both are sources of light that the solution does not have, and are reflected as light is: an
//! error δE of the irradiance follows from its source p (W) by (I − D G) δB = D p, δE = (p + G
//! δB)/A, with the matrix that is there. Sources are, side by side:
//!
//! - the residual of the continuous equation at sampled points ([`fredholm_coupling::Constants`]),
//!   once a draw;
//! - the exchange that row sums of a closed scene lack or have too much of, δG_ij = G_ij (λ_i +
//!   λ_j) with λ the halves of the defects, as the least change that closes the rows has it; of an
//!   open scene only what is above 1, which no scene has;
//! - in an open scene the stated errors of the rows times the radiosity that they see. In a closed
//!   one these errors cancel in the sums, and are not amplified.

use fredholm_coupling::{Assembled, Constants, CouplingError, Extent, MeshError, Radiosity, Residual};
use fredholm_linop::{MultiVector, Report, Stop, StopReason, Storage, Watch};
use fredholm_mesh::Mesh;

use crate::error::{Error, ErrorKind};
use crate::problem::Problem;
use crate::registry;
use crate::solution::{coupling_failure, solve_with};
use crate::watcher::Watcher;

/// What an error of first order is multiplied with: of a coarse mesh it is down to half of the true
/// one.
const FIRST_ORDER_SAFETY: f64 = 2.0;
/// Sources of an error need not be followed further: relative residual, and iterations.
const SOURCES_STOP: Stop = Stop { tolerance: 1e-3, max_iterations: 10_000 };
/// Stated errors of a row within which its sum is that of a closed scene, and the error that is
/// always allowed.
const STATED_ERRORS_OFF_ONE: f64 = 3.0;
const CLOSED_TOLERANCE: f64 = 1e-6;
/// Root mean square over the mean of the irradiance that unshot light comes to.
const ROOT_MEAN_SQUARE_OVER_MEAN: f64 = 1.5;
/// Share of the sampled square of an error that is left, however large the noise.
const LEAST_SHARE_LEFT: f64 = 0.25;

/// Estimates the error of a solution `x`. There is no estimate where the solution is not within its
/// tolerance or the sources of errors could not be followed.
pub(crate) fn estimate<S: Storage>(
    problem: &Problem,
    radiosity: &Radiosity,
    assembled: &Assembled<S>,
    (x, report): (&MultiVector<f64>, &Report),
    watcher: Watcher,
) -> Result<Option<MeshError>, Error> {
    if report.reason != StopReason::Converged || watcher.go_on().is_break() {
        return Ok(None);
    }
    let matrix = &assembled.matrix;
    let irradiance = radiosity.means(matrix, x).irradiance;
    let patches = problem.patches();
    let constants = Constants {
        patches: &patches,
        occluders: &problem.occluders,
        elements: radiosity.elements(),
        reflectance: radiosity.reflectance(),
        radiosity: x,
        irradiance: &irradiance,
    };
    let residual = match constants.residual(watcher.watch) {
        Ok(residual) => residual,
        Err(CouplingError::Interrupted { .. }) => return Ok(None),
        Err(error) => return Err(coupling_failure(error)),
    };
    let rows = Rows::new(radiosity, assembled, x, &irradiance);
    let Some(errors) = follow(radiosity, assembled, (&residual, &rows), watcher)? else { return Ok(None) };
    Ok(Some(stated(&problem.mesh, &irradiance, &errors, residual.draws)))
}

/// Errors of the form factors as sources, W, elements × bands.
struct Rows {
    /// What closes the rows.
    closing: MultiVector<f64>,
    /// Stated errors of the rows.
    stated: MultiVector<f64>,
    closed: bool,
}

impl Rows {
    fn new<S: Storage>(
        radiosity: &Radiosity,
        assembled: &Assembled<S>,
        x: &MultiVector<f64>,
        irradiance: &MultiVector<f64>,
    ) -> Self {
        let (sizes, sums) = (radiosity.elements(), radiosity.closure(&assembled.matrix));
        let error = |i: usize| assembled.error[i] / sizes[i].area;
        let whole = |i: usize| sizes[i].exposed >= sizes[i].area;
        let closed = (0..sizes.len())
            .filter(|&i| whole(i))
            .all(|i| (sums[i] - 1.0).abs() <= (STATED_ERRORS_OFF_ONE * error(i)).max(CLOSED_TOLERANCE));
        let half = |i: usize| {
            let defect = 0.5 * (1.0 - sums[i]);
            if closed { defect } else { defect.min(0.0) }
        };
        let (n, bands) = (x.dim(), x.rhs_count());
        let weighed = MultiVector::from_fn(n, bands, |i, l| half(i) * x.row(i)[l]);
        let given = radiosity.means(&assembled.matrix, &weighed).irradiance;
        let closing = MultiVector::from_fn(n, bands, |i, l| {
            sizes[i].area * (half(i) * irradiance.row(i)[l] + given.row(i)[l])
        });
        let area: f64 = sizes.iter().map(|size| size.area).sum();
        let mean = |l: usize| (0..n).map(|i| sizes[i].exposed * x.row(i)[l]).sum::<f64>() / area;
        let means: Vec<f64> = (0..bands).map(mean).collect();
        let stated = MultiVector::from_fn(n, bands, |i, l| {
            // What an element sees on average, no less than what there is on average.
            let seen = sums[i] * sizes[i].exposed;
            let seen = if seen > 0.0 { sizes[i].area * irradiance.row(i)[l] / seen } else { 0.0 };
            assembled.error[i] * seen.max(means[l])
        });
        Self { closing, stated, closed }
    }
}

/// δE of the elements, W/m²: elements × (right-hand sides of the residual, closing rows, stated
/// errors of rows).
fn follow<S: Storage>(
    radiosity: &Radiosity,
    assembled: &Assembled<S>,
    (residual, rows): (&Residual, &Rows),
    watcher: Watcher,
) -> Result<Option<MultiVector<f64>>, Error> {
    let bands = rows.closing.rhs_count();
    let sampled = residual.draws * bands;
    let rhs_count = sampled + 2 * bands;
    let source = MultiVector::from_fn(rows.closing.dim(), rhs_count, |i, rhs| match rhs {
        _ if rhs < sampled => residual.power.row(i)[rhs],
        _ if rhs < sampled + bands => rows.closing.row(i)[rhs - sampled],
        _ => rows.stated.row(i)[rhs - sampled - bands],
    });
    let stays = |rhs: usize| rows.closed && rhs >= sampled + bands;
    let (scaling, sizes) = (radiosity.scaling(), radiosity.elements());
    let emitted = MultiVector::from_fn(source.dim(), rhs_count, |i, rhs| {
        if stays(rhs) { 0.0 } else { scaling.row(i)[rhs % bands] * source.row(i)[rhs] }
    });
    let reflectance =
        MultiVector::from_fn(source.dim(), rhs_count, |i, rhs| radiosity.reflectance().row(i)[rhs % bands]);
    let system = Radiosity::new(sizes.to_vec(), reflectance, emitted).map_err(coupling_failure)?;
    let solver =
        registry::build(registry::USUAL_SOLVER).map_err(|error| Error::new(ErrorKind::Input, error))?;
    let (change, report) =
        solve_with(&*solver.solver, &system, &assembled.matrix, watcher.until(SOURCES_STOP))?;
    if report.reason != StopReason::Converged {
        return Ok(None);
    }
    let received = system.means(&assembled.matrix, &change).irradiance;
    Ok(Some(MultiVector::from_fn(source.dim(), rhs_count, |i, rhs| {
        source.row(i)[rhs] / sizes[i].area + received.row(i)[rhs]
    })))
}

/// The stated error of the faces: the sampled part without most of its noise, and the errors of the
/// form factors.
fn stated(mesh: &Mesh, irradiance: &MultiVector<f64>, errors: &MultiVector<f64>, draws: usize) -> MeshError {
    let (bands, areas) = (irradiance.rhs_count(), areas(mesh));
    let (values, errors) = (of_faces(mesh, irradiance), of_faces(mesh, errors));
    let sampled = Sampled::new(&errors, (draws, bands), &areas);
    let delta = |face: usize, band: usize| {
        let row = errors.row(face);
        let rows = row[draws * bands + band].abs() + row[(draws + 1) * bands + band].abs();
        FIRST_ORDER_SAFETY * sampled.kept[band] * sampled.mean(row, band).abs() + rows
    };
    let per_face = (0..areas.len()).flat_map(|face| (0..bands).map(move |band| (face, band)));
    MeshError::new(per_face.map(|(face, band)| delta(face, band)).collect(), &values, &areas)
}

/// The mean of several draws, and how much of it is left without their noise.
struct Sampled {
    draws: usize,
    bands: usize,
    /// Per band.
    kept: Vec<f64>,
}

impl Sampled {
    fn new(errors: &MultiVector<f64>, (draws, bands): (usize, usize), areas: &[f64]) -> Self {
        let mut sampled = Self { draws, bands, kept: vec![1.0; bands] };
        if draws > 1 {
            sampled.kept = (0..bands).map(|band| sampled.without_noise(errors, band, areas)).collect();
        }
        sampled
    }

    fn mean(&self, row: &[f64], band: usize) -> f64 {
        (0..self.draws).map(|draw| row[draw * self.bands + band]).sum::<f64>() / self.draws as f64
    }

    /// √ of the share of the square of the mean that is not the variance of the mean.
    fn without_noise(&self, errors: &MultiVector<f64>, band: usize, areas: &[f64]) -> f64 {
        let (mut square, mut noise) = (0.0, 0.0);
        for (row, area) in errors.rows().zip(areas) {
            let mean = self.mean(row, band);
            let spread: f64 =
                (0..self.draws).map(|draw| (row[draw * self.bands + band] - mean).powi(2)).sum();
            square += area * mean * mean;
            noise += area * spread / (self.draws * (self.draws - 1)) as f64;
        }
        if square > 0.0 { (1.0 - noise / square).max(LEAST_SHARE_LEFT).sqrt() } else { 1.0 }
    }
}

/// Areas of the faces, m².
fn areas(mesh: &Mesh) -> Vec<f64> {
    mesh.faces().iter().map(|face| face.area).collect()
}

/// Area means over the faces.
fn of_faces(mesh: &Mesh, values: &MultiVector<f64>) -> MultiVector<f64> {
    MultiVector::from_fn(mesh.faces().len(), values.rhs_count(), |face, rhs| {
        let part = |leaf: usize| mesh.patch(leaf).area() * values.row(leaf)[rhs];
        mesh.leaves_of_face(face).map(part).sum::<f64>() / mesh.faces()[face].area
    })
}

/// The same of a field without a matrix, of which `unshot` (W/m²) is still to be sent. Sources of
/// errors are spread evenly from their first reflection on, and what is unshot from the beginning,
/// as all reflections together spread light. There is no estimate where `watch` breaks.
pub(crate) fn of_shooting(
    mesh: &Mesh,
    constants: &Constants<'_>,
    unshot: &MultiVector<f64>,
    watch: &dyn Watch,
) -> Result<Option<MeshError>, Error> {
    if watch.go_on().is_break() {
        return Ok(None);
    }
    let residual = match constants.residual(watch) {
        Ok(residual) => residual,
        Err(CouplingError::Interrupted { .. }) => return Ok(None),
        Err(error) => return Err(coupling_failure(error)),
    };
    let (bands, sizes) = (unshot.rhs_count(), constants.elements);
    let sampled = residual.draws * bands;
    let all = || 0..mesh.len();
    let reflected = |rhs: usize| -> f64 {
        let rho = |i: usize| constants.reflectance.row(i)[rhs % bands];
        all().map(|i| rho(i) * residual.power.row(i)[rhs]).sum()
    };
    let left = |band: usize| all().map(|i| sizes[i].exposed * unshot.row(i)[band].abs()).sum::<f64>();
    let missing: Vec<f64> = (0..bands).map(|band| left(band) / absorbing(constants, band)).collect();
    let ambient: Vec<f64> = (0..sampled)
        .map(|rhs| reflected(rhs) / absorbing(constants, rhs % bands))
        .chain(missing.iter().map(|missing| ROOT_MEAN_SQUARE_OVER_MEAN * missing))
        .collect();
    let errors = MultiVector::from_fn(mesh.len(), sampled + 2 * bands, |i, rhs| match rhs {
        _ if rhs < sampled => residual.power.row(i)[rhs] / sizes[i].area + ambient[rhs],
        _ if rhs < sampled + bands => ambient[rhs],
        _ => 0.0,
    });
    // What the error is relative to has the light in it that is still to come.
    let whole = MultiVector::from_fn(mesh.len(), bands, |i, l| constants.irradiance.row(i)[l] + missing[l]);
    Ok(Some(stated(mesh, &whole, &errors, residual.draws)))
}

/// Σ w A (1 − ρ), m²: what absorbs.
fn absorbing(constants: &Constants<'_>, band: usize) -> f64 {
    let part = |(i, size): (usize, &Extent)| size.exposed * (1.0 - constants.reflectance.row(i)[band]);
    constants.elements.iter().enumerate().map(part).sum()
}
