//! What a pair is, before anything is integrated: which side of each other's plane the patches lie
//! on, and how many points they need.
//!
//! Gauss–Legendre with n points on an edge of half length a errs like ρ⁻²ⁿ where the integrand is
//! analytic inside the ellipse with the ends of the edge as foci and half axes summing to ρ a (L.
//! N. Trefethen, SIAM Rev. 50(1) 67, 2008, doi:10.1137/060659831). ln r² seen from a point at
//! distances r₀, r₁ from the ends has ρ + 1/ρ = (r₀ + r₁)/a ≥ 2D/a, with D the least distance of
//! the other patch from the middle of the edge. The error of A_i F_ij from the points on one patch
//! is taken as
//!
//! E = C n ρ⁻²ⁿ/(1 − ρ⁻²) · A_i A_j / (π d²) · (d/D) · (d/D for a parallelogram, else d ·
//! circumference/area).
//!
//! Of a parallelogram the errors on opposite sides cancel to h/D. C is measured, see
//! `tests/unoccluded.rs`. Both patches share the tolerance evenly.

use super::patches::Patches;
use super::rules::MAX_POINTS;
use crate::form_factor::lanes::{LANES, Lanes, Lanes3, Places, difference, dot, each};
use std::f64::consts::FRAC_1_PI;

/// C for a parallelogram, and for other patches. The largest errors among 18,000 random pairs are
/// 0.7 and 0.3 of the bound.
const PARALLELOGRAM_FACTOR: f64 = 3.0;
const POLYGON_FACTOR: f64 = 0.3;
/// Part of the tolerance for each patch; the rest is for rounding.
const PATCH_SHARE_OF_TOLERANCE: f64 = 0.45;
/// Rounding of the sums, relative to the facing exchange at the least distance, in units of the
/// last place.
const ROUNDING: f64 = 6.0;
/// Heights below this part of the pair's extent count as 0.
const ZERO_HEIGHT: f64 = 1e-12;
/// The same as a part of the largest coordinate, which is rounded.
const COORDINATE_ROUNDING: f64 = 1e-15;

/// What is known of a block of pairs.
pub(super) struct Survey {
    /// 1 where one patch lies behind the other's plane, or in it.
    pub behind: Lanes,
    /// 1 where one patch crosses the other's plane.
    pub crosses: Lanes,
    /// Points along the edges of the first and of the second; above [`MAX_POINTS`] where the
    /// patches are too close.
    pub points: [Lanes; 2],
    /// Bound of the error, in squared units.
    pub error: Lanes,
    /// A_i A_j / (π d²), at most the smaller area, in squared units.
    pub facing: Lanes,
}

/// Looks at the pairs of two sides, to a tolerance relative to the facing exchange.
#[inline(always)]
pub(super) fn survey(patches: &Patches, pair: [&Places; 2], tolerance: f64) -> Survey {
    let d = difference(&pair[1].vectors(&patches.centre), &pair[0].vectors(&patches.centre));
    let square = dot(&d, &d);
    let distance = each(|m| square[m].sqrt());
    let extents = [Extents::new(patches, pair[0]), Extents::new(patches, pair[1])];
    let sight = Sight::new(patches, pair, &d, &distance, &extents);
    let mut seen = Survey {
        behind: sight.behind,
        crosses: sight.crosses,
        points: [[0.0; LANES]; 2],
        error: [0.0; LANES],
        facing: [0.0; LANES],
    };
    if seen.behind.iter().sum::<f64>() < LANES as f64 {
        seen.measure(patches, pair, &distance, &extents, tolerance);
    }
    seen
}

impl Survey {
    /// Finds the exchange that the tolerance refers to, the points and the error.
    #[inline(always)]
    fn measure(
        &mut self,
        patches: &Patches,
        pair: [&Places; 2],
        distance: &Lanes,
        extents: &[Extents; 2],
        tolerance: f64,
    ) {
        let area = [pair[0].of(&patches.area), pair[1].of(&patches.area)];
        let open: Lanes = each(|m| FRAC_1_PI * (area[0][m] * area[1][m]) / (distance[m] * distance[m]));
        self.facing = each(|m| lower(open[m], lower(area[0][m], area[1][m])));
        let limit: Lanes = each(|m| PATCH_SHARE_OF_TOLERANCE * tolerance * (self.facing[m] / open[m]));
        let one = Orders::new(&extents[0], &extents[1].radius, distance, &limit);
        let alike = extents[0] == extents[1];
        let two = if alike { one } else { Orders::new(&extents[1], &extents[0].radius, distance, &limit) };
        self.points = [one.points, two.points];
        self.error = each(|m| {
            let near = higher(one.near[m], two.near[m]);
            let rounded = ROUNDING * f64::EPSILON + 2.0 * (f64::EPSILON + patches.rounding) / distance[m];
            open[m] * (one.error[m] + two.error[m] + rounded * (near * near))
        });
    }
}

/// Sizes of the patches on one side.
#[derive(PartialEq)]
struct Extents {
    radius: Lanes,
    half: Lanes,
    middle: Lanes,
    slenderness: Lanes,
}

