//! What rows came to: the solution, and how exact it is.
//!
//! *Chance.* Every row is known from replicates, y_r = D_r + C_r B. The variance of the mean of a
//! face is that of their differences. What elements receive too much or too little is reflected, and
//! comes to all faces evenly; this part is known from the few replicates alone.
//!
//! *Elements.* Rows see the mean of an element where a point sends more or less. What that leaves
//! out is d = d_A + chance = d_B + chance by each half of the replicates, so that Σ A d_A d_B over
//! the faces is the square of its norm in the mean, with a standard deviation of √Σ (A d_A d_B)².
//! Of the light of lamps it is found by rays that look at lamps from where they end, unless all of
//! them do; of indirect light from how the four parts of an element differ, which is at least what
//! the parts leave out.

use fredholm_coupling::MeshError;
use fredholm_linop::{MultiVector, Report, SecondKind, Stop};
use fredholm_montecarlo::rows::{Looks, REPLICATES, Rows};

use super::SOLVER;
use super::ground::Ground;
use crate::error::{Error, ErrorKind};
use crate::registry;
use crate::solution::solve_failure;
use crate::stages::Signals;

/// Residual of the rows over the accuracy asked for, and iterations at most.
const RESIDUAL: f64 = 0.01;
const MOST_ITERATIONS: usize = 500;
/// Stated error over the standard error, at least: faces may err together.
const CONFIDENCE: f64 = 1.25;
/// Own standard error of a large face over the accuracy from which on it is uncertain: few are off
/// by four times as much.
const MOST_OF_FACE: f64 = 1.25;
/// Standard errors that are stated for a single face.
const OF_FACE: f64 = 2.0;
/// The same of what all faces have in common, which only the replicates tell: the 95 % quantile of
/// Student's distribution with three degrees of freedom.
const OF_ALL: f64 = 3.182;

/// A solution of some rows.
pub(super) struct Estimate {
    pub(super) irradiance: MultiVector<f64>,
    pub(super) direct: MultiVector<f64>,
    pub(super) report: Report,
    pub(super) error: MeshError,
    /// Relative error by chance, per band, with its confidence.
    pub(super) noise: Vec<f64>,
    /// Relative error of the elements in the worst band: as it is stated, and what it is at least.
    pub(super) elements: f64,
    pub(super) elements_at_least: f64,
    /// Variance of the mean of each family over one ray of each part and replicate, relative to the
    /// square of the norm, in the band with the most noise; 1/m².
    pub(super) variance: Vec<f64>,
    /// What each family of a large face has of the square of the norm in this band; infinite for
    /// others.
    pub(super) large: Vec<f64>,
    /// Own standard error of the large face of each family over [`MOST_OF_FACE`] accuracies; 0 for
    /// others.
    pub(super) uncertainties: Vec<f64>,
    /// What the parts of each family contribute to the square of the error of the elements.
    pub(super) differences: Vec<f64>,
}

