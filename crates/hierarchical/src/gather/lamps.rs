//! What points receive of lamps, with true borders of shadows: F(x→g), the factor of what x sees of
//! all surfaces of lamp g, so that E(x) = Σ_g M_g F(x→g) is their light.
//!
//! Neighbouring patches of a lamp are put together to convex polygons and closed convex solids. By
//! Lambert's formula the factor of such a piece is a sum over the edges of its outline, whatever
//! lies within (Schröder & Hanrahan, doi:10.1145/166117.166138). Of the outline the shadows of the
//! bodies between are cut out exactly. Which bodies may come between an element and a piece is
//! found once an element; what nothing can come between is open for all of its points. Scenes of
//! very many occluders or lamps have none. Metres.

use super::shadows::{Covers, FLAT_HEIGHT, Shadows};
use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::{Bodies, Body, Shadow, ShadowVolume};
use fredholm_visibility::{Occluders, VisibilityError};
use std::ops::Range;
use std::sync::OnceLock;

/// Pieces of lamps that are looked at for every point; lamps of more have none.
const MOST_PIECES: usize = 128;
/// Parts of lamps times bodies that may stand before them, at most: what every pixel may have to
/// look through.
const MOST_PAIRS: usize = 16_384;
/// Occluders up to which their shadows are cut out.
const MOST_OCCLUDERS: usize = 5_000;
/// Patches of a piece up to which the room between it and an element is a shaft for each.
const FEW_PATCHES: usize = 8;
/// Points without which no plane through the scene has anything on both of its sides, in radii.
const FAR_RADII: f64 = 10.0;
/// Points that are looked at one by one, behind what may come between any of them and a piece.
const FEW_POINTS: usize = 12;
/// Bodies that hide parts of a piece from all points between which its factors are interpolated, at
/// most: where they are more, they are too small to do so.
const FEW_BODIES: usize = 8;
/// Points between which factors are interpolated where they change smoothly.
const MANY_POINTS: usize = 20;
/// The same at most: in a larger region a bend between the nodes might not show at them.
const MOST_POINTS: usize = 256;
/// How far such factors may be from being linear between two nodes, over their size. What the
/// polynomial of degree 2 leaves is much less.
const LINEAR_TOLERANCE: f64 = 0.005;
/// How often a plane between two convex sets is looked for.
const PLANE_TRIALS: usize = 6;
/// Relative difference of areas that is none.
const AREA_TOLERANCE: f64 = 1e-6;

/// A convex part of the surfaces of one lamp.
#[derive(Debug)]
struct Piece {
    lamp: usize,
    shape: Shape,
    /// Its corners, and a ball round them.
    corners: Vec<Vec3>,
    ball: (Vec3, f64),
    patches: Vec<Patch>,
}

#[derive(Debug)]
enum Shape {
    /// Lit on the side from which the corners run counter-clockwise.
    Flat {
        normal: Vec3,
    },
    Solid(Body),
}

/// How an element lies to a piece.
#[derive(Debug)]
enum Sight {
    /// One does not see the other.
    Away,
    /// Nothing can come between.
    Open,
    /// These bodies may come between.
    Behind(Vec<u32>),
}

/// The lamps of a scene as its elements see them.
#[derive(Debug)]
pub struct Lamps<'a> {
    occluders: &'a Occluders,
    elements: Vec<&'a Patch>,
    bodies: Bodies,
    balls: Vec<(Vec3, f64)>,
    pieces: Vec<Piece>,
    count: usize,
    sights: Vec<OnceLock<Vec<Sight>>>,
}

