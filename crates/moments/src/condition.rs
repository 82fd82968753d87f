//! Surfaces that are no perfect conductors: thin sheets and bodies with a surface impedance.
//!
//! A sheet without thickness has E_tan = Z_s J on both sides, with J the jump of n × H (T. B. A.
//! Senior, J. L. Volakis, Approximate Boundary Conditions in Electromagnetics, IEE 1995, § 2.4).
//! The electric equation of its current, tested with the functions of the current, is
//!
//! ```text
//! η ⟨f, T J⟩ + ⟨f, Z_s J⟩ = ⟨f, E_i⟩
//! ```
//!
//! On a closed body with E_tan = Z_s n × H outside (M. A. Leontovich 1948) both J = n × H and M =
//! −n × E flow. Half the sum of the fields of both sides is the principal value, and the inside has
//! none, so that with the operators of dielectric bodies
//!
//! ```text
//! (η T + ½ Z_s) J + K M          =  ⟨f, E_i⟩
//! K J − (T/η + ½/Z_s) M          = −⟨f, H_i⟩
//! ```
//!
//! (A. Bendali, M. B. Fares, J. Gay, A boundary-element solution of the Leontovitch problem, IEEE
//! Trans. Antennas Propag. 47 (1999) 1597, doi:10.1109/8.805905, where M is eliminated). Fields
//! without a source that solve both equations have E_tan = Z_s n × H outside and E_tan = −Z_s n × H
//! inside: the power ½ Re Z_s |n × H|² leaves on either side, and so there are none where Re Z_s >
//! 0. The first equation alone is that of a conductor for Z_s = 0.
//!
//! Both matrices are symmetric. Unknowns are η₀ J and, where a body has an impedance, M/√|ζ| with ζ
//! = Z_s/η₀, in V.

use crate::composite::{currents, term, tested_with_both};
use crate::currents::Space;
use crate::equation::{electric_only, electric_term};
use crate::operator::{Factors, Kinds, Operator, Products};
use crate::{Basis, Currents, MomentsError};
use fredholm_linop::{MultiVector, Symmetry};
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{Source, Wave};
use num_complex::Complex64;

/// What a triangle is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// A perfect conductor: E_tan = 0.
    Conductor,
    /// A thin sheet of this sheet impedance, Ω: E_tan = Z_s J on both sides.
    Sheet(Complex64),
    /// The surface of a closed body of this surface impedance, Ω: E_tan = Z_s n × H outside.
    Body(Complex64),
}

impl Condition {
    /// Z_s, Ω.
    #[must_use]
    pub fn impedance(self) -> Complex64 {
        match self {
            Self::Conductor => Complex64::ZERO,
            Self::Sheet(z) | Self::Body(z) => z,
        }
    }

    fn is_body(self) -> bool {
        matches!(self, Self::Body(_))
    }

    fn check(self) -> Result<(), MomentsError> {
        let z = self.impedance();
        let refuse = |what, value, expected| Err(MomentsError::Parameter { what, value, expected });
        if !(z.re >= 0.0 && z.re.is_finite()) {
            return refuse("the real part of an impedance", z.re, "finite and at least 0");
        }
        if !z.im.is_finite() {
            return refuse("the imaginary part of an impedance", z.im, "finite");
        }
        Ok(())
    }

    /// The unknowns of a function: M flows on bodies with an impedance, in the unit √|ζ|.
    fn kinds(self) -> Kinds {
        let unit = (self.impedance().norm() / IMPEDANCE).sqrt();
        if self.is_body() && unit > 0.0 { Kinds { count: 2, unit } } else { Kinds::ELECTRIC }
    }

    /// What the products of functions are multiplied by.
    fn factors(self) -> Factors {
        let zeta = self.impedance() / IMPEDANCE;
        if self.kinds().count == 1 {
            return electric_only(zeta);
        }
        let phase = zeta.conj() / zeta.norm();
        [[zeta * 0.5, Complex64::ZERO], [Complex64::ZERO, phase * -0.5]]
    }
}

/// Conductors, thin sheets and bodies with a surface impedance, together in a wave.
#[derive(Clone, Debug)]
pub struct Imperfect<'a> {
    wave: Wave,
    conditions: Vec<Condition>,
    operator: Operator<'a>,
}

