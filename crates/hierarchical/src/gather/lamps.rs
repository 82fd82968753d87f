//! What points receive of lamps, with true borders of shadows: F(x→g), the factor of what x sees of all surfaces of lamp g, so that E(x) = Σ_g M_g F(x→g) is their light.
//!
//! Neighbouring patches of a lamp are put together to convex polygons and closed convex solids. By Lambert's formula the factor of such a piece is a sum over the edges of its outline, whatever lies within
//! (Schröder & Hanrahan, doi:10.1145/166117.166138). Of the outline the shadows of the bodies between are cut out exactly. Which bodies may come between an element and a piece is found
//! once an element; what nothing can come between is open for all of its points. In scenes of very many occluders rays to a grid on each piece are counted instead. Metres.

use super::shadows::{Covers, FLAT, Shadows};
use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::{Bodies, Body};
use fredholm_visibility::{Occluders, VisibilityError};
use std::sync::OnceLock;

/// Pieces of lamps that are looked at for every point; lamps of more have none.
const MOST_PIECES: usize = 128;
/// Parts of lamps times bodies that may stand before them, at most: what every pixel may have to look
/// through.
const MOST_PAIRS: usize = 16_384;
/// Occluders up to which their shadows are cut out exactly.
const MANY: usize = 20_000;
/// Patches of a piece up to which the room between it and an element is a shaft for each.
const FEW_PATCHES: usize = 8;
/// How often a triangle of a piece is halved both ways for the grid that rays go to.
const HALVINGS: u32 = 3;
/// Points without which no plane through the scene has anything on both of its sides, in radii.
const FAR: f64 = 10.0;
/// Relative difference of areas that is none.
const SAME: f64 = 1e-6;

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
    /// Something may come between that rays find.
    Rays,
}

/// The lamps of a scene as its elements see them.
#[derive(Debug)]
pub struct Lamps<'a> {
    occluders: &'a Occluders,
    elements: Vec<&'a Patch>,
    /// None where there are very many occluders.
    bodies: Option<Bodies>,
    balls: Vec<(Vec3, f64)>,
    pieces: Vec<Piece>,
    count: usize,
    sights: Vec<OnceLock<Vec<Sight>>>,
}

