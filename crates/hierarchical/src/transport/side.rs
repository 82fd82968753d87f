//! A function over a patch from its values at five points: mean, gradient, and how far it deviates
//! from either.
//!
//! Four points have equal weights and give the mean and, by least squares, a linear function; what
//! is left of them, and the distance of the fifth, at the centroid, from the mean, is the *rest*.
//! For a quadratic function on a parallelogram that distance is 1.1 times the standard deviation of
//! the quadratic part in each direction. All relative to the mean; gradients in 1/m.

use fredholm_mesh::{Patch, Vec3};

/// Points of a patch.
pub(crate) const POINTS: usize = 5;
/// Those that the mean is made of; the last point is the centroid.
pub(super) const POINTS_OF_THE_MEAN: usize = POINTS - 1;
/// Places of the two Gauss points of the unit interval.
const GAUSS_POINTS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Places on a triangle of the centroids of three of its quarters, and of the fourth a little off
/// the middle, which is the fifth point.
const TRIANGLE_POINTS: [[f64; 2]; POINTS_OF_THE_MEAN] =
    [[1.0 / 6.0, 1.0 / 6.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0], [1.0 / 3.0, 1.0 / 3.0]];

/// What is known of a function over a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Side {
    /// Mean.
    pub mean: f64,
    /// Gradient over the mean, 1/m; nowhere on the patch does the linear function change its sign.
    pub gradient: Vec3,
    /// Standard deviation over the mean.
    pub deviation: f64,
    /// What the linear function leaves of it.
    pub rest: f64,
}

impl Side {
    /// The same, with deviations of at least `least`.
    pub fn at_least(self, least: f64) -> Self {
        Self { deviation: self.deviation.max(least), rest: self.rest.max(least), ..self }
    }

    /// The same, with deviations of at least `share` of those of another function.
    pub fn at_least_of(self, other: &Self, share: f64) -> Self {
        Self {
            deviation: self.deviation.max(share * other.deviation),
            rest: self.rest.max(share * other.rest),
            ..self
        }
    }

    /// The same function relative to a mean that is larger by `1/share`.
    pub fn scaled(self, share: f64) -> Self {
        Self { deviation: self.deviation * share, rest: self.rest * share, ..self }
    }
}

/// The points of a patch, and its normal and corners relative to the centroid.
pub(crate) struct Points<'a> {
    pub at: [Vec3; POINTS],
    patch: &'a Patch,
}

impl<'a> Points<'a> {
    pub fn of(patch: &'a Patch) -> Self {
        let at = std::array::from_fn(|k| match (k, patch.sides()) {
            (POINTS_OF_THE_MEAN, _) => patch.centroid(),
            (_, 3) => patch.point(TRIANGLE_POINTS[k][0], TRIANGLE_POINTS[k][1]),
            _ => patch.point(GAUSS_POINTS[k / 2], GAUSS_POINTS[k % 2]),
        });
        Self { at, patch }
    }

    /// A place in the part of the patch that a point stands for: a quarter, or as much about the
    /// middle.
    pub fn within(&self, k: usize, [r, s]: [f64; 2]) -> Vec3 {
        let half = |corner: f64, x: f64| 0.5 * (corner + x);
        let (u, v) = if self.patch.sides() == 3 {
            let (r, s) = if r + s > 1.0 { (1.0 - r, 1.0 - s) } else { (r, s) };
            match k {
                0 => (half(0.0, r), half(0.0, s)),
                1 => (half(1.0, r), half(0.0, s)),
                2 => (half(0.0, r), half(1.0, s)),
                _ => (half(1.0, -r), half(1.0, -s)),
            }
        } else if k < POINTS_OF_THE_MEAN {
            (half((k / 2) as f64, r), half((k % 2) as f64, s))
        } else {
            (half(0.5, r), half(0.5, s))
        };
        self.patch.point(u, v)
    }

    /// What values at the points, of either sign or none, tell of the function.
    pub fn side(&self, values: &[f64; POINTS]) -> Side {
        let mean = values[..POINTS_OF_THE_MEAN].iter().sum::<f64>() / POINTS_OF_THE_MEAN as f64;
        if mean <= 0.0 {
            return Side::default();
        }
        let relative = values.map(|value| value / mean - 1.0);
        let gradient = self.gradient(&relative);
        let centre = self.at[POINTS_OF_THE_MEAN];
        let root = |squares: f64| (squares / POINTS_OF_THE_MEAN as f64).sqrt();
        let left = (0..POINTS_OF_THE_MEAN).map(|k| relative[k] - gradient.dot(self.at[k] - centre));
        let bend = relative[POINTS_OF_THE_MEAN];
        let twist = root(left.map(|r| r * r).sum());
        let deviation = root(relative[..POINTS_OF_THE_MEAN].iter().map(|r| r * r).sum());
        Side {
            mean,
            gradient: self.limited(gradient),
            deviation: deviation.hypot(bend),
            rest: twist.hypot(bend),
        }
    }

