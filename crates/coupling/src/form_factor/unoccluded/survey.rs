//! What a pair is, before anything is integrated: which side of each other's plane the patches lie on, and how many points they need.
//!
//! Gauss–Legendre with n points on an edge of half length a errs like ρ⁻²ⁿ where the integrand is analytic inside the ellipse with the ends of the
//! edge as foci and half axes summing to ρ a (L. N. Trefethen, SIAM Rev. 50(1) 67, 2008, doi:10.1137/060659831). ln r² seen from a point at
//! distances r₀, r₁ from the ends has ρ + 1/ρ = (r₀ + r₁)/a ≥ 2D/a, with D the least distance of the other patch from the middle of the edge.
//! The error of A_i F_ij from the points on one patch is taken as
//!
//! E = C n ρ⁻²ⁿ/(1 − ρ⁻²) · A_i A_j / (π d²) · (d/D) · (d/D for a parallelogram, else d · circumference/area).
//!
//! Of a parallelogram the errors on opposite sides cancel to h/D. C is measured, see `tests/unoccluded.rs`. Both patches share the
//! tolerance evenly.

use super::lanes::{LANES, Lanes, Lanes3, Places, difference, dot};
use super::patches::Patches;
use super::rules::MAX_POINTS;
use std::array::from_fn;
use std::f64::consts::FRAC_1_PI;

/// C of the error of one patch.
const CONSTANT: f64 = 2.0;
/// Rounding of the sums, relative to the facing exchange at the least distance, in units of the last place.
const ROUNDING: f64 = 16.0;
/// Heights below this part of the pair's extent count as 0.
const FLAT: f64 = 1e-12;
/// The same as a part of the largest coordinate, which is rounded.
const FAR: f64 = 1e-15;

/// What is known of a block of pairs.
pub(super) struct Survey {
    /// 1 where one patch lies behind the other's plane, or in it.
    pub behind: Lanes,
    /// 1 where one patch crosses the other's plane.
    pub crosses: Lanes,
    /// Points along the edges of the first and of the second; above [`MAX_POINTS`] where the patches are too close.
    pub points: [Lanes; 2],
    /// Bound of the error, in squared units.
    pub error: Lanes,
    /// A_i A_j / (π d²), at most the smaller area, in squared units.
    pub facing: Lanes,
}

/// Looks at the pairs of two sides, to a tolerance relative to the facing exchange.
#[inline(always)]
pub(super) fn survey(patches: &Patches, pair: [&Places; 2], tolerance: f64) -> Survey {
    let centre = pair.map(|side| side.vectors(&patches.centre));
    let d = difference(&centre[1], &centre[0]);
    let radius = pair.map(|side| side.of(&patches.radius));
    let distance = dot(&d, &d).map(f64::sqrt);
    let flat: Lanes = from_fn(|m| {
        FLAT * (distance[m] + 2.0 * (radius[0][m] + radius[1][m])) + FAR / f64::EPSILON * patches.rounding
    });
    let back = d.map(|axis| axis.map(|x| -x));
    let there = heights(patches, pair[0], pair[1], &d);
    let here = heights(patches, pair[1], pair[0], &back);
    let behind: Lanes = from_fn(|m| f64::from(there.high[m] <= flat[m]).max(f64::from(here.high[m] <= flat[m])));
    let crosses: Lanes = from_fn(|m| f64::from(there.low[m] < -flat[m]).max(f64::from(here.low[m] < -flat[m])));
    let area = pair.map(|side| side.of(&patches.area));
    let open: Lanes = from_fn(|m| FRAC_1_PI * area[0][m] * area[1][m] / (distance[m] * distance[m]));
    let facing: Lanes = from_fn(|m| open[m].min(area[0][m].min(area[1][m])));
    let limit: Lanes = from_fn(|m| 0.5 * tolerance * (facing[m] / open[m]));
    let one = orders(patches, pair[0], &radius[1], &distance, &limit);
    let two = orders(patches, pair[1], &radius[0], &distance, &limit);
    let error: Lanes = from_fn(|m| {
        let near = (distance[m] / (distance[m] - (radius[0][m] + radius[1][m]))).powi(2);
        let rounded = ROUNDING * f64::EPSILON + 2.0 * (f64::EPSILON + patches.rounding) / distance[m];
        open[m] * (one.error[m] + two.error[m] + rounded * near)
    });
    Survey { behind, crosses, points: [one.points, two.points], error, facing }
}

/// Least and largest height of the corners of a patch over the plane of another.
struct Heights {
    low: Lanes,
    high: Lanes,
}

#[inline(always)]
fn heights(patches: &Patches, over: &Places, of: &Places, d: &Lanes3) -> Heights {
    let normal = over.vectors(&patches.normal);
    let middle = dot(&normal, d);
    let corner = patches.corner.each_ref().map(|field| dot(&normal, &of.vectors(field)));
    let [a, b, c, e] = corner;
    Heights {
        low: from_fn(|m| middle[m] + a[m].min(b[m]).min(c[m].min(e[m]))),
        high: from_fn(|m| middle[m] + a[m].max(b[m]).max(c[m].max(e[m]))),
    }
}

/// The number of points of one patch and the error they leave, relative to A_i A_j / (π d²).
struct Orders {
    points: Lanes,
    error: Lanes,
}

#[inline(always)]
fn orders(patches: &Patches, side: &Places, reach: &Lanes, distance: &Lanes, limit: &Lanes) -> Orders {
    let [half, middle, slenderness] =
        [&patches.half, &patches.middle, &patches.slenderness].map(|field| side.of(field));
    let (mut power, mut factor) = ([0.0; LANES], [0.0; LANES]);
    for m in 0..LANES {
        let least = (distance[m] - (middle[m] + reach[m])).max(half[m]);
        let x = least / half[m];
        let rho = x + (x * x - 1.0).sqrt();
        let near = distance[m] / least;
        power[m] = 1.0 / (rho * rho);
        factor[m] = CONSTANT * near * near.max(distance[m] * slenderness[m]) / (1.0 - power[m]);
    }
    let (mut points, mut error) = ([1.0; LANES], from_fn(|m| factor[m] * power[m]));
    let mut bound = error;
    for n in 1..=MAX_POINTS {
        for m in 0..LANES {
            let more = bound[m] > limit[m];
            bound[m] *= power[m] * ((n + 1) as f64 / n as f64);
            points[m] += f64::from(more);
            error[m] = if more { bound[m] } else { error[m] };
        }
    }
    Orders { points, error }
}