impl<'a> Imperfect<'a> {
    /// Sets up the electric equation of surfaces with a condition for every triangle, with
    /// integrals to a relative `tolerance` for each pair of triangles.
    ///
    /// # Errors
    /// [`MomentsError::Coarse`] for edges above λ/3 (λ/2 with functions of the first full order),
    /// [`MomentsError::Parameter`] for impedances that are none, or another number of conditions
    /// than of triangles, and of bodies with a surface impedance [`MomentsError::NotClosed`],
    /// [`MomentsError::Junction`] and [`MomentsError::Patchwork`].
    pub fn new(
        basis: &'a Basis,
        wave: Wave,
        conditions: Vec<Condition>,
        tolerance: f64,
    ) -> Result<Self, MomentsError> {
        let triangles = basis.surface().triangles().len();
        if conditions.len() != triangles {
            let (what, expected) = ("the number of conditions", "that of the triangles");
            return Err(MomentsError::Parameter { what, value: conditions.len() as f64, expected });
        }
        conditions.iter().try_for_each(|condition| condition.check())?;
        check_bodies(basis, &conditions)?;
        basis.topology().check_resolution(basis.surface(), wave.wavelength(), basis.order())?;
        let k = Complex64::from(wave.wavenumber());
        let of_function = |f: &crate::Function| conditions[f.halves[0].triangle as usize].kinds();
        let kinds: Vec<Kinds> = basis.functions().iter().map(of_function).collect();
        let term = if kinds.iter().all(|kinds| kinds.count == 1) {
            electric_term(basis.order(), k, 1.0, tolerance)?
        } else {
            term(basis.order(), Space { k, impedance: Complex64::ONE }, tolerance)?
        };
        let products = Products::OnTriangles(conditions.iter().map(|c| c.factors()).collect());
        let operator = Operator::new(basis, kinds, vec![term], products, Symmetry::Symmetric);
        Ok(Self { wave, conditions, operator })
    }

    /// The matrix.
    #[must_use]
    pub fn operator(&self) -> &Operator<'a> {
        &self.operator
    }

    /// One right-hand side for each of the sets of sources outside, V.
    #[must_use]
    pub fn right_hand_side(&self, excitations: &[&[&dyn Source]]) -> MultiVector<Complex64> {
        tested_with_both(&self.operator, &self.wave, excitations)
    }

    /// The currents of a solution. What they radiate into free space is the scattered field.
    ///
    /// # Panics
    /// Like a slice, where there are fewer unknowns than those of the operator.
    #[must_use]
    pub fn currents(&self, x: &[Complex64]) -> Currents<'a> {
        currents(&self.operator, self.wave, x)
    }

    /// Power (W) that sheets and bodies absorb: ½ ∫ Re Z_s |J|² dA. Of bodies, where M stands for
    /// Z_s J but for the error of the mesh, it is the mean of both forms, ¼ ∫ (Re Z_s |J|² + Re
    /// 1/Z_s
    /// |M|²) dA, with which the equations balance by themselves.
    #[must_use]
    pub fn absorbed_power(&self, currents: &Currents<'a>) -> f64 {
        let on_triangle = |(triangle, condition): (usize, &Condition)| {
            let (z, [electric, magnetic]) = (condition.impedance(), currents.squares(triangle));
            match condition {
                Condition::Body(_) if z == Complex64::ZERO => 0.0,
                Condition::Body(_) => 0.25 * (z.re * electric + z.inv().re * magnetic),
                Condition::Conductor | Condition::Sheet(_) => 0.5 * z.re * electric,
            }
        };
        self.conditions.iter().enumerate().map(on_triangle).sum()
    }
}

/// Refuses surface impedances on what is no closed body, or on a part of one only.
fn check_bodies(basis: &Basis, conditions: &[Condition]) -> Result<(), MomentsError> {
    let (equation, topology) = ("a surface impedance", basis.topology());
    let mut first_of = vec![None; conditions.len()];
    for (triangle, condition) in conditions.iter().enumerate() {
        let first = *first_of[topology.component_of(triangle)].get_or_insert(triangle);
        if *condition != conditions[first] && (condition.is_body() || conditions[first].is_body()) {
            return Err(MomentsError::Patchwork { first, second: triangle });
        }
    }
    for (edge, meeting) in topology.edges().iter().enumerate() {
        let triangle = meeting.sides[0].triangle as usize;
        match meeting.sides.len() {
            _ if !conditions[triangle].is_body() => {}
            1 => return Err(MomentsError::NotClosed { equation, edge, triangle }),
            2 => {}
            triangles => return Err(MomentsError::Junction { equation, edge, triangles }),
        }
    }
    Ok(())
}
