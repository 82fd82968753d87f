//! Densities to sample from, each with what its probability is.
//!
//! A density of directions is about an axis, the z of a [`Frame`], in 1/sr; one of points is per
//! area, in 1/m².

mod cosine;
mod frame;
mod lamp_tree;
mod lamps;
mod learned;
mod surface;
mod uniform;
mod von_mises_fisher;

pub use cosine::Cosine;
pub use frame::Frame;
pub use lamp_tree::{Cut, Cuts, LampTree, Receiver};
pub use lamps::LampDensity;
pub(crate) use learned::Look;
pub use surface::SurfaceDensity;
pub use uniform::{UniformHemisphere, UniformSphere};
pub use von_mises_fisher::VonMisesFisher;

use fredholm_mesh::Vec3;

/// A density of unit directions about the axis z.
pub trait DirectionDensity: Send + Sync {
    /// The direction of two numbers in [0, 1).
    fn sample(&self, numbers: [f64; 2]) -> Vec3;

    /// Density at a unit direction, 1/sr.
    fn pdf(&self, direction: Vec3) -> f64;
}

/// The unit vector with 1 − cosθ = `t` at this share of a turn.
fn at(t: f64, turn: f64) -> Vec3 {
    let sine = (t * (2.0 - t)).max(0.0).sqrt();
    let (y, x) = (std::f64::consts::TAU * turn).sin_cos();
    Vec3::new(sine * x, sine * y, 1.0 - t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{Key, PointSet, Samples};
    use statrs::distribution::{ChiSquared, ContinuousCDF};
    use std::f64::consts::TAU;

    /// Rings between values of t = 1 − cosθ, quarters of a turn each: χ² of counts against the
    /// integral of the density, which must be 1 in all.
    fn check(density: &dyn DirectionDensity, edges: &[f64], name: &str) {
        let n = 20_000;
        let (rings, quarters) = (edges.len() - 1, 4);
        let mut counts = vec![0.0; rings * quarters];
        let mut samples = Samples::new(PointSet::Independent, Key { seed: 11, batch: 0, stream: 0 }, n);
        for sample in 0..n {
            let d = density.sample(samples.draw(sample).pair());
            assert!((d.length() - 1.0).abs() < 1e-12 && density.pdf(d) > 0.0, "{name}: {d}");
            let t = 0.5 * (d - Vec3::Z).length_squared();
            let ring = edges[1..rings].iter().filter(|&&edge| t >= edge).count();
            let quarter = (d.y.atan2(d.x).rem_euclid(TAU) / TAU * quarters as f64) as usize;
            counts[ring * quarters + quarter.min(quarters - 1)] += 1.0;
        }
        let mass = |ring: usize| integral(density, edges[ring], edges[ring + 1]);
        let total: f64 = (0..rings).map(mass).sum();
        assert!((total - 1.0).abs() < 1e-6, "{name}: {total}");
        let expected = |bin: usize| f64::from(n) * mass(bin / quarters) / quarters as f64;
        let chi: f64 = counts
            .iter()
            .enumerate()
            .map(|(bin, count)| (count - expected(bin)).powi(2) / expected(bin))
            .sum();
        let p = 1.0 - ChiSquared::new((counts.len() - 1) as f64).unwrap().cdf(chi);
        assert!(p > 1e-4, "{name}: χ² = {chi}, p = {p:e}");
    }

    /// 2π ∫ pdf dt by Simpson's rule.
    fn integral(density: &dyn DirectionDensity, from: f64, to: f64) -> f64 {
        let n = 400;
        let weight = |i: usize| if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        let h = (to - from) / n as f64;
        let value = |i: usize| weight(i) * density.pdf(at(from + h * i as f64, 0.3));
        (0..=n).map(value).sum::<f64>() * h / 3.0 * TAU
    }

    fn even(to: f64) -> Vec<f64> {
        (0..=8).map(|i| to * f64::from(i) / 8.0).collect()
    }

    #[test]
    fn samples_follow_the_densities_and_these_integrate_to_one() {
        check(&UniformSphere, &even(2.0), "sphere");
        check(&UniformHemisphere, &even(1.0), "hemisphere");
        check(&Cosine, &even(1.0), "cosine");
        for kappa in [0.0, 1e-8, 1e-3, 0.5, 1.0] {
            check(&VonMisesFisher::new(kappa), &even(2.0), &format!("{kappa}"));
        }
        for kappa in [30.0, 700.0, 1e4, 1e8] {
            // Rings of about equal mass; the last one reaches e^{-24}.
            let inner = (0..8).map(|i| -(1.0 - f64::from(i) / 8.0_f64).ln() / kappa);
            let edges: Vec<f64> = inner.chain([(24.0 / kappa).min(2.0)]).collect();
            check(&VonMisesFisher::new(kappa), &edges, &format!("{kappa}"));
        }
    }

    #[test]
    fn what_is_below_the_horizon_has_no_density() {
        assert!(Cosine.pdf(-Vec3::Z) == 0.0 && UniformHemisphere.pdf(-Vec3::Z) == 0.0);
        assert!(VonMisesFisher::new(1e8).pdf(-Vec3::Z) == 0.0);
    }
}