impl Estimate {
    /// Solves rows, of which so much of every part is exposed. What is sent of reflected light is
    /// found from what it was before, where that is known.
    pub(super) fn new(
        ground: &Ground,
        rows: &Rows,
        (exposed, sent): (&[f64], &mut Option<MultiVector<f64>>),
        (looks, accuracy): (Looks, f64),
        signals: &Signals,
    ) -> Result<Self, Error> {
        let factor = ground.factor(exposed);
        let [direct, reflected] = rows.lamplight();
        // Of which light the elements' means are reflected.
        let everywhere = looks == Looks::Everywhere;
        let source = if everywhere { reflected } else { sum(&direct, &reflected) };
        let right = times(&factor, &source);
        let input = |error| Error::new(ErrorKind::Input, error);
        let system = SecondKind::new(rows, factor.clone()).map_err(input)?;
        let sent = sent.get_or_insert_with(|| right.clone());
        let stop = Stop { tolerance: RESIDUAL * accuracy, max_iterations: MOST_ITERATIONS };
        let solver = registry::build(SOLVER).map_err(|error| Error::new(ErrorKind::Input, error))?;
        let solved = solver.solver.solve(&system, &right, sent, &stop, &mut signals.clone());
        let report = solved.map_err(solve_failure)?;
        let replicates = rows.replicates(sent);
        let irradiance = mean(&replicates);
        let norms = ground.norms(&irradiance);
        let absorbing = ground.absorbing(exposed);
        let deviations = replicates.each_ref().map(|replicate| difference(replicate, &irradiance));
        let mut variances = MultiVector::zeros(ground.mesh.faces().len(), ground.bands);
        let mut common = vec![0.0; ground.bands];
        for deviation in &deviations {
            let of_faces = ground.means(deviation);
            let terms = variances.as_mut_slice().iter_mut().zip(of_faces.as_slice());
            terms.for_each(|(variance, d)| *variance += d * d / PAIRS);
            let reflected = ground.reflected(deviation, &absorbing);
            common.iter_mut().zip(reflected).for_each(|(variance, d)| *variance += d * d / PAIRS);
        }
        let area = ground.area();
        let together =
            |band: usize| OF_ALL * (area * common[band] / norms[band].max(f64::MIN_POSITIVE)).sqrt();
        let noise: Vec<f64> = (0..ground.bands)
            .map(|band| ground.noise(&variances, &norms, band).hypot(together(band)))
            .collect();
        let halves = [0, 2].map(|first| half(&replicates, first));
        let direct_halves = {
            let directs = rows.direct_replicates();
            [0, 2].map(|first| half(&directs, first))
        };
        // What the parts of a family send of indirect light beside their mean, and what that comes to.
        let apart = [0, 1].map(|k| {
            let indirect = difference(&halves[k], &direct_halves[k]);
            ground.apart(&times(&factor, &indirect), exposed)
        });
        let left_out = [0, 1].map(|k| {
            let second = k == 1;
            let mut found = rows.half(second, &apart[k]);
            if !everywhere {
                let sent = times(&factor, &direct_halves[k]);
                found = sum(&found, &rows.left_out(second, &sent));
            }
            ground.of_faces(&found, &absorbing)
        });
        let found: Vec<[f64; 2]> =
            (0..ground.bands).map(|band| ground.left_out(&left_out, &norms, band)).collect();
        let of_band = |&[square, deviation]: &[f64; 2]| (square.max(0.0) + deviation).sqrt();
        let relative =
            noise.iter().zip(&found).map(|(noise, found)| noise.hypot(of_band(found))).collect::<Vec<_>>();
        let at_least = |&[square, deviation]: &[f64; 2]| (square - 2.0 * deviation).max(0.0).sqrt();
        let worst = noise.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(band, _)| band);
        let products = left_out[0].as_slice().iter().zip(left_out[1].as_slice());
        let per_face: Vec<f64> = variances
            .as_slice()
            .iter()
            .zip(products)
            .zip(common.iter().cycle())
            .map(|((own, (a, b)), common)| {
                (OF_FACE * OF_FACE * own + OF_ALL * OF_ALL * common + (a * b).max(0.0)).sqrt()
            })
            .collect();
        let bands = ground.bands;
        let largest = |band| per_face.iter().skip(band).step_by(bands).copied().fold(0.0, f64::max);
        Ok(Self {
            uncertainties: ground.uncertainties(&irradiance, &variances, MOST_OF_FACE * accuracy),
            large: ground.large(&irradiance, (worst, norms[worst])),
            variance: ground.variance_of_a_ray(&irradiance, &deviations, rows, (worst, norms[worst])),
            error: MeshError { relative_l2: relative, largest: (0..bands).map(largest).collect(), per_face },
            elements: found.iter().map(of_band).fold(0.0, f64::max),
            elements_at_least: found.iter().map(at_least).fold(0.0, f64::max),
            irradiance: ground.evened(&irradiance, &direct, exposed),
            direct,
            report,
            noise,
            differences: ground.products(&apart, &norms),
        })
    }

    /// The stated error in the worst band.
    pub(super) fn stated(&self) -> f64 {
        self.error.relative_l2.iter().copied().fold(0.0, f64::max)
    }

    /// The error by chance in the worst band.
    pub(super) fn worst_noise(&self) -> f64 {
        self.noise.iter().copied().fold(0.0, f64::max)
    }
}

/// R (R − 1): squares of deviations over it are the variance of the mean of R replicates.
pub(super) const PAIRS: f64 = (REPLICATES * (REPLICATES - 1)) as f64;

/// The 95 % quantile of the root of a mean of k independent squares over its estimate from
/// replicates, which has R − 1 degrees of freedom for each: √F(k, (R − 1) k), no less than
/// [`CONFIDENCE`] (E. Paulson, Ann. Math. Stat. 13, 233–235, 1942).
pub(super) fn confidence(independent: f64) -> f64 {
    let above = 2.0 / (9.0 * independent.max(1.0));
    let below = above / (REPLICATES - 1) as f64;
    let (a, b, z) = (1.0 - above, 1.0 - below, 1.645);
    let root = (b * b * above + a * a * below - z * z * above * below).sqrt();
    ((a * b + z * root) / (b * b - z * z * below)).powf(1.5).max(CONFIDENCE)
}

fn combined(a: &MultiVector<f64>, b: &MultiVector<f64>, of: impl Fn(f64, f64) -> f64) -> MultiVector<f64> {
    let mut out = a.clone();
    out.as_mut_slice().iter_mut().zip(b.as_slice()).for_each(|(a, b)| *a = of(*a, *b));
    out
}

fn times(a: &MultiVector<f64>, b: &MultiVector<f64>) -> MultiVector<f64> {
    combined(a, b, |a, b| a * b)
}

fn sum(a: &MultiVector<f64>, b: &MultiVector<f64>) -> MultiVector<f64> {
    combined(a, b, |a, b| a + b)
}

fn difference(a: &MultiVector<f64>, b: &MultiVector<f64>) -> MultiVector<f64> {
    combined(a, b, |a, b| a - b)
}

/// The mean of two replicates, the first of which is given.
fn half(replicates: &[MultiVector<f64>; REPLICATES], first: usize) -> MultiVector<f64> {
    combined(&replicates[first], &replicates[first + 1], |a, b| 0.5 * (a + b))
}

fn mean(replicates: &[MultiVector<f64>; REPLICATES]) -> MultiVector<f64> {
    combined(&half(replicates, 0), &half(replicates, 2), |a, b| 0.5 * (a + b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_independent_squares_need_more_confidence() {
        // √F of (1, 3), (10, 30) and (30, 90) degrees of freedom at 95 %, from tables: √10.13, √2.16
        // and √1.59.
        assert!((confidence(1.0) - 3.18).abs() < 0.1, "{}", confidence(1.0));
        assert!((confidence(10.0) - 1.471).abs() < 0.01, "{}", confidence(10.0));
        assert!((confidence(30.0) - 1.262).abs() < 0.01, "{}", confidence(30.0));
        assert!((confidence(1e6) - CONFIDENCE).abs() < 1e-12);
    }
}
