//! The scene as a tracer sees it: flat patches that emit and reflect diffusely on their lit side.
//!
//! Irradiance at a point p of patch i: E(p) = ∫ κ(p, q) B(q) dA, κ = cosθ cosθ′ V/(π r²) (1/m²), B
//! = M + ρ E. A ray with density cosθ/π from p meets q with density κ(p, q) per area. A ray that
//! ends on a back, or nowhere, brings nothing. Lengths in metres, exitance in W/m².

use crate::MonteCarloError;
use crate::density::{Cosine, DirectionDensity, LampDensity, SurfaceDensity};
use crate::surfaces::{Meets, Site, Surfaces};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::FRAC_1_PI;

/// Rays of a bundle: rings by the cosine density, and rays in each.
const BUNDLE: [u32; 2] = [3, 5];

/// Patches with their materials, ready to be traced.
#[derive(Clone, Debug)]
pub struct Enclosure {
    surfaces: Surfaces,
    densities: Vec<SurfaceDensity>,
    bands: usize,
    reflectance: Vec<f64>,
    exitance: Vec<f64>,
    exposed: Vec<f64>,
    survival: Vec<f64>,
    lamps: LampDensity,
}

impl Enclosure {
    /// Takes patches, and for each and every band reflectance and exitance (W/m²), patch-major. Rays
    /// are traced against the patches.
    ///
    /// # Errors
    /// [`MonteCarloError::Length`] for vectors of other lengths, [`MonteCarloError::Range`] for a
    /// reflectance outside [0, 1) or an exitance that is negative or not finite,
    /// [`MonteCarloError::NoLight`], [`MonteCarloError::Visibility`].
    pub fn new(
        patches: Vec<Patch>,
        bands: usize,
        reflectance: Vec<f64>,
        exitance: Vec<f64>,
    ) -> Result<Self, MonteCarloError> {
        Self::of(Surfaces::new(patches)?, bands, reflectance, exitance)
    }

    /// The same of surfaces that know what rays are traced against.
    ///
    /// # Errors
    /// As of [`Enclosure::new`].
    pub fn of(
        surfaces: Surfaces,
        bands: usize,
        reflectance: Vec<f64>,
        exitance: Vec<f64>,
    ) -> Result<Self, MonteCarloError> {
        let patches = surfaces.patches();
        let values = patches.len() * bands;
        check("the reflectance", "[0, 1)", &reflectance, values, bands, |x| (0.0..1.0).contains(&x))?;
        check("the exitance", "[0, ∞)", &exitance, values, bands, |x| x >= 0.0 && x.is_finite())?;
        let mean = |row: &[f64]| row.iter().sum::<f64>() / bands as f64;
        let power: Vec<f64> =
            exitance.chunks(bands.max(1)).zip(patches).map(|(row, patch)| mean(row) * patch.area()).collect();
        let lamps = LampDensity::new(patches, &power).ok_or(MonteCarloError::NoLight)?;
        let largest = |row: &[f64]| row.iter().copied().fold(0.0, f64::max);
        Ok(Self {
            densities: patches.iter().map(SurfaceDensity::new).collect(),
            survival: reflectance.chunks(bands.max(1)).map(largest).collect(),
            exposed: vec![1.0; patches.len()],
            bands,
            reflectance,
            exitance,
            lamps,
            surfaces,
        })
    }

    /// The same with the exposed share of each patch, which patch-wise walks need: what is buried
    /// reflects nothing.
    ///
    /// # Errors
    /// [`MonteCarloError::Length`], [`MonteCarloError::Range`] for a share outside [0, 1].
    pub fn with_exposed(mut self, shares: Vec<f64>) -> Result<Self, MonteCarloError> {
        check("the exposed share", "[0, 1]", &shares, self.len(), 1, |x| (0.0..=1.0).contains(&x))?;
        self.exposed = shares;
        Ok(self)
    }

