//! The shadows of all bodies from one point, and the factor of what they leave of a polygon.
//!
//! A shadow is an intersection of half-spaces, the same for all polygons that the point looks at.
//! What lies in none of the shadows that reach a polygon is cut out of it in convex pieces; the
//! factor is the sum of theirs. T. Nishita & E. Nakamae, SIGGRAPH 1985, doi:10.1145/325165.325169.
//! Places relative to the point, m.

use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::polygon::{HalfSpace, Side, part};
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{Body, Shadow, ShadowVolume};
use std::ops::Range;

/// Pieces of a polygon up to which what many shadows leave of it is cut out exactly. Inside a
/// crowded body the shadows cross each other so often that the pieces would never end.
const MOST_PIECES: usize = 4096;
/// How often the triangles of a polygon are halved both ways where there would be more.
const HALVINGS: u32 = 5;

/// Cosine of the angle from the middle of a polygon up to which it is seen on a screen.
const LEAST_SCREEN_COSINE: f64 = 0.1;

/// Heights below this part of the distance count as 0.
pub(super) const FLAT_HEIGHT: f64 = 1e-12;

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
    /// Corners of the bodies, one behind the other, and where those of each begin.
    tips: Vec<Vec3>,
    starts: Vec<usize>,
    screen: Screen,
    /// What each shadow covers on the screen.
    dark: Vec<Bounds>,
    volume: ShadowVolume,
    pieces: Pieces,
    next: Pieces,
    rest: Vec<Vec3>,
    cut: Vec<Vec3>,
    off: Vec<Vec3>,
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
        self.clear();
        for body in bodies {
            self.starts.push(self.tips.len());
            self.tips.extend(body.corners().iter().map(|y| *y - x));
            self.add(body, (x, normal), tolerance);
        }
        self.starts.push(self.tips.len());
    }

    /// Casts the shadows of bodies that may cover a part of a polygon, and turns to it.
    pub fn cast_on<'b>(
        &mut self,
        polygon: &[Vec3],
        (x, normal): (Vec3, Vec3),
        bodies: impl Iterator<Item = &'b Body>,
        tolerance: f64,
    ) {
        self.clear();
        self.dark.clear();
        self.screen = Screen::before(polygon);
        let seen = self.screen.bounds(polygon);
        for body in bodies {
            let start = self.tips.len();
            self.tips.extend(body.corners().iter().map(|y| *y - x));
            // Where a body is seen is known sooner than its shadow.
            let bounds = self.screen.bounds(&self.tips[start..]);
            if !bounds.meets(&seen) {
                self.tips.truncate(start);
                continue;
            }
            self.starts.push(start);
            if self.add(body, (x, normal), tolerance) {
                self.dark.push(bounds);
            }
        }
        self.starts.push(self.tips.len());
    }

    fn clear(&mut self) {
        self.planes.clear();
        self.spans.clear();
        self.tips.clear();
        self.starts.clear();
    }

    /// Adds the shadow of a body of which the corners are the last tips; takes these back where it
    /// casts none.
    fn add(&mut self, body: &Body, (x, normal): (Vec3, Vec3), tolerance: f64) -> bool {
        let tips = &self.tips[self.starts.last().copied().unwrap_or(0)..];
        let below = tips.iter().all(|y| normal.dot(*y) <= tolerance);
        if below || body.shadow(x, tolerance, &mut self.volume) == Shadow::Nothing {
            self.tips.truncate(self.starts.pop().unwrap_or(0));
            return false;
        }
        let start = self.planes.len();
        let unit =
            |&(n, c, _): &(Vec3, f64, u32)| HalfSpace { normal: n / n.length(), offset: c / n.length() };
        self.planes.extend(self.volume.planes().iter().map(unit));
        self.spans.push(start..self.planes.len());
        true
    }

    /// Turns to a polygon, of which [`factor`](Self::factor) is then asked.
    pub fn turn(&mut self, polygon: &[Vec3]) {
        let Self { tips, starts, screen, dark, .. } = self;
        *screen = Screen::before(polygon);
        dark.clear();
        dark.extend(starts.windows(2).map(|ends| screen.bounds(&tips[ends[0]..ends[1]])));
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

    /// Factor from the point with normal `n` to what of the polygon turned to, which lies above its
    /// horizon, lies in none of some shadows.
    pub fn factor(&mut self, n: Vec3, polygon: &[Vec3], shadows: &[u32], flat: f64) -> f64 {
        self.pieces.clear();
        self.pieces.push(polygon, &self.screen);
        for &shadow in shadows {
            self.next.clear();
            for k in (0..self.pieces.len()).rev() {
                // Most pieces lie beside most shadows.
                let meets = self.pieces.bounds(k).meets(&self.dark[shadow as usize]);
                if meets && self.darken(k, shadow, flat) {
                    self.pieces.remove(k);
                }
            }
            self.pieces.append(&self.next);
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

    /// Adds what a shadow leaves of a piece to the next pieces; false where it leaves all of it.
    fn darken(&mut self, k: usize, shadow: u32, flat: f64) -> bool {
        let start = self.next.len();
        self.rest.clear();
        self.rest.extend_from_slice(self.pieces.get(k));
        for plane in &self.planes[self.spans[shadow as usize].clone()] {
            match part(&self.rest, *plane, flat, (&mut self.cut, &mut self.off)) {
                Side::Above => {}
                Side::Both => {
                    self.next.push(&self.off, &self.screen);
                    std::mem::swap(&mut self.rest, &mut self.cut);
                }
                Side::Below => {
                    // Nothing lies in the shadow: the piece stays whole.
                    self.next.truncate(start);
                    return false;
                }
            }
        }
        true
    }
}

/// A plane at distance 1 from the point on which polygons are seen: its axes and the direction to
/// it, none for what is seen all round.
#[derive(Clone, Copy, Debug, Default)]
struct Screen(Option<[Vec3; 3]>);

/// A rectangle on the screen: least and largest coordinates.
#[derive(Clone, Copy, Debug, Default)]
struct Bounds([f64; 2], [f64; 2]);

impl Screen {
    fn before(polygon: &[Vec3]) -> Self {
        let to = polygon.iter().sum::<Vec3>().normalize_or_zero();
        if polygon.iter().any(|&y| is_beside(to, y)) {
            return Self(None);
        }
        let (u, v) = to.any_orthonormal_pair();
        Self(Some([u, v, to]))
    }

    /// Bounds of the convex hull of some points; no narrower ones than all where that is not before
    /// the screen.
    fn bounds(&self, points: &[Vec3]) -> Bounds {
        let Some([u, v, to]) = self.0 else { return Bounds::ALL };
        let mut bounds = Bounds::EMPTY;
        for &y in points {
            if is_beside(to, y) {
                return Bounds::ALL;
            }
            let inverse = 1.0 / to.dot(y);
            for (i, place) in [u.dot(y) * inverse, v.dot(y) * inverse].into_iter().enumerate() {
                bounds.0[i] = bounds.0[i].min(place);
                bounds.1[i] = bounds.1[i].max(place);
            }
        }
        bounds
    }
}

/// Whether a point is seen far from a direction, or behind.
fn is_beside(to: Vec3, y: Vec3) -> bool {
    let along = to.dot(y);
    along <= 0.0 || along * along <= LEAST_SCREEN_COSINE * LEAST_SCREEN_COSINE * y.length_squared()
}

impl Bounds {
    const ALL: Self = Self([f64::NEG_INFINITY; 2], [f64::INFINITY; 2]);
    const EMPTY: Self = Self([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);

    fn meets(&self, other: &Self) -> bool {
        (0..2).all(|i| self.0[i] <= other.1[i] && other.0[i] <= self.1[i])
    }
}

/// Convex polygons and their bounds, corners one behind the other.
#[derive(Debug, Default)]
struct Pieces {
    corners: Vec<Vec3>,
    spans: Vec<(Range<usize>, Bounds)>,
}

impl Pieces {
    fn clear(&mut self) {
        self.corners.clear();
        self.spans.clear();
    }

    fn len(&self) -> usize {
        self.spans.len()
    }

    fn get(&self, k: usize) -> &[Vec3] {
        &self.corners[self.spans[k].0.clone()]
    }

    fn bounds(&self, k: usize) -> &Bounds {
        &self.spans[k].1
    }

    fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        (0..self.len()).map(|k| self.get(k))
    }

    /// Forgets those from `count` on; their corners stay until all are cleared.
    fn truncate(&mut self, count: usize) {
        self.spans.truncate(count);
    }

    /// Puts the last one in the place of one.
    fn remove(&mut self, k: usize) {
        self.spans.swap_remove(k);
    }

    fn append(&mut self, others: &Self) {
        for (span, bounds) in &others.spans {
            self.add(&others.corners[span.clone()], *bounds);
        }
    }

    /// Adds a polygon, if it is one.
    fn push(&mut self, corners: &[Vec3], screen: &Screen) {
        if corners.len() >= 3 {
            self.add(corners, screen.bounds(corners));
        }
    }

    fn add(&mut self, corners: &[Vec3], bounds: Bounds) {
        let start = self.corners.len();
        self.corners.extend_from_slice(corners);
        self.spans.push((start..self.corners.len(), bounds));
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
            shadows.starts.push(shadows.tips.len());
            shadows.tips.extend(corners);
        }
        shadows.starts.push(shadows.tips.len());
        shadows
    }

    #[test]
    fn what_is_sampled_agrees_with_what_is_cut_out() {
        let up = Vec3::Z;
        let polygon = [(-2.0, -2.0), (-2.0, 2.0), (2.0, 2.0), (2.0, -2.0)].map(|(x, y)| Vec3::new(x, y, 1.0));
        for count in [1, 8, 30] {
            let mut shadows = shadows(count);
            let all: Vec<u32> = (0..count as u32).collect();
            shadows.turn(&polygon);
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
        shadows.turn(&polygon);
        let factor = shadows.factor(Vec3::Z, &polygon, &all, 1e-12);
        let whole = point_to_polygon(Vec3::Z, polygon.iter().copied());
        assert!(factor >= 0.0 && factor < 0.5 * whole, "{factor} of {whole}");
    }
}
