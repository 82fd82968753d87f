//! Edge currents: what physical optics lacks near straight edges of conductors (first-order
//! physical theory of diffraction).
//!
//! P. Ya. Ufimtsev, Fundamentals of the Physical Theory of Diffraction, 2nd ed., Wiley 2014, ch. 2
//! and 7. On sheets they are the fringe currents of the half-plane, which radiate from the strip of
//! the face behind each point of the edge; on wedges, with β between the edge t and the travel,
//! line currents (E. F. Knott, T. B. A. Senior, Proc. IEEE 62 (1974) 1468,
//! doi:10.1109/PROC.1974.9658)
//!
//! ```text
//! I = 2j f E_i·t/(kη sin²β),   M = 2jη g H_i·t/(k sin²β)
//! ```
//!
//! with the coefficients f and g of [`coefficients`]. Left out are corners, diffraction from edge
//! to edge beyond the depth of the face, waves along the edge, and edges that are short or whose
//! face is shallow against the wavelength, where the half-plane says nothing. I in A, M in V,
//! lengths in metres.

mod coefficients;
pub(crate) mod fresnel;
mod geometry;

use crate::medium::IMPEDANCE;
use crate::source::Source;
use crate::{
    Complex64, ComplexVector, Current, Field, Gate, Radiator, Sampling, Scatterer, SurfaceCurrent, TOLERANCE,
    Wave, WaveError, electric_element, magnetic_element,
};
use coefficients::{half_plane, wedge};
use fredholm_mesh::Vec3;
use geometry::{Edge, Piece, edges};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Shortest edge and shallowest face, in wavelengths.
const SHORTEST_EDGE: f64 = 0.5;
/// Elements a wavelength along an edge.
const PER_WAVELENGTH: f64 = 10.0;
/// sin²β below which a wave runs along the edge.
const ALONG_EDGE_SQUARED_SINE: f64 = 1e-6;

/// Depths that differ by less than this share of them are the same but for rounding.
const SAME_DEPTH: f64 = 1e-12;

/// An element of an edge in the light of one source.
#[derive(Clone, Copy, Debug)]
struct Element {
    piece: Piece,
    edge: Edge,
    /// φ′.
    source_angle: f64,
    /// cos β: how far the wave runs along the edge.
    along: f64,
    /// How far the faces reach along the ray, m.
    depths: [f64; 2],
    /// E_i·t and H_i·t.
    strength: [Complex64; 2],
}

/// The edge currents of a scatterer in the light of its sources.
#[derive(Clone, Debug)]
pub struct EdgeCurrents {
    wave: Wave,
    elements: Vec<Element>,
    small: usize,
}

impl EdgeCurrents {
    /// The edges of the undivided faces in the light of the sources, where nothing hides them: for
    /// one bounce.
    ///
    /// # Errors
    /// [`WaveError::NotConductor`] for other materials than perfect conductors.
    pub fn new(scatterer: &Scatterer, wave: Wave, sources: &[&dyn Source]) -> Result<Self, WaveError> {
        let seen = |piece: &Piece, source: &dyn Source| scatterer.sees(piece.place, source.origin());
        let (mut found, edges) = Self::none(scatterer, wave)?;
        for edge in &edges {
            found.light(scatterer, edge, sources, &seen);
        }
        Ok(found)
    }

