//! The series of spherical waves behind the translation from box to box.
//!
//! With D from the middle of the sources to that of the observers and d what is left of the
//! distance, |d| < |D|,
//!
//! ```text
//! e^{−jk|D+d|}/|D+d| = −jk/(4π) ∮ e^{−jk k̂·d} T(k̂) d²k̂
//! T(k̂) = Σ_{l ≤ L} (−j)^l (2l + 1) h_l⁽²⁾(kD) P_l(k̂·D/|D|)
//! ```
//!
//! (V. Rokhlin, Appl. Comput. Harmon. Anal. 1 (1993) 82, doi:10.1006/acha.1993.1006; R. Coifman,
//! V. Rokhlin, S. Wandzura, IEEE Antennas Propag. Mag. 35(3) (1993) 7, doi:10.1109/74.250128). What
//! is left out begins with (2L + 3) j_{L+1}(kd) h_{L+1}(kD), and falls by about d/D from one degree
//! to the next. h_L grows without bound with L: the digits that T has beyond the result are lost,
//! so that boxes cannot be small beside the wavelength.

use num_complex::Complex64;

/// j_0 to j_n of x > 0, by recursion from above.
fn bessel(n: usize, x: f64) -> Vec<f64> {
    // From where on they are below rounding beside that of order n.
    let first = n.max(x as usize) + 30 + 2 * (n.max(x as usize) as f64).sqrt() as usize;
    let mut values = vec![0.0; first + 2];
    values[first] = f64::MIN_POSITIVE;
    for l in (1..=first).rev() {
        values[l - 1] = (2 * l + 1) as f64 / x * values[l] - values[l + 1];
        if values[l - 1].abs() > 1e200 {
            values[l - 1..].iter_mut().for_each(|value| *value *= 1e-200);
        }
    }
    // j_0 or j_1, whichever is not near a zero.
    let (sin, cos) = x.sin_cos();
    let exact = [sin / x, sin / (x * x) - cos / x];
    let at = usize::from(exact[1].abs() > exact[0].abs());
    let scale = exact[at] / values[at];
    values.truncate(n + 1);
    for value in &mut values {
        *value *= scale;
    }
    values
}

/// h_0 to h_n of the second kind of x > 0.
fn hankel(n: usize, x: f64) -> Vec<Complex64> {
    let (j, (sin, cos)) = (bessel(n, x), x.sin_cos());
    let mut y = vec![-cos / x, -cos / (x * x) - sin / x];
    for l in 1..n {
        y.push((2 * l + 1) as f64 / x * y[l] - y[l - 1]);
    }
    j.into_iter().zip(y).map(|(j, y)| Complex64::new(j, -y)).collect()
}

/// The truncated series for one distance.
pub(crate) struct Series {
    /// (−j)^l (2l + 1) h_l.
    terms: Vec<Complex64>,
    /// (2L + 3) |h_{L+1}| kD.
    next: f64,
    /// (2L + 1) |h_L| kD.
    last: f64,
    kd: f64,
}

impl Series {
    /// Up to `degree`, for kD.
    pub(crate) fn new(degree: usize, kd: f64) -> Self {
        let waves = hankel(degree + 1, kd);
        let size = |l: usize| (2 * l + 1) as f64 * waves[l].norm() * kd;
        let (next, last) = (size(degree + 1), size(degree));
        let term = |(l, wave): (usize, &Complex64)| {
            (2 * l + 1) as f64 * wave * Complex64::new(0.0, -1.0).powi((l % 4) as i32)
        };
        let terms = waves.iter().enumerate().take(degree + 1).map(term).collect();
        Self { terms, next, last, kd }
    }

    /// T for the cosine of the angle between a direction and D.
    pub(crate) fn at(&self, cosine: f64) -> Complex64 {
        let (mut before, mut own) = (0.0, 1.0);
        let mut sum = Complex64::ZERO;
        for (l, term) in self.terms.iter().enumerate() {
            sum += term * own;
            let next = ((2 * l + 1) as f64 * cosine * own - l as f64 * before) / (l + 1) as f64;
            (before, own) = (own, next);
        }
        sum
    }

    /// Digits that T has beyond the result, as a factor.
    pub(crate) fn growth(&self) -> f64 {
        self.last
    }

    /// Relative error for the worst pair of points whose d takes this kd.
    pub(crate) fn error(&self, kd: f64) -> f64 {
        if kd >= self.kd {
            return f64::INFINITY;
        }
        let order = self.terms.len();
        // Beyond its turning point j oscillates: it is no measure there.
        if kd > order as f64 {
            return f64::INFINITY;
        }
        self.next * bessel(order, kd.max(1e-3))[order].abs() / (1.0 - kd / self.kd)
    }

    /// The largest kd with at most this error.
    pub(crate) fn reach(&self, error: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.kd);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if self.error(middle) <= error {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multipole::grid::Grid;
    use fredholm_mesh::Vec3;
    use std::f64::consts::PI;

    #[test]
    fn spherical_functions_hold_their_wronskian_and_known_values() {
        for x in [0.3, 2.0, 3.2, 17.0, 90.0] {
            let h = hankel(40, x);
            for pair in h.windows(2) {
                // j_{l+1} y_l − j_l y_{l+1} = 1/x².
                let [y, next] = [-pair[0].im, -pair[1].im];
                let wronskian = pair[1].re * y - pair[0].re * next;
                assert!((wronskian * x * x - 1.0).abs() < 1e-9, "{x}");
            }
        }
        assert!((bessel(5, 2.0)[5] - 2.635_169_770_244e-3).abs() < 1e-14);
    }

    #[test]
    fn translated_waves_are_those_of_a_point_within_the_error_told() {
        let (shift, degree) = (Vec3::new(6.0, 3.0, -2.0), 14);
        let series = Series::new(degree, shift.length());
        let grid = Grid::new(degree);
        for d in [Vec3::new(1.0, -0.5, 2.0), Vec3::new(3.4, 1.7, -1.1), Vec3::new(-3.0, -1.5, 1.0)] {
            let mut sum = Complex64::ZERO;
            for at in 0..grid.len() {
                let along = grid.direction(at).along;
                let wave = Complex64::cis(-along.dot(d)) * series.at(along.dot(shift) / shift.length());
                sum += wave * grid.weight(at);
            }
            sum *= Complex64::new(0.0, -1.0) / (4.0 * PI);
            let distance = (shift + d).length();
            let error = (sum - Complex64::cis(-distance) / distance).norm() * distance;
            let told = series.error(d.length());
            assert!(error < 2.0 * told && told < 0.02, "{d}: {error:e} {told:e}");
        }
    }

    #[test]
    fn the_reach_has_the_error_asked_for() {
        let series = Series::new(10, 5.0);
        let reach = series.reach(1e-3);
        assert!(reach > 0.5 && reach < 5.0 && (series.error(reach) / 1e-3 - 1.0).abs() < 1e-3);
        assert!(series.growth() > 100.0);
    }
}
