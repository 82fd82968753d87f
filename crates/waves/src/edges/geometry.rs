//! Where the edges of a scatterer are, and how deep its faces reach behind them.

use crate::{Facet, Kind, Scatterer, Wave};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::gauss_legendre;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// Longest piece of an edge that one Gauss rule takes, in wavelengths, and its points.
const LONGEST_PIECE: f64 = 0.5;
const POINTS: usize = 5;
/// Cosine between normals above which two faces meet smoothly.
const SMOOTH_COSINE: f64 = 0.9;
/// Distance, over the extent, within which corners are at the same place and faces in the same
/// plane.
const SAME_PLACE_DISTANCE: f64 = 1e-9;

/// A straight edge between two faces, or of one thin face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    pub(super) ends: [Vec3; 2],
    /// Along the first face, away from the edge.
    along: Vec3,
    /// Normal of the first face.
    up: Vec3,
    /// n: the outer angle over π; 2 for sheets.
    pub(super) opening: f64,
    /// The faces, the first twice for sheets.
    faces: [usize; 2],
}

/// A point of an edge and the length that it stands for, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) place: Vec3,
    pub(super) length: f64,
}

impl Edge {
    /// t = along × up.
    pub(super) fn tangent(&self) -> Vec3 {
        self.along.cross(self.up)
    }

    /// Along the first face, away from the edge.
    pub(super) fn along(&self) -> Vec3 {
        self.along
    }

    /// φ of a direction, 0 … 2π.
    pub(super) fn angle(&self, direction: Vec3) -> f64 {
        direction.dot(self.up).atan2(direction.dot(self.along)).rem_euclid(TAU)
    }

    /// Whether it is the edge of one thin face.
    pub(super) fn is_sheet(&self) -> bool {
        self.faces[0] == self.faces[1]
    }

    pub(super) fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    /// Gauss points along the edge.
    pub(super) fn pieces(&self, wave: &Wave) -> Vec<Piece> {
        let [a, b] = self.ends;
        let count = (self.length() / (LONGEST_PIECE * wave.wavelength())).ceil().max(1.0) as usize;
        let length = self.length() / count as f64;
        let rule = gauss_legendre(POINTS);
        let piece = |i: usize| {
            let place = move |x: f64| a.lerp(b, (i as f64 + x) / count as f64);
            let points = rule.points.iter().zip(&rule.weights);
            points.map(move |(x, weight)| Piece { place: place(*x), length: length * weight })
        };
        (0..count).flat_map(piece).collect()
    }

    /// How far the two faces reach from a point of the edge along the ray of a wave that runs with
    /// `travel`·t along it, m.
    pub(super) fn depths(&self, scatterer: &Scatterer, place: Vec3, along_edge: f64) -> [f64; 2] {
        let across = (1.0 - along_edge * along_edge).max(0.0).sqrt();
        let second = self.opening * PI;
        let away = [self.along, self.along * second.cos() + self.up * second.sin()];
        [0, 1].map(|i| {
            let ray = self.tangent() * along_edge + away[i] * across;
            reach(scatterer, self.faces[i], place, ray)
        })
    }

    /// For each facet, whether its plane contains the edge.
    pub(super) fn faces_of(&self, scatterer: &Scatterer) -> Vec<bool> {
        let contains = |facet: &Facet| {
            let height = |end: Vec3| facet.patch.normal().dot(end - facet.patch.centroid()).abs();
            self.ends.iter().all(|&end| height(end) <= SAME_PLACE_DISTANCE * scatterer.extent())
        };
        scatterer.facets().iter().map(contains).collect()
    }
}

/// How far the plane surface that a face is part of reaches from a point along a ray in it, m.
fn reach(scatterer: &Scatterer, face: usize, place: Vec3, ray: Vec3) -> f64 {
    let faces = scatterer.occluders().patches();
    let (normal, margin) = (faces[face].normal(), SAME_PLACE_DISTANCE * scatterer.extent());
    let lies =
        |other: &&Patch| other.corners().iter().all(|&corner| normal.dot(corner - place).abs() <= margin);
    let mut parts: Vec<[f64; 2]> =
        faces.iter().filter(lies).filter_map(|other| inside(other, place, ray, margin)).collect();
    parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    parts.iter().fold(0.0, |end, part| if part[0] <= end + margin { part[1].max(end) } else { end })
}

/// Where a ray in the plane of a convex face is in it, m.
fn inside(face: &Patch, place: Vec3, ray: Vec3, margin: f64) -> Option<[f64; 2]> {
    let (mut from, mut to) = (0.0_f64, f64::INFINITY);
    for side in 0..face.sides() {
        let corner = face.corner(side);
        let inwards = face.normal().cross(face.corner(side + 1) - corner).try_normalize()?;
        let (height, slope) = (inwards.dot(place - corner), inwards.dot(ray));
        if slope.abs() <= SAME_PLACE_DISTANCE {
            if height < -margin {
                return None;
            }
        } else if slope > 0.0 {
            from = from.max(-height / slope);
        } else {
            to = to.min(-height / slope);
        }
    }
    (to > from).then_some([from, to])
}

