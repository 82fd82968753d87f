//! Diffuse light on a mesh by any discretisation and any solver: B = M + ρ H B, from M and ρ constant on every element.
//!
//! G. Peyré's article, section 3.1. B radiosity, M exitance, E = H B irradiance, W/m², one lane a band. Results are means over whole elements, as those of
//! [`Radiosity`](fredholm_coupling::Radiosity), and values at the nodes. With `galerkin-0` the system and the means are those of that type, the treatment of elements that
//! are partly buried included. The other methods look at points: a buried point receives nothing and is seen by nobody.

use crate::surface::Rules;
use crate::transfer::irradiance_at;
use crate::{Discretisation, DiscretisationError, Equation, FlatLambert, Site, System};
use fredholm_linop::{MultiVector, Observer, Report, Solver, Stop};
use fredholm_mesh::Mesh;
use fredholm_visibility::Occluders;
use rayon::prelude::*;

/// Transfer, reflectance and exitance of a scene.
#[derive(Debug)]
pub struct Light<'a> {
    transfer: FlatLambert<'a>,
    reflectance: MultiVector<f64>,
    exitance: MultiVector<f64>,
}

impl<'a> Light<'a> {
    /// Takes the leaves of a mesh, what may stand between them, and their reflectance and exitance (W/m²), elements × bands. `tolerance` is that of the form
    /// factors, as in [`PairIntegrator`](fredholm_coupling::form_factor::PairIntegrator).
    ///
    /// # Errors
    /// [`DiscretisationError::Dimension`] where the values do not fit the mesh or each other.
    pub fn new(
        mesh: &Mesh,
        occluders: &'a Occluders,
        reflectance: MultiVector<f64>,
        exitance: MultiVector<f64>,
        tolerance: f64,
    ) -> Result<Self, DiscretisationError> {
        let elements = mesh.len();
        for (what, values) in [("the reflectance", &reflectance), ("the exitance", &exitance)] {
            if (values.dim(), values.lanes()) != (elements, reflectance.lanes()) {
                return Err(DiscretisationError::Dimension { what, found: values.dim(), elements });
            }
        }
        let faces = (0..elements).map(|leaf| mesh.surface_of(leaf)).collect();
        let transfer = FlatLambert::new(mesh.patches().copied().collect(), faces, occluders, tolerance)?;
        Ok(Self { transfer, reflectance, exitance })
    }

    /// M at a site.
    fn emitted(&self, site: &Site, band: usize) -> f64 {
        self.exitance.row(site.element)[band]
    }

    /// Builds the system of a method and solves it, from the right-hand side on.
    ///
    /// # Errors
    /// The system does not fit the memory, or the solver does not suit it.
    pub fn solve(
        &self,
        method: &dyn Discretisation,
        solver: &dyn Solver<f64>,
        stop: &Stop,
        observer: &mut dyn Observer<f64>,
    ) -> Result<Lit<'_>, DiscretisationError> {
        let system = method.discretise(Equation::new(&self.transfer, &self.reflectance)?)?;
        let b = system.right_hand_side(&|site, band| self.emitted(site, band));
        let mut x = b.clone();
        let report = solver.solve(&system.operator()?, &b, &mut x, stop, observer)?;
        Ok(Lit { light: self, system, x, report })
    }
}

/// A solution.
pub struct Lit<'a> {
    light: &'a Light<'a>,
    system: Box<dyn System + 'a>,
    x: MultiVector<f64>,
    report: Report,
}

/// Means over whole elements, elements × bands, W/m².
#[derive(Clone, Debug, PartialEq)]
pub struct ElementMeans {
    /// E.
    pub irradiance: MultiVector<f64>,
    /// M + ρ E.
    pub radiosity: MultiVector<f64>,
}

/// Values at the nodes of all elements, W/m².
#[derive(Clone, Debug, PartialEq)]
pub struct Nodal {
    /// The nodes, element after element.
    pub sites: Vec<Site>,
    /// B, nodes × bands.
    pub radiosity: MultiVector<f64>,
}

/// An estimate of the error of the irradiance as a piecewise polynomial.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldError {
    /// ‖E_h − H B_h‖/‖H B_h‖ in L² over the surface, per band.
    pub relative_l2: Vec<f64>,
    /// Root of the mean square of E_h − H B_h on every element, elements × bands, W/m².
    pub per_element: MultiVector<f64>,
}