impl Extents {
    #[inline(always)]
    fn new(patches: &Patches, side: &Places) -> Self {
        Self {
            radius: side.of(&patches.radius),
            half: side.of(&patches.half),
            middle: side.of(&patches.middle),
            slenderness: side.of(&patches.slenderness),
        }
    }
}

/// On which side of each other's planes the patches of a block lie: 1 for true.
struct Sight {
    behind: Lanes,
    crosses: Lanes,
}

impl Sight {
    #[inline(always)]
    fn new(
        patches: &Patches,
        pair: [&Places; 2],
        d: &Lanes3,
        distance: &Lanes,
        [one, two]: &[Extents; 2],
    ) -> Self {
        let reach = each(|m| distance[m] + 2.0 * (one.radius[m] + two.radius[m]));
        let flat = each(|m| ZERO_HEIGHT * reach[m] + COORDINATE_ROUNDING / f64::EPSILON * patches.rounding);
        let normals = [pair[0].vectors(&patches.normal), pair[1].vectors(&patches.normal)];
        let (there, back) = (dot(&normals[0], d), dot(&normals[1], d));
        // Nearly all patches are farther from the other's plane than they are large.
        let least = each(|m| lower(there[m] - two.radius[m], -back[m] - one.radius[m]) - flat[m]);
        if least.iter().fold(f64::INFINITY, |low, &x| lower(x, low)) > 0.0 {
            return Self { behind: [0.0; LANES], crosses: [0.0; LANES] };
        }
        let there = heights(patches, pair[1], &normals[0], &there, 1.0);
        let here = heights(patches, pair[0], &normals[1], &back, -1.0);
        Self {
            behind: each(|m| f64::from(lower(there.high[m], here.high[m]) <= flat[m])),
            crosses: each(|m| f64::from(lower(there.low[m], here.low[m]) < -flat[m])),
        }
    }
}

/// Least and largest height of the corners of a patch over the plane of another.
struct Heights {
    low: Lanes,
    high: Lanes,
}

#[inline(always)]
fn heights(patches: &Patches, of: &Places, normal: &Lanes3, middle: &Lanes, sign: f64) -> Heights {
    let [a, b, c, e] = &patches.corner;
    let (a, b) = (dot(normal, &of.vectors(a)), dot(normal, &of.vectors(b)));
    let (c, e) = (dot(normal, &of.vectors(c)), dot(normal, &of.vectors(e)));
    Heights {
        low: each(|m| sign * middle[m] + lower(lower(a[m], b[m]), lower(c[m], e[m]))),
        high: each(|m| sign * middle[m] + higher(higher(a[m], b[m]), higher(c[m], e[m]))),
    }
}

/// The lower of two numbers. `f64::min` asks for NaN too, which takes three instructions more.
#[inline(always)]
fn lower(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The higher of two numbers.
#[inline(always)]
fn higher(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The number of points of one patch and the error they leave, relative to A_i A_j / (π d²).
#[derive(Clone, Copy)]
struct Orders {
    points: Lanes,
    /// d/D.
    near: Lanes,
    error: Lanes,
}

impl Orders {
    #[inline(always)]
    fn new(extents: &Extents, reach: &Lanes, distance: &Lanes, limit: &Lanes) -> Self {
        let Decay { power, mut error, near } = Decay::new(extents, reach, distance);
        let mut points = [1.0; LANES];
        let mut n = 1.0;
        while n <= MAX_POINTS as f64 && exceeds(&error, limit) {
            let ratio = (n + 1.0) / n;
            for m in 0..LANES {
                let more = error[m] > limit[m];
                error[m] *= if more { power[m] * ratio } else { 1.0 };
                points[m] += if more { 1.0 } else { 0.0 };
            }
            n += 1.0;
        }
        Self { points, near, error }
    }
}

/// How the error of one patch falls with the number of points.
struct Decay {
    /// ρ⁻².
    power: Lanes,
    /// The error of one point.
    error: Lanes,
    /// d/D.
    near: Lanes,
}

impl Decay {
    #[inline(always)]
    fn new(extents: &Extents, reach: &Lanes, distance: &Lanes) -> Self {
        let Extents { half, middle, slenderness, .. } = extents;
        let least: Lanes = each(|m| higher(distance[m] - (middle[m] + reach[m]), half[m]));
        let near: Lanes = each(|m| distance[m] / least[m]);
        let power: Lanes = each(|m| {
            let x = least[m] / half[m];
            let rho = x + (x * x - 1.0).sqrt();
            1.0 / (rho * rho)
        });
        let error = each(|m| {
            let shape =
                higher(PARALLELOGRAM_FACTOR * near[m], POLYGON_FACTOR * (distance[m] * slenderness[m]));
            near[m] * shape * power[m] / (1.0 - power[m])
        });
        Self { power, error, near }
    }
}

/// Whether a lane of `a` is above that of `b`. All lanes are compared, which takes fewer
/// instructions than leaving at the first.
#[inline(always)]
fn exceeds(a: &Lanes, b: &Lanes) -> bool {
    let above = each(|m| if a[m] > b[m] { 1.0 } else { 0.0 });
    above.iter().sum::<f64>() > 0.0
}