impl<'a> Lamps<'a> {
    /// Lamps of some patches each, before elements and what blocks the view; none where there are too many of them.
    ///
    /// # Errors
    /// [`VisibilityError`] for patches that cannot be prepared.
    pub fn new(
        lamps: &[Vec<&Patch>],
        elements: Vec<&'a Patch>,
        occluders: &'a Occluders,
    ) -> Result<Option<Self>, VisibilityError> {
        let exact = occluders.len() <= MANY;
        let mut pieces = Vec::new();
        for (lamp, patches) in lamps.iter().enumerate() {
            // Thousands of small lamps are not worth being put together.
            if patches.len() > MANY {
                return Ok(None);
            }
            pieces.extend(put_together(lamp, patches, exact)?);
            if pieces.len() > MOST_PIECES {
                return Ok(None);
            }
        }
        let bodies = exact.then(|| Bodies::new(occluders, &elements, &[]));
        let list = bodies.as_ref().map_or(&[][..], Bodies::as_slice);
        if pieces.len() * list.len() > MOST_PAIRS {
            return Ok(None);
        }
        let balls = list.iter().map(|body| ball(body.corners())).collect();
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
            outline: Vec::new(),
            above: Vec::new(),
            list: Vec::new(),
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
        let Some(bodies) = &self.bodies else {
            let mut found = Vec::new();
            let open = piece
                .patches
                .iter()
                .all(|patch| self.occluders.shaft_up_to(element, patch, 0, &mut found) && found.is_empty());
            return if open { Sight::Open } else { Sight::Rays };
        };
        let shafts: Option<Vec<_>> = (piece.patches.len() <= FEW_PATCHES).then(|| {
            piece.patches.iter().filter_map(|patch| self.occluders.shaft_between(element, patch)).collect()
        });
        let own = ball(element.corners());
        let between = |&k: &u32| {
            let body = &bodies.as_slice()[k as usize];
            near(own, piece.ball, self.balls[k as usize])
                && !body.corners().iter().all(below)
                && !piece.is_behind(body, tolerance)
                && !beside(body, element.corners(), &piece.corners, tolerance)
                && shafts
                    .as_ref()
                    .is_none_or(|shafts| shafts.iter().any(|shaft| self.occluders.reaches(body, shaft)))
        };
        let found: Vec<u32> = (0..bodies.as_slice().len() as u32).filter(between).collect();
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

/// The outline of a convex solid: its edges between a face that looks at `x` and one that does not, one behind the other.
fn silhouette(body: &Body, x: Vec3, tolerance: f64, out: &mut Vec<Vec3>) {
    const NONE: u32 = u32::MAX;
    let lit: Vec<bool> = body.faces().iter().map(|face| face.height(x) > tolerance).collect();
    let mut next = vec![NONE; body.corners().len()];
    let mut first = NONE;
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
    while at != NONE && out.len() <= next.len() {
        out.push(body.corners()[at as usize] - x);
        at = next[at as usize];
        if at == first {
            return;
        }
    }
    // What does not close is seen of nothing.
    out.clear();
}

/// Convex pieces of the patches of a lamp: merged where that keeps their area and the sides that they are lit on, else as they are.
fn put_together(lamp: usize, patches: &[&Patch], exact: bool) -> Result<Vec<Piece>, VisibilityError> {
    let owned: Vec<Patch> = patches.iter().map(|patch| **patch).collect();
    let corners: Vec<Vec3> = owned.iter().flat_map(|patch| patch.corners().iter().copied()).collect();
    let (centre, radius) = ball(&corners);
    let far: Vec<Vec3> = (0..8)
        .map(|k| {
            let sign = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            centre + FAR * radius.max(f64::MIN_POSITIVE) * Vec3::new(sign(0), sign(1), sign(2))
        })
        .collect();
    let occluders = Occluders::new(&owned)?;
    let bodies = Bodies::new(&occluders, &[], &far);
    let tolerance = occluders.tolerance();
    let merged: Option<Vec<Piece>> =
        bodies.as_slice().iter().map(|body| piece(lamp, body, &owned, tolerance, exact)).collect();
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
fn piece(lamp: usize, body: &Body, patches: &[Patch], tolerance: f64, exact: bool) -> Option<Piece> {
    let on = |patch: &&Patch, normal: Vec3, offset: f64| {
        patch.normal().dot(normal) > 1.0 - SAME
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
        let closed = (covered - surface).abs() <= SAME * surface;
        let corners = body.corners().to_vec();
        let shape = Shape::Solid(body.clone());
        return (closed && exact).then(|| Piece { lamp, shape, ball: ball(&corners), corners, patches: own });
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
    ((covered - area).abs() <= SAME * area).then(|| Piece::flat(lamp, corners.to_vec(), normal, own))
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

/// Whether a face of a body has both groups of points wholly outside: then no segment between them meets the body.
fn beside(body: &Body, a: &[Vec3], b: &[Vec3], tolerance: f64) -> bool {
    body.faces().iter().any(|face| a.iter().chain(b).all(|x| face.height(*x) >= -tolerance))
}

/// Looks at lamps for one thread; buffers are kept from point to point.
#[derive(Debug)]
pub struct Lighter<'l> {
    lamps: &'l Lamps<'l>,
    shadows: Shadows,
    outline: Vec<Vec3>,
    above: Vec<Vec3>,
    list: Vec<u32>,
}

impl Lighter<'_> {
    /// The factors from a point of an element to what it sees of each lamp.
    pub fn factors(&mut self, element: usize, point: Vec3, factors: &mut [f64]) {
        factors.fill(0.0);
        let lamps = self.lamps;
        let normal = lamps.elements[element].normal();
        for (piece, sight) in lamps.pieces.iter().zip(lamps.sights(element)) {
            if !matches!(sight, Sight::Away) {
                factors[piece.lamp] += self.factor(piece, sight, point, normal);
            }
        }
    }

    fn factor(&mut self, piece: &Piece, sight: &Sight, x: Vec3, normal: Vec3) -> f64 {
        let tolerance = self.lamps.occluders.tolerance();
        piece.outline(x, tolerance, &mut self.outline);
        let flat = FLAT * (piece.ball.0.distance(x) + piece.ball.1);
        // The part above the horizon.
        self.above.clear();
        clip(&self.outline, HalfSpace { normal, offset: 0.0 }, flat, &mut self.above);
        if self.above.len() < 3 {
            return 0.0;
        }
        let open = |corners: &[Vec3]| point_to_polygon(normal, corners.iter().copied()).max(0.0);
        match sight {
            Sight::Away => 0.0,
            Sight::Open => open(&self.above),
            Sight::Behind(found) => {
                let bodies = self.lamps.bodies.as_ref().map_or(&[][..], Bodies::as_slice);
                let between = found.iter().map(|&k| &bodies[k as usize]);
                self.shadows.cast(x, normal, between, tolerance);
                self.list.clear();
                for shadow in 0..self.shadows.len() as u32 {
                    match self.shadows.covers(shadow, &self.above, flat) {
                        Covers::Nothing => {}
                        Covers::Part => self.list.push(shadow),
                        Covers::All => return 0.0,
                    }
                }
                if self.list.is_empty() {
                    return open(&self.above);
                }
                self.shadows.factor(normal, &self.above, &self.list, flat)
            }
            Sight::Rays => self.counted(x, normal),
        }
    }

    /// The factor of small triangles of which the middle is seen.
    fn counted(&mut self, x: Vec3, normal: Vec3) -> f64 {
        let (cells, polygon) = (1_u32 << HALVINGS, &self.above);
        let mut sum = 0.0;
        for k in 2..polygon.len() {
            let [origin, u, v] = [polygon[0], polygon[k - 1] - polygon[0], polygon[k] - polygon[0]];
            let at = |i: u32, j: u32| origin + (u * f64::from(i) + v * f64::from(j)) / f64::from(cells);
            for i in 0..cells {
                for j in 0..cells - i {
                    let lower = [at(i, j), at(i + 1, j), at(i, j + 1)];
                    let upper = [at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)];
                    for corners in [lower, upper].iter().take(if i + j + 1 < cells { 2 } else { 1 }) {
                        let middle = corners.iter().sum::<Vec3>() / 3.0;
                        if self.lamps.occluders.unoccluded(x, x + middle) {
                            sum += point_to_polygon(normal, corners.iter().copied());
                        }
                    }
                }
            }
        }
        sum.max(0.0)
    }
}
