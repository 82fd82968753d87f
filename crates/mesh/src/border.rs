//! Borders of a polygon in its plane: do they cross, touch or contain each other?
//!
//! Sides are sorted by their least x; a side is compared with those that begin before it ends: a
//! sweep as in M. I. Shamos and D. Hoey, 1976, doi:10.1109/SFCS.1976.16, without their ordered
//! tree. Any unit of length.

use glam::DVec2;

use crate::MeshError;
use crate::error::Ring;

/// A corner of a border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// Index in the input.
    pub index: usize,
    pub at: DVec2,
}

/// Side from a corner to the next.
#[derive(Clone, Copy, Debug)]
struct Side {
    ring: usize,
    place: usize,
    from: Corner,
    to: Corner,
}

/// Refuses borders that come within `tolerance` of themselves or each other; the outline is number 0.
pub(crate) fn refuse_contact(rings: &[Vec<Corner>], tolerance: f64) -> Result<(), MeshError> {
    let mut sides: Vec<Side> =
        rings.iter().enumerate().flat_map(|(ring, corners)| sides_of(ring, corners)).collect();
    sides.sort_by(|a, b| a.low().x.total_cmp(&b.low().x));
    for (i, first) in sides.iter().enumerate() {
        let reach = first.high() + tolerance;
        let near = sides[i + 1..].iter().take_while(|second| second.low().x <= reach.x);
        for second in near {
            let apart = second.low().y > reach.y || first.low().y > second.high().y + tolerance;
            if !apart && first.meets(second, rings[first.ring].len(), tolerance) {
                return Err(first.contact(second));
            }
        }
    }
    Ok(())
}

/// Whether a point lies inside a border, by the parity of crossings of a ray along x.
pub(crate) fn contains(ring: &[Corner], point: DVec2) -> bool {
    let crossed = |side: &Side| {
        let (a, b) = (side.from.at, side.to.at);
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
    };
    sides_of(0, ring).filter(crossed).count() % 2 == 1
}

/// Signed area, positive for counter-clockwise borders.
pub(crate) fn area(ring: &[Corner]) -> f64 {
    let origin = ring[0].at;
    0.5 * sides_of(0, ring).map(|side| (side.from.at - origin).perp_dot(side.to.at - origin)).sum::<f64>()
}

fn sides_of(ring: usize, corners: &[Corner]) -> impl Iterator<Item = Side> {
    (0..corners.len()).map(move |place| {
        let (from, to) = (corners[place], corners[(place + 1) % corners.len()]);
        Side { ring, place, from, to }
    })
}

impl Side {
    fn low(&self) -> DVec2 {
        self.from.at.min(self.to.at)
    }

    fn high(&self) -> DVec2 {
        self.from.at.max(self.to.at)
    }

    /// Whether two sides meet where they should not. Sides that share a corner may meet there only.
    fn meets(&self, other: &Self, corners: usize, tolerance: f64) -> bool {
        let follows = |a: &Self, b: &Self| a.ring == b.ring && (a.place + 1) % corners == b.place;
        if follows(self, other) {
            return self.folds_onto(other, tolerance);
        }
        if follows(other, self) {
            return other.folds_onto(self, tolerance);
        }
        self.crosses(other) || self.gap(other) <= tolerance
    }

    /// Whether the next side runs back along this one.
    fn folds_onto(&self, next: &Self, tolerance: f64) -> bool {
        self.distance(next.to.at) <= tolerance || next.distance(self.from.at) <= tolerance
    }

    fn crosses(&self, other: &Self) -> bool {
        let splits = |a: &Self, b: &Self| {
            let along = a.to.at - a.from.at;
            along.perp_dot(b.from.at - a.from.at) * along.perp_dot(b.to.at - a.from.at) < 0.0
        };
        splits(self, other) && splits(other, self)
    }

    /// Distance of two sides that do not cross.
    fn gap(&self, other: &Self) -> f64 {
        let ends = [self.distance(other.from.at), self.distance(other.to.at)];
        let others = [other.distance(self.from.at), other.distance(self.to.at)];
        ends.into_iter().chain(others).fold(f64::INFINITY, f64::min)
    }

    fn distance(&self, point: DVec2) -> f64 {
        let along = self.to.at - self.from.at;
        let t = (point - self.from.at).dot(along) / along.length_squared();
        point.distance(self.from.at + along * t.clamp(0.0, 1.0))
    }

    fn contact(&self, other: &Self) -> MeshError {
        let (low, high) = if self.ring <= other.ring { (self, other) } else { (other, self) };
        if low.ring == high.ring {
            let [first, second] = [low.from.index.min(high.from.index), low.from.index.max(high.from.index)];
            return MeshError::SelfIntersecting { ring: Ring::numbered(low.ring), first, second };
        }
        MeshError::Crossing { first: Ring::numbered(low.ring), second: Ring::numbered(high.ring) }
    }
}