    /// The gradient in the plane that fits the outer points best.
    fn gradient(&self, values: &[f64; POINTS]) -> Vec3 {
        let centre = self.at[POINTS_OF_THE_MEAN];
        let u = (self.at[0] - centre).normalize_or_zero();
        let v = self.patch.normal().cross(u);
        let (mut uu, mut uv, mut vv, mut fu, mut fv) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (x, f) in self.at[..POINTS_OF_THE_MEAN].iter().zip(values) {
            let (s, t) = ((*x - centre).dot(u), (*x - centre).dot(v));
            (uu, uv, vv) = (uu + s * s, uv + s * t, vv + t * t);
            (fu, fv) = (fu + f * s, fv + f * t);
        }
        let determinant = uu * vv - uv * uv;
        if determinant <= 0.0 {
            return Vec3::ZERO;
        }
        u * ((fu * vv - fv * uv) / determinant) + v * ((fv * uu - fu * uv) / determinant)
    }

    /// The gradient, shortened where the linear function would be negative at a corner.
    fn limited(&self, gradient: Vec3) -> Vec3 {
        let centre = self.at[POINTS_OF_THE_MEAN];
        let least = self.patch.corners().iter().map(|x| gradient.dot(*x - centre)).fold(0.0, f64::min);
        if least < -1.0 { gradient / -least } else { gradient }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch(sides: usize) -> Patch {
        let (a, b, c) = (Vec3::new(1., 0., 2.), Vec3::new(3., 0.5, 2.), Vec3::new(3.5, 2., 2.));
        match sides {
            3 => Patch::triangle([a, b, c]).unwrap(),
            _ => Patch::quad([a, b, c, c - b + a]).unwrap().unwrap(),
        }
    }

    #[test]
    fn a_linear_function_is_its_gradient() {
        for sides in [3, 4] {
            let patch = patch(sides);
            let points = Points::of(&patch);
            let f = |x: Vec3| 10.0 + x.x - 0.5 * x.y;
            let side = points.side(&points.at.map(f));
            assert!((side.mean - f(patch.centroid())).abs() < 1e-12);
            assert!((side.gradient * side.mean - Vec3::new(1.0, -0.5, 0.0)).length() < 1e-12);
            assert!(side.rest < 1e-12 && side.deviation > 0.01, "{side:?}");
        }
    }

    #[test]
    fn places_fill_the_parts_of_their_points_and_all_of_the_patch_evenly() {
        for sides in [3, 4] {
            let patch = patch(sides);
            let points = Points::of(&patch);
            let n = 40;
            let middle = |i: usize| (i as f64 + 0.5) / n as f64;
            let mean = |k: usize| {
                let places = (0..n * n).map(|p| points.within(k, [middle(p / n), middle(p % n)]));
                places.sum::<Vec3>() / (n * n) as f64
            };
            let outer: Vec3 = (0..POINTS_OF_THE_MEAN).map(mean).sum::<Vec3>() / POINTS_OF_THE_MEAN as f64;
            assert!((outer - patch.centroid()).length() < 1e-3, "{outer}");
            assert!((mean(POINTS_OF_THE_MEAN) - patch.centroid()).length() < 1e-3);
            (0..POINTS_OF_THE_MEAN)
                .for_each(|k| assert!((mean(k) - points.at[k]).length() < 0.1 * patch.area().sqrt()));
        }
    }

    #[test]
    fn a_quadratic_function_leaves_a_rest() {
        let patch = patch(4);
        let points = Points::of(&patch);
        let side = points.side(&points.at.map(|x| 1.0 + (x.y - patch.centroid().y).powi(2)));
        assert!(side.gradient.length() < 1e-12 && side.rest > 0.1, "{side:?}");
    }

    #[test]
    fn a_steep_gradient_stops_at_zero() {
        let patch = patch(4);
        let points = Points::of(&patch);
        let side = points.side(&points.at.map(|x| (x.x - 2.0).max(0.0)));
        let least = patch.corners().iter().map(|x| 1.0 + side.gradient.dot(*x - patch.centroid()));
        assert!(least.fold(1.0, f64::min) > -1e-12, "{side:?}");
    }
}
