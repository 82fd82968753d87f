//! Where on the line of an event a corner and an edge line up.
//!
//! From a point c of the plane that a corner and an edge span, the ray to the corner meets the line
//! of the edge. The event is there where it meets the edge itself, before the corner or behind it.
//! Both places change along the line without turning back, so that its two ends tell. Lengths in
//! metres.

use super::critical::Plane;
use fredholm_mesh::Vec3;

/// Part of an edge by which a point must be inside its ends to meet it: in scenes with right angles
/// lines often go exactly through corners.
pub(super) const EDGE_END_MARGIN: f64 = 1e-7;
/// Part of a chord that is left out at its ends, where lines of sight are often exactly parallel to
/// the edge.
pub(super) const CHORD_END_MARGIN: f64 = 1e-6;

/// A corner and an edge that line up.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgeVertexEvent {
    pub corner: Vec3,
    pub edge: [Vec3; 2],
    /// Whether the edge lies behind the corner.
    pub behind: bool,
}

impl EdgeVertexEvent {
    /// Whether they line up from a part of a chord in the plane with normal n.
    #[inline]
    pub(super) fn is_active(&self, [first, last]: [Vec3; 2], n: Vec3) -> bool {
        let inner = [first.lerp(last, CHORD_END_MARGIN), last.lerp(first, CHORD_END_MARGIN)];
        let across = (self.edge[1] - self.edge[0]).cross(n);
        let [first, last] = [self.meeting(inner[0], n, across), self.meeting(inner[1], n, across)];
        match (self.order(&first), self.order(&last)) {
            (true, true) => {
                (first.before_end() || last.before_end()) && (first.behind_start() || last.behind_start())
            }
            (false, false) => false,
            _ => true,
        }
    }

    /// Where the line from c through the corner meets the line of the edge; `across` is the normal
    /// of the edge in the plane.
    #[inline]
    fn meeting(&self, c: Vec3, n: Vec3, across: Vec3) -> Meeting {
        let (d, a) = (self.corner - c, self.edge[0] - c);
        let (whole, distance, place) = (d.dot(across), a.dot(across), a.cross(d).dot(n));
        let sign = 1f64.copysign(whole);
        Meeting { whole: sign * whole, distance: sign * distance, place: sign * place }
    }

    #[inline]
    fn order(&self, &Meeting { whole, distance, .. }: &Meeting) -> bool {
        if self.behind {
            distance > (1.0 + EDGE_END_MARGIN) * whole
        } else {
            EDGE_END_MARGIN * whole < distance && distance < (1.0 - EDGE_END_MARGIN) * whole
        }
    }
}

/// A point of the line of an edge, seen through a corner: its distance in distances of the corner,
/// and its place along the edge from 0 to 1, both times `whole`, which is not negative.
struct Meeting {
    whole: f64,
    distance: f64,
    place: f64,
}

impl Meeting {
    #[inline]
    fn before_end(&self) -> bool {
        self.place < (1.0 - EDGE_END_MARGIN) * self.whole
    }

    #[inline]
    fn behind_start(&self) -> bool {
        self.place > EDGE_END_MARGIN * self.whole
    }
}

/// A plane on which the hidden part may change its topology.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CriticalPlane {
    pub plane: Plane,
    /// Whether it does so nowhere but where its edge–vertex events tell.
    sure: bool,
    /// Whether it does so everywhere.
    always: bool,
    /// The last edge–vertex event on this plane, counted from 1.
    last: u32,
}

impl CriticalPlane {
    /// Whether it is active nowhere but where its edge–vertex events tell.
    pub(crate) fn is_sure(&self) -> bool {
        self.sure
    }

    /// A plane of which no event is known yet.
    pub(super) fn new(plane: Plane) -> Self {
        Self { plane, sure: true, always: false, last: 0 }
    }

    /// A plane that may be active anywhere.
    pub(super) fn perhaps(plane: Plane) -> Self {
        Self { plane, sure: false, always: false, last: 0 }
    }

    /// A plane that is active wherever it cuts the source.
    pub(super) fn always(plane: Plane) -> Self {
        Self { plane, sure: true, always: true, last: 0 }
    }
}

/// Whether a critical line is active on a polygon: whether the topology of the shadow differs on
/// its two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Active {
    Yes,
    No,
    Unknown,
}

