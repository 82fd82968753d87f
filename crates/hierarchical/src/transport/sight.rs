//! What gets through between two flat nodes: all, nothing, or a share of it.
//!
//! No body in the shaft of the two polygons, and all gets through; one convex body across all
//! segments between their corners, and nothing does. Else points of each polygon see the other one
//! exactly clipped, and the share is Σ F_seen/Σ F_open over the points; what both sides make of it
//! differs by an estimate of its error. Behind many bodies segments take the place of the clipping
//! ([`super::segments`]), between places of either side that every pair draws for itself: what they
//! miss is as often too much as too little. E. A. Haines & J. R. Wallace 1994,
//! doi:10.1007/978-3-642-57963-9_12, for the shaft.

use super::segments::{Segments, Through};
use super::side::{POINTS, Points, Side};
use super::spread::{CLOSE_DEVIATION, open_factor};
use fredholm_coupling::form_factor::VisibleParts;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Body, Shadow, ShadowVolume};

/// Bodies in a scene up to which points see exactly.
const MOST_EXACT_BODIES: usize = 256;
/// Occluders between two patches up to which segments are tested against each of them.
const MOST_LISTED_OCCLUDERS: usize = 64;

/// Least uncertainty of a share that is neither 0 nor 1 for sure.
const LEAST_UNCERTAINTY: f64 = 0.2;
/// Spread that is added to both sides before they are weighed.
const ADDED_SPREAD: f64 = 1e-3;

/// What may come between the elements of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight<'a> {
    pub occluders: &'a Occluders,
    pub bodies: &'a Bodies,
    /// Whether there are too many occluders to put them together to bodies.
    pub many: bool,
}

/// What two patches see of each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum View {
    /// Nothing is between.
    Open,
    /// Nothing gets through.
    Nothing,
    /// A share of the open exchange; relative to that, how both sides deviate, and the uncertainty
    /// of the share.
    Part { share: f64, sides: [Side; 2], doubt: f64 },
}

/// Answers for one thread.
pub(crate) struct Viewer<'a> {
    sight: Sight<'a>,
    parts: VisibleParts<'a>,
    volume: ShadowVolume,
    between: Vec<u32>,
    segments: Segments,
    pub front: Vec<Vec3>,
}

impl<'a> Viewer<'a> {
    pub fn new(sight: Sight<'a>) -> Self {
        let parts = VisibleParts::new(sight.occluders, sight.bodies);
        Self {
            sight,
            parts,
            volume: ShadowVolume::default(),
            between: Vec::new(),
            segments: Segments::default(),
            front: Vec::new(),
        }
    }

    /// What two patches see of each other.
    pub fn view(&mut self, a: &Patch, b: &Patch) -> View {
        let many = self.sight.many || self.sight.bodies.as_slice().len() > MOST_EXACT_BODIES;
        if many { self.behind_many(a, b) } else { self.behind_few(a, b) }
    }

    /// Whether nothing is between two points.
    pub fn sees(&self, x: Vec3, y: Vec3) -> bool {
        self.sight.occluders.unoccluded(x, y)
    }

    fn behind_few(&mut self, a: &Patch, b: &Patch) -> View {
        let Sight { occluders, bodies, .. } = self.sight;
        let Some(shaft) = occluders.shaft_between(a, b) else { return View::Nothing };
        let mut reaching = occluders.reaching(bodies, &shaft).peekable();
        if reaching.peek().is_none() {
            return View::Open;
        }
        if reaching.any(|(_, body)| blocks(body, a, b, bodies.tolerance(), &mut self.volume)) {
            return View::Nothing;
        }
        let (xs, ys) = (Points::of(a), Points::of(b));
        let (over_a, over_b) = (self.seen(&xs, a, b), self.seen(&ys, b, a));
        view(side(&xs, over_a), side(&ys, over_b))
    }

    /// Open and seen form factors from the points of one patch to the other.
    fn seen(&mut self, points: &Points, from: &Patch, to: &Patch) -> [[f64; POINTS]; 2] {
        let mut found = [[0.0; POINTS]; 2];
        if !self.parts.prepare(from, to) {
            return found;
        }
        for (k, &x) in points.at.iter().enumerate() {
            found[1][k] = self.parts.factor(x);
            found[0][k] = open_factor(x, from.normal(), to, &mut self.front).max(found[1][k]);
        }
        found
    }

    fn behind_many(&mut self, a: &Patch, b: &Patch) -> View {
        let occluders = self.sight.occluders;
        let listed = occluders.shaft_up_to(a, b, MOST_LISTED_OCCLUDERS, &mut self.between);
        if self.between.is_empty() {
            return View::Open;
        }
        let between = &self.between;
        let clear = |x: Vec3, y: Vec3| {
            if listed { occluders.unoccluded_by(x, y, between) } else { occluders.unoccluded(x, y) }
        };
        let points = [&Points::of(a), &Points::of(b)];
        match self.segments.between([a, b], points, clear) {
            Some(Through { share, sides, doubt }) => View::Part { share, sides, doubt },
            None => view(None, None),
        }
    }
}

/// Puts together what the points of both sides see.
fn view(a: Option<(f64, Side)>, b: Option<(f64, Side)>) -> View {
    let (share, sides, doubt) = weigh(a, b);
    View::Part { share, sides, doubt: doubt.max(LEAST_UNCERTAINTY) }
}

/// The share that both sides make out, how it varies over them, and how far they differ.
pub(super) fn weigh(a: Option<(f64, Side)>, b: Option<(f64, Side)>) -> (f64, [Side; 2], f64) {
    let (share, doubt) = match (a, b) {
        (Some(a), Some(b)) => {
            // The side over which less varies knows the share better.
            let (here, there) = (b.1.deviation + ADDED_SPREAD, a.1.deviation + ADDED_SPREAD);
            ((here * a.0 + there * b.0) / (here + there), (a.0 - b.0).abs())
        }
        (Some(one), None) | (None, Some(one)) => (one.0, LEAST_UNCERTAINTY),
        (None, None) => (0.5, 0.5),
    };
    let sides =
        [a, b].map(|side| side.map_or_else(|| Side::default().at_least(CLOSE_DEVIATION), |(_, side)| side));
    (share, sides, doubt)
}

/// Share that one side sees and how that varies, relative to the open factor; none where no point
/// is in front.
fn side(points: &Points, [open, seen]: [[f64; POINTS]; 2]) -> Option<(f64, Side)> {
    let (open, seen) = (points.side(&open), points.side(&seen));
    let share = if open.mean > 0.0 { (seen.mean / open.mean).min(1.0) } else { 0.0 };
    (open.mean > 0.0).then(|| (share, seen.scaled(share)))
}

/// Whether a convex body is across every segment between two patches: what holds for their corners
/// holds for all of their points.
fn blocks(body: &Body, a: &Patch, b: &Patch, tolerance: f64, volume: &mut ShadowVolume) -> bool {
    a.corners().iter().all(|&x| match body.shadow(x, tolerance, volume) {
        Shadow::Nothing => false,
        Shadow::Volume => b.corners().iter().all(|&y| volume.holds(&[y - x])),
    })
}
