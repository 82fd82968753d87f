//! The equations of perfectly conducting bodies and sheets for the surface current J.
//!
//! With the tangential part of E and H of the current (the operators T and K of [`Operator`]):
//!
//! ```text
//! electric  (any surface):   η ⟨f, T J⟩ = ⟨f, E_i⟩
//! magnetic  (closed bodies): η [½ ⟨n × g, J⟩ − ⟨g, K J⟩] = η ⟨g, H_i⟩
//! combined  (closed bodies): α electric + (1 − α) magnetic
//! ```
//!
//! where g are the dual functions (`dual`), one for each f, with ∫ (n × g)·f dA = 1: ½ J − n × K J
//! = n × H_i is an equality of functions that n × g and not f are the duals of. Tested with f, the
//! magnetic equation of a sphere of half a wavelength with edges of λ/10 has six times the error,
//! and the combined one three times. Functions of the first full order are their own duals well
//! enough: they test n × the equation, g = f × n.
//!
//! R. F. Harrington, Field Computation by Moment Methods, Macmillan 1968; J. R. Mautz, R. F.
//! Harrington, H-field, E-field, and combined-field solutions for conducting bodies of revolution,
//! AEÜ 32 (1978) 157. The first is of the first kind and symmetric. Closed bodies have resonances
//! inside, at which the first two have solutions without a source: only the combination has one
//! answer at every frequency. Unknowns are η J (V/m times a function of 1/m, so V); the residual of
//! every solver is that of these equations.

use crate::dual::dual;
use crate::element::shares;
use crate::element_kernel::Tests;
use crate::kernel::{Medium, WIDTH, Wanted};
use crate::operator::{DualPart, Factors, Integrals, Kinds, Operator, Products, Term};
use crate::pairs::Integrator;
use crate::patterns::Radiating;
use crate::rules::Rules;
use crate::{Basis, MomentsError, Order};
use fredholm_compressed::{Multipole, MultipoleSettings, MultipoleSummary};
use fredholm_linop::{MultiVector, Symmetry, Watch};
use fredholm_mesh::Vec3;
use fredholm_quadrature::symmetric_triangle;
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{ComplexVector, Field, Source, Wave, incident};
use num_complex::Complex64;
use pulp::Arch;
use rayon::prelude::*;
use std::sync::Arc;

/// Degree of the rule for incident fields: exact for a source at λ/10 to 1e-6.
const INCIDENT_DEGREE: usize = 6;
/// The same with functions of the first full order, on triangles with edges of λ/2.
const INCIDENT_DEGREE_OF_FIRST: usize = 12;

/// Which equation is solved on a conductor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Equation {
    /// The electric field equation, for open and closed surfaces.
    Electric,
    /// The magnetic field equation, for closed bodies.
    Magnetic,
    /// α times the electric and 1 − α times the magnetic field equation, for closed bodies.
    Combined {
        /// α, between 0 and 1.
        alpha: f64,
    },
}

impl Default for Equation {
    fn default() -> Self {
        Self::Combined { alpha: 0.5 }
    }
}

impl Equation {
    /// The factors of both equations.
    pub(crate) fn shares(self) -> [f64; 2] {
        match self {
            Self::Electric => [1.0, 0.0],
            Self::Magnetic => [0.0, 1.0],
            Self::Combined { alpha } => [alpha, 1.0 - alpha],
        }
    }

    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Electric => "the electric field equation",
            Self::Magnetic => "the magnetic field equation",
            Self::Combined { .. } => "the combined field equation",
        }
    }

    fn check(self, basis: &Basis) -> Result<(), MomentsError> {
        if let Self::Combined { alpha } = self
            && !(0.0..=1.0).contains(&alpha)
        {
            let expected = "between 0 and 1";
            return Err(MomentsError::Parameter {
                what: "alpha of the combined field equation",
                value: alpha,
                expected,
            });
        }
        if self == Self::Electric {
            return Ok(());
        }
        basis.topology().check_closed(basis.surface(), self.name())
    }
}