impl<'a> Lamps<'a> {
    /// Lamps of some patches each, before elements and what blocks the view; none where there are
    /// too many of them.
    ///
    /// # Errors
    /// [`VisibilityError`] for patches that cannot be prepared.
    pub fn new(
        lamps: &[Vec<&Patch>],
        elements: Vec<&'a Patch>,
        occluders: &'a Occluders,
    ) -> Result<Option<Self>, VisibilityError> {
        if occluders.len() > MOST_OCCLUDERS {
            return Ok(None);
        }
        let mut pieces = Vec::new();
        for (lamp, patches) in lamps.iter().enumerate() {
            // Thousands of small lamps are not worth being put together.
            if patches.len() > MOST_OCCLUDERS {
                return Ok(None);
            }
            pieces.extend(put_together(lamp, patches)?);
            if pieces.len() > MOST_PIECES {
                return Ok(None);
            }
        }
        let bodies = Bodies::new(occluders, &elements, &[]);
        if pieces.len() * bodies.as_slice().len() > MOST_PAIRS {
            return Ok(None);
        }
        let balls = bodies.as_slice().iter().map(|body| ball(body.corners())).collect();
        let sights = elements.iter().map(|_| OnceLock::new()).collect();
        Ok(Some(Self { occluders, elements, bodies, balls, pieces, count: lamps.len(), sights }))
    }

    /// Number of lamps.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Looks at the lamps for one thread.
    #[must_use]
    pub fn lighter(&self) -> Lighter<'_> {
        Lighter {
            lamps: self,
            shadows: Shadows::default(),
            volume: ShadowVolume::default(),
            outline: Vec::new(),
            above: Vec::new(),
            list: Vec::new(),
            between: Vec::new(),
            order: Vec::new(),
        }
    }

    fn sights(&self, element: usize) -> &[Sight] {
        self.sights[element].get_or_init(|| {
            let patch = self.elements[element];
            self.pieces.iter().map(|piece| self.sight(patch, piece)).collect()
        })
    }

    fn sight(&self, element: &Patch, piece: &Piece) -> Sight {
        let tolerance = self.occluders.tolerance();
        let (origin, normal) = (element.centroid(), element.normal());
        // A quad that is not quite flat has corners off its plane.
        let warp = element.corners().iter().map(|x| normal.dot(*x - origin).abs()).fold(0.0, f64::max);
        let below = |x: &Vec3| normal.dot(*x - origin) <= tolerance - warp;
        let unlit = match &piece.shape {
            Shape::Flat { normal } => {
                element.corners().iter().all(|x| normal.dot(*x - piece.corners[0]) <= tolerance)
            }
            Shape::Solid(_) => false,
        };
        if unlit || piece.corners.iter().all(below) {
            return Sight::Away;
        }
        let shafts: Option<Vec<_>> = (piece.patches.len() <= FEW_PATCHES).then(|| {
            piece.patches.iter().filter_map(|patch| self.occluders.shaft_between(element, patch)).collect()
        });
        let own = ball(element.corners());
        let between = |&k: &u32| {
            let body = &self.bodies.as_slice()[k as usize];
            near(own, piece.ball, self.balls[k as usize])
                && !body.corners().iter().all(below)
                && !piece.is_behind(body, tolerance)
                && !beside(body, element.corners(), &piece.corners, tolerance)
                && shafts
                    .as_ref()
                    .is_none_or(|shafts| shafts.iter().any(|shaft| self.occluders.reaches(body, shaft)))
        };
        let found: Vec<u32> = (0..self.bodies.as_slice().len() as u32).filter(between).collect();
        if found.is_empty() { Sight::Open } else { Sight::Behind(found) }
    }
}

impl Piece {
    fn flat(lamp: usize, corners: Vec<Vec3>, normal: Vec3, patches: Vec<Patch>) -> Self {
        Self { lamp, shape: Shape::Flat { normal }, ball: ball(&corners), corners, patches }
    }

    /// Whether a body is a part of the piece, or lies behind it.
    fn is_behind(&self, body: &Body, tolerance: f64) -> bool {
        match &self.shape {
            Shape::Flat { normal } => {
                body.corners().iter().all(|x| normal.dot(*x - self.corners[0]) <= tolerance)
            }
            Shape::Solid(_) => body
                .corners()
                .iter()
                .all(|x| self.corners.iter().any(|own| own.distance_squared(*x) <= tolerance * tolerance)),
        }
    }