/// The edge–vertex events of all critical planes, each with the one before it on the same plane.
#[derive(Clone, Debug, Default)]
pub(crate) struct EdgeVertexEvents(Vec<(EdgeVertexEvent, u32)>);

impl EdgeVertexEvents {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds an edge–vertex event to its critical plane; one that is not sure may show or not.
    pub(super) fn add(&mut self, event: &mut CriticalPlane, ev_event: EdgeVertexEvent, sure: bool) {
        if sure {
            self.0.push((ev_event, event.last));
            event.last = self.0.len() as u32;
        }
        event.sure &= sure;
    }

    /// Whether a critical plane is active on the line in which it cuts a convex polygon, given by
    /// the two ends.
    pub(super) fn ask(&self, event: &CriticalPlane, chord: Option<[Vec3; 2]>) -> Active {
        if event.always {
            return Active::Yes;
        }
        let (n, _) = event.plane;
        let Some(chord) = chord else { return Active::Unknown };
        let mut next = event.last;
        while let Some((ev_event, before)) = next.checked_sub(1).map(|k| &self.0[k as usize]) {
            if ev_event.is_active(chord, n) {
                return Active::Yes;
            }
            next = *before;
        }
        if event.sure { Active::No } else { Active::Unknown }
    }
}

/// The two ends of the line in which a plane cuts a convex polygon, given the heights of its
/// corners over the plane, each of which is asked for once.
#[inline]
pub(super) fn chord(corners: &[Vec3], mut height: impl FnMut(usize) -> f64) -> Option<[Vec3; 2]> {
    let (mut ends, mut found) = ([Vec3::ZERO; 2], 0);
    let mut cross = |from: (usize, f64), to: (usize, f64)| {
        if (from.1 >= 0.0) != (to.1 >= 0.0) && found < 2 {
            let along = corners[to.0] - corners[from.0];
            ends[found] = corners[from.0] + along * (from.1 / (from.1 - to.1));
            found += 1;
        }
    };
    let first = height(0);
    let mut from = first;
    for k in 1..corners.len() {
        let to = height(k);
        cross((k - 1, from), (k, to));
        from = to;
    }
    cross((corners.len() - 1, from), (0, first));
    (found == 2).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A post of height 1 before a wall at x = 2 from y = −1 to 1, seen from the floor.
    fn post() -> EdgeVertexEvent {
        EdgeVertexEvent {
            corner: Vec3::new(1.0, 0.0, 1.0),
            edge: [Vec3::new(2.0, -1.0, 1.5), Vec3::new(2.0, 1.0, 1.5)],
            behind: true,
        }
    }

    #[test]
    fn a_corner_and_an_edge_line_up_where_the_ray_meets_the_edge() {
        // The plane through the corner and the edge cuts the floor along x = −1.
        let n = Vec3::new(-0.5, 0.0, 1.0).normalize();
        let chord = |low: f64, high: f64| [Vec3::new(-1.0, low, 0.0), Vec3::new(-1.0, high, 0.0)];
        assert!(post().is_active(chord(-0.5, 0.5), n) && post().is_active(chord(1.5, 5.0), n));
        assert!(!post().is_active(chord(2.1, 5.0), n));
    }

    #[test]
    fn an_event_shows_on_the_polygons_on_which_it_is_seen() {
        let n = Vec3::new(-0.5, 0.0, 1.0).normalize();
        let (mut event, mut ev_events) =
            (CriticalPlane::new((n, n.dot(post().corner))), EdgeVertexEvents::default());
        let ask = |ev_events: &EdgeVertexEvents, event: &CriticalPlane, y: f64| {
            let square = [[-1.5, y], [-0.5, y], [-0.5, y + 1.0], [-1.5, y + 1.0]];
            let square = square.map(|[x, y]| Vec3::new(x, y, 0.0));
            let (n, c) = event.plane;
            ev_events.ask(event, chord(&square, |k| n.dot(square[k]) - c))
        };
        ev_events.add(&mut event, post(), true);
        assert_eq!(ask(&ev_events, &event, 0.0), Active::Yes);
        assert_eq!(ask(&ev_events, &event, 3.0), Active::No);
        ev_events.add(&mut event, post(), false);
        assert_eq!(ask(&ev_events, &event, 3.0), Active::Unknown);
    }
}
