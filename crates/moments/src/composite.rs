//! Dielectric bodies and conductors, next to and inside of each other: the equations of Poggio,
//! Miller, Chang, Harrington, Wu and Tsai in every region, the electric one on conductors.
//!
//! Every region r has currents on its border, J = n × H and M = −n × E with n into it. The field in
//! it is what they radiate in its medium, in region 0 with the incident field. On a border between
//! two dielectrics the currents of both sides are the negatives of each other, on conductors M = 0.
//! Equal tangential fields on both sides, and E_tan = 0 on conductors, tested with the functions of
//! the currents ([`Basis::between`]):
//!
//! ```text
//! Σ_r [η_r ⟨f_r, T_r J_r⟩ + ⟨f_r, K_r M_r⟩]    =  ⟨f₀, E_i⟩
//! Σ_r [⟨f_r, K_r J_r⟩ − ⟨f_r, T_r M_r⟩/η_r]    = −⟨f₀, H_i⟩
//! ```
//!
//! with f_r the part of a function in region r. What principal values leave out is opposite on both
//! sides of a border between dielectrics. A. J. Poggio, E. K. Miller, in R. Mittra (ed.), Computer
//! Techniques for Electromagnetics, Pergamon 1973, ch. 4; J. R. Mautz, R. F. Harrington, AEÜ 33
//! (1979) 71; P. Ylä-Oijala, M. Taskinen, J. Sarvas, Progress In Electromagnetics Research 52
//! (2005) 81, doi:10.2528/PIER04071301. Dielectrics have no resonances; the inside of closed
//! conductors has those of the electric equation. The matrix is symmetric. The permeability is that
//! of free space. Unknowns are η₀ J and M of every function, side by side, in V.

use crate::currents::Space;
use crate::element_kernel::Tests;
use crate::equation::tested;
use crate::kernel::Wanted;
use crate::operator::{Factors, Integrals, Kinds, Operator, Products, Term};
use crate::regions::Regions;
use crate::{Basis, Currents, MomentsError, Order};
use fredholm_linop::{MultiVector, Symmetry};
use fredholm_mesh::Vec3;
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{Field, Source, Wave};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Bodies of one or several dielectrics and conductors in a wave.
#[derive(Clone, Debug)]
pub struct Composite<'a> {
    regions: &'a Regions,
    wave: Wave,
    /// Of every region.
    spaces: Vec<Space>,
    operator: Operator<'a>,
}

impl<'a> Composite<'a> {
    /// Bodies whose dielectrics have these relative permittivities ε′ − jε″, by their numbers, with
    /// integrals to a relative `tolerance` for each pair of triangles. The basis is one between
    /// regions.
    ///
    /// # Errors
    /// [`MomentsError::Coarse`] for edges above a third of the wavelength on either side (half of
    /// it with functions of the first full order), [`MomentsError::Parameter`] for numbers out of
    /// range and too few permittivities, [`MomentsError::NoRegions`] for a basis of a surface in
    /// free space.
    pub fn new(
        basis: &'a Basis,
        wave: Wave,
        permittivities: &[Complex64],
        tolerance: f64,
    ) -> Result<Self, MomentsError> {
        let regions = basis.regions().ok_or(MomentsError::NoRegions)?;
        let space = |medium: &Option<usize>| {
            let permittivity = medium.map_or(Ok(Complex64::ONE), |number| given(permittivities, number))?;
            check(permittivity)?;
            let index = permittivity.sqrt();
            Ok(Space { k: index * wave.wavenumber(), impedance: index.inv() })
        };
        let spaces: Vec<Space> = regions.media().iter().map(space).collect::<Result<_, MomentsError>>()?;
        check_resolution(basis, &spaces)?;
        let terms =
            spaces.iter().map(|&space| term(basis.order(), space, tolerance)).collect::<Result<_, _>>()?;
        let kinds =
            |function: &crate::Function| if function.magnetic { Kinds::BOTH } else { Kinds::ELECTRIC };
        let kinds = basis.functions().iter().map(kinds).collect();
        let products = Products::Everywhere(Factors::default());
        let operator = Operator::new(basis, kinds, terms, products, Symmetry::Symmetric);
        Ok(Self { regions, wave, spaces, operator })
    }

