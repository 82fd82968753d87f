//! The shadows of all bodies from one point, and the factor of what they leave of a polygon.
//!
//! A shadow is an intersection of half-spaces, the same for all polygons that the point looks at. What lies in none of the shadows that reach a polygon is cut out of it in convex pieces; the factor is the sum of theirs.
//! T. Nishita & E. Nakamae, SIGGRAPH 1985, doi:10.1145/325165.325169. Places relative to the point, m.

use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::polygon::{HalfSpace, clip};
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{Body, Shadow, ShadowVolume};
use std::ops::Range;

/// Pieces of a polygon up to which what many shadows leave of it is cut out exactly. Inside a crowded body the
/// shadows cross each other so often that the pieces would never end.
const MOST_PIECES: usize = 4096;
/// How often the triangles of a polygon are halved both ways where there would be more.
const HALVINGS: u32 = 5;

/// Heights below this part of the distance count as 0.
pub(super) const FLAT: f64 = 1e-12;

/// How a shadow lies to a group of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Covers {
    Nothing,
    Part,
    All,
}

/// The shadows from one point.
#[derive(Debug, Default)]
pub(super) struct Shadows {
    planes: Vec<HalfSpace>,
    spans: Vec<Range<usize>>,
    volume: ShadowVolume,
    pieces: Pieces,
    next: Pieces,
    rest: Vec<Vec3>,
    cut: Vec<Vec3>,
}

impl Shadows {
    /// Casts the shadows of bodies that reach above the horizon of `x`.
    pub fn cast<'b>(
        &mut self,
        x: Vec3,
        normal: Vec3,
        bodies: impl Iterator<Item = &'b Body>,
        tolerance: f64,
    ) {
        self.planes.clear();
        self.spans.clear();
        for body in bodies {
            let below = body.corners().iter().all(|y| normal.dot(*y - x) <= tolerance);
            if below || body.shadow(x, tolerance, &mut self.volume) == Shadow::Nothing {
                continue;
            }
            let start = self.planes.len();
            let unit =
                |&(n, c, _): &(Vec3, f64, u32)| HalfSpace { normal: n / n.length(), offset: c / n.length() };
            self.planes.extend(self.volume.planes().iter().map(unit));
            self.spans.push(start..self.planes.len());
        }
    }

    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// How a shadow lies to a ball.
    pub fn covers_ball(&self, shadow: u32, centre: Vec3, radius: f64) -> Covers {
        let least = self.heights(shadow, centre).fold(f64::INFINITY, f64::min);
        if least <= -radius {
            Covers::Nothing
        } else if least >= radius {
            Covers::All
        } else {
            Covers::Part
        }
    }

    /// How a shadow lies to a convex polygon; `flat` is a length that counts as none.
    pub fn covers(&self, shadow: u32, corners: &[Vec3], flat: f64) -> Covers {
        let mut all = true;
        for plane in &self.planes[self.spans[shadow as usize].clone()] {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for &y in corners {
                let height = plane.height(y);
                (low, high) = (low.min(height), high.max(height));
            }
            if high <= flat {
                return Covers::Nothing;
            }
            all &= low >= -flat;
        }
        if all { Covers::All } else { Covers::Part }
    }

    fn heights(&self, shadow: u32, y: Vec3) -> impl Iterator<Item = f64> {
        self.planes[self.spans[shadow as usize].clone()].iter().map(move |plane| plane.height(y))
    }

    /// Factor from the point with normal `n` to what of a polygon above its horizon lies in none of some shadows.
    pub fn factor(&mut self, n: Vec3, polygon: &[Vec3], shadows: &[u32], flat: f64) -> f64 {
        self.pieces.clear();
        self.pieces.push(polygon);
        for &shadow in shadows {
            self.next.clear();
            for k in 0..self.pieces.len() {
                self.darken(k, shadow, flat);
            }
            std::mem::swap(&mut self.pieces, &mut self.next);
            if self.pieces.len() > MOST_PIECES {
                return self.sampled(n, polygon, shadows);
            }
        }
        self.pieces.iter().map(|piece| point_to_polygon(n, piece.iter().copied())).sum::<f64>().max(0.0)
    }

    /// The same from small triangles of which the middle lies in no shadow.
    fn sampled(&self, n: Vec3, polygon: &[Vec3], shadows: &[u32]) -> f64 {
        let lit = |y: Vec3| shadows.iter().all(|&s| self.heights(s, y).any(|height| height < 0.0));
        let cells = 1 << HALVINGS;
        let mut sum = 0.0;
        for k in 2..polygon.len() {
            let [origin, u, v] = [polygon[0], polygon[k - 1] - polygon[0], polygon[k] - polygon[0]];
            let at = |i: u32, j: u32| {
                origin + u * (f64::from(i) / f64::from(cells)) + v * (f64::from(j) / f64::from(cells))
            };
            for i in 0..cells {
                for j in 0..cells - i {
                    let lower = [at(i, j), at(i + 1, j), at(i, j + 1)];
                    // Beside the diagonal there is no upper half.
                    let upper = [at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)];
                    for corners in [lower, upper].iter().take(if i + j + 1 < cells { 2 } else { 1 }) {
                        if lit(corners.iter().sum::<Vec3>() / 3.0) {
                            sum += point_to_polygon(n, corners.iter().copied());
                        }
                    }
                }
            }
        }
        sum.max(0.0)
    }

    /// Adds what a shadow leaves of a piece to the next pieces.
    fn darken(&mut self, k: usize, shadow: u32, flat: f64) {
        let start = self.next.len();
        self.rest.clear();
        self.rest.extend_from_slice(self.pieces.get(k));
        for plane in &self.planes[self.spans[shadow as usize].clone()] {
            let beyond = HalfSpace { normal: -plane.normal, offset: -plane.offset };
            self.cut.clear();
            clip(&self.rest, beyond, flat, &mut self.cut);
            self.next.push(&self.cut);
            self.cut.clear();
            clip(&self.rest, *plane, flat, &mut self.cut);
            std::mem::swap(&mut self.rest, &mut self.cut);
            if self.rest.len() < 3 {
                // Nothing lies in the shadow: the piece stays whole.
                self.next.truncate(start);
                self.next.push(self.pieces.get(k));
                return;
            }
        }
    }
}