/// What electric currents in free space add to the electric equation, times a factor.
pub(crate) fn electric_term(
    order: Order,
    k: Complex64,
    factor: f64,
    tolerance: f64,
) -> Result<Term, MomentsError> {
    let wanted = Wanted { electric: true, magnetic: false };
    let integrals = Integrals::new(order, k, (wanted, Tests::Straight), tolerance)?;
    Ok(Term { integrals, electric: electric_only(factor.into()), magnetic: Factors::default() })
}

/// Both equations with functions of the first full order, which test the magnetic one turned.
fn first_order_term(
    k: Complex64,
    [electric, magnetic]: [f64; 2],
    tolerance: f64,
) -> Result<Term, MomentsError> {
    let wanted = Wanted { electric: electric != 0.0, magnetic: magnetic != 0.0 };
    let integrals = Integrals::new(Order::First, k, (wanted, Tests::Turned), tolerance)?;
    let (electric, magnetic) = (electric_only(electric.into()), electric_only((-magnetic).into()));
    Ok(Term { integrals, electric, magnetic })
}

/// The magnetic integrals that dual functions test.
fn dual_integrator(k: Complex64, tolerance: f64) -> Result<Integrator, MomentsError> {
    let wanted = Wanted { electric: false, magnetic: true };
    let rules = Rules::new(tolerance, k, true)?;
    Ok(Integrator { medium: Medium::new(k), wanted, rules, arch: Arch::new(), observers_cut: true })
}

/// A factor of electric currents tested with the electric equation, where there is nothing else.
pub(crate) fn electric_only(value: Complex64) -> Factors {
    [[value, Complex64::ZERO], [Complex64::ZERO; 2]]
}

/// A perfect conductor in a wave.
#[derive(Clone, Debug)]
pub struct Conductor<'a> {
    basis: &'a Basis,
    wave: Wave,
    equation: Equation,
    operator: Operator<'a>,
}

impl<'a> Conductor<'a> {
    /// Sets up an equation with integrals to a relative `tolerance` for each pair of triangles
    /// (1e-3 is usual: errors of pairs are smaller than those of the mesh by then).
    ///
    /// # Errors
    /// [`MomentsError::Coarse`] for edges above λ/3 (λ/2 with functions of the first full order),
    /// those of [`Topology::check_closed`](crate::Topology::check_closed) for equations of closed
    /// bodies, [`MomentsError::Parameter`] for numbers out of range.
    pub fn new(
        basis: &'a Basis,
        wave: Wave,
        equation: Equation,
        tolerance: f64,
    ) -> Result<Self, MomentsError> {
        equation.check(basis)?;
        basis.topology().check_resolution(basis.surface(), wave.wavelength(), basis.order())?;
        let [electric, magnetic] = equation.shares();
        let k = Complex64::from(wave.wavenumber());
        let symmetry = if magnetic == 0.0 { Symmetry::Symmetric } else { Symmetry::General };
        let kinds = vec![Kinds::ELECTRIC; basis.len()];
        let none = Products::Everywhere(Factors::default());
        let operator = match basis.order() {
            _ if magnetic == 0.0 => {
                let term = electric_term(basis.order(), k, electric, tolerance)?;
                Operator::new(basis, kinds, vec![term], none, symmetry)
            }
            Order::First => {
                let term = first_order_term(k, [electric, magnetic], tolerance)?;
                let half = Products::Everywhere(electric_only((0.5 * magnetic).into()));
                Operator::new(basis, kinds, vec![term], half, symmetry)
            }
            Order::Lowest => {
                let terms = match electric {
                    0.0 => Vec::new(),
                    _ => vec![electric_term(Order::Lowest, k, electric, tolerance)?],
                };
                Operator::new(basis, kinds, terms, none, symmetry).with_dual(DualPart {
                    basis: Arc::new(dual(basis)?),
                    integrator: dual_integrator(k, tolerance)?,
                    magnetic: -magnetic,
                    product: 0.5 * magnetic,
                })
            }
        };
        Ok(Self { basis, wave, equation, operator })
    }

