//! Edge currents: what physical optics lacks near straight edges of conductors (first-order physical theory of
//! diffraction).
//!
//! P. Ya. Ufimtsev, Fundamentals of the Physical Theory of Diffraction, 2nd ed., Wiley 2014, ch. 2 and 7; as line currents
//! E. F. Knott, T. B. A. Senior, Proc. IEEE 62 (1974) 1468, doi:10.1109/PROC.1974.9658. With the wedge's outer angle nπ, the
//! angles φ of the observer and φ′ of the source from the first face, and β between the edge t and the travel:
//!
//! ```text
//! I = 2j (f − f₀) E_i·t/(kη sin²β),   M = 2jη (g − g₀) H_i·t/(k sin²β)
//! f, g = (1/n) sin(π/n) [1/(cos(π/n) − cos((φ − φ′)/n)) ∓ 1/(cos(π/n) − cos((φ + φ′)/n))]
//! f₀ = sin φ′/(cos φ + cos φ′),   g₀ = −sin φ/(cos φ + cos φ′)   for each lit face, angles from that face
//! ```
//!
//! f and f₀ are infinite together at the boundaries of shadow and reflection, their difference is not; there it is the
//! mean of two angles beside. Where the wave grazes a face (a cube lit squarely) this theory has no finite answer, and such
//! edges are left out; so are waves along the edge. Observers off the cone of diffracted rays take φ from the plane across the edge. Corners and
//! second diffraction are left out. I in A, M in V, lengths in metres.

use crate::medium::IMPEDANCE;
use crate::source::Source;
use crate::{
    Complex64, ComplexVector, Current, Facet, Field, Gate, Kind, Radiator, Sampling, Scatterer,
    SurfaceCurrent, TOLERANCE, Wave, WaveError, electric_element, magnetic_element,
};
use fredholm_mesh::{Patch, Vec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Angle beside a boundary at which the coefficients are taken, rad.
const BESIDE: f64 = 1e-3;
/// Angle between travel and face up to which a wave grazes it, rad.
const GRAZING: f64 = 1e-3;
/// Elements a wavelength along an edge.
const PER_WAVELENGTH: f64 = 10.0;
/// Cosine between normals above which two faces meet smoothly.
const SMOOTH: f64 = 0.9;

/// A straight edge between two faces, or of one thin face.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    ends: [Vec3; 2],
    /// Along the first face, away from the edge.
    along: Vec3,
    /// Normal of the first face.
    up: Vec3,
    /// n: the outer angle over π.
    opening: f64,
}

/// An element of an edge in the light of one source.
#[derive(Clone, Copy, Debug)]
struct Element {
    place: Vec3,
    length: f64,
    edge: Edge,
    /// φ′.
    source_angle: f64,
    /// 2j E_i·t/(kη sin²β) and 2jη H_i·t/(k sin²β).
    strength: [Complex64; 2],
}

/// The edge currents of a scatterer in the light of its sources.
#[derive(Clone, Debug)]
pub struct EdgeCurrents {
    wave: Wave,
    elements: Vec<Element>,
}

impl EdgeCurrents {
    /// Finds the edges of the undivided faces and what lights them.
    ///
    /// # Errors
    /// [`WaveError::NotConductor`] for other materials than perfect conductors.
    pub fn new(scatterer: &Scatterer, wave: Wave, sources: &[&dyn Source]) -> Result<Self, WaveError> {
        scatterer.check_conductor("the theory of edge currents")?;
        let sheets = scatterer.facets().iter().all(|facet| facet.kind == Kind::Sheet);
        let edges = edges(scatterer.occluders().patches(), sheets);
        let mut elements = Vec::new();
        for source in sources {
            for edge in &edges {
                elements.extend(edge.lit(scatterer, &wave, *source));
            }
        }
        Ok(Self { wave, elements })
    }

