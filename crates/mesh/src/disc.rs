//! Discs: rings of triangles.
//!
//! A regular n-gon of radius R has the area ½ n R² sin(2π/n). Setting it to π r² gives R. Inside,
//! ring j of m = ⌊n/6⌋ has radius R j/m and 6 j corners (the outermost n), which makes the
//! triangles nearly equilateral: 6 m (m − 1) + n of them. Metres.

use std::f64::consts::TAU;

use crate::cutting::Form;
use crate::facet::{Facet, Group};
use crate::{MeshError, Patch, Vec3, triangle};

/// More segments than this gain nothing: 10,000 of them follow a circle to one part in ten million.
const MOST_SEGMENTS: usize = 10_000;

/// A regular polygon around a centre, standing for a disc.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rings {
    pub centre: Vec3,
    pub normal: Vec3,
    /// Two unit vectors that make a right-handed frame with the normal.
    pub across: [Vec3; 2],
    /// Distance of the outermost corners, m.
    pub radius: f64,
    pub segments: usize,
}

/// Corner `index` of ring `ring`; ring 0 is the centre.
type Corner = (usize, usize);

impl Rings {
    /// The polygon that has the area of a disc.
    pub fn disc(centre: Vec3, normal: Vec3, radius: f64, segments: usize) -> Result<Self, MeshError> {
        check(centre, radius, segments)?;
        let normal = direction(normal, "the disc's normal")?;
        let n = segments as f64;
        let radius = radius * (TAU / (n * (TAU / n).sin())).sqrt();
        Ok(Self { centre, normal, across: frame(normal), radius, segments })
    }

    /// Corner `k` of the border.
    pub fn border(&self, k: usize) -> Vec3 {
        self.corner((self.rings(), k))
    }

    pub fn group(&self) -> Group {
        let mut longest = 0.0_f64;
        self.each(&mut |corners| longest = longest.max(triangle::longest(corners)));
        let (rings, segments) = (self.rings() as u128, self.segments as u128);
        Group { form: Form::Triangle { longest }, number: 6 * rings * (rings - 1) + segments }
    }

    /// The triangles, from the centre outwards.
    pub fn facets(&self) -> Result<Vec<Facet>, MeshError> {
        let mut facets = Vec::new();
        self.each(&mut |[a, b, c]| facets.push(Patch::piece([a, b, c, c], 3, self.normal).map(Facet::Flat)));
        facets.into_iter().collect()
    }

    /// The whole polygon as few convex pieces: quads, and a triangle where the number of corners is
    /// odd.
    pub fn blockers(&self) -> Result<Vec<Patch>, MeshError> {
        let last = self.segments - 1;
        let piece = |k: usize| {
            let sides = if k + 2 > last { 3 } else { 4 };
            let corners = [0, k, k + 1, (k + 2).min(last)].map(|k| self.border(k));
            Patch::piece(corners, sides, self.normal)
        };
        (1..last).step_by(2).map(piece).collect()
    }

    fn rings(&self) -> usize {
        (self.segments / 6).max(1)
    }

    fn corners_on(&self, ring: usize) -> usize {
        if ring == self.rings() { self.segments } else { 6 * ring }
    }

    fn corner(&self, (ring, index): Corner) -> Vec3 {
        if ring == 0 {
            return self.centre;
        }
        let around = self.corners_on(ring);
        let (sin, cos) = (TAU * (index % around) as f64 / around as f64).sin_cos();
        let radius = self.radius * ring as f64 / self.rings() as f64;
        self.centre + (self.across[0] * cos + self.across[1] * sin) * radius
    }

    fn each(&self, visit: &mut impl FnMut([Vec3; 3])) {
        for ring in 0..self.rings() {
            self.band(ring, visit);
        }
    }

    /// The triangles between a ring and the next: whichever ring's next side has its middle first
    /// gets a triangle.
    fn band(&self, ring: usize, visit: &mut impl FnMut([Vec3; 3])) {
        let (inner, outer) = (self.corners_on(ring), self.corners_on(ring + 1));
        let (mut i, mut j) = (0, 0);
        while i < inner || j < outer {
            let apex = (ring, i);
            let base = (ring + 1, j);
            let outwards = i == inner || (j < outer && (2 * j + 1) * inner <= (2 * i + 1) * outer);
            let next = if outwards { (ring + 1, j + 1) } else { (ring, i + 1) };
            visit([apex, base, next].map(|corner| self.corner(corner)));
            if outwards { j += 1 } else { i += 1 }
        }
    }
}

/// Refuses a position, radius or number of segments that makes no sense.
pub(crate) fn check(centre: Vec3, radius: f64, segments: usize) -> Result<(), MeshError> {
    if !centre.is_finite() {
        return Err(MeshError::NotFinite { corner: 0 });
    }
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(MeshError::Length { quantity: "the radius", value: radius });
    }
    match segments {
        0..3 => Err(MeshError::TooFewSegments { segments }),
        3..=MOST_SEGMENTS => Ok(()),
        _ => Err(MeshError::TooManySegments { segments, limit: MOST_SEGMENTS }),
    }
}

/// The unit vector along a direction.
pub(crate) fn direction(vector: Vec3, quantity: &'static str) -> Result<Vec3, MeshError> {
    let length = vector.length();
    vector.try_normalize().ok_or(MeshError::Length { quantity, value: length })
}

/// Two unit vectors that make a right-handed frame with a normal.
pub(crate) fn frame(normal: Vec3) -> [Vec3; 2] {
    let (first, second) = normal.any_orthonormal_pair();
    [first, second]
}
