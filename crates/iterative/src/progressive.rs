//! Progressive radiosity, Southwell's relaxation as shooting: the patch with the most unshot power
//! sends it to all others.
//!
//! Source: M. F. Cohen, S. E. Chen, J. R. Wallace, D. P. Greenberg, A progressive refinement
//! approach to fast radiosity image generation, SIGGRAPH 1988, DOI 10.1145/54852.378487; S. J.
//! Gortler, M. F. Cohen, P. Slusallek, IEEE Computer Graphics and Applications 14 (6), 1994, DOI
//! 10.1109/38.329094. The residual r is the unshot radiosity ΔB, and the patch chosen has the
//! largest A_i |r_i|; x_i += r_i/a_ii, r −= A e_i r_i/a_ii. Where no areas are given, what a patch
//! sends, Σ_k |k_ki| = A_i Σ_k F_ik, stands for its area. From x = 0 no application is needed, and
//! a shot reads one column: the matrix may be one that computes its columns when they are asked
//! for.
//!
//! Overshooting (M. Feda, W. Purgathofer, Accelerating radiosity by overshooting, Eurographics
//! Workshop on Rendering 1992): the patch sends in advance what it will receive of the unshot light
//! by the ambient estimate, s = r_i + ρ_i Amb with Amb = Σ A_j r_j/(Σ A_j (1 − ρ̄)), ρ_i = d_i A_i
//! and ρ̄ their mean over areas, but at most 1.9 r_i: between 0 and 2 r_i every step comes nearer
//! to the solution in the norm of Ψ.
//!
//! Requires a_ii ≠ 0; overshooting, real unknowns. Converges for strictly diagonally dominant
//! matrices (without overshooting) and for Hermitian positive definite ones.
//!
//! Cost of an iteration: n shots, each of one column; areas that are not given take one reading of
//! the matrix.
//!
//! ```
//! use fredholm_iterative::Progressive;
//! use fredholm_linop::{MultiVector, PackedSymmetric, Quiet, SecondKind, Solver, Stop, StopReason};
//!
//! // x = b + K x with K = [0 ½; ½ 0] and b = (1, 1): x = (2, 2).
//! let coupling = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0])?;
//! let a = SecondKind::new(&coupling, MultiVector::from_vec(2, 1, vec![1.0, 1.0])?)?;
//! let b = MultiVector::from_vec(2, 1, vec![1.0, 1.0])?;
//! let mut x = MultiVector::zeros(2, 1);
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! let report = Progressive::default().solve(&a, &b, &mut x, &stop, &mut Quiet)?;
//! assert_eq!(report.reason, StopReason::Converged);
//! assert!((x.row(0)[0] - 2.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::core::{Shooting, Step, divisors, quotients, sent_shares, solve_by_steps};
use fredholm_linop::{Context, Halt, Iteration, MultiVector, Scalar, Scheme, SecondKind, SolveError};

const NAME: &str = "progressive";

/// Shoots from the patch with the most unshot power, over and over.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progressive {
    /// Areas A_i, m²; where empty, what each patch sends stands for them.
    pub areas: Vec<f64>,
    /// Whether to shoot in advance what the patch will receive.
    pub overshoot: bool,
    /// Shots an iteration; as many as there are unknowns where not given.
    pub shots: Option<usize>,
}

/// s = r_i/a_ii.
struct Plain;

/// s = r_i + ρ_i Amb, within bounds.
struct Overshooting<'a, T> {
    a: &'a SecondKind<'a, T>,
    areas: Vec<f64>,
    ambient: Vec<T>,
}

solve_by_steps!(Progressive);

impl<T: Scalar> Scheme<T> for Progressive {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "Progressive radiosity: the patch with the most unshot power sends it to all others; overshooting on request"
    }

    // The residual, the product, the diagonal, the areas twice and one column.
    fn bytes(&self, dim: usize, rhs_count: usize) -> u64 {
        let vectors = (rhs_count as u64).saturating_mul(3).saturating_add(3);
        vectors.saturating_mul(dim as u64).saturating_mul(size_of::<T>() as u64)
    }

    fn begin<'a>(
        &self,
        a: &'a SecondKind<'a, T>,
        b: &'a MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<Box<dyn Iteration<T> + 'a>, Halt> {
        let diagonal = divisors(NAME, a)?;
        let areas = self.weights(a, context)?;
        let shots = self.shots.unwrap_or(b.dim());
        if !self.overshoot {
            return Ok(Box::new(Shooting::new(a, b, (diagonal, areas), Plain).with_shots(shots)));
        }
        if !T::IS_REAL {
            let reason = "overshooting adds an ambient power, which complex unknowns do not have".to_owned();
            return Err(SolveError::Unsuitable { solver: NAME, reason }.into());
        }
        let rule = Overshooting { a, areas: areas.clone(), ambient: vec![T::zero(); b.rhs_count()] };
        Ok(Box::new(Shooting::new(a, b, (diagonal, areas), rule).with_shots(shots)))
    }
}