    /// The same for several bounces: the sources light all edges, hidden or not, and so does the
    /// field of the currents on all faces that do not contain the edge, taken as one wave that
    /// travels along its mean power flow. Where something hides the edge, the latter takes away the
    /// former.
    ///
    /// Edges that another face goes through are left out.
    ///
    /// # Errors
    /// [`WaveError::NotConductor`] for other materials than perfect conductors,
    /// [`WaveError::NotFinite`] where a coordinate of the mesh is none.
    pub fn of_bounces(
        scatterer: &Scatterer,
        wave: Wave,
        sources: &[&dyn Source],
        currents: &dyn SurfaceCurrent,
    ) -> Result<Self, WaveError> {
        let (mut found, edges) = Self::none(scatterer, wave)?;
        // Edges of one face are lit by the same currents.
        let mut planes: Vec<(Vec<bool>, Vec<Edge>)> = Vec::new();
        for edge in edges {
            let contains = edge.faces_of(scatterer);
            match planes.last_mut().filter(|(same, _)| *same == contains) {
                Some((_, edges)) => edges.push(edge),
                None => planes.push((contains, vec![edge])),
            }
        }
        for (contains, edges) in planes {
            let others = Others { currents, contains };
            let sampling = Sampling::Tolerance(TOLERANCE);
            let radiator = Radiator::new(scatterer, wave, &others, Gate::Open, sampling);
            for edge in &edges {
                found.light_by(scatterer, edge, sources, &radiator)?;
            }
        }
        Ok(found)
    }

    /// No currents yet, and the edges that are long enough.
    fn none(scatterer: &Scatterer, wave: Wave) -> Result<(Self, Vec<Edge>), WaveError> {
        scatterer.check_conductor("the theory of edge currents")?;
        let all = edges(scatterer);
        let long = |edge: &Edge| {
            let middle = edge.ends[0].midpoint(edge.ends[1]);
            let depths = edge.depths(scatterer, middle, 0.0);
            depths.into_iter().fold(edge.length(), f64::min) >= SHORTEST_EDGE * wave.wavelength()
        };
        let (large, small): (Vec<Edge>, Vec<Edge>) = all.into_iter().partition(long);
        Ok((Self { wave, elements: Vec::new(), small: small.len() }, large))
    }

    /// Adds an edge in the light of the sources that its points see.
    fn light(
        &mut self,
        scatterer: &Scatterer,
        edge: &Edge,
        sources: &[&dyn Source],
        sees: &dyn Fn(&Piece, &dyn Source) -> bool,
    ) {
        let pieces = edge.pieces(&self.wave);
        for &source in sources {
            for &piece in pieces.iter().filter(|piece| sees(piece, source)) {
                let towards = source.origin().seen_from(piece.place);
                let field = source.field(&self.wave, piece.place);
                self.elements.extend(Self::element(scatterer, (edge, piece), towards, field));
            }
        }
    }

    /// Adds an edge in the light of the sources and of other faces.
    fn light_by(
        &mut self,
        scatterer: &Scatterer,
        edge: &Edge,
        sources: &[&dyn Source],
        radiator: &Radiator<'_>,
    ) -> Result<(), WaveError> {
        let pieces = edge.pieces(&self.wave);
        let places: Vec<Vec3> = pieces.iter().map(|piece| piece.place).collect();
        let fields = match radiator.fields(&places) {
            // Another face goes through the edge: it is none of a half-plane.
            Err(WaveError::OnSurface { .. }) => return Ok(()),
            found => found?,
        };
        self.light(scatterer, edge, sources, &|_, _| true);
        for (piece, field) in pieces.into_iter().zip(fields) {
            if let Some(flow) = field.power_density().try_normalize() {
                self.elements.extend(Self::element(scatterer, (edge, piece), -flow, field));
            }
        }
        Ok(())
    }

    /// The element of a piece that a wave from the direction `towards` its source meets; none for a
    /// wave from within the body or along the edge.
    fn element(
        scatterer: &Scatterer,
        (edge, piece): (&Edge, Piece),
        towards: Vec3,
        Field { e, h }: Field,
    ) -> Option<Element> {
        let (t, source_angle) = (edge.tangent(), edge.angle(towards));
        let along = -towards.dot(t);
        if 1.0 - along * along < ALONG_EDGE_SQUARED_SINE || source_angle > edge.opening * PI {
            return None;
        }
        let depths = edge.depths(scatterer, piece.place, along);
        let strength = [e.dot(t), h.dot(t)];
        Some(Element { piece, edge: *edge, source_angle, along, depths, strength })
    }

