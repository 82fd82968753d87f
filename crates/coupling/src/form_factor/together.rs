//! What bodies hide of a convex polygon from several points of one source.
//!
//! Most points see the shadow of one body only: the part of the target in its shadow volume is the
//! hidden part, and nothing of what is left is needed. Where the shadows of several bodies meet the
//! target, they are subtracted one after the other ([`Hiding`]). Lengths in metres.

use super::packet::{Found, POINTS, Packet, Shadows, Target};
use super::shadow::{Hiding, SideId, Topology};
use fredholm_mesh::Vec3;
use fredholm_visibility::body::Screen;

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Together {
    hiding: Hiding,
    packet: Packet,
    side_ids: Vec<SideId>,
    /// Shadows that meet the target, for each point.
    shadows: Vec<Shadows>,
}

impl Together {
    /// Appends the form factor from each of the `points` with normal `n` to what `screens` hide of
    /// `target`, and what makes the hidden part.
    pub(crate) fn hidden_factors(
        &mut self,
        points: &[Vec3],
        (n, target): (Vec3, &[Vec3]),
        screens: &[Screen],
        found: &mut Vec<(f64, Topology)>,
    ) {
        let start = found.len();
        found.resize(start + points.len(), (0.0, Topology::default()));
        self.shadows.clear();
        self.shadows.resize(points.len(), Shadows::default());
        self.side_ids.clear();
        self.side_ids.extend(0..target.len() as SideId);
        let packets = points.chunks(POINTS).zip(found[start..].chunks_mut(POINTS));
        let target_sides = Target { corners: target, side_ids: &self.side_ids, normal: n };
        for ((points, hidden), shadows) in packets.zip(self.shadows.chunks_mut(POINTS)) {
            let mut found = Found { hidden, shadows };
            for (k, screen) in screens.iter().enumerate() {
                self.packet.hide(points, target_sides, (k, screen), &mut found);
            }
        }
        for ((&x, found), shadows) in points.iter().zip(&mut found[start..]).zip(&self.shadows) {
            if shadows.are_together() {
                let screens = screens.iter().enumerate().filter(|(k, _)| shadows.has(*k));
                *found = (self.hiding.hidden_factor(x, n, target, screens), self.hiding.topology());
            }
        }
    }
}
