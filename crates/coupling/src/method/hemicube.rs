//! Hemicube: A_i F_ij ≈ A_i Σ ΔF over the pixels through which the centroid of i sees j.
//!
//! M. F. Cohen & D. P. Greenberg, SIGGRAPH 1985, doi:10.1145/325165.325171. In m². A half cube of
//! half side 1 stands over the centroid; a pixel of area ΔA has ΔF = ΔA/(π (x² + y² + 1)²) on the
//! top and z ΔA/(π (y² + z² + 1)²) on a side. The classical comparator: with rising resolution it
//! converges (raggedly, about as 1/N) to A_i times the factor of the centroid, not to A_i F_ij. The
//! stated error is half the pixels on the outline, one pixel at least, and the difference between
//! the centroid and the mean. It is not reciprocal.

use super::facing::Facing;
use super::nystrom::collocation;
use super::{Evaluated, FormFactorMethod, MethodError, Setting};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;
use std::f64::consts::FRAC_1_PI;

/// Highest resolution.
const HIGHEST_RESOLUTION: usize = 4096;

pub(super) struct Hemicube;

impl FormFactorMethod for Hemicube {
    fn name(&self) -> &'static str {
        "hemicube"
    }

    fn summary(&self) -> &'static str {
        "pixels of a half cube about the centroid of the first patch"
    }

    fn convergent(&self) -> bool {
        false
    }

    fn default_setting(&self) -> Setting {
        Setting::Resolution(128)
    }

    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError> {
        let pixels = setting.resolution(self.name(), HIGHEST_RESOLUTION)?;
        let Some(facing) = Facing::new(a, b, occluders) else { return Ok(Evaluated::default()) };
        let p = facing.a.centroid();
        let sees = |direction| facing.b.hit(p, direction).is_some_and(|q| facing.sees(p, q));
        let mut sum = Estimate { value: 0.0, error: top_pixel(pixels) };
        for face in faces(facing.a.normal) {
            sum = sum + face.seen(pixels, sees);
        }
        let area = facing.a.area();
        let estimate = Estimate { value: area * sum.value, error: area * sum.error + collocation(&facing) };
        Ok(facing.evaluated(estimate, (3 * pixels * pixels) as u64))
    }
}

/// The largest ΔF of all pixels.
fn top_pixel(pixels: usize) -> f64 {
    4.0 * FRAC_1_PI / (pixels * pixels) as f64
}

/// What a pixel adds to the sum, and to its error.
fn pixel(share: f64, sees: bool, outline: bool) -> Estimate {
    let part = |is: bool| if is { share } else { 0.0 };
    Estimate { value: part(sees), error: 0.5 * part(outline) }
}

/// A face: its points are `centre` + x `across` + y `up`, x in (−1, 1), y in (`low`, 1).
struct Face {
    centre: Vec3,
    across: Vec3,
    up: Vec3,
    low: f64,
    normal: Vec3,
}

/// The top, and four sides of which the upper half is above the horizon.
fn faces(normal: Vec3) -> [Face; 5] {
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let side = |centre: Vec3, across: Vec3| Face { centre, across, up: normal, low: 0.0, normal };
    [
        Face { centre: normal, across: u, up: v, low: -1.0, normal },
        side(u, v),
        side(v, -u),
        side(-u, -v),
        side(-v, u),
    ]
}

impl Face {
    /// Σ ΔF of the pixels that see j, and half of it over those on the outline.
    fn seen(&self, pixels: usize, sees: impl Fn(Vec3) -> bool) -> Estimate {
        let side = 2.0 / pixels as f64;
        let rows = ((1.0 - self.low) / side).round() as usize;
        let mut below = vec![false; pixels];
        let mut sum = Estimate::default();
        for row in 0..rows {
            let mut left = false;
            for (column, below) in below.iter_mut().enumerate() {
                let middle = |k: usize| (k as f64 + 0.5) * side;
                let ray =
                    self.centre + self.across * (middle(column) - 1.0) + self.up * (middle(row) + self.low);
                let (now, share) = (sees(ray), self.share(ray, side));
                let outline = now != left || now != *below;
                sum = sum + pixel(share, now, outline);
                (left, *below) = (now, now);
            }
        }
        sum
    }

    /// ΔF of the pixel about the end of a ray.
    fn share(&self, ray: Vec3, side: f64) -> f64 {
        ray.dot(self.normal) * side * side * FRAC_1_PI / ray.length_squared().powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pixels_together_have_one() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let sum = |n: usize| faces(normal).iter().map(|face| face.seen(n, |_| true).value).sum::<f64>();
        assert!((sum(64) - 1.0).abs() < 1e-3 && (sum(256) - 1.0).abs() < 0.1 * (sum(64) - 1.0).abs());
    }
}
