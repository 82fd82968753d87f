//! The part of a convex polygon in an intersection of half-spaces, without the parts that are cut off: what one body hides.
//!
//! Polygons of few corners, in arrays of fixed length. Planes are asked about one after the other, as in I. E. Sutherland & G. W. Hodgman,
//! Commun. ACM 17(1) 32, 1974, doi:10.1145/360767.360802. Lengths in metres.

use super::shadow::Maker;
use crate::polygon::crossing;
use fredholm_mesh::Vec3;

/// Corners at most.
pub(super) const MOST: usize = 24;

/// A convex polygon: corners, and what makes the side that starts at each.
#[derive(Clone, Copy, Debug)]
struct Few {
    corners: [Vec3; MOST],
    makers: [Maker; MOST],
    len: usize,
}

impl Default for Few {
    fn default() -> Self {
        Self { corners: [Vec3::ZERO; MOST], makers: [0; MOST], len: 0 }
    }
}

impl Few {
    /// Takes a corner as the one after `len` others, and counts it. What has no place is left out: nobody asks for more than [`MOST`].
    #[inline]
    fn set(&mut self, len: &mut usize, corner: Vec3, maker: Maker) {
        if *len < MOST {
            self.corners[*len] = corner;
            self.makers[*len] = maker;
            *len += 1;
        }
    }
}

/// A polygon that is cut, and the place for what is left of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Cover {
    parts: [Few; 2],
    now: usize,
    heights: [f64; MOST],
}

impl Cover {
    /// Starts with a polygon and what makes its sides, all moved by `shift`.
    #[inline]
    pub(super) fn start(&mut self, corners: &[Vec3], makers: &[Maker], shift: Vec3) {
        self.now = 0;
        let part = &mut self.parts[0];
        part.len = corners.len().min(MOST);
        part.makers[..part.len].copy_from_slice(&makers[..part.len]);
        for (moved, &corner) in part.corners.iter_mut().zip(corners) {
            *moved = corner + shift;
        }
    }

    pub(super) fn corners(&self) -> &[Vec3] {
        let part = &self.parts[self.now];
        &part.corners[..part.len]
    }

    pub(super) fn makers(&self) -> &[Maker] {
        let part = &self.parts[self.now];
        &part.makers[..part.len]
    }

    /// Keeps the part with n·x ≥ c; heights of at most `flat` count as 0. Returns whether there is one.
    #[inline]
    pub(super) fn keep(&mut self, (n, c, maker): (Vec3, f64, Maker), flat: f64) -> bool {
        let part = &self.parts[self.now];
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (height, corner) in self.heights.iter_mut().zip(&part.corners[..part.len]) {
            let h = n.dot(*corner) - c;
            low = if h < low { h } else { low };
            high = if h > high { h } else { high };
            *height = h;
        }
        let above = high > flat;
        if above && low < -flat {
            self.cut(maker, flat);
        }
        above
    }

    fn cut(&mut self, maker: Maker, flat: f64) {
        let [first, second] = &mut self.parts;
        let (part, left) = if self.now == 0 { (&*first, second) } else { (&*second, first) };
        let heights = &mut self.heights[..part.len];
        heights.iter_mut().filter(|height| height.abs() <= flat).for_each(|height| *height = 0.0);
        let (mut len, mut from) = (0, part.len - 1);
        for (to, &height) in heights.iter().enumerate() {
            let before = heights[from];
            if before * height < 0.0 {
                let maker = if before > 0.0 { maker } else { part.makers[from] };
                left.set(&mut len, crossing((part.corners[from], before), (part.corners[to], height)), maker);
            }
            if height >= 0.0 {
                left.set(&mut len, part.corners[to], part.makers[to]);
            }
            from = to;
        }
        left.len = len;
        self.now = 1 - self.now;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];

    fn area(corners: &[Vec3]) -> f64 {
        corners.windows(2).map(|e| 0.5 * (e[0] - corners[0]).cross(e[1] - corners[0]).z).sum()
    }

    #[test]
    fn two_planes_leave_a_quarter() {
        let mut cover = Cover::default();
        cover.start(&SQUARE, &[0, 1, 2, 3], Vec3::X);
        assert!(cover.keep((Vec3::X, 1.5, 7), 1e-12) && cover.keep((-Vec3::Y, -0.5, 8), 1e-12));
        assert!((area(cover.corners()) - 0.25).abs() < 1e-15);
        let mut makers = cover.makers().to_vec();
        makers.sort_unstable();
        assert_eq!(makers, [0, 1, 7, 8]);
    }

    #[test]
    fn a_plane_that_touches_leaves_all_or_nothing() {
        let mut cover = Cover::default();
        cover.start(&SQUARE, &[0, 1, 2, 3], Vec3::ZERO);
        assert!(cover.keep((Vec3::X, 0.0, 7), 1e-12) && cover.corners().len() == 4);
        assert!(!cover.keep((Vec3::X, 1.0, 7), 1e-12));
    }
}
