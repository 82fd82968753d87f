//! Several bounces between any materials: K of the currents J and M/η₀, by Nyström at the centres.
//!
//! What facet q sends is at facet p a wave that comes from q, so that its angle of incidence is
//! known pair by pair and the coefficients of reflection and transmission apply as to the wave of a
//! source: J = n × (H + H_r − H_t), M = −n × (E + E_r − E_t). Coefficients are made for waves with
//! both fields across their travel u: of J the H is taken as it is, and E = η₀ H × u; of M the E
//! is, and H = u × E/η₀. So facets of one plane do not couple. On perfect conductors this is the
//! coupling of the electric form, with M = 0. It is physical optics at every bounce (F.
//! Obelleiro-Basteiro, J. L. Rodriguez, R. J. Burkholder, IEEE Trans. Antennas Propag. 43 (1995)
//! 356, with the tangent plane's coefficients instead of those of a conductor).
//!
//! Unknowns of facet i are 4i … 4i + 3: J along t₁ and t₂, M/η₀ along t₁ and t₂, all in A/m.
//! Products are computed pair by pair; nothing but the view is stored.

use super::View;
use super::dense::assemble;
use super::sides::sign;
use crate::medium::IMPEDANCE;
use crate::optics::response;
use crate::rule::{phase_error, reach, seen_from};
use crate::{
    ComplexVector, Current, Facet, Field, Scatterer, Shadow, TOLERANCE, Wave, WaveError, electric_element,
    magnetic_element,
};
use fredholm_linop::{Dense, LinearOperator, MultiVector};
use fredholm_mesh::Vec3;
use num_complex::Complex64;
use rayon::prelude::*;

/// Unknowns of a facet.
pub(crate) const UNKNOWNS: usize = 4;

/// The coupling of the currents of any materials.
pub struct MaterialCoupling<'a> {
    scatterer: &'a Scatterer,
    wave: Wave,
    shadow: Shadow,
    view: Option<View>,
}

impl<'a> MaterialCoupling<'a> {
    /// Finds what sees each other.
    ///
    /// # Errors
    /// [`WaveError::NotConductor`] for treatments of shadows that know conductors only.
    pub fn new(scatterer: &'a Scatterer, wave: Wave, shadow: Shadow) -> Result<Self, WaveError> {
        shadow.check(scatterer)?;
        Ok(Self { scatterer, wave, shadow, view: View::new(scatterer, shadow) })
    }

    /// Bytes of the view, at most: before anything is computed.
    #[must_use]
    pub fn bytes(scatterer: &Scatterer, shadow: Shadow) -> u64 {
        View::bytes(scatterer, shadow)
    }

    fn facet(&self, i: usize) -> &Facet {
        &self.scatterer.facets()[i]
    }

    /// Whether q sends anything to p.
    fn couples(&self, p: usize, q: usize) -> bool {
        let seen = || self.view.as_ref().is_none_or(|view| view.sees(p, q));
        let d = self.facet(p).centre - self.facet(q).centre;
        p != q && sign(self.facet(p), self.facet(q), d, self.shadow) != 0.0 && seen()
    }

    /// The current at p that the current of q makes.
    fn made(&self, p: usize, q: usize, sent: Current) -> Current {
        let (observer, source) = (self.facet(p), self.facet(q));
        if self.is_far(observer, source) {
            return self.term(observer, observer.centre - source.centre, source.area, sent);
        }
        let phase = self.wave.wavenumber() * source.edge();
        let rule = seen_from(source, observer.centre, phase, TOLERANCE);
        let terms =
            rule.into_iter().map(|(y, weight)| self.term(observer, observer.centre - y, weight, sent));
        terms.fold(Current::default(), |sum, term| Current { j: sum.j + term.j, m: sum.m + term.m })
    }

    /// Whether one point of the source is enough, as for conductors: beyond its reach, or on the
    /// same smooth surface.
    fn is_far(&self, p: &Facet, q: &Facet) -> bool {
        let error = phase_error(1, self.wave.wavenumber() * q.edge()).clamp(TOLERANCE, 0.1);
        let near = 0.5 * q.diameter * reach(1, error);
        p.centre.distance_squared(q.centre) > near * near
            || p.normal.dot(q.normal) > super::nystrom::SMOOTH_COSINE
    }

