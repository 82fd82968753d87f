//! ∫ₑ∫_f ln r ds dt over two edges that are not parallel, in closed form.
//!
//! What P. Schröder & P. Hanrahan, "On the form factor between two polygons", SIGGRAPH 1993,
//! doi:10.1145/166117.166138 (report TR-404-93, Princeton), compute with a table of cases, in a
//! form without cases. Measure s and t from the feet of the common perpendicular of both lines, of
//! length d, with θ the angle between the directions: r² = s² + t² − 2 s t cosθ + d². Since ∇·(s ln
//! r, t ln r) = 2 ln r + 1 − d²/r²,
//!
//! ∫∫ ln r = ½ ( [s ∫ ln r dt]ₛ + [t ∫ ln r ds]ₜ − L_e L_f + d² ∫∫ ds dt/r² ),
//!
//! brackets being differences between the ends of an edge. The single integrals are elementary. For
//! the last one let d sinh u = s sinθ and d sinh v = t sinθ. The integral over t is an arc tangent,
//! the argument of (1 − e^{u−v+iθ}) (1 + e^{u+v+iθ}) up to a constant, and each factor stays on one
//! side of the real axis: its logarithm has no branch to cross. So
//!
//! d² ∫∫ ds dt/r² = (d²/sinθ) [[ Λ(u + v, π − θ) + |u + v| θ/2 − Λ(u − v, θ) − |u − v| (π − θ)/2
//! ]],
//!
//! Λ(x, θ) = Im Li₂(e^{−|x| + iθ}), double brackets the differences between the ends of both edges.
//! With d = 0 (lines that meet) it vanishes. Dimensionless lengths in the unit of the pair. The
//! terms are of the size of the distance to the feet, and the rounding of the directions turns the
//! common perpendicular by its 1/sinθ-fold: edges that are nearly parallel, or short and far,
//! cancel, and the stated rounding says so.

use super::dilogarithm;
use crate::form_factor::contour::{Edge, ROUNDING, log_integral};
use fredholm_quadrature::Estimate;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Both lines seen from the feet of their common perpendicular: ends of the edges, angle and
/// distance.
struct Feet {
    s: [f64; 2],
    t: [f64; 2],
    sine: f64,
    angle: f64,
    distance: f64,
}

impl Feet {
    fn of(e: Edge, f: Edge) -> Self {
        let cross = e.direction.cross(f.direction);
        let sine = cross.length();
        let common = cross / sine;
        let w = e.start - f.start;
        let s = w.cross(f.direction).dot(common) / sine;
        // From the foot on e, not from the start of e: the rounding of both feet is then the same,
        // and cancels.
        let t = -(w - e.direction * s).dot(f.direction);
        let angle = sine.atan2(e.direction.dot(f.direction));
        Self { s: [s, s + e.length], t: [t, t + f.length], sine, angle, distance: w.dot(common).abs() }
    }

    /// Largest of all lengths.
    fn reach(&self) -> f64 {
        largest(self.s.into_iter().chain(self.t)).max(self.distance)
    }

    /// d² ∫∫ ds dt/r² as its four terms.
    fn inverse_square(&self) -> [f64; 4] {
        if self.distance == 0.0 {
            return [0.0; 4];
        }
        let place = |x: f64| (self.sine * x / self.distance).asinh();
        let (u, v) = (self.s.map(place), self.t.map(place));
        let scale = self.distance * (self.distance / self.sine);
        let at = |i: usize, k: usize| scale * potential(u[i], v[k], self.angle);
        [at(1, 1), -at(1, 0), -at(0, 1), at(0, 0)]
    }
}

/// Λ(u + v, π − θ) + |u + v| θ/2 − Λ(u − v, θ) − |u − v| (π − θ)/2.
fn potential(u: f64, v: f64, angle: f64) -> f64 {
    let (sum, difference) = ((u + v).abs(), (u - v).abs());
    spiral(sum, PI - angle) + 0.5 * sum * angle - spiral(difference, angle) - 0.5 * difference * (PI - angle)
}

/// Im Li₂(e^{−x + iθ}), x ≥ 0.
fn spiral(x: f64, angle: f64) -> f64 {
    dilogarithm(Complex64::from_polar((-x).exp(), angle)).im
}

/// ∫ₑ∫_f ln r ds dt with its rounding. The edges must not be parallel.
pub(super) fn skew_edges(e: Edge, f: Edge) -> Estimate {
    let feet = Feet::of(e, f);
    let along_f = feet.s.map(|s| log_integral(e.start + e.direction * (s - feet.s[0]), f));
    let along_e = feet.t.map(|t| log_integral(f.start + f.direction * (t - feet.t[0]), e));
    let ends = |x: [f64; 2], along: [f64; 2]| x[1] * along[1] - x[0] * along[0];
    let inverse_square = feet.inverse_square();
    let twice = ends(feet.s, along_f) + ends(feet.t, along_e) - e.length * f.length
        + inverse_square.iter().sum::<f64>();
    // The feet are rounded relative to the largest distance, wherever they lie.
    let logs = feet.reach() * largest(along_f.into_iter().chain(along_e));
    let terms = logs.max(largest(inverse_square)).max(e.length * f.length);
    Estimate { value: 0.5 * twice, error: ROUNDING * terms / feet.sine }
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m, value| m.max(value.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_mesh::Vec3;

    /// Edges with ends at s and t from the feet of the common perpendicular, of length d.
    fn edges(s: [f64; 2], t: [f64; 2], angle: f64, d: f64) -> (Edge, Edge) {
        let across = Vec3::new(angle.cos(), angle.sin(), 0.0);
        let e = Edge { start: Vec3::X * s[0], direction: Vec3::X, length: s[1] - s[0] };
        let f = Edge { start: across * t[0] + Vec3::Z * d, direction: across, length: t[1] - t[0] };
        (e, f)
    }

    /// Nested quadrature of an arbitrary-precision library.
    #[test]
    fn agrees_with_values_of_many_digits() {
        let cases = [
            (([0.5, 2.0], [-1.0, 1.5], 1.1, 0.7), 1.529_295_654_202_265_4),
            (([1.0, 2.0], [3.0, 4.0], 2.5, 0.3), 1.564_994_859_160_937_4),
            (([-1.0, 2.0], [-1.0, 1.0], 0.4, 0.9), 1.674_695_071_669_242),
        ];
        for ((s, t, angle, d), exact) in cases {
            let (e, f) = edges(s, t, angle, d);
            let got = skew_edges(e, f);
            assert!((got.value - exact).abs() < 2e-15 && got.error < 4e-14, "{got:?} against {exact}");
        }
    }

    #[test]
    fn touching_lines_are_the_limit_of_close_ones() {
        let at = |d: f64| {
            let (e, f) = edges([0.0, 1.0], [-0.5, 0.7], 0.8, d);
            skew_edges(e, f).value
        };
        assert!((at(1e-9) - at(0.0)).abs() < 1e-8 && (at(1e-17) - at(0.0)).abs() < 1e-15);
    }

    #[test]
    fn order_and_sense_of_the_edges_do_not_matter() {
        let (e, f) = edges([0.2, 1.0], [-0.5, 0.7], 0.8, 0.3);
        let turned =
            Edge { start: f.start + f.direction * f.length, direction: -f.direction, length: f.length };
        let value = skew_edges(e, f).value;
        for other in [skew_edges(f, e), skew_edges(e, turned), skew_edges(turned, e)] {
            assert!((other.value - value).abs() < 4e-16 * 10.0, "{other:?} against {value}");
        }
    }
}
