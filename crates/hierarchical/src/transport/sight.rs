//! What gets through between two flat nodes: all, nothing, or a share of it.
//!
//! No body in the shaft of the two polygons, and all gets through; one convex body across all segments between their corners, and nothing does. Else points of each polygon
//! see the other one exactly clipped, and the share is Σ F_seen/Σ F_open over the points; what both sides make of it differs by an estimate of its error. Behind many bodies
//! segments between the points of both sides take the place of the clipping. E. A. Haines & J. R. Wallace 1994, doi:10.1007/978-3-642-57963-9_12, for the shaft.

use super::spread::{POINTS, points, summary};
use fredholm_coupling::form_factor::{VisibleParts, point_to_polygon};
use fredholm_coupling::kernel::lambert;
use fredholm_coupling::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Body, Room, Shadow};

/// Bodies in a scene up to which points see exactly.
const FEW: usize = 256;

/// Least uncertainty of a share that is neither 0 nor 1 for sure.
const DOUBT: f64 = 0.1;
/// Spread that is added to both sides before they are weighed.
const EVEN: f64 = 1e-3;

/// What may come between the elements of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight<'a> {
    pub occluders: &'a Occluders,
    pub bodies: &'a Bodies,
}

/// What two patches see of each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum View {
    /// Nothing is between.
    Open,
    /// Nothing gets through.
    Nothing,
    /// A share of the open exchange; relative to that, the spreads over both sides and the uncertainty of the share.
    Part { share: f64, spread: [f64; 2], doubt: f64 },
}

/// Answers for one thread.
pub(crate) struct Viewer<'a> {
    sight: Sight<'a>,
    parts: VisibleParts<'a>,
    room: Room,
    between: Vec<u32>,
    front: Vec<Vec3>,
}

impl<'a> Viewer<'a> {
    pub fn new(sight: Sight<'a>) -> Self {
        let parts = VisibleParts::new(sight.occluders, sight.bodies);
        Self { sight, parts, room: Room::default(), between: Vec::new(), front: Vec::new() }
    }

    /// What two patches see of each other.
    pub fn view(&mut self, a: &Patch, b: &Patch) -> View {
        if self.sight.bodies.as_slice().len() > FEW { self.behind_many(a, b) } else { self.behind_few(a, b) }
    }

    fn behind_few(&mut self, a: &Patch, b: &Patch) -> View {
        let Sight { occluders, bodies } = self.sight;
        let Some(shaft) = occluders.shaft_between(a, b) else { return View::Nothing };
        let mut reaching = bodies.as_slice().iter().filter(|body| occluders.reaches(body, &shaft)).peekable();
        if reaching.peek().is_none() {
            return View::Open;
        }
        if reaching.any(|body| blocks(body, a, b, bodies.tolerance(), &mut self.room)) {
            return View::Nothing;
        }
        let (over_a, over_b) = (self.seen(a, b), self.seen(b, a));
        view(over_a, over_b)
    }

    /// Open and seen form factors from the points of one patch to the other.
    fn seen(&mut self, from: &Patch, to: &Patch) -> [[f64; POINTS]; 2] {
        let mut found = [[0.0; POINTS]; 2];
        if !self.parts.prepare(from, to) {
            return found;
        }
        for (k, x) in points(from).into_iter().enumerate() {
            found[1][k] = self.parts.factor(x);
            found[0][k] = self.open(x, from, to).max(found[1][k]);
        }
        found
    }

    /// Form factor from a point of one patch to the part of the other above its horizon.
    fn open(&mut self, x: Vec3, from: &Patch, to: &Patch) -> f64 {
        self.front.clear();
        if (x - to.corner(0)).dot(to.normal()) <= 0.0 {
            return 0.0;
        }
        clip(to.corners(), HalfSpace::through(x, from.normal()), 0.0, &mut self.front);
        point_to_polygon(from.normal(), self.front.iter().map(|&y| y - x))
    }

    fn behind_many(&mut self, a: &Patch, b: &Patch) -> View {
        let occluders = self.sight.occluders;
        occluders.shaft(a, b, &mut self.between);
        if self.between.is_empty() {
            return View::Open;
        }
        let (xs, ys) = (points(a), points(b));
        let mut found = [[[0.0; POINTS]; 2]; 2];
        for (i, &x) in xs.iter().enumerate() {
            for (j, &y) in ys.iter().enumerate() {
                let weight = lambert(x, a.normal(), y, b.normal());
                let seen = weight > 0.0 && occluders.unoccluded_by(x, y, &self.between);
                for (side, k) in [(0, i), (1, j)] {
                    found[side][0][k] += weight;
                    found[side][1][k] += if seen { weight } else { 0.0 };
                }
            }
        }
        view(found[0], found[1])
    }
}

/// Puts together what the points of both sides see: open and seen factors of each.
fn view(over_a: [[f64; POINTS]; 2], over_b: [[f64; POINTS]; 2]) -> View {
    let [a, b] = [over_a, over_b].map(|[open, seen]| {
        let ((open, _), (mean, relative)) = (summary(&open), summary(&seen));
        if open > 0.0 { ((mean / open).min(1.0), relative * mean / open) } else { (0.0, 0.0) }
    });
    // The side over which less varies knows the share better.
    let (here, there) = (b.1 + EVEN, a.1 + EVEN);
    let share = (here * a.0 + there * b.0) / (here + there);
    View::Part { share, spread: [a.1, b.1], doubt: (0.5 * (a.0 - b.0).abs()).max(DOUBT) }
}

/// Whether a convex body is across every segment between two patches: what holds for their corners holds for all of their points.
fn blocks(body: &Body, a: &Patch, b: &Patch, tolerance: f64, room: &mut Room) -> bool {
    a.corners().iter().all(|&x| match body.shadow(x, tolerance, room) {
        Shadow::Nothing => false,
        Shadow::Room => b.corners().iter().all(|&y| room.holds(&[y - x])),
    })
}