    /// The same for one point of the source, at the separation d.
    fn term(&self, observer: &Facet, d: Vec3, weight: f64, sent: Current) -> Current {
        let towards = (-d).normalize_or_zero();
        let side = observer.side(towards);
        if side == 0.0 {
            return Current::default();
        }
        let h = electric_element(&self.wave, sent.j * weight, d).h;
        let mut field = Field { e: h.crossed_by(towards) * IMPEDANCE, h };
        if sent.m != ComplexVector::ZERO {
            let e = magnetic_element(&self.wave, sent.m * weight, d).e;
            field += Field { e, h: e.crossed_by(towards) * (-1.0 / IMPEDANCE) };
        }
        response(self.scatterer.material(observer), &self.wave, (observer, side, towards), field, self.shadow)
    }

    /// The block of a pair, a row an unknown of p.
    fn block(&self, p: usize, q: usize) -> [[Complex64; UNKNOWNS]; UNKNOWNS] {
        if !self.couples(p, q) {
            return [[Complex64::ZERO; UNKNOWNS]; UNKNOWNS];
        }
        let columns: [[Complex64; UNKNOWNS]; UNKNOWNS] = std::array::from_fn(|b| {
            let unit = std::array::from_fn(|a| Complex64::from(if a == b { 1.0 } else { 0.0 }));
            values(self.facet(p), self.made(p, q, current(self.facet(q), unit)))
        });
        std::array::from_fn(|a| columns.map(|column| column[a]))
    }

    /// All blocks stored: [`Dense::bytes`] of four times the number of facets.
    ///
    /// # Errors
    /// [`WaveError::Linop`] where it does not fit in memory.
    pub fn dense_matrix(&self) -> Result<Dense<Complex64>, WaveError> {
        assemble(self.scatterer.facets().len(), |p, q| self.block(p, q))
    }
}

/// The current of the unknowns of a facet.
pub(crate) fn current(facet: &Facet, [a, b, c, d]: [Complex64; UNKNOWNS]) -> Current {
    let along = |pair: [Complex64; 2]| super::nystrom::tangential(facet, pair);
    Current { j: along([a, b]), m: along([c, d]) * IMPEDANCE }
}

/// The unknowns of a facet from its current.
pub(crate) fn values(facet: &Facet, Current { j, m }: Current) -> [Complex64; UNKNOWNS] {
    let [s, t] = facet.tangents;
    [j.dot(s), j.dot(t), m.dot(s) / IMPEDANCE, m.dot(t) / IMPEDANCE]
}

impl LinearOperator<Complex64> for MaterialCoupling<'_> {
    fn dim(&self) -> usize {
        UNKNOWNS * self.scatterer.facets().len()
    }

    fn apply(&self, x: &MultiVector<Complex64>, y: &mut MultiVector<Complex64>) {
        let facets = self.scatterer.facets();
        for l in 0..x.rhs_count() {
            let unknowns = |q: usize| std::array::from_fn(|a| x.row(UNKNOWNS * q + a)[l]);
            let sent: Vec<Current> = (0..facets.len()).map(|q| current(&facets[q], unknowns(q))).collect();
            let rows: Vec<[Complex64; UNKNOWNS]> = (0..facets.len())
                .into_par_iter()
                .map(|p| {
                    let mut sum = Current::default();
                    for q in (0..facets.len()).filter(|&q| self.couples(p, q)) {
                        let made = self.made(p, q, sent[q]);
                        sum = Current { j: sum.j + made.j, m: sum.m + made.m };
                    }
                    values(&facets[p], sum)
                })
                .collect();
            for (p, row) in rows.iter().enumerate() {
                (0..UNKNOWNS).for_each(|a| y.row_mut(UNKNOWNS * p + a)[l] = row[a]);
            }
        }
    }

    fn row(&self, i: usize, _rhs: usize, out: &mut [Complex64]) {
        let (p, a) = (i / UNKNOWNS, i % UNKNOWNS);
        for (q, entries) in out.chunks_exact_mut(UNKNOWNS).enumerate() {
            entries.copy_from_slice(&self.block(p, q)[a]);
        }
    }

    fn column(&self, j: usize, _rhs: usize, out: &mut [Complex64]) {
        let (q, b) = (j / UNKNOWNS, j % UNKNOWNS);
        for (p, entries) in out.chunks_exact_mut(UNKNOWNS).enumerate() {
            entries.copy_from_slice(&self.block(p, q).map(|row| row[b]));
        }
    }

    fn diagonal(&self, _rhs: usize, out: &mut [Complex64]) {
        out.fill(Complex64::ZERO);
    }
}