    /// The patches.
    #[must_use]
    pub fn patches(&self) -> &[Patch] {
        self.surfaces.patches()
    }

    /// Number of patches.
    #[must_use]
    pub fn len(&self) -> usize {
        self.patches().len()
    }

    /// Whether there is no patch; such an enclosure cannot be made.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.patches().is_empty()
    }

    /// Number of bands.
    #[must_use]
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// Reflectances of a patch, one a band.
    #[must_use]
    pub fn reflectance(&self, patch: usize) -> &[f64] {
        &self.reflectance[patch * self.bands..(patch + 1) * self.bands]
    }

    /// Exitances of a patch, one a band, W/m².
    #[must_use]
    pub fn exitance(&self, patch: usize) -> &[f64] {
        &self.exitance[patch * self.bands..(patch + 1) * self.bands]
    }

    /// Exposed share of a patch.
    #[must_use]
    pub fn exposed(&self, patch: usize) -> f64 {
        self.exposed[patch]
    }

    /// Largest reflectance of a patch over the bands: the probability to go on that keeps weights
    /// from growing.
    #[must_use]
    pub fn survival(&self, patch: usize) -> f64 {
        self.survival[patch]
    }

    /// The lamps.
    #[must_use]
    pub fn lamps(&self) -> &LampDensity {
        &self.lamps
    }

    /// The even point of a patch.
    #[must_use]
    pub fn point(&self, patch: usize, numbers: [f64; 2]) -> Site {
        Site { patch, point: self.densities[patch].sample(numbers) }
    }

    /// A point of a lamp, in proportion to exitance.
    #[must_use]
    pub fn lamp(&self, numbers: [f64; 2]) -> Site {
        let (patch, point) = self.lamps.sample(numbers);
        Site { patch, point }
    }

    /// The lit side that a ray with density cosθ/π meets first.
    #[must_use]
    pub fn bounce(&self, from: Site, numbers: [f64; 2]) -> Option<Site> {
        self.surfaces.bounce(from, numbers)
    }

    /// What a ray with density cosθ/π meets first.
    #[must_use]
    pub fn bounce_to(&self, from: Site, numbers: [f64; 2]) -> Meets {
        self.surfaces.bounce_to(from, numbers)
    }

    /// The lit side that a ray meets first; the direction is in the frame of the patch, its normal
    /// z.
    #[must_use]
    pub fn ray(&self, from: Site, direction: Vec3) -> Option<Site> {
        self.cast(from.point, self.world(from, direction))
    }

    /// A direction of the frame of a patch, in the axes of the scene.
    #[must_use]
    pub fn world(&self, at: Site, direction: Vec3) -> Vec3 {
        self.surfaces.frame(at.patch).world(direction)
    }

    /// Unit direction to a point, in the frame of the patch.
    #[must_use]
    pub fn direction(&self, from: Site, to: Vec3) -> Vec3 {
        self.surfaces.frame(from.patch).local((to - from.point).normalize_or_zero())
    }

    /// The lit side that a ray from anywhere meets first.
    #[must_use]
    pub fn cast(&self, origin: Vec3, direction: Vec3) -> Option<Site> {
        self.surfaces.cast(origin, direction)
    }

    /// Whether a ray of this direction, in the frame of the patch, meets a lit side or nothing:
    /// under what stands on a patch no ray does.
    #[must_use]
    pub fn opens(&self, from: Site, direction: Vec3) -> bool {
        let world = self.world(from, direction);
        self.surfaces.meets(from.point, world) != Meets::Back
    }

    /// Whether a ray of a fixed bundle from a site meets a lit side or nothing: it is not buried.
    #[must_use]
    pub fn is_exposed(&self, site: Site) -> bool {
        let [rings, rays] = BUNDLE;
        let direction = |k: u32| {
            let (ring, ray) = (f64::from(k / rays), f64::from(k % rays));
            Cosine
                .sample([(ring + 0.5) / f64::from(rings), (ray + ring / f64::from(rings)) / f64::from(rays)])
        };
        (0..rings * rays).any(|k| self.opens(site, direction(k)))
    }

    /// Share of an n × n grid of points of a patch that are not buried, in [0, 1].
    #[must_use]
    pub fn share_exposed(&self, patch: usize, n: u32) -> f64 {
        let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let exposed = |k: &u32| self.is_exposed(self.point(patch, [middle(k / n), middle(k % n)]));
        (0..n * n).filter(exposed).count() as f64 / f64::from(n * n)
    }

    /// cosθ cosθ′/(π r²) between two sites that face each other, else 0; 1/m². Visibility is not
    /// asked.
    #[must_use]
    pub fn kernel(&self, p: Site, q: Site) -> f64 {
        let between = q.point - p.point;
        let square = between.length_squared();
        let out = self.patches()[p.patch].normal().dot(between);
        let back = -self.patches()[q.patch].normal().dot(between);
        if out > 0.0 && back > 0.0 { out * back * FRAC_1_PI / (square * square) } else { 0.0 }
    }

    /// Whether nothing lies between two sites.
    #[must_use]
    pub fn sees(&self, p: Site, q: Site) -> bool {
        self.surfaces.occluders().unoccluded(p.point, q.point)
    }
}

