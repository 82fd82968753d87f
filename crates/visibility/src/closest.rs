//! What does a ray meet first?

use fredholm_mesh::Vec3;

use crate::Occluders;
use crate::probe::Probe;
use crate::tree::Beam;

/// Where a ray first meets a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the patch.
    pub patch: usize,
    /// Place on the ray: `point` is origin + t · direction.
    pub t: f64,
    /// The place that was hit, m.
    pub point: Vec3,
}

impl Occluders {
    /// The first patch that the ray from `origin` meets, at 0 < t < `t_max`, from either side.
    ///
    /// The direction need not be of unit length; `t_max` may be infinite. A patch whose plane is within the
    /// [tolerance](Self::tolerance) of the origin is not met, so a ray may start on a surface.
    ///
    /// Where several patches are met within the tolerance of the first, as on the two faces of a plate, the one
    /// that turns its lit side to the origin is the answer, and among equals the one of the smallest index.
    ///
    /// `None` where nothing is met, and for a ray without a direction or with coordinates that are not finite.
    #[must_use]
    pub fn closest(&self, origin: Vec3, direction: Vec3, t_max: f64) -> Option<Hit> {
        if t_max.is_nan() || t_max <= 0.0 {
            return None;
        }
        let length = direction.length();
        let span = t_max.min(self.frame.beyond(origin) / length);
        let probe = Probe::ray(origin, origin + direction * span, &self.frame)?;
        let beam = Beam::new(&probe, &self.frame)?;
        let nearest = self.nearest(&probe, &beam)?;
        let alike = nearest + self.tolerance() / (span * length);
        let patch = self.foremost(&probe, &beam, alike)?;
        let t = nearest * span;
        Some(Hit { patch: patch as usize, t, point: origin + direction * t })
    }

    /// Least fraction of the probe at which a facet is crossed.
    fn nearest(&self, probe: &Probe, beam: &Beam) -> Option<f64> {
        let mut least = f64::INFINITY;
        self.tree.nearest(beam, |run| {
            for facet in &self.facets[run] {
                if let Some(fraction) = self.crossing(facet, probe) {
                    least = least.min(fraction);
                }
            }
            least
        });
        least.is_finite().then_some(least)
    }

    /// Of the patches crossed up to a fraction of the probe, those that face its start, and of those the first.
    fn foremost(&self, probe: &Probe, beam: &Beam, alike: f64) -> Option<u32> {
        let mut best: Option<(bool, u32)> = None;
        let beam = beam.up_to(alike);
        self.tree.any(
            |node| beam.meets(node),
            |run| {
                let facets = self.facets[run].iter();
                let met =
                    facets.filter(|f| self.crossing(f, probe).is_some_and(|fraction| fraction <= alike));
                let ranked = met.map(|f| (f.height(probe.p) < 0.0, f.patch));
                best = best.into_iter().chain(ranked).min();
                false
            },
        );
        best.map(|(_, patch)| patch)
    }
}
