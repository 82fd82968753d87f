//! Points of lamps in proportion to what they emit: w/(W A) per area on a patch of weight w = A M,
//! M the mean exitance over the bands.

use super::SurfaceDensity;
use fredholm_mesh::{Patch, Vec3};

/// The density of points in proportion to exitance.
#[derive(Clone, Debug)]
pub struct LampDensity {
    /// The lamps, by number of the patch, and how much of the whole lies up to each.
    lamps: Vec<(usize, SurfaceDensity)>,
    cumulated: Vec<f64>,
    /// Density on each patch, 1/m².
    density: Vec<f64>,
}

impl LampDensity {
    /// The density of patches with these weights (W); `None` where all are 0.
    #[must_use]
    pub fn new(patches: &[Patch], weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        if total <= 0.0 || !total.is_finite() {
            return None;
        }
        let lit = || patches.iter().zip(weights).enumerate().filter(|(_, (_, weight))| **weight > 0.0);
        let mut sum = 0.0;
        let mut cumulate = |weight: f64| {
            sum += weight / total;
            sum
        };
        Some(Self {
            lamps: lit().map(|(number, (patch, _))| (number, SurfaceDensity::new(patch))).collect(),
            cumulated: lit().map(|(_, (_, &weight))| cumulate(weight)).collect(),
            density: patches
                .iter()
                .zip(weights)
                .map(|(patch, weight)| weight / total / patch.area())
                .collect(),
        })
    }

    /// Patch and point (m) of two numbers in [0, 1).
    #[must_use]
    pub fn sample(&self, [u, v]: [f64; 2]) -> (usize, Vec3) {
        let at = self.cumulated.partition_point(|&end| end <= u).min(self.lamps.len() - 1);
        let start = if at == 0 { 0.0 } else { self.cumulated[at - 1] };
        // What is left of the first number is even again.
        let rest = ((u - start) / (self.cumulated[at] - start)).clamp(0.0, 1.0 - f64::EPSILON);
        let (patch, surface) = &self.lamps[at];
        (*patch, surface.sample([rest, v]))
    }

    /// Density on a patch, 1/m².
    #[must_use]
    pub fn pdf(&self, patch: usize) -> f64 {
        self.density[patch]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{Key, PointSet, Samples};

    #[test]
    fn lamps_are_chosen_by_power_and_dark_patches_never() {
        let square = |x: f64, side: f64| {
            let corner = |i, j| Vec3::new(x + side * i, side * j, 0.0);
            Patch::quad([corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)])
                .unwrap()
                .unwrap()
        };
        let patches = [square(0.0, 1.0), square(2.0, 1.0), square(4.0, 2.0)];
        let density = LampDensity::new(&patches, &[1.0, 0.0, 3.0]).unwrap();
        let n = 40_000;
        let key = Key { seed: 1, batch: 0, stream: 0 };
        let (mut counts, mut samples) = ([0.0; 3], Samples::new(PointSet::Independent, key, n));
        for s in 0..n {
            let (patch, p) = density.sample(samples.draw(s).pair());
            counts[patch] += 1.0 / f64::from(n);
            assert!((p - patches[patch].centroid()).abs().max_element() <= 1.0);
        }
        // Deviation of a share of ¼: 0.0022.
        assert!(counts[1] == 0.0 && (counts[0] - 0.25_f64).abs() < 0.009, "{counts:?}");
        let integral: f64 = (0..3).map(|i| density.pdf(i) * patches[i].area()).sum();
        assert!((integral - 1.0).abs() < 1e-14);
        assert!(LampDensity::new(&patches, &[0.0; 3]).is_none());
    }
}
