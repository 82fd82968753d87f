//! Spheres: geodesic polyhedra on the icosahedron.
//!
//! The corner with barycentric weights wᵢ, multiples of 1/f, in a triangle v₀, v₁, v₂ of the
//! icosahedron lies in the direction Σ sin(wᵢ θ) vᵢ, cos θ = 1/√5, on the sphere of radius R. Along
//! the edges this divides the arc evenly (K. Shoemake, 1985, doi:10.1145/325334.325242), and
//! neighbours meet in the same corners. The 20 f² flat facets have edges that differ by less than
//! 1.2 : 1. R makes their total area 4π r². Metres.

use std::f64::consts::PI;

use crate::cutting::Form;
use crate::disc::check;
use crate::facet::{Facet, Group};
use crate::{MeshError, Patch, Vec3, triangle};

/// Corners of each triangle of the icosahedron, counter-clockwise from outside.
const TRIANGLES: [[usize; 3]; 20] = [
    [0, 1, 2],
    [0, 2, 3],
    [0, 3, 4],
    [0, 4, 5],
    [0, 5, 1],
    [1, 6, 2],
    [2, 6, 7],
    [2, 7, 3],
    [3, 7, 8],
    [3, 8, 4],
    [4, 8, 9],
    [4, 9, 5],
    [5, 9, 10],
    [5, 10, 1],
    [1, 10, 6],
    [11, 7, 6],
    [11, 8, 7],
    [11, 9, 8],
    [11, 10, 9],
    [11, 6, 10],
];

/// A geodesic polyhedron around a centre, standing for a sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Geodesic {
    centre: Vec3,
    /// Distance of the corners, m.
    radius: f64,
    /// Pieces along each edge of the icosahedron.
    frequency: usize,
    longest: f64,
}

impl Geodesic {
    /// The polyhedron that has the area of a sphere.
    pub fn new(centre: Vec3, radius: f64, segments: usize) -> Result<Self, MeshError> {
        check(centre, radius, segments)?;
        let frequency = segments.div_ceil(5);
        let (mut area, mut longest) = (0.0, 0.0_f64);
        for corners in unit_facets(frequency, TRIANGLES[0]) {
            let [a, b, c] = corners;
            area += 10.0 * (b - a).cross(c - a).length();
            longest = longest.max(triangle::longest(corners));
        }
        let radius = radius * (4.0 * PI / area).sqrt();
        Ok(Self { centre, radius, frequency, longest: longest * radius })
    }

    pub fn group(&self) -> Group {
        Group { form: Form::Triangle { longest: self.longest }, number: 20 * (self.frequency as u128).pow(2) }
    }

    /// The facets, lit outside.
    pub fn facets(&self) -> Result<Vec<Facet>, MeshError> {
        let unit = TRIANGLES.into_iter().flat_map(|triangle| unit_facets(self.frequency, triangle));
        let place = |corner: Vec3| self.centre + corner * self.radius;
        unit.map(|corners| Patch::triangle(corners.map(place)).map(Facet::Flat)).collect()
    }
}

fn unit_facets(frequency: usize, triangle: [usize; 3]) -> impl Iterator<Item = [Vec3; 3]> {
    let [a, b, c] = triangle.map(icosahedron);
    let angle = 0.2_f64.sqrt().acos();
    let direction = move |w: [f64; 3]| {
        let [i, j, k] = w.map(|w| (w * angle).sin());
        (a * i + b * j + c * k).normalize()
    };
    (0..frequency * frequency).map(move |index| triangle::weights(frequency, index).map(direction))
}

/// Corner of the icosahedron of radius 1: the poles are 0 and 11, two rings of five lie between.
fn icosahedron(corner: usize) -> Vec3 {
    let height = 1.0 / 5.0_f64.sqrt();
    let ring = |turns: f64, z: f64| {
        let (sin, cos) = (PI * turns).sin_cos();
        Vec3::new(cos * 2.0 * height, sin * 2.0 * height, z)
    };
    match corner {
        0 => Vec3::Z,
        1..=5 => ring(0.4 * (corner - 1) as f64, height),
        6..=10 => ring(0.4 * (corner - 6) as f64 + 0.2, -height),
        _ => Vec3::NEG_Z,
    }
}
