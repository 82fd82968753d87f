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
    /// What has no place is left out: nobody asks for more than [`MOST`].
    #[inline]
    fn push(&mut self, corner: Vec3, maker: Maker) {
        if self.len < MOST {
            self.corners[self.len] = corner;
            self.makers[self.len] = maker;
            self.len += 1;
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
        part.len = 0;
        for (&corner, &maker) in corners.iter().zip(makers) {
            part.push(corner + shift, maker);
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
        let (mut above, mut below) = (false, false);
        for (height, corner) in self.heights.iter_mut().zip(&part.corners[..part.len]) {
            *height = n.dot(*corner) - c;
            above |= *height > flat;
            below |= *height < -flat;
        }
        if above && below {
            self.cut(maker, flat);
        }
        above
    }

    fn cut(&mut self, maker: Maker, flat: f64) {
        let [first, second] = &mut self.parts;
        let (part, left) = if self.now == 0 { (&*first, second) } else { (&*second, first) };
        left.len = 0;
        let snapped = |height: f64| if height.abs() <= flat { 0.0 } else { height };
        let at = |k: usize| (part.corners[k], snapped(self.heights[k]), part.makers[k]);
        let mut from = at(part.len - 1);
        for k in 0..part.len {
            let to = at(k);
            if from.1 * to.1 < 0.0 {
                let maker = if from.1 > 0.0 { maker } else { from.2 };
                left.push(crossing((from.0, from.1), (to.0, to.1)), maker);
            }
            if to.1 >= 0.0 {
                left.push(to.0, to.2);
            }
            from = to;
        }
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
