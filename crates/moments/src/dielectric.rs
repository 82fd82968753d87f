//! Homogeneous dielectric bodies: the equations of Poggio, Miller, Chang, Harrington, Wu and Tsai.
//!
//! The surface has J = n × H and M = −n × E. Outside (medium 1) the field is the incident one and
//! that of J and M; inside (medium 2) it is that of −J and −M. Equal tangential parts on both
//! sides, tested with the functions of the currents:
//!
//! ```text
//! (η₁ T₁ + η₂ T₂) J + (K₁ + K₂) M                =  ⟨f, E_i⟩
//! (K₁ + K₂) J       − (T₁/η₁ + T₂/η₂) M          = −⟨f, H_i⟩
//! ```
//!
//! A. J. Poggio, E. K. Miller, in R. Mittra (ed.), Computer Techniques for Electromagnetics,
//! Pergamon 1973, ch. 4; J. R. Mautz, R. F. Harrington, AEÜ 33 (1979) 71. It has no resonances and
//! is symmetric. The permeability is that of free space. Unknowns are η₀ J and M of every function,
//! side by side, in V.

use crate::currents::Space;
use crate::equation::tested;
use crate::kernel::{Medium, Wanted};
use crate::operator::{Kinds, Operator, Products, Term};
use crate::pairs::Integrator;
use crate::rules::Rules;
use crate::{Basis, Currents, MomentsError};
use fredholm_linop::{MultiVector, Symmetry};
use fredholm_mesh::Vec3;
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{Field, Source, Wave};
use num_complex::Complex64;
use pulp::Arch;
use std::f64::consts::TAU;

/// A homogeneous body in a wave.
#[derive(Clone, Debug)]
pub struct Dielectric<'a> {
    basis: &'a Basis,
    wave: Wave,
    inside: Space,
    operator: Operator<'a>,
}

impl<'a> Dielectric<'a> {
    /// A body of relative permittivity ε′ − jε″ in free space, with integrals to a relative
    /// `tolerance` for each pair of triangles.
    ///
    /// # Errors
    /// [`MomentsError::Coarse`] for edges above a third of the shorter wavelength, those of
    /// [`Topology::check_closed`](crate::Topology::check_closed), [`MomentsError::Parameter`] for
    /// numbers out of range.
    pub fn new(
        basis: &'a Basis,
        wave: Wave,
        permittivity: Complex64,
        tolerance: f64,
    ) -> Result<Self, MomentsError> {
        check(permittivity)?;
        let index = permittivity.sqrt();
        let k = Complex64::from(wave.wavenumber());
        let outside = Space { k, impedance: Complex64::ONE };
        let inside = Space { k: k * index, impedance: index.inv() };
        let shortest = TAU / outside.k.norm().max(inside.k.norm());
        basis.topology().check_resolution(basis.surface(), shortest)?;
        basis.topology().check_closed(basis.surface(), "the equation of dielectric bodies")?;
        let terms =
            [outside, inside].into_iter().map(|space| term(space, tolerance)).collect::<Result<_, _>>()?;
        let products = Products::Everywhere(Kinds::default());
        let operator = Operator::new(basis, 2, terms, products, Symmetry::Symmetric);
        Ok(Self { basis, wave, inside, operator })
    }

    /// The matrix.
    #[must_use]
    pub fn operator(&self) -> &Operator<'a> {
        &self.operator
    }

    /// One right-hand side for each of the sets of sources outside, V.
    #[must_use]
    pub fn right_hand_side(&self, excitations: &[&[&dyn Source]]) -> MultiVector<Complex64> {
        tested_with_both(self.basis, &self.wave, excitations, |_| 1.0)
    }

    /// The currents of a solution. What they radiate into free space is the scattered field.
    ///
    /// # Panics
    /// Like a slice, where there are fewer unknowns than those of the operator.
    #[must_use]
    pub fn currents(&self, x: &[Complex64]) -> Currents<'a> {
        let kind = |first: usize| x.iter().skip(first).step_by(2).copied().collect::<Vec<_>>();
        Currents::new(self.basis, self.wave, &kind(0), Some(&kind(1)))
    }

    /// The field at points (m) in the body.
    ///
    /// # Errors
    /// [`MomentsError::OnSurface`] for a point on the surface.
    pub fn fields_inside(
        &self,
        currents: &Currents<'a>,
        points: &[Vec3],
    ) -> Result<Vec<Field>, MomentsError> {
        let fields = currents.fields_in(points, self.inside)?;
        Ok(fields.into_iter().map(|field| field * -1.0).collect())
    }
}

/// ⟨f, E_i⟩ and −η₀ ⟨f, H_i⟩ of every function, side by side, the second times the unit of its
/// unknown.
pub(crate) fn tested_with_both(
    basis: &Basis,
    wave: &Wave,
    excitations: &[&[&dyn Source]],
    unit: impl Fn(usize) -> f64,
) -> MultiVector<Complex64> {
    let mut b = MultiVector::zeros(2 * basis.len(), excitations.len());
    for (rhs, sources) in excitations.iter().enumerate() {
        let electric = tested(basis, wave, sources, |field, _| field.e);
        let magnetic = tested(basis, wave, sources, |field, _| field.h * -IMPEDANCE);
        let pairs = electric.into_iter().zip(magnetic).enumerate();
        let both: Vec<Complex64> = pairs.flat_map(|(n, (e, h))| [e, h * unit(n)]).collect();
        b.set_vector(rhs, &both);
    }
    b
}

fn check(permittivity: Complex64) -> Result<(), MomentsError> {
    let refuse = |what, value, expected| Err(MomentsError::Parameter { what, value, expected });
    if !(permittivity.re > 0.0 && permittivity.re.is_finite()) {
        return refuse("the real part of the permittivity", permittivity.re, "finite and above 0");
    }
    if !(permittivity.im <= 0.0 && permittivity.im.is_finite()) {
        return refuse("the imaginary part of the permittivity", permittivity.im, "finite and at most 0");
    }
    Ok(())
}

/// What one side of the surface adds.
pub(crate) fn term(space: Space, tolerance: f64) -> Result<Term, MomentsError> {
    let (zero, one) = (Complex64::ZERO, Complex64::ONE);
    let wanted = Wanted { electric: true, magnetic: true, turned: false };
    let rules = Rules::new(tolerance, space.k, true)?;
    Ok(Term {
        integrator: Integrator { medium: Medium::new(space.k), wanted, rules, arch: Arch::new() },
        electric: [[space.impedance, zero], [zero, -space.impedance.inv()]],
        magnetic: [[zero, one], [one, zero]],
    })
}