    /// The matrix.
    #[must_use]
    pub fn operator(&self) -> &Operator<'a> {
        &self.operator
    }

    /// The matrix by multilevel fast multipoles, in free space.
    ///
    /// # Errors
    /// [`MomentsError::Grounded`] above a ground plane, [`MomentsError::Compression`] for settings
    /// out of range, bodies that are too small, where it takes more than the limit, and where
    /// `watch` no longer wants it.
    pub fn multipole(
        &self,
        settings: MultipoleSettings,
        watch: &dyn Watch,
    ) -> Result<Multipole, MomentsError> {
        self.radiating()?.multipole(settings, watch)
    }

    /// What the matrix by multipoles will be made of, before anything is computed.
    ///
    /// # Errors
    /// Those of [`multipole`](Self::multipole) for what does not fit.
    pub fn multipole_summary(&self, settings: MultipoleSettings) -> Result<MultipoleSummary, MomentsError> {
        self.radiating()?.predicted(settings)
    }

    fn radiating(&self) -> Result<Radiating<'_>, MomentsError> {
        Radiating::new(&self.operator, self.wave.wavenumber(), self.equation.shares())
    }

    /// The functions.
    #[must_use]
    pub fn basis(&self) -> &'a Basis {
        self.basis
    }

    /// The wave.
    #[must_use]
    pub fn wave(&self) -> Wave {
        self.wave
    }

    /// One right-hand side for each of the sets of sources, V.
    #[must_use]
    pub fn right_hand_side(&self, excitations: &[&[&dyn Source]]) -> MultiVector<Complex64> {
        let [electric, magnetic] = self.equation.shares();
        let mut b = MultiVector::zeros(self.basis.len(), excitations.len());
        for (rhs, sources) in excitations.iter().enumerate() {
            let mut tests =
                tested(self.basis, &self.wave, sources, Tests::Straight, |field| field.e * electric);
            let (tester, straight) = match self.operator.dual() {
                Some(dual) => (&*dual.basis, Tests::Straight),
                None => (self.basis, Tests::Turned),
            };
            if magnetic != 0.0 {
                let field = |field: Field| field.h * (magnetic * IMPEDANCE);
                let of_magnetic = tested(tester, &self.wave, sources, straight, field);
                tests.iter_mut().zip(of_magnetic).for_each(|(sum, part)| *sum += part);
            }
            b.set_vector(rhs, &tests);
        }
        b
    }
}

/// ∫ f·v dA of every function in region 0, or of f × n, for a vector v of the incident field.
pub(crate) fn tested(
    basis: &Basis,
    wave: &Wave,
    sources: &[&dyn Source],
    tests: Tests,
    value: impl Fn(Field) -> ComplexVector + Sync,
) -> Vec<Complex64> {
    let degree = match basis.order() {
        Order::Lowest => INCIDENT_DEGREE,
        Order::First => INCIDENT_DEGREE_OF_FIRST,
    };
    // The degree is one of the table.
    let rule = symmetric_triangle(degree).unwrap_or_default();
    let surface = basis.surface();
    let on_triangle = |triangle: usize| {
        let element = surface.element(triangle);
        let mut sums = [Complex64::ZERO; WIDTH];
        for point in &rule {
            let at = shares([point.u, point.v]);
            let v = value(incident(sources, wave, element.point(at))) * point.weight;
            let turned = |f: Vec3| match tests {
                Tests::Straight => f,
                Tests::Turned => f.cross(element.normal(at)),
            };
            sums.iter_mut().zip(element.vectors(at)).for_each(|(sum, f)| *sum += v.dot(turned(f)));
        }
        sums
    };
    let sums: Vec<[Complex64; WIDTH]> =
        (0..surface.triangles().len()).into_par_iter().map(on_triangle).collect();
    let product = |half: &crate::Half| sums[half.triangle as usize][usize::from(half.number)] * half.weight;
    let outside = |function: &crate::Function| {
        function.halves.iter().filter(|half| half.region == 0).map(product).sum()
    };
    basis.functions().iter().map(outside).collect()
}