    /// Adds the edge currents of the waves that come from other faces: the field of the currents on all faces that do not
    /// contain the edge, taken as one wave that travels along its mean power flow.
    ///
    /// Edges that another face goes through are left out.
    ///
    /// # Errors
    /// [`WaveError::NotFinite`] where a coordinate of the mesh is none.
    pub fn with_bounces(
        mut self,
        scatterer: &Scatterer,
        currents: &dyn SurfaceCurrent,
    ) -> Result<Self, WaveError> {
        let sheets = scatterer.facets().iter().all(|facet| facet.kind == Kind::Sheet);
        for edge in edges(scatterer.occluders().patches(), sheets) {
            let others = Others { currents, contains: edge.faces_of(scatterer) };
            let sampling = Sampling::Tolerance(TOLERANCE);
            let radiator = Radiator::new(scatterer, self.wave, &others, Gate::Open, sampling);
            if radiator.elements() == 0 {
                continue;
            }
            let (places, length) = edge.pieces(&self.wave);
            let fields = match radiator.fields(&places) {
                // Another face goes through the edge: it is none of a half-plane.
                Err(WaveError::OnSurface { .. }) => continue,
                found => found?,
            };
            let arrives = |(&place, field): (&Vec3, Field)| {
                let towards = -field.power_density().try_normalize()?;
                edge.element(&self.wave, (place, length), towards, field)
            };
            self.elements.extend(places.iter().zip(fields).filter_map(arrives));
        }
        Ok(self)
    }

    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.elements.len()
    }

    /// Whether no edge is lit.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// What they add to the scattered field at these points (m), in parallel.
    #[must_use]
    pub fn fields(&self, points: &[Vec3]) -> Vec<Field> {
        let field = |&p: &Vec3| self.elements.iter().map(|element| element.field(&self.wave, p)).sum();
        points.par_iter().map(field).collect()
    }

    /// What they add to the far field F (V) in the direction u (unit vector).
    #[must_use]
    pub fn far_amplitude(&self, u: Vec3) -> ComplexVector {
        let k = self.wave.wavenumber();
        let term = |element: &Element| {
            let [current, magnetic] = element.currents(u);
            let (t, phase) = (element.edge.tangent(), Complex64::cis(k * u.dot(element.place)));
            let across = ComplexVector::along(t - u * u.dot(t), current * IMPEDANCE);
            (across - ComplexVector::along(u.cross(t), magnetic)) * (phase * element.length)
        };
        self.elements.iter().map(term).sum::<ComplexVector>() * Complex64::new(0.0, -k / (2.0 * TAU))
    }
}

/// Currents without those of the faces that contain an edge.
struct Others<'a> {
    currents: &'a dyn SurfaceCurrent,
    contains: Vec<bool>,
}

impl SurfaceCurrent for Others<'_> {
    fn at(&self, facet: usize, q: Vec3) -> Current {
        if self.contains[facet] { Current::default() } else { self.currents.at(facet, q) }
    }
}

impl Element {
    /// I and M towards the direction u.
    fn currents(&self, u: Vec3) -> [Complex64; 2] {
        let [f, g] = self.edge.fringe(self.edge.angle(u), self.source_angle);
        [self.strength[0] * f, self.strength[1] * g]
    }

    fn field(&self, wave: &Wave, p: Vec3) -> Field {
        let d = p - self.place;
        let [current, magnetic] = self.currents(d);
        let t = self.edge.tangent() * self.length;
        electric_element(wave, ComplexVector::along(t, current), d)
            + magnetic_element(wave, ComplexVector::along(t, magnetic), d)
    }
}

impl Edge {
    /// t = along × up.
    fn tangent(&self) -> Vec3 {
        self.along.cross(self.up)
    }

    /// φ of a direction, 0 … 2π.
    fn angle(&self, direction: Vec3) -> f64 {
        direction.dot(self.up).atan2(direction.dot(self.along)).rem_euclid(TAU)
    }

