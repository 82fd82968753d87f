//! Where on the line of an event a corner and an edge line up.
//!
//! From a point c of the plane that a corner and an edge span, the ray to the corner meets the line of the edge. The event is there where it meets the edge itself, before the corner
//! or behind it. Both places change along the line without turning back, so that its two ends tell. Lengths in metres.

use super::critical::Plane;
use fredholm_mesh::Vec3;

/// Part of an edge by which a point must be inside its ends to meet it: in scenes with right angles lines often go exactly through corners.
pub(super) const MARGIN: f64 = 1e-7;
/// Part of a chord that is left out at its ends, where lines of sight are often exactly parallel to the edge.
pub(super) const INSIDE: f64 = 1e-6;

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
    #[inline]
    pub(super) fn shows(&self, [first, last]: [Vec3; 2], n: Vec3) -> bool {
        let inner = [first.lerp(last, INSIDE), last.lerp(first, INSIDE)];
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

    /// Where the line from c through the corner meets the line of the edge; `across` is the normal of the edge in the plane.
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
            distance > (1.0 + MARGIN) * whole
        } else {
            MARGIN * whole < distance && distance < (1.0 - MARGIN) * whole
        }
    }
}

/// A point of the line of an edge, seen through a corner: its distance in distances of the corner, and its place along the edge from 0 to 1, both times `whole`, which is not negative.
struct Meeting {
    whole: f64,
    distance: f64,
    place: f64,
}

impl Meeting {
    #[inline]
    fn before_end(&self) -> bool {
        self.place < (1.0 - MARGIN) * self.whole
    }

    #[inline]
    fn behind_start(&self) -> bool {
        self.place > MARGIN * self.whole
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

    /// Whether an event shows on the line in which its plane cuts a convex polygon, given by the two ends.
    pub(super) fn ask(&self, event: &Event, chord: Option<[Vec3; 2]>) -> Shows {
        if event.always {
            return Shows::Surely;
        }
        let (n, _) = event.plane;
        let Some(chord) = chord else { return Shows::Perhaps };
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

/// The two ends of the line in which a plane cuts a convex polygon, given the heights of its corners over the plane, each of which is asked for once.
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
        let ask = |sightings: &Sightings, event: &Event, y: f64| {
            let square = [[-1.5, y], [-0.5, y], [-0.5, y + 1.0], [-1.5, y + 1.0]];
            let square = square.map(|[x, y]| Vec3::new(x, y, 0.0));
            let (n, c) = event.plane;
            sightings.ask(event, chord(&square, |k| n.dot(square[k]) - c))
        };
        sightings.add(&mut event, post(), true);
        assert_eq!(ask(&sightings, &event, 0.0), Shows::Surely);
        assert_eq!(ask(&sightings, &event, 3.0), Shows::Never);
        sightings.add(&mut event, post(), false);
        assert_eq!(ask(&sightings, &event, 3.0), Shows::Perhaps);
    }
}