fn check(
    what: &'static str,
    range: &'static str,
    values: &[f64],
    expected: usize,
    bands: usize,
    valid: impl Fn(f64) -> bool,
) -> Result<(), MonteCarloError> {
    if values.len() != expected {
        return Err(MonteCarloError::Length { what, expected, found: values.len() });
    }
    match values.iter().position(|&value| !valid(value)) {
        Some(at) => Err(MonteCarloError::Range { what, patch: at / bands, value: values[at], range }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{Key, PointSet, Samples};
    use fredholm_mesh::{Cutting, Lines, MeshBuilder, Shape};
    use fredholm_visibility::Occluders;
    use std::sync::Arc;

    /// Rays against the undivided pieces find what rays against the patches find.
    #[test]
    fn few_pieces_answer_like_many_patches() {
        let mut builder = MeshBuilder::default();
        let shapes = [
            (Shape::Box { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 1.5), inward: true }, 5),
            (Shape::Box { min: Vec3::splat(0.3), max: Vec3::splat(0.6), inward: false }, 3),
            (Shape::Sphere { centre: Vec3::new(0.5, 1.5, 0.7), radius: 0.2, inward: false, segments: 7 }, 1),
        ];
        for (surface, (shape, n)) in shapes.iter().enumerate() {
            builder.surface("s", surface);
            let lines = if *n > 1 { Lines::Counts { u: *n, v: *n } } else { Lines::Whole };
            builder.add(shape, &Cutting { lines, ..Cutting::default() }).unwrap();
        }
        let mesh = builder.build();
        let patches: Vec<Patch> = mesh.patches().copied().collect();
        let n = patches.len();
        assert!(mesh.occluders().len() < n);
        let pieces = Arc::new(Occluders::new(mesh.occluders()).unwrap());
        let surfaces = Surfaces::blocked_by(pieces, patches.clone());
        let coarse = Enclosure::of(surfaces, 1, vec![0.5; n], vec![1.0; n]).unwrap();
        let fine = Enclosure::new(patches, 1, vec![0.5; n], vec![1.0; n]).unwrap();
        let mut samples = Samples::new(PointSet::Independent, Key { seed: 3, batch: 0, stream: 0 }, 4000);
        for sample in 0..4000 {
            let mut draw = samples.draw(sample);
            let at = fine.point(sample as usize % n, draw.pair());
            let numbers = draw.pair();
            let [a, b] = [&fine, &coarse].map(|scene| scene.bounce(at, numbers));
            assert_eq!(a.map(|site| site.patch), b.map(|site| site.patch), "{sample}");
            assert!(a.zip(b).is_none_or(|(a, b)| a.point.distance(b.point) < 1e-9));
        }
    }
}
