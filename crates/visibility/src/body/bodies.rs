//! The bodies of a scene: what of its occluders can come between its elements, put together as far
//! as it is convex.

use fredholm_mesh::{Patch, Vec3};

use super::coplanar::merge;
use super::solid::{Lid, solid};
use super::weld::{Polygon, connected, weld};
use super::{Body, Face, place};
use crate::Occluders;

/// Convex bodies that block the view between the elements of a scene.
#[derive(Clone, Debug, Default)]
pub struct Bodies {
    list: Vec<Body>,
    /// Balls around them, side by side: most bodies are told by them to be out of the way.
    balls: Vec<(Vec3, f64)>,
    /// Boxes around them, m.
    bounds: Vec<[Vec3; 2]>,
    tolerance: f64,
}

impl Bodies {
    /// Puts the patches of `occluders` together: neighbours in one plane to convex polygons, and
    /// faces that close round a convex volume to solids. A polygon with all `elements` and `points`
    /// on one side of its plane blocks nothing between them and is left out.
    #[must_use]
    pub fn new(occluders: &Occluders, elements: &[&Patch], points: &[Vec3]) -> Self {
        let tolerance = occluders.tolerance();
        let (corners, polygons) = weld(occluders.patches());
        let mut polygons = merge(&corners, &polygons, tolerance);
        polygons.retain(|polygon| divides(&corners, polygon, elements, points, tolerance));
        let mut bodies = Vec::new();
        for list in connected(&polygons, |_, _| true) {
            let mut faces: Vec<&Polygon> = list.iter().map(|&k| &polygons[k]).collect();
            let middle = |polygon: &Polygon| place(polygon.corners.iter().map(|&k| &corners[k as usize]));
            faces.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
            let whole = solid(&corners, &faces, tolerance, &occluders.frame);
            let covered =
                |lid: &Lid| polygons.iter().any(|polygon| covers(&corners, polygon, lid, tolerance));
            match whole.filter(|solid| solid.stands_for_its_faces(elements, points, tolerance, covered)) {
                Some(solid) => bodies.push(solid.body),
                None => bodies.extend(faces.iter().map(|face| flat(&corners, face, occluders))),
            }
        }
        bodies.sort_by(|a, b| place(a.corners().iter()).total_cmp(&place(b.corners().iter())));
        let balls = bodies.iter().map(Body::ball).collect();
        let bounds = bodies.iter().map(around).collect();
        Self { list: bodies, balls, bounds, tolerance }
    }

    /// The bodies, in an order that the numbers of the patches do not change.
    #[must_use]
    pub fn as_slice(&self) -> &[Body] {
        &self.list
    }

    /// Balls around the bodies in the coordinates of the scene's frame: centres and radii.
    pub(crate) fn balls(&self) -> &[(Vec3, f64)] {
        &self.balls
    }

    /// The lowest and highest coordinates of each body, m.
    #[must_use]
    pub fn bounds(&self) -> &[[Vec3; 2]] {
        &self.bounds
    }

    /// Length up to which two places count as one, m.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

fn around(body: &Body) -> [Vec3; 2] {
    let low = body.corners().iter().fold(Vec3::INFINITY, |low, &x| low.min(x));
    [low, body.corners().iter().fold(Vec3::NEG_INFINITY, |high, &x| high.max(x))]
}

fn flat(corners: &[Vec3], polygon: &Polygon, occluders: &Occluders) -> Body {
    let outline = polygon.corners.iter().map(|&k| corners[k as usize]).collect();
    Body::flat(outline, polygon.normal, &occluders.frame)
}

/// Whether a lid lies in a polygon.
fn covers(corners: &[Vec3], polygon: &Polygon, lid: &Lid, tolerance: f64) -> bool {
    let plane = Face::through(corners[polygon.corners[0] as usize], polygon.normal);
    let inside = |x: Vec3| {
        polygon.sides().all(|side| {
            let [a, b] = side.map(|k| corners[k as usize]);
            polygon.normal.cross(b - a).dot(x - a) >= -tolerance * a.distance(b)
        })
    };
    lid.corners.iter().all(|&x| plane.height(x).abs() <= tolerance && inside(x))
}

fn divides(
    corners: &[Vec3],
    polygon: &Polygon,
    elements: &[&Patch],
    points: &[Vec3],
    tolerance: f64,
) -> bool {
    let plane = Face::through(corners[polygon.corners[0] as usize], polygon.normal);
    let (mut above, mut below) = (false, false);
    elements.iter().flat_map(|element| element.corners()).chain(points).any(|&x| {
        let height = plane.height(x);
        above |= height > tolerance;
        below |= height < -tolerance;
        above && below
    })
}
