//! What bodies hide of an exchange: ∫_i h(x) dA with h(x) the exact form factor from x to the
//! hidden part of j, in m².
//!
//! h is smooth between the critical lines ([`critical`](super::critical)), along which the source
//! is cut where that pays ([`Pieces`]). The unoccluded exchange is computed apart, which keeps the
//! singularity of touching patches out of this integral.

use super::critical::Critical;
use super::ev_events::CriticalPlane;
use super::pieces::{Breaks, Pieces, PiecesWork};
use super::shadow::Topology;
use super::together::Together;
use super::{ErrorModel, Segment, point_to_polygon, to_segments};
use fredholm_mesh::Vec3;
use fredholm_quadrature::Estimate;
use fredholm_visibility::body::Screen;

/// The source polygon with its normal, the target, and what stands between.
#[derive(Clone, Copy)]
pub(crate) struct Occluded<'a> {
    pub source: &'a [Vec3],
    pub normal: Vec3,
    pub target: &'a [Vec3],
    pub screens: &'a [Screen<'a>],
    /// The exchange with nothing between, m².
    pub open: f64,
    /// Heights up to which a point lies on a face, m.
    pub tolerance: f64,
}

impl Occluded<'_> {
    /// The form factor h at each of the `points`.
    fn hidden(&self, points: &[Vec3], together: &mut Together, found: &mut Vec<(f64, Topology)>) {
        together.hidden_factors(points, (self.normal, self.target), self.screens, found);
    }
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct HiddenWork {
    together: Together,
    critical: Critical,
    pieces: PiecesWork,
    edges: Vec<Segment>,
}

impl HiddenWork {
    /// Points at which the hidden part was asked for, of all integrals.
    pub(crate) fn points(&self) -> u64 {
        self.pieces.points_asked
    }
}

/// The hidden part of the exchange (m²), to an absolute `goal` (m²).
pub(crate) fn hidden_exchange(
    scene: &Occluded,
    model: &ErrorModel,
    goal: f64,
    work: &mut HiddenWork,
) -> Estimate {
    let HiddenWork { together, critical, pieces, edges } = work;
    let steep = Steep::of(scene, edges);
    let (events, ev_events) = critical.events(scene.source, scene.target, scene.screens, scene.tolerance);
    let most = |x: Vec3| point_to_polygon(scene.normal, scene.target.iter().map(|&y| y - x));
    let sure = scene.screens.len() == 1 && events.iter().all(CriticalPlane::is_sure);
    let breaks =
        Breaks { events, ev_events, sure, flat: scene.tolerance, distance: |x| steep.distance(x), most };
    let h = |points: &[Vec3], found: &mut Vec<_>| scene.hidden(points, together, found);
    Pieces::new(h, breaks, pieces, model, goal).integrate(scene.source, scene.open)
}

/// What makes the hidden part steep where it is close: edges that may cut the target, and of those
/// that lie on the source the ends.
struct Steep<'a> {
    edges: &'a [Segment],
}

impl<'a> Steep<'a> {
    fn of(scene: &Occluded, edges: &'a mut Vec<Segment>) -> Self {
        let lies = |x: Vec3| (x - scene.source[0]).dot(scene.normal).abs() <= scene.tolerance;
        edges.clear();
        for [a, b] in scene.screens.iter().flat_map(Screen::steep) {
            if lies(a) && lies(b) {
                edges.extend([[a, a], [b, b]].map(Segment::new));
            } else {
                edges.push(Segment::new([a, b]));
            }
        }
        Self { edges }
    }

    /// Distance of a point from the nearest of them, m.
    fn distance(&self, x: Vec3) -> f64 {
        to_segments(x, self.edges.iter().copied())
    }
}
