//! A body between a source and a target polygon: what of its outline can matter there.
//!
//! det(a − x, b − x, y − x) is affine in x and in y. An edge a b that has all corners y of the target on its inner side from all corners x of the source has so from all
//! points of the source: it never cuts the target. Faces that look at all of the source or at none of it need no second look either.

use fredholm_mesh::Vec3;

use super::{Body, Edge, Face, Room, Shadow};

/// Faces that look at part of the source at most, one bit each.
const TURNING: usize = 62;
/// The bits of all faces that look at none of the source, and of all that look at all of it.
const DARK: u8 = 62;
const LIT: u8 = 63;

/// A body as points of one polygon see it before another.
#[derive(Clone, Debug)]
pub struct Screen<'a> {
    body: &'a Body,
    /// Edges that may cut the target, m.
    edges: Vec<[Vec3; 2]>,
    /// What decides about each of them.
    borders: Vec<Border>,
    /// Faces whose planes pass through the source, by their numbers, and whether part of the target lies before them.
    turning: Vec<(u32, Face, bool)>,
    /// Faces that look at all of the source and do not have all of the target behind them.
    front: Vec<(u32, Face)>,
    /// The bit of the faces that look at all of the source, if there are any.
    lit: u64,
    /// Whether the body itself is asked: nothing is left of it, or too many of its faces turn.
    plain: bool,
    tolerance: f64,
}

/// An edge, by its number, and the bits of its faces: it shows where one of them looks at a point and the other does not.
#[derive(Clone, Copy, Debug)]
struct Border {
    number: u32,
    faces: [u8; 2],
}

impl<'a> Screen<'a> {
    /// Prepares `body` between two polygons. Heights of at most `tolerance` (m) over a face count as none.
    #[must_use]
    pub fn new(body: &'a Body, source: &[Vec3], target: &[Vec3], tolerance: f64) -> Self {
        let edges = Vec::with_capacity(8);
        let (borders, turning, front) = (Vec::with_capacity(8), Vec::new(), Vec::new());
        let mut screen = Self { body, edges, borders, turning, front, lit: 0, plain: false, tolerance };
        let mut bits = [DARK; super::outline::FACES];
        for (k, (bit, face)) in bits.iter_mut().zip(&body.faces).enumerate() {
            *bit = screen.look((k as u32, face), source, target);
        }
        screen.plain = screen.turning.len() > TURNING || body.edges.is_empty();
        for (k, edge) in body.edges.iter().enumerate() {
            screen.consider((k as u32, edge), edge.faces.map(|face| bits[face as usize]), source, target);
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
            return DARK;
        }
        let before = target.iter().any(|&y| face.height(y) > self.tolerance);
        if all {
            self.lit = 1 << LIT;
            if before {
                self.front.push((k, *face));
            }
            return LIT;
        }
        self.turning.push((k, *face, before));
        // Those beyond share a bit, which says no more than that they turn.
        (self.turning.len() - 1).min(TURNING - 1) as u8
    }

    fn consider(&mut self, (k, edge): (u32, &Edge), faces: [u8; 2], source: &[Vec3], target: &[Vec3]) {
        let [left, right] = faces;
        if left == right && left >= DARK {
            return;
        }
        let [a, b] = self.body.ends(edge);
        // Counter-clockwise round a face that looks at x, the inside is to the left.
        let turned = left == LIT || right == DARK;
        let (ends, faces) = if turned { ([b, a], [right, left]) } else { ([a, b], [left, right]) };
        let known = faces.iter().any(|&face| face >= DARK);
        let cuts = |x: &Vec3| {
            let inward = (ends[0] - *x).cross(ends[1] - *x);
            let outside = |height: f64| height < 0.0 && height < -self.tolerance * inward.length();
            target.iter().any(|y| outside(inward.dot(*y - *x)))
        };
        if !known || source.iter().any(cuts) {
            self.edges.push(ends);
            self.borders.push(Border { number: k, faces });
        }
    }

    /// The edges near which what is hidden of the target may be a steep function on the source, m: those that may cut the target, or all edges of a body that has part of the source inside
    /// or on it.
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
        !self.plain && self.borders[edge].faces.iter().all(|&bit| bit >= DARK)
    }

    /// The faces whose planes pass through the source, and whether any edge that may cut the target is theirs.
    #[inline]
    pub fn turning(&self) -> impl Iterator<Item = (&Face, bool)> {
        let cuts = |bit: usize| self.borders.iter().any(|border| border.faces.contains(&(bit as u8)));
        self.turning.iter().enumerate().map(move |(bit, (_, face, _))| (face, !self.plain && cuts(bit)))
    }

    /// The body.
    #[must_use]
    #[inline]
    pub fn body(&self) -> &Body {
        self.body
    }

    /// Heights up to which a point lies on a face, m.
    #[must_use]
    #[inline]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// What of the target is hidden from a point `x` of the source; where that is a room, `room` holds it.
    pub fn shadow(&self, x: Vec3, room: &mut Room) -> Shadow {
        self.front_from(x, room);
        self.rest(x, room)
    }

    /// Writes the half-spaces that are the same from all points of the source to `room`, in coordinates relative to the origin.
    pub fn front(&self, room: &mut Room) {
        self.front_from(Vec3::ZERO, room);
    }

    /// As [`shadow`](Self::shadow), less the half-spaces of [`front`](Self::front).
    pub fn outline(&self, x: Vec3, room: &mut Room) -> Shadow {
        room.clear();
        self.rest(x, room)
    }

    fn front_from(&self, x: Vec3, room: &mut Room) {
        room.clear();
        for (k, face) in &self.front {
            room.push_face(*k as usize, face.normal, face.height(x));
        }
    }

    /// Adds what [`front`](Self::front) lacks.
    fn rest(&self, x: Vec3, room: &mut Room) -> Shadow {
        if self.plain {
            return self.body.shadow(x, self.tolerance, room);
        }
        let mut lit = self.lit;
        for (bit, (k, face, before)) in self.turning.iter().enumerate() {
            let height = face.height(x);
            if height > self.tolerance {
                lit |= 1 << bit;
                if *before {
                    room.push_face(*k as usize, face.normal, height);
                }
            }
        }
        if lit == 0 {
            return self.body.shadow(x, self.tolerance, room);
        }
        for ([a, b], Border { number, faces: [first, second] }) in self.edges.iter().zip(&self.borders) {
            let [first, second] = [first, second].map(|bit| lit >> bit & 1 == 1);
            if first != second {
                let inward = (*a - x).cross(*b - x);
                room.push_edge(*number as usize, if second { inward } else { -inward });
            }
        }
        Shadow::Room
    }
}