    /// Elements that the edges of a scatterer take at most, for each source: known before they are
    /// made.
    #[must_use]
    pub fn predicted(scatterer: &Scatterer, wave: &Wave) -> f64 {
        let sides = |face: &fredholm_mesh::Patch| -> f64 {
            (0..face.sides()).map(|i| face.corner(i).distance(face.corner(i + 1))).sum()
        };
        let total: f64 = scatterer.occluders().patches().iter().map(sides).sum();
        PER_WAVELENGTH * total / wave.wavelength()
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

    /// Edges that are left out because they, or their faces, are smaller than half a wavelength.
    #[must_use]
    pub fn small(&self) -> usize {
        self.small
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
        // A plane wave meets all elements of an edge alike: only their phases differ.
        let term = |alike: &[Element]| {
            let mut strength = [Complex64::ZERO; 2];
            for Element { piece, strength: [e, h], .. } in alike {
                let phase = Complex64::cis(k * u.dot(piece.place)) * piece.length;
                strength[0] += e * phase;
                strength[1] += h * phase;
            }
            let [electric, magnetic] = alike[0].moments(&self.wave, u, f64::INFINITY, strength);
            let across = (electric - ComplexVector::along(u, electric.dot(u))) * IMPEDANCE;
            across - magnetic.crossed_by(u)
        };
        let all: ComplexVector = self.elements.chunk_by(Element::is_like).map(term).sum();
        all * Complex64::new(0.0, -k / (2.0 * TAU))
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
    /// Whether another element radiates as this one in every direction, but for its strength.
    fn is_like(&self, other: &Self) -> bool {
        let same = |(a, b): (f64, f64)| (a - b).abs() <= SAME_DEPTH * a.abs();
        let geometry = |element: &Self| (element.edge, element.source_angle, element.along);
        geometry(self) == geometry(other) && self.depths.into_iter().zip(other.depths).all(same)
    }

    /// The electric and the magnetic moment a metre that radiate towards the direction u from this
    /// distance (m), for E·t and H·t of this strength.
    fn moments(&self, wave: &Wave, u: Vec3, distance: f64, [e, h]: [Complex64; 2]) -> [ComplexVector; 2] {
        let t = self.edge.tangent();
        let k = wave.wavenumber();
        let sin_squared = 1.0 - self.along * self.along;
        let factor = Complex64::new(0.0, 2.0 / (k * sin_squared));
        // What lies farther from the edge than the point itself does not count for it.
        let reaches = self.depths.map(|depth| depth / (1.0 + (depth / distance).powi(2)).sqrt());
        let depths = reaches.map(|reach| k * sin_squared * reach);
        if !self.edge.is_sheet() {
            let [f, g] = wedge(self.edge.opening, self.edge.angle(u), self.source_angle, depths);
            let electric = ComplexVector::along(t, e * f * factor / IMPEDANCE);
            return [electric, ComplexVector::along(t, h * g * factor * IMPEDANCE)];
        }
        let sine = sin_squared.sqrt();
        let ray = t * self.along + self.edge.along() * sine;
        // The end of the strip has its own way to a point that is not far away.
        let nearer = |reach: f64| (distance - (u * distance - ray * reach).length()) / reach;
        let slope = if distance.is_finite() { nearer(reaches[0]) } else { u.dot(ray) };
        let c = (slope - self.along * self.along) / sin_squared;
        let strip = half_plane(c, self.source_angle, depths[0]);
        let oblique = (strip.ends - strip.across * Complex64::new(0.0, c)) * h * (0.5 * self.along);
        let along = (strip.soft * e / IMPEDANCE + oblique) * factor;
        let across = strip.across * h / (k * sine);
        let moment = ComplexVector::along(t, along) + ComplexVector::along(self.edge.along(), across);
        [moment, ComplexVector::ZERO]
    }

    fn field(&self, wave: &Wave, p: Vec3) -> Field {
        let d = p - self.piece.place;
        let distance = d.length();
        let [electric, magnetic] = self.moments(wave, d / distance, distance, self.strength);
        let length = self.piece.length;
        electric_element(wave, electric * length, d) + magnetic_element(wave, magnetic * length, d)
    }
}