    /// A length that counts as none, seen from `x`, m.
    fn least(&self, x: Vec3) -> f64 {
        FLAT_HEIGHT * (self.ball.0.distance(x) + self.ball.1)
    }

    /// The corners of the outline as seen from `x`, relative to it; none where nothing is seen.
    fn outline(&self, x: Vec3, tolerance: f64, out: &mut Vec<Vec3>) {
        out.clear();
        match &self.shape {
            Shape::Flat { normal } => {
                if normal.dot(x - self.corners[0]) > tolerance {
                    out.extend(self.corners.iter().map(|&y| y - x));
                }
            }
            Shape::Solid(body) => silhouette(body, x, tolerance, out),
        }
    }
}

/// The outline of a convex solid: its edges between a face that looks at `x` and one that does not,
/// one behind the other.
fn silhouette(body: &Body, x: Vec3, tolerance: f64, out: &mut Vec<Vec3>) {
    const NO_CORNER: u32 = u32::MAX;
    let lit: Vec<bool> = body.faces().iter().map(|face| face.height(x) > tolerance).collect();
    let mut next = vec![NO_CORNER; body.corners().len()];
    let mut first = NO_CORNER;
    for edge in body.edges() {
        let [left, right] = edge.faces.map(|face| lit[face as usize]);
        if left != right {
            let [a, b] = edge.ends;
            let [from, to] = if left { [a, b] } else { [b, a] };
            next[from as usize] = to;
            first = from;
        }
    }
    let mut at = first;
    while at != NO_CORNER && out.len() <= next.len() {
        out.push(body.corners()[at as usize] - x);
        at = next[at as usize];
        if at == first {
            return;
        }
    }
    // What does not close is seen of nothing.
    out.clear();
}

/// Convex pieces of the patches of a lamp: merged where that keeps their area and the sides that
/// they are lit on, else as they are.
fn put_together(lamp: usize, patches: &[&Patch]) -> Result<Vec<Piece>, VisibilityError> {
    let owned: Vec<Patch> = patches.iter().map(|patch| **patch).collect();
    let corners: Vec<Vec3> = owned.iter().flat_map(|patch| patch.corners().iter().copied()).collect();
    let (centre, radius) = ball(&corners);
    let far: Vec<Vec3> = (0..8)
        .map(|k| {
            let sign = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            centre + FAR_RADII * radius.max(f64::MIN_POSITIVE) * Vec3::new(sign(0), sign(1), sign(2))
        })
        .collect();
    let occluders = Occluders::new(&owned)?;
    let bodies = Bodies::new(&occluders, &[], &far);
    let tolerance = occluders.tolerance();
    let merged: Option<Vec<Piece>> =
        bodies.as_slice().iter().map(|body| piece(lamp, body, &owned, tolerance)).collect();
    let whole = |pieces: &Vec<Piece>| {
        let count: usize = pieces.iter().map(|piece| piece.patches.len()).sum();
        count == owned.len()
    };
    Ok(merged.filter(whole).unwrap_or_else(|| {
        owned
            .iter()
            .map(|patch| Piece::flat(lamp, patch.corners().to_vec(), patch.normal(), vec![*patch]))
            .collect()
    }))
}

