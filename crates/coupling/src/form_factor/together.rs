//! What bodies hide of a convex polygon from several points of one source.
//!
//! Most points see the shadow of one body only: the part of the target in its room is the hidden part, and nothing of what is left is needed. Where the shadows of several bodies
//! meet the target, they are subtracted one after the other ([`Hiding`]). Lengths in metres.

use super::cover::{Cover, MOST};
use super::rims::Rims;
use super::shadow::{Hiding, Kind, Maker, size};
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{Room, Screen, Shadow};

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Together {
    hiding: Hiding,
    room: Room,
    cover: Cover,
    /// The target as far as it lies behind the faces that look at the whole source.
    corners: Vec<Vec3>,
    makers: Vec<Maker>,
    /// Shadows that meet the target, for each point.
    shadows: Vec<u32>,
    /// The hidden parts, and the point of each.
    rims: Rims,
    points: Vec<usize>,
}

impl Together {
    /// Appends the form factor from each of the `points` with normal `n` to what `screens` hide of `target`, and what makes the hidden part.
    pub(crate) fn hidden_factors(
        &mut self,
        points: &[Vec3],
        (n, target): (Vec3, &[Vec3]),
        screens: &[Screen],
        found: &mut Vec<(f64, Kind)>,
    ) {
        let start = found.len();
        found.resize(start + points.len(), (0.0, Kind::default()));
        let found = &mut found[start..];
        self.shadows.clear();
        self.shadows.resize(points.len(), 0);
        self.rims.clear();
        self.points.clear();
        for (k, screen) in screens.iter().enumerate() {
            let first = Kind::first(k);
            if self.behind_faces(target, screen, first) {
                self.add(points, (screen, first), found);
            }
        }
        for (&k, factor) in self.points.iter().zip(self.rims.factors(n)) {
            found[k].0 += factor;
        }
        let hiding = &mut self.hiding;
        for ((&x, found), _) in points.iter().zip(found).zip(&self.shadows).filter(|(_, count)| **count > 1) {
            *found = (hiding.hidden_factor(x, n, target, screens), hiding.kind());
        }
    }

    /// Prepares the target behind the faces of a body. Returns whether there is one.
    fn behind_faces(&mut self, target: &[Vec3], screen: &Screen, first: Maker) -> bool {
        self.makers.clear();
        self.makers.extend(0..target.len() as Maker);
        self.corners.clear();
        self.corners.extend_from_slice(target);
        screen.front(&mut self.room);
        if self.room.planes().is_empty() {
            return true;
        }
        self.cover.start(target, &self.makers, Vec3::ZERO);
        let some = self.within(screen, first);
        self.corners.clear();
        self.corners.extend_from_slice(self.cover.corners());
        self.makers.clear();
        self.makers.extend_from_slice(self.cover.makers());
        some
    }

    /// Lists what the body hides from each point.
    fn add(&mut self, points: &[Vec3], (screen, first): (&Screen, Maker), found: &mut [(f64, Kind)]) {
        for (k, &x) in points.iter().enumerate() {
            if screen.outline(x, &mut self.room) == Shadow::Nothing {
                continue;
            }
            if self.corners.len() + self.room.planes().len() > MOST {
                self.shadows[k] = 2;
                continue;
            }
            self.cover.start(&self.corners, &self.makers, -x);
            if self.within(screen, first) {
                self.shadows[k] += 1;
                self.rims.push(self.cover.corners());
                self.points.push(k);
                found[k].1.add(self.cover.makers());
            }
        }
    }

    /// Keeps what lies in the room. Returns whether there is something.
    #[inline]
    fn within(&mut self, screen: &Screen, first: Maker) -> bool {
        let flat = screen.tolerance();
        let cover = &mut self.cover;
        self.room.planes().iter().all(|&(m, c, maker)| cover.keep((m, c, first + maker), flat * size(m)))
    }
}
