//! Facets that a point is close to, integrated for it alone.

use super::Radiator;
use crate::rule::seen_from;
use crate::{Current, Facet, Field, WaveError, electric_element, magnetic_element};
use fredholm_mesh::Vec3;

/// Height over a facet, in its diameters, up to which a point lies on it.
const TOUCHING: f64 = 1e-9;

impl Radiator<'_> {
    /// What the near facets of receiver `index` at `p` radiate to it.
    pub(super) fn near_part(&self, index: usize, p: Vec3) -> Result<Field, WaveError> {
        let mut sum = Field::ZERO;
        for group in &self.groups {
            let d = p - Vec3::from_array(group.centre);
            if d.length_squared() > group.near_squared {
                continue;
            }
            let facet = &self.scatterer.facets()[group.facet];
            if touches(facet, p) {
                return Err(WaveError::OnSurface { receiver: index, facet: group.facet });
            }
            let weight = if d.dot(facet.normal) > 0.0 { 1.0 } else { group.behind };
            sum += self.facet(group.facet, p) * weight;
        }
        Ok(sum)
    }

    /// The field of one facet at `p`, by the rule that its distance asks for.
    fn facet(&self, index: usize, p: Vec3) -> Field {
        let facet = &self.scatterer.facets()[index];
        let term = |(q, weight): (Vec3, f64)| {
            let Current { j, m } = self.current.at(index, q);
            let electric = electric_element(&self.wave, j * weight, p - q);
            if self.magnetic.is_empty() {
                return electric;
            }
            electric + magnetic_element(&self.wave, m * weight, p - q)
        };
        seen_from(facet, p, self.phase(facet), self.tolerance).into_iter().map(term).sum()
    }
}

/// Whether p lies on the facet.
fn touches(facet: &Facet, p: Vec3) -> bool {
    let margin = TOUCHING * facet.diameter;
    let height = facet.normal.dot(p - facet.centre);
    let inside = |i: usize| {
        let (a, b) = (facet.patch.corner(i), facet.patch.corner(i + 1));
        facet.normal.cross(b - a).normalize_or_zero().dot(p - a) >= -margin
    };
    height.abs() <= margin && (0..facet.patch.sides()).all(inside)
}
