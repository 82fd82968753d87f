//! A body between a source and a target polygon: what of its outline can matter there.
//!
//! det(a − x, b − x, y − x) is affine in x and in y. An edge a b that has all corners y of the
//! target on its inner side from all corners x of the source has so from all points of the source:
//! it never cuts the target. Faces that look at all of the source or at none of it need no second
//! look either.

use fredholm_mesh::Vec3;

use super::outline::edge_number;
use super::{Body, Edge, Face, Shadow, ShadowVolume};

/// Faces that look at part of the source at most, one bit each.
const MOST_TURNING_FACES: usize = 62;
/// The bits of all faces that look at none of the source, and of all that look at all of it.
const ALL_FACES_DARK: u8 = 62;
const LIT_BIT: u8 = 63;

/// A body as points of one polygon see it before another.
#[derive(Clone, Debug)]
pub struct Screen<'a> {
    body: &'a Body,
    /// Edges that may cut the target, m.
    edges: Vec<[Vec3; 2]>,
    /// What decides about each of them.
    borders: Vec<Border>,
    /// Faces whose planes pass through the source, by their numbers, and whether part of the target
    /// lies before them.
    turning: Vec<(u32, Face, bool)>,
    /// Faces that look at all of the source and do not have all of the target behind them.
    front: Vec<(u32, Face)>,
    /// The bit of the faces that look at all of the source, if there are any.
    lit: u64,
    /// Whether the body itself is asked: nothing is left of it, or too many of its faces turn.
    plain: bool,
    tolerance: f64,
}

/// An edge, by the number of its half-space, and the bits of its faces: it shows where one of them
/// looks at a point and the other does not.
#[derive(Clone, Copy, Debug)]
struct Border {
    number: u32,
    faces: [u8; 2],
}

/// An edge a b of an outline.
#[derive(Clone, Copy, Debug)]
pub struct SilhouetteEdge {
    /// The number of its half-space.
    pub number: u32,
    /// Its place among [`edges`](Screen::edges).
    pub place: usize,
    /// Whether from a point x, (a − x) × (b − x) points out of the shadow, and not into it.
    pub turned: bool,
}

/// A polygon and the box around it.
struct Around<'a> {
    corners: &'a [Vec3],
    centre: Vec3,
    half: Vec3,
}

impl<'a> Around<'a> {
    fn new(corners: &'a [Vec3]) -> Self {
        let low = corners.iter().fold(Vec3::INFINITY, |low, &x| low.min(x));
        let high = corners.iter().fold(Vec3::NEG_INFINITY, |high, &x| high.max(x));
        Self { corners, centre: 0.5 * (low + high), half: 0.5 * (high - low) }
    }

    /// Whether the box has a part with n·(y − x) < 0.
    #[inline]
    fn may_lie_outside(&self, n: Vec3, x: Vec3) -> bool {
        n.dot(self.centre - x) < n.abs().dot(self.half)
    }
}

/// Which faces look at a point: one bit each, and one for all that look at all of the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Looking(u64);

impl Looking {
    fn has(self, bit: u8) -> bool {
        self.0 >> bit & 1 == 1
    }
}

impl<'a> Screen<'a> {
    /// Prepares `body` between two polygons. Heights of at most `tolerance` (m) over a face count
    /// as none.
    #[must_use]
    pub fn new(body: &'a Body, source: &[Vec3], target: &[Vec3], tolerance: f64) -> Self {
        let edges = Vec::with_capacity(8);
        let (borders, turning, front) = (Vec::with_capacity(8), Vec::new(), Vec::new());
        let mut screen = Self { body, edges, borders, turning, front, lit: 0, plain: false, tolerance };
        let mut bits = [ALL_FACES_DARK; super::outline::MOST_FACES];
        for (k, (bit, face)) in bits.iter_mut().zip(&body.faces).enumerate() {
            *bit = screen.look((k as u32, face), source, target);
        }
        screen.plain = screen.turning.len() > MOST_TURNING_FACES || body.edges.is_empty();
        let target = Around::new(target);
        for (k, edge) in body.edges.iter().enumerate() {
            screen.consider((k as u32, edge), edge.faces.map(|face| bits[face as usize]), source, &target);
        }
        screen
    }

    /// Takes a face, and returns its bit.
    fn look(&mut self, (k, face): (u32, &Face), source: &[Vec3], target: &[Vec3]) -> u8 {
        let (mut some, mut all) = (false, true);
        for &x in source {
            let looks = face.height(x) > self.tolerance;
            some |= looks;
            all &= looks;
        }
        if !some {
            return ALL_FACES_DARK;
        }
        let before = target.iter().any(|&y| face.height(y) > self.tolerance);
        if all {
            self.lit = 1 << LIT_BIT;
            if before {
                self.front.push((k, *face));
            }
            return LIT_BIT;
        }
        self.turning.push((k, *face, before));
        // Those beyond share a bit, which says no more than that they turn.
        (self.turning.len() - 1).min(MOST_TURNING_FACES - 1) as u8
    }

