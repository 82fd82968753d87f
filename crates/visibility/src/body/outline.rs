//! The shadow of a body from a point, as an intersection of half-spaces.

use fredholm_mesh::Vec3;

use super::{Body, Edge};

/// Faces of a solid at most, one bit each.
pub(super) const MOST_FACES: usize = 256;

/// One bit for each face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Bits([u64; MOST_FACES / 64]);

impl Bits {
    fn set(&mut self, k: usize) {
        self.0[k / 64] |= 1 << (k % 64);
    }

    fn has(self, k: u32) -> bool {
        self.0[k as usize / 64] >> (k % 64) & 1 == 1
    }
}

/// Sine of the angle by which a point that counts as hidden may lie outside: where it lies exactly
/// on the border, rounding does not decide.
const GRAZING_SINE: f64 = 1e-9;

/// What a body hides from a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadow {
    /// Nothing: the point lies in the plane of a flat body, or nothing is left of the body.
    Nothing,
    /// What lies in a [`ShadowVolume`].
    Volume,
}

/// An intersection of half-spaces {y : n·(y − x) ≥ c}, in coordinates relative to the point x.
#[derive(Clone, Debug, Default)]
pub struct ShadowVolume {
    planes: Vec<(Vec3, f64, u32)>,
}

impl ShadowVolume {
    /// Normals n (of any length), offsets c and numbers: those behind the faces, and those of the
    /// outline, for which c = 0. Half-spaces of one body that the same face or edge makes have the
    /// same number from all points.
    #[must_use]
    #[inline]
    pub fn planes(&self) -> &[(Vec3, f64, u32)] {
        &self.planes
    }

    pub(super) fn clear(&mut self) {
        self.planes.clear();
    }

    /// Adds a half-space; a plane without direction bounds nothing.
    pub(super) fn push(&mut self, normal: Vec3, offset: f64, number: u32) {
        if normal != Vec3::ZERO {
            self.planes.push((normal, offset, number));
        }
    }

    /// Whether all of the points, relative to x, lie inside, or outside by an angle of rounding.
    #[must_use]
    pub fn holds(&self, points: &[Vec3]) -> bool {
        let holds = |(n, c, _): &(Vec3, f64, u32), y: &Vec3| {
            let height = n.dot(*y) - *c;
            height > 0.0 || height > -GRAZING_SINE * n.length() * y.length()
        };
        self.planes.iter().all(|plane| points.iter().all(|y| holds(plane, y)))
    }
}

/// The number of the half-space within edge `k`; those behind faces have the numbers of these.
pub(super) fn edge_number(k: u32) -> u32 {
    MOST_FACES as u32 + k
}

impl Body {
    /// What the body hides from `x`; where that is a volume, `volume` holds it. Heights of at most
    /// `tolerance` (m) over a face count as none: a point of the surface does not shade itself.
    pub fn shadow(&self, x: Vec3, tolerance: f64, volume: &mut ShadowVolume) -> Shadow {
        volume.clear();
        if self.edges.is_empty() {
            return Shadow::Nothing;
        }
        let lit = self.behind(x, tolerance, volume);
        if lit == Bits::default() {
            // From a point of a solid, all that lies behind the faces at that point is seen through
            // the solid.
            self.behind(x, -tolerance, volume);
            return if self.solid { Shadow::Volume } else { Shadow::Nothing };
        }
        for (k, edge) in self.edges.iter().enumerate() {
            if let Some(inward) = self.inward(edge, x, lit) {
                volume.push(inward, 0.0, edge_number(k as u32));
            }
        }
        Shadow::Volume
    }

    /// Adds the shadow volumes behind the faces over which x is higher than `least`, and returns
    /// those faces.
    fn behind(&self, x: Vec3, least: f64, volume: &mut ShadowVolume) -> Bits {
        let mut lit = Bits::default();
        for (k, face) in self.faces.iter().enumerate() {
            let height = face.height(x);
            if height > least {
                lit.set(k);
                volume.push(-face.normal, height, k as u32);
            }
        }
        lit
    }

    /// The normal of the plane through x and an edge of the outline, pointing into the shadow.
    fn inward(&self, edge: &Edge, x: Vec3, lit: Bits) -> Option<Vec3> {
        let [left, right] = edge.faces.map(|face| lit.has(face));
        if left == right {
            return None;
        }
        let [a, b] = self.ends(edge).map(|end| end - x);
        // Counter-clockwise round a face that looks at x, the inside is to the left.
        Some(if left { b.cross(a) } else { a.cross(b) })
    }
}
