//! Pieces that cross or lie on each other.

use super::boxes::Boxes;
use super::overlap::{area, common, cross};
use crate::{Bounds, Patch, Vec3};

/// Distance, relative to the longest side of the box around all, up to which pieces lie in one
/// plane. Files mostly hold coordinates of six or seven digits: what was meant to be in one plane
/// is so within their rounding only.
const SAME_PLANE_DISTANCE: f64 = 1e-7;
/// Roundings of the largest coordinate that it is no less than.
const ROUNDINGS: f64 = 16.0;

/// Two pieces that lie on each other, wholly or in part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The pieces, the one of the smaller number first.
    pub pieces: [u32; 2],
    /// Whether both are lit on the same side.
    pub same_side: bool,
    /// Area in common, m².
    pub area: f64,
    /// A point of it, m.
    pub place: Vec3,
}

/// What meets without sharing sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    /// Pieces that lie on each other.
    pub overlaps: Vec<Overlap>,
    /// Pieces that cross each other.
    pub crossings: Vec<[u32; 2]>,
}

impl Contacts {
    /// Compares pieces whose boxes meet.
    #[must_use]
    pub fn of(pieces: &[Patch]) -> Self {
        let tolerance = tolerance(pieces);
        let boxes: Vec<Bounds> = pieces.iter().map(around).collect();
        let tree = Boxes::new(boxes.clone());
        let mut found = Self::default();
        for (first, (patch, own)) in pieces.iter().zip(&boxes).enumerate() {
            for second in tree.near(own, tolerance) {
                let other = &pieces[second as usize];
                let pair = [first as u32, second];
                if second as usize <= first {
                    continue;
                }
                if let Some(polygon) = common(patch, other, tolerance) {
                    found.overlaps.push(Overlap {
                        pieces: pair,
                        same_side: patch.normal().dot(other.normal()) > 0.0,
                        area: area(&polygon, patch.normal()),
                        place: polygon.iter().sum::<Vec3>() / polygon.len() as f64,
                    });
                } else if cross(patch, other, tolerance) {
                    found.crossings.push(pair);
                }
            }
        }
        found
    }
}

/// Distance up to which pieces lie in one plane, m.
pub(super) fn tolerance<'a>(pieces: impl IntoIterator<Item = &'a Patch>) -> f64 {
    let bounds = Bounds::around(pieces.into_iter().flat_map(|patch| patch.corners().iter().copied()));
    let Some(Bounds { min, max }) = bounds else { return 0.0 };
    let largest = min.abs().max(max.abs()).max_element();
    (SAME_PLANE_DISTANCE * (max - min).max_element()).max(ROUNDINGS * f64::EPSILON * largest)
}

/// The box around a patch.
pub(super) fn around(patch: &Patch) -> Bounds {
    let (mut min, mut max) = (patch.corner(0), patch.corner(0));
    for &corner in patch.corners() {
        (min, max) = (min.min(corner), max.max(corner));
    }
    Bounds { min, max }
}