impl Lit<'_> {
    /// What the solver did.
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// The discrete system.
    #[must_use]
    pub fn system(&self) -> &dyn System {
        &*self.system
    }

    /// Its solution, unknowns × bands, W/m².
    #[must_use]
    pub fn unknowns(&self) -> &MultiVector<f64> {
        &self.x
    }

    /// Coefficients of the irradiance in the trial space, unknowns × bands, W/m².
    #[must_use]
    pub fn irradiance(&self) -> MultiVector<f64> {
        self.system.irradiance(&|site, band| self.light.emitted(site, band), &self.x)
    }

    /// Means over the elements.
    #[must_use]
    pub fn means(&self) -> ElementMeans {
        let (space, light) = (self.system.space(), self.light);
        let coefficients = self.irradiance();
        let rules = Rules::gauss(space.degree() + 1);
        let mut irradiance = MultiVector::zeros(space.surface().len(), coefficients.lanes());
        for i in 0..irradiance.dim() {
            let weights = weights(&*self.system, &rules, i);
            for (&dof, weight) in space.dofs(i).iter().zip(weights) {
                let terms = irradiance.row_mut(i).iter_mut().zip(coefficients.row(dof));
                terms.for_each(|(mean, value)| *mean += weight * value);
            }
        }
        let radiosity = MultiVector::from_fn(irradiance.dim(), irradiance.lanes(), |i, band| {
            light.exitance.row(i)[band] + light.reflectance.row(i)[band] * irradiance.row(i)[band]
        });
        ElementMeans { irradiance, radiosity }
    }

    /// Values at the nodes.
    #[must_use]
    pub fn nodal(&self) -> Nodal {
        let sites = self.system.space().node_sites();
        let source = |site: &Site, band: usize| self.light.emitted(site, band);
        let radiosity = MultiVector::from_fn(sites.len(), self.x.lanes(), |at, band| {
            self.system.value(&source, &self.x, &sites[at], band)
        });
        Nodal { sites, radiosity }
    }

    /// H B_h at sites of one element, sites × bands: the irradiance of the solution, not bound to the polynomials of the elements.
    #[must_use]
    pub fn irradiance_at(&self, sites: &[Site]) -> MultiVector<f64> {
        let source = |site: &Site, band: usize| self.light.emitted(site, band);
        let field = |site: &Site, band: usize| self.system.value(&source, &self.x, site, band);
        irradiance_at(&self.system.equation(), self.system.space().degree(), sites, &field)
    }

    /// Compares the irradiance as a piecewise polynomial with H B_h, which is closer to the truth where the field is smooth, and shows what the
    /// polynomials cannot follow where it is not. It costs about as much as the assembly.
    #[must_use]
    pub fn error(&self) -> FieldError {
        let (surface, bands) = (self.system.space().surface(), self.x.lanes());
        let coefficients = self.irradiance();
        let rules = Rules::gauss(self.system.space().degree() + 2);
        let squares: Vec<Squares> =
            (0..surface.len()).into_par_iter().map(|i| self.squares(&coefficients, &rules, i)).collect();
        let sum =
            |of: fn(&Squares) -> &Vec<f64>, band: usize| squares.iter().map(|s| of(s)[band]).sum::<f64>();
        let relative = |band| match (sum(|s| &s.error, band), sum(|s| &s.value, band)) {
            (error, value) if value > 0.0 => (error / value).sqrt(),
            _ => 0.0,
        };
        let relative_l2 = (0..bands).map(relative).collect();
        let root = |i: usize, band: usize| (squares[i].error[band] / squares[i].area).sqrt();
        FieldError { relative_l2, per_element: MultiVector::from_fn(surface.len(), bands, root) }
    }

    fn squares(&self, coefficients: &MultiVector<f64>, rules: &Rules, i: usize) -> Squares {
        let (space, bands) = (self.system.space(), self.x.lanes());
        let placed = space.surface().place(i, rules.of(space.surface().chart(i).sides()));
        let sites: Vec<Site> = placed.iter().map(|(site, _)| *site).collect();
        let true_to_h = self.irradiance_at(&sites);
        let mut sums = Squares { area: 0.0, error: vec![0.0; bands], value: vec![0.0; bands] };
        for (at, (site, weight)) in placed.iter().enumerate() {
            sums.area += weight;
            for band in 0..bands {
                let value = true_to_h.row(at)[band];
                let polynomial = space.value(coefficients, band, i, site.u, site.v);
                sums.error[band] += weight * (polynomial - value).powi(2);
                sums.value[band] += weight * value * value;
            }
        }
        sums
    }
}

/// Sums over one element: area, and per band ∫ (E_h − H B_h)² and ∫ (H B_h)².
struct Squares {
    area: f64,
    error: Vec<f64>,
    value: Vec<f64>,
}

/// Shares of the functions of element i in a mean: ∫ φ_a dA / A.
fn weights(system: &dyn System, rules: &Rules, i: usize) -> Vec<f64> {
    let (space, surface) = (system.space(), system.space().surface());
    let mut sums = vec![0.0; space.basis(i).len()];
    for (site, weight) in surface.place(i, rules.of(surface.chart(i).sides())) {
        let values = space.basis(i).values(site.u, site.v);
        sums.iter_mut().zip(values).for_each(|(sum, phi)| *sum += weight * phi);
    }
    let area: f64 = sums.iter().sum();
    sums.iter().map(|sum| sum / area).collect()
}
