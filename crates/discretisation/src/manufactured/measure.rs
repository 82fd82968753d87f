//! The error of a method on a manufactured problem: ‖x_h − x‖/‖x‖ in L² over the surface.

use super::Manufactured;
use crate::surface::Rules;
use crate::{Discretisation, DiscretisationError, Equation, Site, Source, Surface, System};
use fredholm_linop::{MultiVector, Quiet, Solver, Stop};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Residual that the solver is asked for: below every error that is measured.
const SOLVER_RESIDUAL: f64 = 1e-13;

/// Relative errors in L².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Unknowns.
    pub unknowns: usize,
    /// Of the method's own solution: x_h, or Nyström's interpolant.
    pub own: f64,
    /// Of the iterated solution b + ρ H x_h.
    pub iterated: f64,
    /// Stated without knowing x: of x_h against the iterated solution.
    pub stated: f64,
}

/// Orders ln(e/e')/ln(n'/n) from each mesh of n parts a side to the next.
#[must_use]
pub fn orders(errors: &[f64], meshes: &[usize]) -> Vec<f64> {
    let pairs = errors.windows(2).zip(meshes.windows(2));
    pairs.map(|(e, n)| (e[0] / e[1]).ln() / (n[1] as f64 / n[0] as f64).ln()).collect()
}

/// Solves on n × n elements a piece with `order` Gauss points along the sides of an element.
///
/// # Errors
/// The system cannot be built or solved.
pub fn measure(
    problem: &Manufactured,
    method: &dyn Discretisation,
    n: usize,
    order: usize,
    solver: &dyn Solver<f64>,
) -> Result<Errors, DiscretisationError> {
    let surface = problem.surface(n)?;
    let transfer = problem.transfer(&surface, order);
    let reflectance = MultiVector::from_fn(surface.len(), 1, |_, _| problem.reflectance);
    let system = method.discretise(Equation::new(&transfer, &reflectance)?)?;
    let known = Known::new(problem, &surface, order);
    let source = |site: &Site, _: usize| known.source(site);
    let x = solution(&*system, &source, solver)?;
    let rules = Rules::gauss(system.space().degree() + 2);
    let parts: Vec<Sums> = (0..surface.len())
        .into_par_iter()
        .map(|i| element(problem, &*system, &source, &x, &rules, i))
        .collect();
    Ok(summary(&parts, x.dim()))
}

fn solution(
    system: &dyn System,
    source: &Source,
    solver: &dyn Solver<f64>,
) -> Result<MultiVector<f64>, DiscretisationError> {
    let b = system.right_hand_side(source);
    let mut x = MultiVector::zeros(b.dim(), 1);
    let stop = Stop { tolerance: SOLVER_RESIDUAL, max_iterations: 10_000 };
    solver.solve(&system.operator()?, &b, &mut x, &stop, &mut Quiet)?;
    Ok(x)
}

/// The source at the Gauss points of the transfer, which are asked for again and again.
struct Known<'a> {
    problem: &'a Manufactured,
    values: BTreeMap<(usize, u64, u64), f64>,
}

impl<'a> Known<'a> {
    fn new(problem: &'a Manufactured, surface: &Surface, order: usize) -> Self {
        let rules = Rules::gauss(order);
        let place = |i| surface.place(i, rules.of(surface.chart(i).sides()));
        let sites = (0..surface.len()).flat_map(place);
        let values = sites.map(|(site, _)| (key(&site), problem.source(site.position))).collect();
        Self { problem, values }
    }

    fn source(&self, site: &Site) -> f64 {
        let known = self.values.get(&key(site)).copied();
        known.unwrap_or_else(|| self.problem.source(site.position))
    }
}

fn key(site: &Site) -> (usize, u64, u64) {
    (site.element, site.u.to_bits(), site.v.to_bits())
}

/// ∫ of the squares of x and of three differences.
type Sums = [f64; 4];

fn element(
    problem: &Manufactured,
    system: &dyn System,
    source: &Source,
    x: &MultiVector<f64>,
    rules: &Rules,
    i: usize,
) -> Sums {
    let surface = system.space().surface();
    let placed = surface.place(i, rules.of(surface.chart(i).sides()));
    let sites: Vec<Site> = placed.iter().map(|(site, _)| *site).collect();
    let (own, iterated) = (system.reconstruct(source, x, &sites), system.iterated(source, x, &sites));
    let mut sums = [0.0; 4];
    for (at, (site, weight)) in placed.iter().enumerate() {
        let exact = problem.exact(site.position);
        let (own, iterated) = (own.row(at)[0], iterated.row(at)[0]);
        let plain = system.value(source, x, site, 0);
        let differences = [exact, own - exact, iterated - exact, plain - iterated];
        sums.iter_mut().zip(differences).for_each(|(sum, d)| *sum += weight * d * d);
    }
    sums
}

fn summary(parts: &[Sums], unknowns: usize) -> Errors {
    let total = parts.iter().fold([0.0; 4], |total, part| [0, 1, 2, 3].map(|k| total[k] + part[k]));
    let relative = |square: f64| (square / total[0]).sqrt();
    Errors { unknowns, own: relative(total[1]), iterated: relative(total[2]), stated: relative(total[3]) }
}
