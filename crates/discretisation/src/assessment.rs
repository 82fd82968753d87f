//! What H B_h says of a solution B_h: means over the elements, the error of the polynomials, and
//! what is seen of the scene.
//!
//! G. Peyré's article, section 3.1. The iterated irradiance H B_h, W/m², is not bound to the
//! polynomials of the elements and converges faster where the field is smooth (I. H. Sloan, Math.
//! Comp. 30 (1976) 758, doi:10.2307/2005395). It is integrated over every element at (k + 2)² Gauss
//! points, k the degree. H 1, dimensionless, is what a point sees of all surfaces: 1 in a closed
//! scene.

use crate::surface::Rules;
use crate::transfer::irradiance_at;
use crate::{ElementMeans, Lit, Site};
use fredholm_linop::{MultiVector, Watch};
use rayon::prelude::*;

/// Points a direction, beyond the degree.
const POINTS_BEYOND_DEGREE: usize = 2;

/// An estimate of the error of the irradiance as a piecewise polynomial.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldError {
    /// ‖E_h − H B_h‖/‖H B_h‖ in L² over the surface, per band.
    pub relative_l2: Vec<f64>,
    /// Root of the mean square of E_h − H B_h on every element, elements × bands, W/m².
    pub per_element: MultiVector<f64>,
}

/// What H B_h says of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// Means of H B_h over the elements: closer than those of the polynomials.
    pub means: ElementMeans,
    /// Error of the polynomials.
    pub error: FieldError,
    /// Mean of H 1 over the points of every element that see anything; 0 where none does.
    pub seen: Vec<f64>,
}

impl Lit<'_> {
    /// Compares the irradiance as a piecewise polynomial with H B_h, which is closer to the truth
    /// where the field is smooth, and shows what the polynomials cannot follow where it is not. It
    /// costs about as much as the assembly.
    #[must_use]
    pub fn error(&self) -> FieldError {
        self.assess().error
    }

    /// Integrates H B_h over all elements: what [`error`](Self::error) gives, and more for the same
    /// cost.
    #[must_use]
    pub fn assess(&self) -> Assessment {
        let integrals = self.integrator();
        let elements = 0..self.system.space().surface().len();
        self.assessment(&elements.into_par_iter().map(integrals).collect::<Vec<_>>())
    }

    /// The same while `watch` says so, which is asked before each element from any thread; `None`
    /// where it did not.
    #[must_use]
    pub fn assess_while(&self, watch: &dyn Watch) -> Option<Assessment> {
        let integrals = self.integrator();
        let elements = 0..self.system.space().surface().len();
        let wanted = |i| watch.go_on().is_continue().then(|| integrals(i));
        let found: Option<Vec<_>> = elements.into_par_iter().map(wanted).collect();
        found.map(|found| self.assessment(&found))
    }

    fn integrator(&self) -> impl Fn(usize) -> Integrals + Sync {
        let (coefficients, rules) =
            (self.irradiance(), Rules::gauss(self.system.space().degree() + POINTS_BEYOND_DEGREE));
        move |i| self.integrals(&coefficients, &rules, i)
    }

    fn assessment(&self, found: &[Integrals]) -> Assessment {
        let bands = self.x.rhs_count();
        let relative_l2 = (0..bands).map(|band| relative(found, band)).collect();
        let root = |i: usize, band: usize| (found[i].error[band] / found[i].area).sqrt();
        let per_element = MultiVector::from_fn(found.len(), bands, root);
        let mean = |i: usize, band: usize| found[i].value[band] / found[i].area;
        Assessment {
            means: self.with_radiosity(MultiVector::from_fn(found.len(), bands, mean)),
            error: FieldError { relative_l2, per_element },
            seen: found.iter().map(Integrals::seen).collect(),
        }
    }

    fn integrals(&self, coefficients: &MultiVector<f64>, rules: &Rules, i: usize) -> Integrals {
        let (space, bands) = (self.system.space(), self.x.rhs_count());
        let placed = space.surface().place(i, rules.of(space.surface().chart(i).sides()));
        let sites: Vec<Site> = placed.iter().map(|(site, _)| *site).collect();
        let iterated = self.iterated_with_one(&sites);
        let mut sums = Integrals::zeros(bands);
        for (at, (site, weight)) in placed.iter().enumerate() {
            sums.add_sight(*weight, iterated.row(at)[bands]);
            for band in 0..bands {
                let polynomial = space.value(coefficients, band, i, site.u, site.v);
                sums.add(band, *weight, iterated.row(at)[band], polynomial);
            }
        }
        sums
    }

    /// H B_h in all bands and H 1 at sites of one element, sites × (bands + 1).
    fn iterated_with_one(&self, sites: &[Site]) -> MultiVector<f64> {
        let (equation, bands) = (self.system.equation(), self.x.rhs_count());
        let field = |site: &Site, rhs: usize| if rhs < bands { self.radiosity_at(site, rhs) } else { 1.0 };
        irradiance_at(equation.transfer(), bands + 1, self.system.space().degree(), sites, &field)
    }
}

/// √(Σ error/Σ square).
fn relative(found: &[Integrals], band: usize) -> f64 {
    let error: f64 = found.iter().map(|sums| sums.error[band]).sum();
    let square: f64 = found.iter().map(|sums| sums.square[band]).sum();
    if square > 0.0 { (error / square).sqrt() } else { 0.0 }
}

/// Integrals over one element: 1, and per band H B_h, (H B_h)² and (E_h − H B_h)²; over the points
/// that see anything 1 and H 1.
struct Integrals {
    area: f64,
    value: Vec<f64>,
    square: Vec<f64>,
    error: Vec<f64>,
    open: f64,
    sight: f64,
}

impl Integrals {
    fn zeros(bands: usize) -> Self {
        let zeros = || vec![0.0; bands];
        Self { area: 0.0, value: zeros(), square: zeros(), error: zeros(), open: 0.0, sight: 0.0 }
    }

    fn add(&mut self, band: usize, weight: f64, value: f64, polynomial: f64) {
        self.value[band] += weight * value;
        self.square[band] += weight * value * value;
        self.error[band] += weight * (polynomial - value).powi(2);
    }

    fn add_sight(&mut self, weight: f64, sight: f64) {
        self.area += weight;
        if sight > 0.0 {
            self.open += weight;
            self.sight += weight * sight;
        }
    }

    fn seen(&self) -> f64 {
        if self.open > 0.0 { self.sight / self.open } else { 0.0 }
    }
}
