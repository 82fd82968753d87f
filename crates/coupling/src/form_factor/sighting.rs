//! Where on the line of an event a corner and an edge line up.
//!
//! From a point c of the plane that a corner and an edge span, the ray to the corner meets the line of the edge. The event is there where it meets the edge itself, before the corner
//! or behind it. Both places change along the line without turning back, so that its two ends tell. Lengths in metres.

use super::critical::Plane;
use fredholm_mesh::Vec3;

/// Part of an edge by which a point must be inside its ends to meet it: in scenes with right angles lines often go exactly through corners.
const MARGIN: f64 = 1e-7;
/// Part of a chord that is left out at its ends, where lines of sight are often exactly parallel to the edge.
const INSIDE: f64 = 1e-6;

/// A corner and an edge that line up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    pub corner: Vec3,
    pub edge: [Vec3; 2],
    /// Whether the edge lies behind the corner.
    pub behind: bool,
}

impl Sighting {
    /// Whether they line up from a part of a chord in the plane with normal n.
    pub(super) fn shows(&self, [first, last]: [Vec3; 2], n: Vec3) -> bool {
        let inner = [first.lerp(last, INSIDE), last.lerp(first, INSIDE)];
        let [first, last] = inner.map(|c| self.meeting(c, n));
        match (self.order(first.0), self.order(last.0)) {
            (true, true) => first.1.min(last.1) < 1.0 - MARGIN && first.1.max(last.1) > MARGIN,
            (false, false) => false,
            _ => true,
        }
    }

    /// Where the line from c through the corner meets the line of the edge: the distance in distances of the corner, and the place along the edge from 0 to 1.
    fn meeting(&self, c: Vec3, n: Vec3) -> (f64, f64) {
        let [a, b] = self.edge;
        let (d, e) = (self.corner - c, b - a);
        let across = d.cross(e).dot(n);
        ((a - c).cross(e).dot(n) / across, (a - c).cross(d).dot(n) / across)
    }

    fn order(&self, t: f64) -> bool {
        if self.behind { t > 1.0 + MARGIN } else { MARGIN < t && t < 1.0 - MARGIN }
    }
}

/// A plane on which the hidden part may change its kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub plane: Plane,
    /// Whether it does so nowhere but where sightings tell.
    sure: bool,
    /// Whether it does so everywhere.
    always: bool,
    /// The last sighting on this plane, counted from 1.
    last: u32,
}

impl Event {
    /// Whether it shows nowhere but where sightings tell.
    pub(crate) fn is_sure(&self) -> bool {
        self.sure
    }

    /// An event that nobody has seen yet.
    pub(super) fn new(plane: Plane) -> Self {
        Self { plane, sure: true, always: false, last: 0 }
    }

    /// An event that may show anywhere.
    pub(super) fn perhaps(plane: Plane) -> Self {
        Self { plane, sure: false, always: false, last: 0 }
    }

    /// An event that shows wherever its plane cuts the source.
    pub(super) fn always(plane: Plane) -> Self {
        Self { plane, sure: true, always: true, last: 0 }
    }
}

/// Whether a line shows on a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shows {
    Surely,
    Never,
    Perhaps,
}

/// The sightings of all events, each with the one before it on the same plane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sightings(Vec<(Sighting, u32)>);

impl Sightings {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds a sighting to an event; one that is not sure may show or not.
    pub(super) fn add(&mut self, event: &mut Event, sighting: Sighting, sure: bool) {
        if sure {
            self.0.push((sighting, event.last));
            event.last = self.0.len() as u32;
        }
        event.sure &= sure;
    }

    /// Whether an event shows on a convex polygon.
    pub(super) fn ask(&self, event: &Event, corners: &[Vec3]) -> Shows {
        if event.always {
            return Shows::Surely;
        }
        let (n, c) = event.plane;
        let Some(chord) = chord(corners, |k| n.dot(corners[k]) - c) else { return Shows::Perhaps };
        let mut next = event.last;
        while let Some((sighting, before)) = next.checked_sub(1).map(|k| &self.0[k as usize]) {
            if sighting.shows(chord, n) {
                return Shows::Surely;
            }
            next = *before;
        }
        if event.sure { Shows::Never } else { Shows::Perhaps }
    }
}

/// The two ends of the line in which a plane cuts a convex polygon, given the heights of its corners over the plane.
pub(super) fn chord(corners: &[Vec3], height: impl Fn(usize) -> f64) -> Option<[Vec3; 2]> {
    let (mut ends, mut found) = ([Vec3::ZERO; 2], 0);
    for k in 0..corners.len() {
        let l = if k + 1 == corners.len() { 0 } else { k + 1 };
        let (from, to) = (height(k), height(l));
        if (from >= 0.0) != (to >= 0.0) && found < 2 {
            ends[found] = corners[k] + (corners[l] - corners[k]) * (from / (from - to));
            found += 1;
        }
    }
    (found == 2).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A post of height 1 before a wall at x = 2 from y = −1 to 1, seen from the floor.
    fn post() -> Sighting {
        Sighting {
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
        assert!(post().shows(chord(-0.5, 0.5), n) && post().shows(chord(1.5, 5.0), n));
        assert!(!post().shows(chord(2.1, 5.0), n));
    }

    #[test]
    fn an_event_shows_on_the_polygons_on_which_it_is_seen() {
        let n = Vec3::new(-0.5, 0.0, 1.0).normalize();
        let (mut event, mut sightings) = (Event::new((n, n.dot(post().corner))), Sightings::default());
        let square = |y: f64| {
            [[-1.5, y], [-0.5, y], [-0.5, y + 1.0], [-1.5, y + 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0))
        };
        sightings.add(&mut event, post(), true);
        assert_eq!(sightings.ask(&event, &square(0.0)), Shows::Surely);
        assert_eq!(sightings.ask(&event, &square(3.0)), Shows::Never);
        sightings.add(&mut event, post(), false);
        assert_eq!(sightings.ask(&event, &square(3.0)), Shows::Perhaps);
    }
}
