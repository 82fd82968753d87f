//! Monte Carlo: A_i F_ij = A_i E[ k V / (½/A_j + ½ k) ] over points q of j, half of them even on j,
//! half where cosine-weighted rays from p meet it.
//!
//! E. Veach & L. J. Guibas, SIGGRAPH 1995, doi:10.1145/218380.218498, the balance heuristic of two
//! densities in the measure of area: 1/A_j, and the kernel k = cosθ cosθ'/(π r²) itself. In m². p
//! is even on i. Points alone have no finite variance where patches share an edge, rays alone waste
//! themselves on small and far patches; together no sample exceeds 2 A_i. The error is one standard
//! error: it is estimated from the samples, falls as N^(−1/2), and is 0 where no sample sees
//! anything.

use super::facing::{Facing, Part};
use super::keyed::keyed;
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;
use std::f64::consts::TAU;

pub(super) struct MonteCarlo;

impl FormFactorMethod for MonteCarlo {
    fn name(&self) -> &'static str {
        "monte-carlo"
    }

    fn summary(&self) -> &'static str {
        "random points and directions, with the standard error"
    }

    fn convergent(&self) -> bool {
        false
    }

    fn default_setting(&self) -> Setting {
        Setting::Samples { count: 4096, seed: 1 }
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        let (count, seed) = setting.samples(self.name())?;
        let Some(facing) = Facing::new(a, b, occluders) else { return Ok(Evaluated::default()) };
        let sampler = Sampler::new(&facing);
        let scores = (0..count).map(|sample| sampler.score(|dimension| keyed(seed, sample, dimension)));
        Ok(Evaluated::new(mean(scores, count), 2 * count))
    }
}

/// Mean and its standard error.
fn mean(scores: impl Iterator<Item = f64>, count: u64) -> Estimate {
    // Welford's recurrence: the sum of squares would lose a small variance.
    let (mut mean, mut squares) = (0.0, 0.0);
    for (k, score) in scores.enumerate() {
        let step = score - mean;
        mean += step / (k + 1) as f64;
        squares += step * (score - mean);
    }
    let n = count as f64;
    Estimate { value: mean, error: (squares / (n * (n - 1.0))).sqrt() }
}

/// Both parts as triangles, with the axes of the first.
struct Sampler<'a> {
    facing: &'a Facing<'a>,
    first: Vec<Patch>,
    second: Vec<Patch>,
    areas: [f64; 2],
    axes: [Vec3; 2],
}

impl<'a> Sampler<'a> {
    fn new(facing: &'a Facing<'a>) -> Self {
        let triangles = |part: &Part| part.triangles();
        let across = facing.a.normal.any_orthonormal_vector();
        Self {
            facing,
            first: triangles(&facing.a),
            second: triangles(&facing.b),
            areas: [facing.a.area(), facing.b.area()],
            axes: [across, facing.a.normal.cross(across)],
        }
    }

    /// Mean of one point and one ray from the same p, m².
    fn score(&self, random: impl Fn(u64) -> f64) -> f64 {
        let p = even(&self.first, random(0), random(1));
        let point = even(&self.second, random(2), random(3));
        let ray = self.facing.b.hit(p, self.ray(random(4), random(5)));
        let weighed = self.weighed(p, point) + ray.map_or(0.0, |q| self.weighed(p, q));
        0.5 * self.areas[0] * weighed
    }

    /// k V over the mean of both densities.
    fn weighed(&self, p: Vec3, q: Vec3) -> f64 {
        let kernel = self.facing.kernel(p, q);
        kernel / (0.5 / self.areas[1] + 0.5 * kernel)
    }

    /// A direction with density cosθ/π.
    fn ray(&self, x: f64, y: f64) -> Vec3 {
        let (sine, turn) = (x.sqrt(), TAU * y);
        let [u, v] = self.axes;
        (u * turn.cos() + v * turn.sin()) * sine + self.facing.a.normal * (1.0 - x).sqrt()
    }
}

/// An even point of several triangles; `x` chooses the triangle, and what is left of it the place.
fn even(triangles: &[Patch], x: f64, y: f64) -> Vec3 {
    let mut left = x * triangles.iter().map(Patch::area).sum::<f64>();
    let mut chosen = None;
    for triangle in triangles {
        chosen = Some((triangle, (left / triangle.area()).min(1.0)));
        if left < triangle.area() {
            break;
        }
        left -= triangle.area();
    }
    let fold = |u: f64| if u + y > 1.0 { (1.0 - u, 1.0 - y) } else { (u, y) };
    chosen.map_or(Vec3::ZERO, |(triangle, u)| triangle.point(fold(u).0, fold(u).1))
}