impl Progressive {
    fn weights<T: Scalar>(&self, a: &SecondKind<'_, T>, context: &mut Context<'_>) -> Result<Vec<f64>, Halt> {
        let (found, needed) = (self.areas.len(), a.factor().dim());
        if found == needed {
            return Ok(self.areas.clone());
        }
        if found == 0 {
            return sent_shares(a, context);
        }
        let reason = format!("{found} areas were given for {needed} unknowns");
        Err(SolveError::Unsuitable { solver: NAME, reason }.into())
    }
}

impl<T: Scalar> Step<T> for Plain {
    fn prepare(&mut self, _: &MultiVector<T>) {}

    fn step(&self, _: usize, residual: &[T], diagonal: &[T]) -> Vec<T> {
        quotients(residual, diagonal)
    }
}

impl<T: Scalar> Step<T> for Overshooting<'_, T> {
    fn prepare(&mut self, residual: &MultiVector<T>) {
        self.ambient = ambient(self.a.factor(), &self.areas, residual);
    }

    fn step(&self, i: usize, residual: &[T], diagonal: &[T]) -> Vec<T> {
        let plain = quotients(residual, diagonal);
        let reflectances = self.a.factor().row(i).iter().map(|d| d.re() * self.areas[i]);
        let ahead = reflectances.zip(&self.ambient).map(|(reflectance, amb)| amb.re() * reflectance);
        plain.iter().zip(ahead).map(|(r, ahead)| T::from_real(overshot(r.re(), ahead))).collect()
    }
}

/// r + ahead, but neither less than r nor more than 1.9 r.
fn overshot(r: f64, ahead: f64) -> f64 {
    let relative = if r == 0.0 { 0.0 } else { ahead / r };
    r * (1.0 + relative.clamp(0.0, 0.9))
}

/// The ambient radiosity per right-hand side: Amb = Σ A_j r_j/(Σ A_j (1 − ρ̄)), what the unshot
/// light comes to if it is spread evenly.
pub(crate) fn ambient<T: Scalar>(factor: &MultiVector<T>, areas: &[f64], unshot: &MultiVector<T>) -> Vec<T> {
    let total: f64 = areas.iter().sum();
    let mut sums = vec![(T::zero(), 0.0); unshot.rhs_count()];
    for ((row, d), &area) in unshot.rows().zip(factor.rows()).zip(areas) {
        for (l, (light, reflected)) in sums.iter_mut().enumerate() {
            *light += row[l].scale(area);
            *reflected += d[l].re() * area * area;
        }
    }
    let escape = |reflected: f64| total - reflected;
    let mean = |(light, reflected): (T, f64)| light.scale(escape(reflected).recip());
    sums.into_iter().map(|sum| if escape(sum.1) > 0.0 { mean(sum) } else { T::zero() }).collect()
}

/// What to show of an unfinished solution: B + ΔB + ρ Amb, with the residual ΔB = b − A x and ρ_i =
/// d_i A_i. `areas` in m².
///
/// The ambient term spreads the unshot light evenly; it is exact in an integrating sphere of one
/// material.
///
/// # Errors
/// [`SolveError::Shape`] where areas, x or residual do not fit `a`.
pub fn with_ambient<T: Scalar>(
    a: &SecondKind<'_, T>,
    areas: &[f64],
    x: &MultiVector<T>,
    residual: &MultiVector<T>,
) -> Result<MultiVector<T>, SolveError> {
    let factor = a.factor();
    let (expected, expected_rhs) = (factor.dim(), factor.rhs_count());
    let shapes = [
        ("areas", areas.len(), expected_rhs),
        ("solution", x.dim(), x.rhs_count()),
        ("residual", residual.dim(), residual.rhs_count()),
    ];
    if let Some(&(vector, found, found_rhs)) =
        shapes.iter().find(|&&(_, dim, rhs_count)| (dim, rhs_count) != (expected, expected_rhs))
    {
        return Err(SolveError::Shape { vector, found, found_rhs, expected, expected_rhs });
    }
    let ambient = ambient(factor, areas, residual);
    let shown = |i: usize, l: usize| {
        let reflectance = factor.row(i)[l].scale(areas[i]);
        x.row(i)[l] + residual.row(i)[l] + reflectance * ambient[l]
    };
    Ok(MultiVector::from_fn(expected, expected_rhs, shown))
}