/// A body as a piece, where the patches on it make up all of its surface and are lit outside.
fn piece(lamp: usize, body: &Body, patches: &[Patch], tolerance: f64) -> Option<Piece> {
    let on = |patch: &&Patch, normal: Vec3, offset: f64| {
        patch.normal().dot(normal) > 1.0 - AREA_TOLERANCE
            && patch.corners().iter().all(|x| (normal.dot(*x) - offset).abs() <= tolerance)
    };
    if body.is_solid() {
        let faces = body.faces();
        let outside = |patch: &&Patch| faces.iter().any(|face| on(patch, face.normal, face.offset));
        let inside = |x: Vec3| faces.iter().all(|face| face.height(x) <= tolerance);
        let own: Vec<Patch> =
            patches.iter().filter(|patch| inside(patch.centroid())).filter(outside).copied().collect();
        let covered: f64 = own.iter().map(Patch::area).sum();
        let surface = surface(body);
        let closed = (covered - surface).abs() <= AREA_TOLERANCE * surface;
        let corners = body.corners().to_vec();
        let shape = Shape::Solid(body.clone());
        return closed.then(|| Piece { lamp, shape, ball: ball(&corners), corners, patches: own });
    }
    let normal = body.faces()[0].normal;
    let corners = body.corners();
    let within = |x: Vec3| {
        (0..corners.len()).all(|k| {
            let [a, b] = [corners[k], corners[(k + 1) % corners.len()]];
            normal.cross(b - a).dot(x - a) >= -tolerance * a.distance(b)
        })
    };
    let own: Vec<Patch> = patches
        .iter()
        .filter(|patch| on(patch, normal, normal.dot(corners[0])) && within(patch.centroid()))
        .copied()
        .collect();
    let covered: f64 = own.iter().map(Patch::area).sum();
    let area = (2..corners.len())
        .map(|k| 0.5 * (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]).dot(normal))
        .sum::<f64>();
    ((covered - area).abs() <= AREA_TOLERANCE * area)
        .then(|| Piece::flat(lamp, corners.to_vec(), normal, own))
}

/// Area of the surface of a solid by the divergence theorem over its edges, m².
fn surface(body: &Body) -> f64 {
    let origin = body.corners()[0];
    let mut areas = vec![Vec3::ZERO; body.faces().len()];
    for edge in body.edges() {
        let [a, b] = body.ends(edge).map(|end| end - origin);
        areas[edge.faces[0] as usize] += 0.5 * a.cross(b);
        areas[edge.faces[1] as usize] += 0.5 * b.cross(a);
    }
    areas.iter().map(|area| area.length()).sum()
}

/// A ball round some points: centre and radius.
fn ball(points: &[Vec3]) -> (Vec3, f64) {
    let low = points.iter().fold(Vec3::INFINITY, |low, x| low.min(*x));
    let high = points.iter().fold(Vec3::NEG_INFINITY, |high, x| high.max(*x));
    let centre = 0.5 * (low + high);
    (centre, points.iter().map(|x| x.distance(centre)).fold(0.0, f64::max))
}

