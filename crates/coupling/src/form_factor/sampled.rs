//! A_i F_ij behind many occluders: the unoccluded factor times the share of it that reaches
//! through, G_ij = G⁰_ij Σ w_k V_k / Σ w_k over pairs of points, w the point-to-point kernel times
//! the areas the points stand for.
//!
//! The pairs follow the four-dimensional additive recurrence of `rays`, the same for every pair of
//! patches. Their number is multiplied by four until the tripled standard error over eight batches
//! meets the tolerance, or until there are more than exact shadows would cost. In m².

use super::jacobian;
use crate::kernel::lambert;
use crate::polygon::folded;
use crate::rays::recurrence;
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;

const BATCHES: usize = 8;
const FIRST_SAMPLES: usize = 64;
const MOST_SAMPLES: usize = 16384;

/// A_i F_ij (m²) of two patches whose unoccluded value is `open`; `sees` answers whether two points
/// see each other.
pub(crate) fn sampled(
    a: &Patch,
    b: &Patch,
    open: Estimate,
    tolerance: f64,
    sees: impl Fn(Vec3, Vec3) -> bool,
) -> Estimate {
    let mut batches = [Share::default(); BATCHES];
    let (mut done, mut last) = (0, 0.0);
    loop {
        let until = (4 * done).max(FIRST_SAMPLES);
        for k in done..until {
            batches[k % BATCHES].add(a, b, pair_parameters(k), &sees);
        }
        done = until;
        let (share, spread) = summary(&batches);
        // Eight batches may agree by luck, but seldom both with each other and with the stage
        // before.
        let error = spread.max((share - last).abs());
        last = share;
        let total = open.value * error + open.error * share;
        if total <= tolerance || done >= MOST_SAMPLES {
            return Estimate { value: open.value * share, error: total };
        }
    }
}

/// Weight that gets through, weight in all, and the largest of one pair.
#[derive(Clone, Copy, Default)]
struct Share {
    through: f64,
    all: f64,
    largest: f64,
}

impl Share {
    fn add(&mut self, a: &Patch, b: &Patch, x: [f64; 4], sees: &impl Fn(Vec3, Vec3) -> bool) {
        let ((p, wp), (q, wq)) = (weighted(a, x[0], x[1]), weighted(b, x[2], x[3]));
        let weight = wp * wq * lambert(p, a.normal(), q, b.normal());
        self.all += weight;
        self.largest = self.largest.max(weight);
        if weight > 0.0 && sees(p, q) {
            self.through += weight;
        }
    }
}

fn pair_parameters(k: usize) -> [f64; 4] {
    recurrence(k, [0.5; 4])
}

/// A point of the patch and the area it stands for, up to a constant.
fn weighted(patch: &Patch, u: f64, v: f64) -> (Vec3, f64) {
    let (u, v) = folded(patch, u, v);
    (patch.point(u, v), jacobian(patch, u, v))
}

/// Mean share and three standard errors over the batches, 98 % of a t-distribution with seven
/// degrees of freedom; never less than the heaviest pair's worth. Where no pair has any weight
/// nothing is known.
fn summary(batches: &[Share]) -> (f64, f64) {
    let all: f64 = batches.iter().map(|s| s.all).sum();
    if all == 0.0 {
        return (0.0, 1.0);
    }
    let mean = batches.iter().map(|s| s.through).sum::<f64>() / all;
    let spread: f64 = batches.iter().map(|s| (s.through - mean * s.all).powi(2)).sum();
    let n = batches.len() as f64;
    let standard = (spread * n / (n - 1.0)).sqrt() / all;
    let heaviest = batches.iter().map(|s| s.largest).fold(0.0, f64::max) / all;
    (mean, (3.0 * standard).max(heaviest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares() -> (Patch, Patch) {
        let v = |x, y, z| Vec3::new(x, y, z);
        let a = Patch::quad([v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)]).unwrap().unwrap();
        let b = Patch::quad([v(0., 1., 1.), v(1., 1., 1.), v(1., 0., 1.), v(0., 0., 1.)]).unwrap().unwrap();
        (a, b)
    }

    #[test]
    fn a_centred_block_hides_half_within_the_stated_error() {
        let (a, b) = squares();
        let open = Estimate { value: 0.199_824_895_698_388, error: 0.0 };
        let inside = |x: f64| (0.25..=0.75).contains(&x);
        let sees = |p: Vec3, q: Vec3| {
            let middle = (p + q) * 0.5;
            !(inside(middle.x) && inside(middle.y))
        };
        let got = sampled(&a, &b, open, 1e-4, sees);
        // Closed forms by superposition of rectangles.
        let exact = 0.099_506_294_598_985;
        assert!((got.value - exact).abs() <= got.error, "{got:?}");
        assert!(got.error < 5e-3);
    }

    #[test]
    fn where_hardly_a_point_faces_the_other_patch_little_is_claimed() {
        // A wall that reaches below the floor, and above it by less than the points are apart.
        let v = |x, y, z| Vec3::new(x, y, z);
        let floor =
            Patch::quad([v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)]).unwrap().unwrap();
        for height in [1e-9, 1e-5, 1e-3] {
            let wall = Patch::quad([v(2., 0., -1.), v(2., 0., height), v(2., 1., height), v(2., 1., -1.)])
                .unwrap()
                .unwrap();
            let open = Estimate { value: 1e-3, error: 0.0 };
            let got = sampled(&floor, &wall, open, 1e-9, |_, _| false);
            assert!(got.error >= 1e-4 * open.value, "{height}: {got:?}");
        }
    }

    #[test]
    fn all_or_nothing_is_all_or_nothing() {
        let (a, b) = squares();
        let open = Estimate { value: 0.2, error: 0.0 };
        assert!((sampled(&a, &b, open, 1e-2, |_, _| true).value - 0.2).abs() < 1e-15);
        assert!(sampled(&a, &b, open, 1e-2, |_, _| false).value == 0.0);
    }
}
