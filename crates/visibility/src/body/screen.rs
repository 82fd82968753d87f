//! A body between a source and a target polygon: what of its outline can matter there.
//!
//! det(a − x, b − x, y − x) is affine in x and in y. An edge a b that has all corners y of the target on its inner side from all corners x of the source has so from all
//! points of the source: it never cuts the target. Faces that look at all of the source or at none of it need no second look either.

use fredholm_mesh::Vec3;

use super::outline::Bits;
use super::{Body, Edge, Face, Room, Shadow};

/// A body as points of one polygon see it before another.
#[derive(Clone, Debug)]
pub struct Screen<'a> {
    body: &'a Body,
    /// Edges that may cut the target, m.
    edges: Vec<[Vec3; 2]>,
    /// Faces whose planes pass through the source.
    turning: Vec<Face>,
    /// Faces that look at all of the source and do not have all of the target behind them, where the outline is the same from everywhere.
    front: Option<Vec<Face>>,
    /// Faces that do not have all of the target behind them, where the outline is not the same from everywhere.
    ahead: Bits,
    tolerance: f64,
}

/// Which points a face looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Looks {
    All,
    Some,
    None,
}

impl<'a> Screen<'a> {
    /// Prepares `body` between two polygons. Heights of at most `tolerance` (m) over a face count as none.
    #[must_use]
    pub fn new(body: &'a Body, source: &[Vec3], target: &[Vec3], tolerance: f64) -> Self {
        let mut looks = [Looks::None; super::outline::FACES];
        for (looks, face) in looks.iter_mut().zip(&body.faces) {
            *looks = looks_at(face, source, tolerance);
        }
        let some = |at: Looks| {
            body.faces.iter().zip(looks).filter(move |(_, looks)| *looks == at).map(|(face, _)| *face)
        };
        let turning: Vec<Face> = some(Looks::Some).collect();
        let fixed = turning.is_empty() && some(Looks::All).next().is_some() && !body.edges.is_empty();
        let before = |face: &Face| target.iter().any(|&y| face.height(y) > tolerance);
        let front = fixed.then(|| some(Looks::All).filter(before).collect());
        let mut ahead = Bits::default();
        if !fixed {
            body.faces.iter().enumerate().filter(|(_, face)| before(face)).for_each(|(k, _)| ahead.set(k));
        }
        let mut screen = Self { body, edges: Vec::with_capacity(8), turning, front, ahead, tolerance };
        for edge in &body.edges {
            screen.consider(edge, edge.faces.map(|face| looks[face as usize]), source, target);
        }
        screen
    }

    fn consider(&mut self, edge: &Edge, [left, right]: [Looks; 2], source: &[Vec3], target: &[Vec3]) {
        if left == right && left != Looks::Some {
            return;
        }
        let [a, b] = self.body.ends(edge);
        // Counter-clockwise round a face that looks at x, the inside is to the left.
        let ends = if left == Looks::All || right == Looks::None { [b, a] } else { [a, b] };
        let cuts = |x: &Vec3| {
            let inward = (ends[0] - *x).cross(ends[1] - *x);
            let outside = |height: f64| height < 0.0 && height < -self.tolerance * inward.length();
            target.iter().any(|y| outside(inward.dot(*y - *x)))
        };
        if self.front.is_none() || source.iter().any(cuts) {
            self.edges.push(ends);
        }
    }

    /// The edges that may cut the target from some point of the source, m.
    #[must_use]
    #[inline]
    pub fn edges(&self) -> &[[Vec3; 2]] {
        &self.edges
    }

    /// The faces whose planes pass through the source.
    #[must_use]
    #[inline]
    pub fn turning(&self) -> &[Face] {
        &self.turning
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
        for (k, face) in self.front.iter().flatten().enumerate() {
            room.push_face(k, face.normal, face.height(x));
        }
    }

    /// Adds what [`front`](Self::front) lacks.
    fn rest(&self, x: Vec3, room: &mut Room) -> Shadow {
        if self.front.is_none() {
            return self.body.shadow_among(x, self.tolerance, self.ahead, room);
        }
        for (k, [a, b]) in self.edges.iter().enumerate() {
            room.push_edge(k, (*a - x).cross(*b - x));
        }
        Shadow::Room
    }
}

fn looks_at(face: &Face, points: &[Vec3], tolerance: f64) -> Looks {
    let (mut some, mut all) = (false, true);
    for &x in points {
        let looks = face.height(x) > tolerance;
        some |= looks;
        all &= looks;
    }
    match (some, all) {
        (_, true) => Looks::All,
        (true, false) => Looks::Some,
        _ => Looks::None,
    }
}