/// Whether a ball may reach into the room between two others.
fn near((a, ra): (Vec3, f64), (b, rb): (Vec3, f64), (c, rc): (Vec3, f64)) -> bool {
    let along = b - a;
    let t = ((c - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    c.distance(a + t * along) <= ra.max(rb) + rc
}

/// Whether a face of a body has both groups of points wholly outside: then no segment between them
/// meets the body.
fn beside(body: &Body, a: &[Vec3], b: &[Vec3], tolerance: f64) -> bool {
    body.faces().iter().any(|face| a.iter().chain(b).all(|x| face.height(*x) >= -tolerance))
}

/// Points of an element before a piece of a lamp.
#[derive(Clone, Copy)]
struct Group<'g> {
    piece: &'g Piece,
    element: &'g Patch,
    points: &'g [Vec3],
}

/// A box round points, with sides along their element.
struct Region {
    axes: [Vec3; 3],
    low: [f64; 3],
    high: [f64; 3],
    /// The corners, of which the first four are enough where it is flat.
    corners: [Vec3; 8],
    count: usize,
}

impl Region {
    /// The box round some of the points of a group.
    fn new(group: Group, order: &[u32], tolerance: f64) -> Self {
        let normal = group.element.normal();
        let along = (group.element.corner(1) - group.element.corner(0)).normalize_or_zero();
        let axes = [along, normal.cross(along), normal];
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &k in order {
            for (i, axis) in axes.iter().enumerate() {
                let place = axis.dot(group.points[k as usize]);
                (low[i], high[i]) = (low[i].min(place), high[i].max(place));
            }
        }
        let corner = |k: usize| {
            let place = |i: usize| if k >> i & 1 == 1 { high[i] } else { low[i] };
            axes[0] * place(0) + axes[1] * place(1) + axes[2] * place(2)
        };
        let count = if high[2] - low[2] > tolerance { 8 } else { 4 };
        Self { axes, low, high, corners: std::array::from_fn(corner), count }
    }

    fn corners(&self) -> &[Vec3] {
        &self.corners[..self.count]
    }

    fn is_flat(&self) -> bool {
        self.count == 4
    }

    /// The axis along which it is longer, and the middle on it, m.
    fn middle(&self) -> (Vec3, f64) {
        let longer = usize::from(self.high[1] - self.low[1] > self.high[0] - self.low[0]);
        (self.axes[longer], 0.5 * (self.low[longer] + self.high[longer]))
    }

    /// Node i, j of the 3 × 3 of a flat one.
    fn node(&self, [i, j]: [usize; 2]) -> Vec3 {
        let share = |k: usize, i: usize| self.low[k] + 0.5 * i as f64 * (self.high[k] - self.low[k]);
        self.axes[0] * share(0, i) + self.axes[1] * share(1, j) + self.axes[2] * self.low[2]
    }

    /// The value at a point of the polynomial of degree 2 in each direction through those at the
    /// nodes.
    fn interpolated(&self, values: &[[f64; 3]; 3], x: Vec3) -> f64 {
        let weights = |k: usize| {
            let size = self.high[k] - self.low[k];
            let t = if size > 0.0 { (self.axes[k].dot(x) - self.low[k]) / size } else { 0.0 };
            [(2.0 * t - 1.0) * (t - 1.0), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)]
        };
        let [u, v] = [weights(0), weights(1)];
        (0..9).map(|k| u[k / 3] * v[k % 3] * values[k / 3][k % 3]).sum()
    }
}

/// Which of the 3 × 3 nodes of a region.
type Node = [usize; 2];

/// The nodes of a region, the corners first; and for those between two others, these.
const NODES: [(Node, Option<[Node; 2]>); 9] = [
    ([0, 0], None),
    ([2, 2], None),
    ([0, 2], None),
    ([2, 0], None),
    ([0, 1], Some([[0, 0], [0, 2]])),
    ([2, 1], Some([[2, 0], [2, 2]])),
    ([1, 0], Some([[0, 0], [2, 0]])),
    ([1, 2], Some([[0, 2], [2, 2]])),
    ([1, 1], Some([[1, 0], [1, 2]])),
];

/// Whether a plane is found that has the segments from a convex region to a piece on one side and a
/// body on the other.
///
/// The difference of the two convex sets does not hold the origin then. A point of it is moved
/// towards the farthest one against it (E. G. Gilbert, SIAM J. Control 4, 1966,
/// doi:10.1137/0304007) until that one is on its side; that it is not soon found says nothing.
fn is_apart(region: &[Vec3], piece: &[Vec3], body: &[Vec3]) -> bool {
    let least = |along: Vec3, points: &mut dyn Iterator<Item = &Vec3>| {
        let mut found = (f64::INFINITY, Vec3::ZERO);
        for &y in points {
            let height = along.dot(y);
            if height < found.0 {
                found = (height, y);
            }
        }
        found
    };
    let mut v = region[0] - body[0];
    for _ in 0..PLANE_TRIALS {
        let (height, a) = least(v, &mut region.iter().chain(piece));
        let (depth, b) = least(-v, &mut body.iter());
        if height + depth > 0.0 {
            return true;
        }
        let way = (a - b) - v;
        let share = (-v.dot(way) / way.length_squared()).clamp(0.0, 1.0);
        if share.is_nan() || share <= 0.0 {
            return false;
        }
        v += share * way;
    }
    false
}