/// Convex polygons, one behind the other.
#[derive(Debug, Default)]
struct Pieces {
    corners: Vec<Vec3>,
    ends: Vec<usize>,
}

impl Pieces {
    fn clear(&mut self) {
        self.truncate(0);
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn start(&self, k: usize) -> usize {
        if k == 0 { 0 } else { self.ends[k - 1] }
    }

    fn get(&self, k: usize) -> &[Vec3] {
        &self.corners[self.start(k)..self.ends[k]]
    }

    fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        (0..self.len()).map(|k| self.get(k))
    }

    fn truncate(&mut self, count: usize) {
        self.corners.truncate(self.start(count));
        self.ends.truncate(count);
    }

    /// Adds a polygon, if it is one.
    fn push(&mut self, corners: &[Vec3]) {
        if corners.len() >= 3 {
            self.corners.extend_from_slice(corners);
            self.ends.push(self.corners.len());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shadows of squares of side 0.3 at a height of 0.5, all over the sky of the origin.
    fn shadows(count: usize) -> Shadows {
        let mut shadows = Shadows::default();
        for k in 0..count {
            let at = |r: f64| (k as f64 * r).fract() * 2.0 - 1.0;
            let (x, y) = (at(0.754_877_666), at(0.569_840_291));
            let corner = |u: f64, v: f64| Vec3::new(x + 0.15 * u, y + 0.15 * v, 0.5);
            let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            let start = shadows.planes.len();
            for i in 0..4 {
                let normal = corners[i].cross(corners[(i + 1) % 4]).normalize();
                shadows.planes.push(HalfSpace { normal, offset: 0.0 });
            }
            shadows.spans.push(start..shadows.planes.len());
        }
        shadows
    }

    #[test]
    fn what_is_sampled_agrees_with_what_is_cut_out() {
        let up = Vec3::Z;
        let polygon = [(-2.0, -2.0), (-2.0, 2.0), (2.0, 2.0), (2.0, -2.0)].map(|(x, y)| Vec3::new(x, y, 1.0));
        for count in [1, 8, 30] {
            let mut shadows = shadows(count);
            let all: Vec<u32> = (0..count as u32).collect();
            let exact = shadows.factor(up, &polygon, &all, 1e-12);
            let sampled = shadows.sampled(up, &polygon, &all);
            let whole = point_to_polygon(up, polygon.iter().copied());
            assert!(exact < whole && (sampled - exact).abs() < 0.02 * whole, "{count}: {sampled} {exact}");
        }
    }

    #[test]
    fn thousands_of_crossing_shadows_come_to_an_end() {
        let mut shadows = shadows(2000);
        let all: Vec<u32> = (0..2000).collect();
        let polygon = [(-2.0, -2.0), (-2.0, 2.0), (2.0, 2.0), (2.0, -2.0)].map(|(x, y)| Vec3::new(x, y, 1.0));
        let factor = shadows.factor(Vec3::Z, &polygon, &all, 1e-12);
        let whole = point_to_polygon(Vec3::Z, polygon.iter().copied());
        assert!(factor >= 0.0 && factor < 0.5 * whole, "{factor} of {whole}");
    }
}
