//! The 2 × 2 block of a pair of facets, and the integral G it is made of.

use crate::element::curl;
use crate::rule::seen_from;
use crate::{ComplexVector, Facet, Shadow, Wave};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// K_ab, a row a tangent of the observer.
pub(crate) type Block = [[Complex64; 2]; 2];

/// The block of observer p and source q from G and the sign s.
pub(crate) fn block(p: &Facet, q: &Facet, g: ComplexVector, sign: f64, shadow: Shadow) -> Block {
    let factor = if shadow == Shadow::Thesis { -2.0 * sign } else { 2.0 * sign };
    let normal = g.dot(p.normal);
    p.tangents.map(|a| q.tangents.map(|b| (g.dot(a) * p.normal.dot(b) - normal * a.dot(b)) * factor))
}

/// G at `x` by one point in the middle of the source.
pub(crate) fn midpoint(wave: &Wave, x: Vec3, q: &Facet) -> ComplexVector {
    term(wave, x - q.centre, q.area)
}

/// G at `x` by the rule that the distance asks for.
pub(crate) fn integral(wave: &Wave, x: Vec3, q: &Facet, tolerance: f64) -> ComplexVector {
    let rule = seen_from(q, x, wave.wavenumber() * q.edge(), tolerance);
    rule.into_iter().map(|(y, weight)| term(wave, x - y, weight)).sum()
}

fn term(wave: &Wave, d: Vec3, weight: f64) -> ComplexVector {
    ComplexVector::along(d, curl(wave.wavenumber(), d.length()) * weight)
}