/// Looks at lamps for one thread; buffers are kept from point to point.
#[derive(Debug)]
pub struct Lighter<'l> {
    lamps: &'l Lamps<'l>,
    shadows: Shadows,
    volume: ShadowVolume,
    outline: Vec<Vec3>,
    above: Vec<Vec3>,
    list: Vec<u32>,
    /// Bodies that may come between, one list behind the other.
    between: Vec<u32>,
    /// Numbers of the points, those of a region next to each other.
    order: Vec<u32>,
}

impl Lighter<'_> {
    /// The factors from points (m) of an element to what they see of each lamp, points × lamps.
    /// Points near each other are quicker together: what comes between none of them and a lamp is
    /// found for all of them at once.
    pub fn factors(&mut self, element: usize, points: &[Vec3], factors: &mut [f64]) {
        factors.fill(0.0);
        let lamps = self.lamps;
        let patch = lamps.elements[element];
        for (piece, sight) in lamps.pieces.iter().zip(lamps.sights(element)) {
            let group = Group { piece, element: patch, points };
            self.between.clear();
            self.order.clear();
            self.order.extend(0..points.len() as u32);
            match sight {
                Sight::Away => {}
                Sight::Open => self.part(group, (0..points.len(), 0..0), factors),
                Sight::Behind(found) => {
                    self.between.extend_from_slice(found);
                    self.part(group, (0..points.len(), 0..found.len()), factors);
                }
            }
        }
    }

    /// Adds the factors of some points of a group, from bodies that may come between: those that
    /// come between none of them are left out, and where some are left, either half of the points
    /// is looked at by itself.
    fn part(&mut self, group: Group, (own, among): (Range<usize>, Range<usize>), factors: &mut [f64]) {
        if own.len() <= FEW_POINTS {
            return self.each(group, (own, among), factors);
        }
        let region = Region::new(group, &self.order[own.clone()], self.lamps.occluders.tolerance());
        let bodies = self.lamps.bodies.as_slice();
        let start = self.between.len();
        for k in among {
            let number = self.between[k];
            let body = &bodies[number as usize];
            if is_apart(region.corners(), &group.piece.corners, body.corners()) {
                continue;
            }
            if self.hides(body, group.piece, region.corners()) {
                self.between.truncate(start);
                return;
            }
            self.between.push(number);
        }
        let between = start..self.between.len();
        let smooth = region.is_flat()
            && (MANY_POINTS..=MOST_POINTS).contains(&own.len())
            && between.len() <= FEW_BODIES;
        let values = if smooth { self.values(group, &region, between.clone()) } else { None };
        if let Some(values) = values {
            for &k in &self.order[own] {
                let value = region.interpolated(&values, group.points[k as usize]).max(0.0);
                factors[k as usize * self.lamps.count + group.piece.lamp] += value;
            }
        } else if between.is_empty() && own.len() < MANY_POINTS {
            self.each(group, (own, between), factors);
        } else {
            let middle = own.start + self.parted(group, own.clone(), &region);
            self.part(group, (own.start..middle, between.clone()), factors);
            self.part(group, (middle..own.end, between), factors);
        }
        self.between.truncate(start);
    }

    /// Puts the points before the middle of a region first, and returns their number.
    fn parted(&mut self, group: Group, own: Range<usize>, region: &Region) -> usize {
        let (order, (along, middle)) = (&mut self.order[own], region.middle());
        let mut count = 0;
        for k in 0..order.len() {
            if along.dot(group.points[order[k] as usize]) < middle {
                order.swap(k, count);
                count += 1;
            }
        }
        // Points that all lie in one place are halved as they come.
        if count == 0 { order.len() / 2 } else { count }
    }

    /// Whether a body hides a piece from all corners of a convex region: then it does so from all
    /// of its points, since where a convex body meets two sides of a triangle, it meets all
    /// segments between them.
    fn hides(&mut self, body: &Body, piece: &Piece, region: &[Vec3]) -> bool {
        let (tolerance, volume) = (self.lamps.occluders.tolerance(), &mut self.volume);
        region.iter().all(|&x| {
            let inside = |&(normal, offset, _): &(Vec3, f64, u32)| {
                piece.corners.iter().all(|y| normal.dot(*y - x) >= offset)
            };
            body.shadow(x, tolerance, volume) == Shadow::Volume && volume.planes().iter().all(inside)
        })
    }

    /// The factors at the nodes of a region; none unless they determine those in it. They do where
    /// each of the bodies hides a part of the piece from all nodes, so that no border of a shadow
    /// passes between them, and where the factor is nearly linear.
    fn values(&mut self, group: Group, region: &Region, between: Range<usize>) -> Option<[[f64; 3]; 3]> {
        let mut values = [[0.0_f64; 3]; 3];
        let normal = group.element.normal();
        for ([i, j], ends) in NODES {
            let x = region.node([i, j]);
            let sight = self.sight(group.piece, between.clone(), x, normal);
            if sight == Covers::All || self.list.len() < between.len() {
                return None;
            }
            let value = self.factor(sight, group.piece.least(x), normal);
            values[i][j] = value;
            let at = |[i, j]: [usize; 2]| values[i][j];
            if ends.is_some_and(|[a, b]| (value - 0.5 * (at(a) + at(b))).abs() > LINEAR_TOLERANCE * value) {
                return None;
            }
        }
        Some(values)
    }

    /// Adds the factor of each of some points, behind some bodies.
    fn each(&mut self, group: Group, (own, between): (Range<usize>, Range<usize>), factors: &mut [f64]) {
        let normal = group.element.normal();
        for k in own {
            let at = self.order[k] as usize;
            let x = group.points[at];
            let sight = self.sight(group.piece, between.clone(), x, normal);
            factors[at * self.lamps.count + group.piece.lamp] +=
                self.factor(sight, group.piece.least(x), normal);
        }
    }

    /// Finds the part of a piece above the horizon; false where there is none.
    fn look(&mut self, piece: &Piece, x: Vec3, normal: Vec3) -> bool {
        piece.outline(x, self.lamps.occluders.tolerance(), &mut self.outline);
        self.above.clear();
        clip(&self.outline, HalfSpace { normal, offset: 0.0 }, piece.least(x), &mut self.above);
        self.above.len() >= 3
    }

    /// Looks at a piece from a point behind some bodies: finds those that hide a part of it.
    fn sight(&mut self, piece: &Piece, between: Range<usize>, x: Vec3, normal: Vec3) -> Covers {
        if !self.look(piece, x, normal) {
            return Covers::All;
        }
        let bodies = self.lamps.bodies.as_slice();
        let between = self.between[between].iter().map(|&k| &bodies[k as usize]);
        self.shadows.cast_on(&self.above, (x, normal), between, self.lamps.occluders.tolerance());
        self.list.clear();
        for shadow in 0..self.shadows.len() as u32 {
            match self.shadows.covers(shadow, &self.above, piece.least(x)) {
                Covers::Nothing => {}
                Covers::Part => self.list.push(shadow),
                Covers::All => return Covers::All,
            }
        }
        if self.list.is_empty() { Covers::Nothing } else { Covers::Part }
    }

    /// The factor of what was looked at.
    fn factor(&mut self, sight: Covers, flat: f64, normal: Vec3) -> f64 {
        match sight {
            Covers::All => 0.0,
            Covers::Nothing => point_to_polygon(normal, self.above.iter().copied()).max(0.0),
            Covers::Part => self.shadows.factor(normal, &self.above, &self.list, flat),
        }
    }
}