    /// The matrix.
    #[must_use]
    pub fn operator(&self) -> &Operator<'a> {
        &self.operator
    }

    /// One right-hand side for each of the sets of sources in region 0, V.
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

    /// The total field at points (m) inside of bodies, 0 in conductors; none in region 0.
    ///
    /// # Errors
    /// [`MomentsError::OnSurface`] for a point on the surface.
    pub fn fields_inside(
        &self,
        currents: &Currents<'a>,
        points: &[Vec3],
    ) -> Result<Vec<Option<Field>>, MomentsError> {
        let regions: Vec<Option<usize>> = points.iter().map(|&p| self.regions.at(p)).collect();
        let mut fields: Vec<Option<Field>> = vec![None; points.len()];
        for (field, _) in fields.iter_mut().zip(&regions).filter(|(_, region)| region.is_none()) {
            *field = Some(Field::ZERO);
        }
        for (region, &space) in self.spaces.iter().enumerate().skip(1) {
            let inside: Vec<usize> = (0..points.len()).filter(|&i| regions[i] == Some(region)).collect();
            let places: Vec<Vec3> = inside.iter().map(|&i| points[i]).collect();
            let found = currents.fields_in(&places, region, space).map_err(|error| match error {
                MomentsError::OnSurface { point, triangle } => {
                    MomentsError::OnSurface { point: inside[point], triangle }
                }
                error => error,
            })?;
            inside.into_iter().zip(found).for_each(|(i, field)| fields[i] = Some(field));
        }
        Ok(fields)
    }
}

/// The permittivity of a number.
fn given(permittivities: &[Complex64], number: usize) -> Result<Complex64, MomentsError> {
    permittivities.get(number).copied().ok_or(MomentsError::Parameter {
        what: "the number of a dielectric",
        value: number as f64,
        expected: "below that of the permittivities",
    })
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

/// Refuses triangles that are too large for the wave in a region next to them.
fn check_resolution(basis: &Basis, spaces: &[Space]) -> Result<(), MomentsError> {
    let shortest = |sides: &[crate::Side]| {
        let regions = sides.iter().flat_map(|side| basis.faces()[side.triangle as usize].regions).flatten();
        TAU / regions.map(|region| spaces[region].k.norm()).fold(0.0, f64::max)
    };
    let edges = basis.topology().edges().iter().enumerate();
    edges.map(|(edge, meeting)| (edge, meeting, shortest(&meeting.sides))).try_for_each(
        |(edge, meeting, wavelength)| {
            let [a, b] = meeting.vertices.map(|vertex| basis.surface().vertices()[vertex as usize]);
            let length = a.distance(b);
            let (longest, most) = basis.order().longest_edge();
            if length > longest * wavelength {
                return Err(MomentsError::Coarse { edge, length, wavelength, most });
            }
            Ok(())
        },
    )
}

/// ⟨f, E_i⟩ and, where there is a magnetic current, −η₀ ⟨f, H_i⟩ of every function times the unit
/// of its unknown.
pub(crate) fn tested_with_both(
    operator: &Operator<'_>,
    wave: &Wave,
    excitations: &[&[&dyn Source]],
) -> MultiVector<Complex64> {
    let mut b = MultiVector::zeros(operator.dim(), excitations.len());
    let any = operator.unknowns().any(|(_, magnetic)| magnetic.is_some());
    for (rhs, sources) in excitations.iter().enumerate() {
        let electric = tested(operator.basis(), wave, sources, Tests::Straight, |field| field.e);
        let magnetic = if any {
            tested(operator.basis(), wave, sources, Tests::Straight, |field| field.h * -IMPEDANCE)
        } else {
            Vec::new()
        };
        for (function, (first, second)) in operator.unknowns().enumerate() {
            b.row_mut(first)[rhs] = electric[function];
            if let Some((second, unit)) = second {
                b.row_mut(second)[rhs] = magnetic[function] * unit;
            }
        }
    }
    b
}

/// The currents of the unknowns of an operator.
pub(crate) fn currents<'a>(operator: &Operator<'a>, wave: Wave, x: &[Complex64]) -> Currents<'a> {
    let electric: Vec<Complex64> = operator.unknowns().map(|(first, _)| x[first]).collect();
    let of = |second: Option<(usize, f64)>| second.map_or(Complex64::ZERO, |(at, unit)| x[at] * unit);
    let any = operator.unknowns().any(|(_, second)| second.is_some());
    let magnetic: Option<Vec<Complex64>> =
        any.then(|| operator.unknowns().map(|(_, second)| of(second)).collect());
    Currents::new(operator.basis(), wave, &electric, magnetic.as_deref())
}

/// What one region adds.
pub(crate) fn term(order: Order, space: Space, tolerance: f64) -> Result<Term, MomentsError> {
    let (zero, one) = (Complex64::ZERO, Complex64::ONE);
    let wanted = Wanted { electric: true, magnetic: true };
    Ok(Term {
        integrals: Integrals::new(order, space.k, (wanted, Tests::Straight), tolerance)?,
        electric: [[space.impedance, zero], [zero, -space.impedance.inv()]],
        magnetic: [[zero, one], [one, zero]],
    })
}
