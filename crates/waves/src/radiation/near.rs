//! Facets that a point is close to, integrated for it alone.

use super::{Group, Radiator, phase};
use crate::rule::seen_from;
use crate::{Current, Facet, Field, WaveError, electric_element, magnetic_element};
use fredholm_mesh::Vec3;

/// Height over a facet, in its diameters, up to which a point lies on it.
const TOUCHING_HEIGHT: f64 = 1e-9;

/// Facets that are looked at together.
const FACETS_OF_A_RUN: usize = 64;

/// A sphere around the places that are near to some facets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    centre: Vec3,
    radius: f64,
}

impl Run {
    /// The spheres of consecutive groups.
    pub(crate) fn all(groups: &[Group]) -> Vec<Self> {
        groups.chunks(FACETS_OF_A_RUN).map(Self::around).collect()
    }

    fn around(groups: &[Group]) -> Self {
        let centres = || groups.iter().map(|group| Vec3::from_array(group.centre));
        let centre = centres().sum::<Vec3>() / groups.len() as f64;
        let reach =
            groups.iter().zip(centres()).map(|(group, c)| c.distance(centre) + group.near_squared.sqrt());
        // What rounding could add.
        Self { centre, radius: reach.fold(0.0, f64::max) * (1.0 + 1e-9) }
    }

    /// The groups that leave out the point `p`, in their order.
    pub(crate) fn near<'a>(
        groups: &'a [Group],
        runs: &'a [Self],
        p: Vec3,
    ) -> impl Iterator<Item = &'a Group> {
        let close = groups.chunks(FACETS_OF_A_RUN).zip(runs).filter(move |(_, run)| run.may_be_near(p));
        let left_out = move |group: &&Group| group.leaves_out(p - Vec3::from_array(group.centre));
        close.flat_map(|(groups, _)| groups).filter(left_out)
    }

    fn may_be_near(&self, p: Vec3) -> bool {
        p.distance(self.centre) <= self.radius
    }
}

impl Radiator<'_> {
    /// What the near facets of receiver `index` at `p` radiate to it.
    pub(super) fn near_part(&self, index: usize, p: Vec3) -> Result<Field, WaveError> {
        let (mut sum, samples) = (Field::ZERO, self.samples());
        for group in Run::near(&samples.groups, &samples.runs, p) {
            let d = p - Vec3::from_array(group.centre);
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
            if self.samples().magnetic.is_empty() {
                return electric;
            }
            electric + magnetic_element(&self.wave, m * weight, p - q)
        };
        let phase = phase(facet, &self.wave);
        seen_from(facet, p, phase, self.tolerance()).into_iter().map(term).sum()
    }
}

/// Whether p lies on the facet.
fn touches(facet: &Facet, p: Vec3) -> bool {
    let margin = TOUCHING_HEIGHT * facet.diameter;
    let height = facet.normal.dot(p - facet.centre);
    let inside = |i: usize| {
        let (a, b) = (facet.patch.corner(i), facet.patch.corner(i + 1));
        facet.normal.cross(b - a).normalize_or_zero().dot(p - a) >= -margin
    };
    height.abs() <= margin && (0..facet.patch.sides()).all(inside)
}