    fn consider(&mut self, (k, edge): (u32, &Edge), faces: [u8; 2], source: &[Vec3], target: &Around) {
        let [left, right] = faces;
        if left == right && left >= ALL_FACES_DARK {
            return;
        }
        let [a, b] = self.body.ends(edge);
        // Counter-clockwise round a face that looks at x, the inside is to the left.
        let turned = left == LIT_BIT || right == ALL_FACES_DARK;
        let (ends, faces) = if turned { ([b, a], [right, left]) } else { ([a, b], [left, right]) };
        let known = faces.iter().any(|&face| face >= ALL_FACES_DARK);
        let cuts = |x: &Vec3| {
            let inward = (ends[0] - *x).cross(ends[1] - *x);
            let outside = |height: f64| height < 0.0 && height < -self.tolerance * inward.length();
            target.may_lie_outside(inward, *x) && target.corners.iter().any(|y| outside(inward.dot(*y - *x)))
        };
        if !known || source.iter().any(cuts) {
            self.edges.push(ends);
            self.borders.push(Border { number: edge_number(k), faces });
        }
    }

    /// The edges near which what is hidden of the target may be a steep function on the source, m:
    /// those that may cut the target, or all edges of a body that has part of the source inside or
    /// on it.
    pub fn steep(&self) -> impl Iterator<Item = [Vec3; 2]> {
        let all = self.lit == 0 || self.edges.is_empty();
        let whole = self.body.edges.iter().filter(move |_| all).map(|edge| self.body.ends(edge));
        whole.chain(self.edges.iter().filter(move |_| !all).copied())
    }

    /// The edges that may cut the target from some point of the source, m.
    #[must_use]
    #[inline]
    pub fn edges(&self) -> &[[Vec3; 2]] {
        &self.edges
    }

    /// Whether an edge is in the outline from all points of the source.
    #[must_use]
    #[inline]
    pub fn is_fixed(&self, edge: usize) -> bool {
        !self.plain && self.borders[edge].faces.iter().all(|&bit| bit >= ALL_FACES_DARK)
    }

    /// The faces whose planes pass through the source, and whether any edge that may cut the target
    /// is theirs.
    #[inline]
    pub fn turning(&self) -> impl Iterator<Item = (&Face, bool)> {
        let cuts = |bit: usize| self.borders.iter().any(|border| border.faces.contains(&(bit as u8)));
        self.turning.iter().enumerate().map(move |(bit, (_, face, _))| (face, !self.plain && cuts(bit)))
    }

    /// Heights up to which a point lies on a face, m.
    #[must_use]
    #[inline]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// What of the target is hidden from a point `x` of the source; where that is a volume,
    /// `volume` holds it.
    pub fn shadow(&self, x: Vec3, volume: &mut ShadowVolume) -> Shadow {
        let Some(looking) = self.looking(x) else { return self.body.shadow(x, self.tolerance, volume) };
        volume.clear();
        for (number, face) in self.faces(looking) {
            volume.push(-face.normal, face.height(x), number);
        }
        for SilhouetteEdge { number, place, turned } in self.silhouette(looking) {
            let [a, b] = self.edges[place];
            let inward = (a - x).cross(b - x);
            volume.push(if turned { -inward } else { inward }, 0.0, number);
        }
        Shadow::Volume
    }

    /// Which faces look at a point of the source: from points where this is the same, the same
    /// faces and edges make the shadow. `None` where the body itself is asked.
    #[must_use]
    #[inline]
    pub fn looking(&self, x: Vec3) -> Option<Looking> {
        if self.plain {
            return None;
        }
        let mut lit = self.lit;
        for (bit, (_, face, _)) in self.turning.iter().enumerate() {
            lit |= u64::from(face.height(x) > self.tolerance) << bit;
        }
        (lit != 0).then_some(Looking(lit))
    }

    /// The faces behind which the shadow lies, with the numbers of their half-spaces.
    #[inline]
    pub fn faces(&self, looking: Looking) -> impl Iterator<Item = (u32, &Face)> {
        let looks =
            move |(bit, (_, _, before)): &(usize, &(u32, Face, bool))| *before && looking.has(*bit as u8);
        let turning = self.turning.iter().enumerate().filter(looks);
        let front = self.front.iter().map(|(k, face)| (*k, face));
        front.chain(turning.map(|(_, (k, face, _))| (*k, face)))
    }

    /// The edges of the outline that may cut the target.
    #[inline]
    pub fn silhouette(&self, looking: Looking) -> impl Iterator<Item = SilhouetteEdge> {
        self.borders.iter().enumerate().filter_map(move |(place, border)| {
            let [first, second] = border.faces.map(|bit| looking.has(bit));
            (first != second).then_some(SilhouetteEdge { number: border.number, place, turned: first })
        })
    }
}
