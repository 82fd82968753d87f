//! Faces that close round a convex volume become one solid, so that its shadow is one convex shape.
//!
//! A solid may lack one face: a segment that crosses the volume enters and leaves through different
//! faces, so one of the two is there. It may lack more where each is covered by another face, or
//! has all elements on one side: nothing is seen through those.

use std::collections::BTreeMap;

use fredholm_mesh::{Patch, Vec3};

use super::outline::MOST_FACES;
use super::weld::{Polygon, undirected};
use super::{Body, Edge, Face};
use crate::frame::Frame;

/// The faces as one convex solid, or `None` where they are none.
pub(super) fn solid(points: &[Vec3], polygons: &[&Polygon], tolerance: f64, frame: &Frame) -> Option<Solid> {
    if polygons.len() < 3 || polygons.len() >= MOST_FACES {
        return None;
    }
    let mut numbers: Vec<u32> = polygons.iter().flat_map(|p| p.corners.iter().copied()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let corners: Vec<Vec3> = numbers.iter().map(|&k| points[k as usize]).collect();
    let outward: Vec<Polygon> = polygons.iter().map(|p| turned_outward(points, p, &corners)).collect();
    let mut faces: Vec<Face> =
        outward.iter().map(|p| Face::through(points[p.corners[0] as usize], p.normal)).collect();
    let (mut edges, open) = edges(&outward)?;
    let mut lids = Vec::new();
    for ring in rings(open)? {
        let number = (faces.len() + lids.len()) as u32;
        edges.extend(ring.iter().map(|&(side, face)| Edge { ends: side, faces: [face, number] }));
        lids.push(Lid::over(points, &ring, tolerance)?);
    }
    faces.extend(lids.iter().map(|lid| lid.face));
    if faces.len() > MOST_FACES {
        return None;
    }
    let convex = faces.iter().all(|face| bounds(face, &corners, tolerance));
    let place = |k: u32| numbers.binary_search(&k).unwrap_or_default() as u32;
    for edge in &mut edges {
        edge.ends = edge.ends.map(place);
    }
    convex.then(|| Solid { body: Body::new(corners, faces, edges, frame), lids })
}

/// A solid, and which faces are missing: the last ones.
pub(super) struct Solid {
    pub body: Body,
    lids: Vec<Lid>,
}

/// A face that is missing.
pub(super) struct Lid {
    pub face: Face,
    pub corners: Vec<Vec3>,
}

impl Lid {
    /// The face within a ring of sides of the others, which run the other way round it; `None`
    /// where they do not lie in a plane.
    fn over(points: &[Vec3], ring: &[Side], tolerance: f64) -> Option<Self> {
        let corners: Vec<Vec3> = ring.iter().rev().map(|(side, _)| points[side[1] as usize]).collect();
        let origin = *corners.first()?;
        let crosses = corners.windows(2).map(|ends| (ends[0] - origin).cross(ends[1] - origin));
        let face = Face::through(origin, crosses.sum::<Vec3>().try_normalize()?);
        let flat = corners.iter().all(|&x| face.height(x).abs() <= tolerance);
        flat.then_some(Self { face, corners })
    }
}

/// A side and the polygon it belongs to.
type Side = ([u32; 2], u32);

fn turned_outward(points: &[Vec3], polygon: &Polygon, corners: &[Vec3]) -> Polygon {
    let centre = corners.iter().sum::<Vec3>() / corners.len() as f64;
    let above = (centre - points[polygon.corners[0] as usize]).dot(polygon.normal) > 0.0;
    if above { polygon.clone().flipped() } else { polygon.clone() }
}

/// The edges where two polygons meet, and the sides that belong to one only; `None` where polygons
/// overlap.
fn edges(polygons: &[Polygon]) -> Option<(Vec<Edge>, Vec<Side>)> {
    let mut sides: BTreeMap<[u32; 2], Vec<Side>> = BTreeMap::new();
    for (polygon, face) in polygons.iter().zip(0..) {
        for side in polygon.sides() {
            sides.entry(undirected(side)).or_default().push((side, face));
        }
    }
    let (mut edges, mut open) = (Vec::new(), Vec::new());
    for uses in sides.into_values() {
        match uses[..] {
            [single] => open.push(single),
            [(side, left), (back, right)] if side[0] == back[1] => {
                edges.push(Edge { ends: side, faces: [left, right] });
            }
            _ => return None,
        }
    }
    Some((edges, open))
}

/// The sides of polygons that belong to one only, put together to rings; `None` where a corner has
/// two of them.
fn rings(open: Vec<Side>) -> Option<Vec<Vec<Side>>> {
    let count = open.len();
    let mut from: BTreeMap<u32, Side> = open.into_iter().map(|side| (side.0[0], side)).collect();
    if from.len() < count {
        return None;
    }
    let mut rings = Vec::new();
    while let Some((_, first)) = from.pop_first() {
        let mut ring = vec![first];
        let mut end = first.0[1];
        while end != first.0[0] {
            let next = from.remove(&end)?;
            ring.push(next);
            end = next.0[1];
        }
        rings.push(ring);
    }
    Some(rings)
}

/// Whether all corners lie behind the face, and one of them far enough for a volume.
fn bounds(face: &Face, corners: &[Vec3], tolerance: f64) -> bool {
    let deepest = corners.iter().map(|&x| face.height(x)).fold(0.0, f64::min);
    corners.iter().all(|&x| face.height(x) <= tolerance) && deepest < -1e3 * tolerance
}

/// Relative difference of an area and the sum of its parts.
const AREA_TOLERANCE: f64 = 1e-6;

impl Solid {
    /// Whether one solid hides what its faces hide: no point is in it, no element reaches into it,
    /// and those that lie on it looking in are covered by its faces, as what stands on a body or
    /// under it is, and are not the inner sides of a hollow body. `covered` tells whether another
    /// face covers a missing one.
    pub fn stands_for_its_faces(
        &self,
        elements: &[&Patch],
        points: &[Vec3],
        tolerance: f64,
        covered: impl Fn(&Lid) -> bool,
    ) -> bool {
        let outside = |x: &Vec3| self.body.faces().iter().any(|face| face.height(*x) > tolerance);
        if !points.iter().all(outside) || !self.is_shut(elements, points, tolerance, covered) {
            return false;
        }
        let mut looked_into = vec![0.0; self.body.faces().len()];
        let reaches = elements.iter().any(|element| match self.meets(element, tolerance) {
            Meeting::Apart => false,
            Meeting::Inside => true,
            Meeting::LooksIn(face) => {
                if self.within(element, face, tolerance) {
                    looked_into[face as usize] += element.area();
                }
                false
            }
        });
        !reaches && !self.hollow(&looked_into)
    }

    /// Whether nothing is seen through the missing faces, or only one is missing.
    fn is_shut(
        &self,
        elements: &[&Patch],
        points: &[Vec3],
        tolerance: f64,
        covered: impl Fn(&Lid) -> bool,
    ) -> bool {
        let seen = || elements.iter().flat_map(|element| element.corners()).chain(points);
        let ends = |lid: &Lid| seen().all(|&x| lid.face.height(x) <= tolerance);
        self.lids.len() <= 1 || self.lids.iter().all(|lid| ends(lid) || covered(lid))
    }

    /// Whether an element in the plane of a face lies in that face.
    fn within(&self, element: &Patch, face: u32, tolerance: f64) -> bool {
        let mut others = self.body.faces().iter().zip(0..).filter(|(_, k)| *k != face);
        others.all(|(other, _)| element.corners().iter().all(|&x| other.height(x) <= tolerance))
    }

    /// Whether elements that look in cover all faces but one at most.
    fn hollow(&self, looked_into: &[f64]) -> bool {
        let bare = (0..looked_into.len() - self.lids.len())
            .filter(|&k| looked_into[k] < (1.0 - AREA_TOLERANCE) * self.body.face_area(k));
        bare.count() <= 1
    }

    fn meets(&self, element: &Patch, tolerance: f64) -> Meeting {
        let faces = self.body.faces();
        let all = |face: &Face, low: f64| element.corners().iter().all(|&x| face.height(x) >= low);
        if faces.iter().any(|face| all(face, tolerance)) {
            return Meeting::Apart;
        }
        let against = |k: &usize| all(&faces[*k], -tolerance);
        let Some(k) = (0..faces.len()).find(against) else {
            return if self.holds_part(element, tolerance) { Meeting::Inside } else { Meeting::Apart };
        };
        if element.normal().dot(faces[k].normal) > 0.0 || !self.covers_part(element, k) {
            Meeting::Apart
        } else {
            Meeting::LooksIn(k as u32)
        }
    }

    /// Whether part of an element lies deeper than `tolerance` below all faces. Beside an edge of
    /// the solid it may lie outside without being before any one face.
    fn holds_part(&self, element: &Patch, tolerance: f64) -> bool {
        let mut part = element.corners().to_vec();
        for face in self.body.faces() {
            part = below(&part, face, tolerance);
        }
        !part.is_empty()
    }

    /// Whether an element in the plane of face `k` may overlap that face: no other face has all of
    /// it outside.
    fn covers_part(&self, element: &Patch, k: usize) -> bool {
        let outside = |face: &Face| element.corners().iter().all(|&x| face.height(x) >= 0.0);
        !self.body.faces().iter().enumerate().any(|(other, face)| other != k && outside(face))
    }
}

/// The part of a convex polygon deeper than `depth` (m) below a face.
fn below(corners: &[Vec3], face: &Face, depth: f64) -> Vec<Vec3> {
    let mut part = Vec::with_capacity(corners.len() + 1);
    let Some(&last) = corners.last() else { return part };
    let height = |x: Vec3| face.height(x) + depth;
    let mut from = (last, height(last));
    for &corner in corners {
        let to = (corner, height(corner));
        if (from.1 < 0.0) != (to.1 < 0.0) {
            part.push(from.0 + (to.0 - from.0) * (from.1 / (from.1 - to.1)));
        }
        if to.1 < 0.0 {
            part.push(to.0);
        }
        from = to;
    }
    part
}

/// How an element lies to a solid.
enum Meeting {
    Apart,
    Inside,
    LooksIn(u32),
}