    /// f − f₀ and g − g₀; 0 inside the wedge.
    fn fringe(&self, observer: f64, source: f64) -> [f64; 2] {
        if observer > self.opening * PI {
            return [0.0; 2];
        }
        let near = [PI - source, PI + source, (2.0 * self.opening - 1.0) * PI - source];
        if near.iter().all(|boundary| (observer - boundary).abs() > BESIDE) {
            return self.difference(observer, source);
        }
        let [low, high] = [-2.0, 2.0].map(|side| self.difference(observer + side * BESIDE, source));
        [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])]
    }

    fn difference(&self, observer: f64, source: f64) -> [f64; 2] {
        let n = self.opening;
        let (sin, cos) = (PI / n).sin_cos();
        let term = |angle: f64| sin / n / (cos - (angle / n).cos());
        let (minus, plus) = (term(observer - source), term(observer + source));
        let mut found = [minus - plus, minus + plus];
        // Angles from the second face run the other way round.
        for (o, s) in [(observer, source), (n * PI - observer, n * PI - source)] {
            if s < PI {
                let sum = o.cos() + s.cos();
                found[0] -= s.sin() / sum;
                found[1] -= -o.sin() / sum;
            }
        }
        found
    }

    /// Middles of even pieces and their length, at least ten a wavelength.
    fn pieces(&self, wave: &Wave) -> (Vec<Vec3>, f64) {
        let [a, b] = self.ends;
        let count = (a.distance(b) / wave.wavelength() * PER_WAVELENGTH).ceil().max(1.0) as usize;
        let places = (0..count).map(|i| a.lerp(b, (i as f64 + 0.5) / count as f64)).collect();
        (places, a.distance(b) / count as f64)
    }

    /// For each facet, whether its plane contains the edge.
    fn faces_of(&self, scatterer: &Scatterer) -> Vec<bool> {
        let contains = |facet: &Facet| {
            let height = |end: Vec3| facet.patch.normal().dot(end - facet.patch.centroid()).abs();
            self.ends.iter().all(|&end| height(end) <= 1e-9 * scatterer.extent())
        };
        scatterer.facets().iter().map(contains).collect()
    }

    /// The elements in the light of a source.
    fn lit(&self, scatterer: &Scatterer, wave: &Wave, source: &dyn Source) -> Vec<Element> {
        let (places, length) = self.pieces(wave);
        let seen = places.iter().filter(|&&place| scatterer.sees(place, source.origin()));
        let element = |&place: &Vec3| {
            let towards = source.origin().seen_from(place);
            self.element(wave, (place, length), towards, source.field(wave, place))
        };
        seen.filter_map(element).collect()
    }

    /// The element of a piece that a wave from the direction `towards` its source meets.
    fn element(
        &self,
        wave: &Wave,
        (place, length): (Vec3, f64),
        towards: Vec3,
        Field { e, h }: Field,
    ) -> Option<Element> {
        let (t, source_angle) = (self.tangent(), self.angle(towards));
        let sin_squared = 1.0 - towards.dot(t).powi(2);
        let faces = [0.0, PI, (self.opening - 1.0) * PI, self.opening * PI];
        let grazes = faces.iter().any(|face| (source_angle - face).abs() < GRAZING);
        if sin_squared < 1e-6 || grazes || source_angle > self.opening * PI {
            return None;
        }
        let factor = Complex64::new(0.0, 2.0 / (wave.wavenumber() * sin_squared));
        let strength = [e.dot(t) * factor / IMPEDANCE, h.dot(t) * factor * IMPEDANCE];
        Some(Element { place, length, edge: *self, source_angle, strength })
    }
}

/// The edges of faces: those that two faces share at an angle, and of sheets those of one face alone.
fn edges(faces: &[Patch], sheets: bool) -> Vec<Edge> {
    let mut found = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        for side in 0..face.sides() {
            let ends = [face.corner(side), face.corner(side + 1)];
            let margin = 1e-9 * face.diameter();
            let neighbour =
                faces.iter().enumerate().find(|(j, other)| *j != i && has_side(other, ends, margin));
            let edge = |opening| {
                let t = (ends[1] - ends[0]).normalize_or_zero();
                Edge { ends, along: face.normal().cross(t), up: face.normal(), opening }
            };
            match neighbour {
                None if sheets => found.push(edge(2.0)),
                Some((j, other)) if i < j && !sheets && face.normal().dot(other.normal()) < SMOOTH => {
                    let first = edge(2.0);
                    // The second face runs away from the edge at the outer angle.
                    let away = other.centroid() - ends[0].midpoint(ends[1]);
                    found.push(edge(first.angle(away) / PI));
                }
                _ => {}
            }
        }
    }
    found
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
    use crate::surface::{cube, dihedral, plate};

    #[test]
    fn a_plate_has_four_edges_and_a_cube_twelve_right_ones() {
        let plate = plate(1.0, 0.2).unwrap();
        let found = edges(plate.occluders().patches(), true);
        assert!(found.len() == 4 && found.iter().all(|edge| (edge.opening - 2.0).abs() < 1e-12));
        assert!(found.iter().all(|edge| edge.along.dot(edge.ends[0]) < 0.0));
        let cube = cube(1.0, 0.2).unwrap();
        let found = edges(cube.occluders().patches(), false);
        assert!(found.len() == 12 && found.iter().all(|edge| (edge.opening - 1.5).abs() < 1e-12));
        // The edge that two sheets share is not one of a sheet alone.
        let pair = dihedral(1.0, 1.0, 1.5, 0.2).unwrap();
        assert_eq!(edges(pair.occluders().patches(), true).len(), 6);
    }

    /// The coefficients are finite and continuous through the boundaries of shadow and reflection.
    #[test]
    fn the_fringe_is_smooth_through_the_boundaries() {
        for opening in [1.5, 2.0] {
            let edge = Edge { ends: [Vec3::ZERO, Vec3::Z], along: Vec3::X, up: Vec3::Y, opening };
            for source in [0.5, 0.8, 1.2] {
                for boundary in [PI - source, PI + source] {
                    if boundary < opening * PI {
                        let values =
                            [-0.01, -0.0015, 0.0, 0.0015, 0.01].map(|d| edge.fringe(boundary + d, source));
                        for pair in values.windows(2) {
                            assert!((pair[0][0] - pair[1][0]).abs() < 0.05, "{opening} {source} {values:?}");
                            assert!((pair[0][1] - pair[1][1]).abs() < 0.05, "{opening} {source} {values:?}");
                        }
                    }
                }
            }
        }
    }
}
