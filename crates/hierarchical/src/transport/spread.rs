//! How much the form factor varies over the two patches of a pair, from a few points of each.
//!
//! Each patch is four points of a quarter each. Between points the kernel is that of a disc, F(x) = cosθ cosθ' A/(π r² + A) with A a quarter of the larger patch: it stays below 1
//! where patches touch. Spread over a patch: standard deviation over its points relative to their mean. J. R. Wallace, K. A. Elmquist, E. A. Haines, SIGGRAPH 1989, doi:10.1145/74334.74366, for the disc. Dimensionless.

use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;

/// Points over a patch.
pub(crate) const POINTS: usize = 4;
/// Places of the two Gauss points of the unit interval.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Barycentric places of four points over a triangle, of equal weight: the centroids of its quarters.
const THIRDS: [[f64; 2]; POINTS] =
    [[1.0 / 6.0, 1.0 / 6.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0], [1.0 / 3.0, 1.0 / 3.0]];

/// What a pair exchanges when open, roughly, and its relative spreads over both patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    /// A_a F_ab, m².
    pub exchange: f64,
    /// Over a, over b.
    pub relative: [f64; 2],
}

/// Four points that stand for a quarter of a patch each.
pub(crate) fn points(patch: &Patch) -> [Vec3; POINTS] {
    std::array::from_fn(|k| {
        if patch.sides() == 3 {
            patch.point(THIRDS[k][0], THIRDS[k][1])
        } else {
            patch.point(GAUSS[k / 2], GAUSS[k % 2])
        }
    })
}

/// Mean and relative standard deviation of some values; nothing varies where all are 0.
pub(crate) fn summary(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64;
    if mean > 0.0 { (mean, variance.sqrt() / mean) } else { (0.0, 0.0) }
}

/// Looks at an open pair.
pub(crate) fn spread(a: &Patch, b: &Patch) -> Spread {
    let (xs, ys) = (points(a), points(b));
    let quarter = 0.25 * a.area().max(b.area());
    let (mut from_a, mut from_b) = ([0.0; POINTS], [0.0; POINTS]);
    for (i, &x) in xs.iter().enumerate() {
        for (j, &y) in ys.iter().enumerate() {
            let density = disc(x, a.normal(), y, b.normal(), quarter);
            from_a[i] += density;
            from_b[j] += density;
        }
    }
    let (mean, over_a) = summary(&from_a);
    let exchange = mean / POINTS as f64 * a.area() * b.area();
    Spread { exchange: exchange.min(a.area()).min(b.area()), relative: [over_a, summary(&from_b).1] }
}

/// Form factor over area, 1/m², from a point to a disc of some area that faces along `ny`.
fn disc(x: Vec3, nx: Vec3, y: Vec3, ny: Vec3, area: f64) -> f64 {
    let line = y - x;
    let r2 = line.length_squared();
    let cosines = line.dot(nx).max(0.0) * (-line.dot(ny)).max(0.0);
    if r2 > 0.0 { cosines / (r2 * (PI * r2 + area)) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, half: f64, up: bool) -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(half * x, half * y, z);
        let corners = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        let patch = Patch::quad(corners).unwrap().unwrap();
        if up { patch } else { patch.flipped() }
    }

    #[test]
    fn far_squares_exchange_as_points_do_and_hardly_vary() {
        let found = spread(&square(0.0, 0.5, true), &square(100.0, 0.5, false));
        assert!((found.exchange * PI * 1e4 - 1.0).abs() < 1e-3, "{found:?}");
        assert!(found.relative.iter().all(|&s| s < 1e-3), "{found:?}");
    }

    #[test]
    fn a_square_at_right_angles_varies_as_its_height() {
        // Far away the factor is proportional to the height over the other plane: ½ ± 1/(2√3), a spread of 1/√3.
        let floor = square(0.0, 0.5, true);
        let corner = |y: f64, z: f64| Vec3::new(100.0, y, z);
        let wall = Patch::quad([corner(-0.5, 0.), corner(-0.5, 1.), corner(0.5, 1.), corner(0.5, 0.)]);
        let found = spread(&floor, &wall.unwrap().unwrap());
        assert!((found.relative[1] * 3f64.sqrt() - 1.0).abs() < 1e-2, "{found:?}");
        assert!(found.relative[0] < 2e-2);
    }

    #[test]
    fn nothing_is_exchanged_back_to_back() {
        let found = spread(&square(0.0, 0.5, false), &square(1.0, 0.5, true));
        assert_eq!(found, Spread { exchange: 0.0, relative: [0.0; 2] });
    }
}
