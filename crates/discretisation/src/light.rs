//! Diffuse light on a mesh by any discretisation and any solver: B = M + ρ H B, from M and ρ
//! constant on every element.
//!
//! G. Peyré's article, section 3.1. B radiosity, M exitance, E = H B irradiance, W/m², one
//! right-hand side a band. Results are means over whole elements, as those of
//! [`Radiosity`](fredholm_coupling::Radiosity), and values at the nodes. With `galerkin-0` the
//! system and the means are those of that type, the treatment of elements that are partly buried
//! included. The other methods look at points: a buried point receives nothing and is seen by
//! nobody.

use crate::surface::Rules;
use crate::transfer::irradiance_at;
use crate::{Discretisation, DiscretisationError, Equation, FlatLambert, Site, System};
use fredholm_linop::{MultiVector, Observer, Report, Solver, Stop, Watch};
use fredholm_mesh::Mesh;
use fredholm_visibility::Occluders;

/// Transfer, reflectance and exitance of a scene.
#[derive(Debug)]
pub struct Light<'a> {
    transfer: FlatLambert<'a>,
    reflectance: MultiVector<f64>,
    exitance: MultiVector<f64>,
}

impl<'a> Light<'a> {
    /// Takes the leaves of a mesh, what may stand between them, and their reflectance and exitance
    /// (W/m²), elements × bands. `tolerance` is that of the form factors, as in
    /// [`PairIntegrator`](fredholm_coupling::form_factor::PairIntegrator).
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
            if (values.dim(), values.rhs_count()) != (elements, reflectance.rhs_count()) {
                return Err(DiscretisationError::Dimension { what, found: values.dim(), elements });
            }
        }
        let faces = (0..elements).map(|leaf| mesh.surface_of(leaf)).collect();
        let transfer = FlatLambert::new(mesh.patches().copied().collect(), faces, occluders, tolerance)?;
        Ok(Self { transfer, reflectance, exitance })
    }

    /// Tells `watch` of the progress of an assembly.
    #[must_use]
    pub fn watched(mut self, watch: &'a dyn Watch) -> Self {
        self.transfer = self.transfer.watched(watch);
        self
    }

    /// M at a site.
    pub(crate) fn emitted(&self, site: &Site, band: usize) -> f64 {
        self.exitance.row(site.element)[band]
    }

    /// Builds the system of a method.
    ///
    /// # Errors
    /// The system does not fit the memory, or the surface does not suit the method.
    pub fn discretise(
        &self,
        method: &dyn Discretisation,
    ) -> Result<Box<dyn System + '_>, DiscretisationError> {
        method.discretise(Equation::new(&self.transfer, &self.reflectance)?)
    }

    /// Builds the system of a method and solves it, from the right-hand side on.
    ///
    /// # Errors
    /// As of [`discretise`](Self::discretise) and [`solve_system`](Self::solve_system).
    pub fn solve(
        &self,
        method: &dyn Discretisation,
        solver: &dyn Solver<f64>,
        stop: &Stop,
        observer: &mut dyn Observer<f64>,
    ) -> Result<Lit<'_>, DiscretisationError> {
        self.solve_system(self.discretise(method)?, solver, stop, observer)
    }

    /// Solves a system of this light, from the right-hand side on.
    ///
    /// # Errors
    /// The solver does not suit the system.
    pub fn solve_system<'s>(
        &'s self,
        system: Box<dyn System + 's>,
        solver: &dyn Solver<f64>,
        stop: &Stop,
        observer: &mut dyn Observer<f64>,
    ) -> Result<Lit<'s>, DiscretisationError> {
        let b = system.right_hand_side(&|site, band| self.emitted(site, band));
        let mut x = b.clone();
        let report = solver.solve(&system.operator()?, &b, &mut x, stop, observer)?;
        Ok(Lit { light: self, system, x, report })
    }
}

/// A solution.
pub struct Lit<'a> {
    light: &'a Light<'a>,
    pub(crate) system: Box<dyn System + 'a>,
    pub(crate) x: MultiVector<f64>,
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

    /// Means over the elements of the irradiance as a polynomial; [`assess`](Self::assess) has
    /// closer ones.
    #[must_use]
    pub fn means(&self) -> ElementMeans {
        let space = self.system.space();
        let coefficients = self.irradiance();
        let rules = Rules::gauss(space.degree() + 1);
        let mut irradiance = MultiVector::zeros(space.surface().len(), coefficients.rhs_count());
        for i in 0..irradiance.dim() {
            let weights = weights(&*self.system, &rules, i);
            for (&dof, weight) in space.dofs(i).iter().zip(weights) {
                let terms = irradiance.row_mut(i).iter_mut().zip(coefficients.row(dof));
                terms.for_each(|(mean, value)| *mean += weight * value);
            }
        }
        self.with_radiosity(irradiance)
    }

    /// Adds B = M + ρ E to means of E.
    pub(crate) fn with_radiosity(&self, irradiance: MultiVector<f64>) -> ElementMeans {
        let light = self.light;
        let radiosity = MultiVector::from_fn(irradiance.dim(), irradiance.rhs_count(), |i, band| {
            light.exitance.row(i)[band] + light.reflectance.row(i)[band] * irradiance.row(i)[band]
        });
        ElementMeans { irradiance, radiosity }
    }

    /// Values at the nodes.
    #[must_use]
    pub fn nodal(&self) -> Nodal {
        let sites = self.system.space().node_sites();
        let source = |site: &Site, band: usize| self.light.emitted(site, band);
        let radiosity = MultiVector::from_fn(sites.len(), self.x.rhs_count(), |at, band| {
            self.system.value(&source, &self.x, &sites[at], band)
        });
        Nodal { sites, radiosity }
    }

    /// B_h at a site.
    pub(crate) fn radiosity_at(&self, site: &Site, band: usize) -> f64 {
        self.system.value(&|site, band| self.light.emitted(site, band), &self.x, site, band)
    }

    /// H B_h at sites of one element, sites × bands: the irradiance of the solution, not bound to
    /// the polynomials of the elements.
    #[must_use]
    pub fn irradiance_at(&self, sites: &[Site]) -> MultiVector<f64> {
        let field = |site: &Site, band: usize| self.radiosity_at(site, band);
        let equation = self.system.equation();
        irradiance_at(equation.transfer(), equation.rhs_count(), self.system.space().degree(), sites, &field)
    }
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