/// The edges: those that two faces of closed bodies share at an angle, and those of one sheet
/// alone. Tessellated spheres have none.
pub(super) fn edges(scatterer: &Scatterer) -> Vec<Edge> {
    let faces = scatterer.occluders().patches();
    let sides = Sides::new(faces, SAME_PLACE_DISTANCE * scatterer.extent());
    let kinds = kinds(scatterer);
    let mut found = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        if scatterer.is_curved(face) {
            continue;
        }
        for side in 0..face.sides() {
            let ends = [face.corner(side), face.corner(side + 1)];
            let edge = |opening, other| {
                let t = (ends[1] - ends[0]).normalize_or_zero();
                let along = face.normal().cross(t);
                Edge { ends, along, up: face.normal(), opening, faces: [i, other] }
            };
            match (sides.neighbour(faces, i, ends), kinds[i]) {
                (None, Kind::Sheet) => found.push(edge(2.0, i)),
                (Some(j), Kind::Closed) if i < j && face.normal().dot(faces[j].normal()) < SMOOTH_COSINE => {
                    // The second face runs away from the edge at the outer angle.
                    let away = faces[j].centroid() - ends[0].midpoint(ends[1]);
                    found.push(edge(edge(2.0, j).angle(away) / PI, j));
                }
                _ => {}
            }
        }
    }
    found
}

/// What each face is part of.
fn kinds(scatterer: &Scatterer) -> Vec<Kind> {
    let (faces, facets) = (scatterer.occluders().patches(), scatterer.facets());
    let first = facets.first().map_or(Kind::Sheet, |facet| facet.kind);
    if facets.iter().all(|facet| facet.kind == first) {
        return vec![first; faces.len()];
    }
    let margin = SAME_PLACE_DISTANCE * scatterer.extent();
    let on = |face: &Patch, p: Vec3| {
        let height = face.normal().dot(p - face.centroid()).abs();
        let within = |side: usize| {
            let corner = face.corner(side);
            face.normal().cross(face.corner(side + 1) - corner).dot(p - corner) >= 0.0
        };
        height <= margin && (0..face.sides()).all(within)
    };
    let kind = |face: &Patch| {
        let own = facets.iter().find(|facet| on(face, facet.patch.centroid()));
        own.map_or(Kind::Closed, |facet| facet.kind)
    };
    faces.iter().map(kind).collect()
}

/// The sides of faces, by the place of their middle.
struct Sides {
    cell: f64,
    at: HashMap<[i64; 3], Vec<usize>>,
}

impl Sides {
    fn new(faces: &[Patch], margin: f64) -> Self {
        let mut sides = Self { cell: 4.0 * margin, at: HashMap::new() };
        for (i, face) in faces.iter().enumerate() {
            for side in 0..face.sides() {
                let middle = face.corner(side).midpoint(face.corner(side + 1));
                sides.at.entry(sides.key(middle)).or_default().push(i);
            }
        }
        sides
    }

    fn key(&self, p: Vec3) -> [i64; 3] {
        p.to_array().map(|x| (x / self.cell).floor() as i64)
    }

    /// The first other face with the side between these ends.
    fn neighbour(&self, faces: &[Patch], face: usize, ends: [Vec3; 2]) -> Option<usize> {
        let key = self.key(ends[0].midpoint(ends[1]));
        let step = |i: usize, axis: u32| (i / 3_usize.pow(axis) % 3) as i64 - 1;
        let near = |i: usize| [0, 1, 2].map(|axis| key[axis].saturating_add(step(i, axis as u32)));
        let candidates = (0..27).filter_map(|i| self.at.get(&near(i))).flatten().copied();
        let shares = |&other: &usize| other != face && has_side(&faces[other], ends, 0.25 * self.cell);
        candidates.filter(shares).min()
    }
}

fn has_side(face: &Patch, [a, b]: [Vec3; 2], margin: f64) -> bool {
    let same = |p: Vec3, q: Vec3| p.distance(q) <= margin;
    (0..face.sides()).any(|side| {
        let (c, d) = (face.corner(side), face.corner(side + 1));
        (same(a, d) && same(b, c)) || (same(a, c) && same(b, d))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{cube, dihedral, plate, sphere};

    #[test]
    fn a_plate_has_four_edges_and_a_cube_twelve_right_ones() {
        let plate = plate(1.0, 0.2).unwrap();
        let found = edges(&plate);
        assert!(found.len() == 4 && found.iter().all(|edge| (edge.opening - 2.0).abs() < 1e-12));
        assert!(found.iter().all(|edge| edge.along.dot(edge.ends[0]) < 0.0));
        let cube = cube(1.0, 0.2).unwrap();
        let found = edges(&cube);
        assert!(found.len() == 12 && found.iter().all(|edge| (edge.opening - 1.5).abs() < 1e-12));
        // The edge that two sheets share is not one of a sheet alone.
        assert_eq!(edges(&dihedral(1.0, 1.0, 1.5, 0.2).unwrap()).len(), 6);
        // However coarse, a sphere has none.
        assert!(edges(&sphere(1.0, 1.0).unwrap()).is_empty());
    }

    #[test]
    fn faces_reach_to_their_far_side() {
        let plate = plate(2.0, 0.5).unwrap();
        for edge in edges(&plate) {
            let middle = edge.ends[0].midpoint(edge.ends[1]);
            let [straight, _] = edge.depths(&plate, middle, 0.0);
            let [askew, _] = edge.depths(&plate, middle, 0.8);
            assert!((straight - 2.0).abs() < 1e-12 && (askew - 1.25).abs() < 1e-12, "{straight} {askew}");
        }
        let cube = cube(1.0, 0.5).unwrap();
        for edge in edges(&cube) {
            let middle = edge.ends[0].midpoint(edge.ends[1]);
            let depths = edge.depths(&cube, middle, 0.0);
            assert!(depths.iter().all(|depth| (depth - 1.0).abs() < 1e-9), "{depths:?}");
        }
    }

    #[test]
    fn the_pieces_have_the_length_of_the_edge() {
        let (plate, wave) = (plate(2.0, 0.5).unwrap(), Wave::new(1e9).unwrap());
        for edge in edges(&plate) {
            let total: f64 = edge.pieces(&wave).iter().map(|piece| piece.length).sum();
            assert!((total - 2.0).abs() < 1e-12);
        }
    }
}
