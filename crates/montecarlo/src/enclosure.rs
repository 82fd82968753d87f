//! The scene as a tracer sees it: flat patches that emit and reflect diffusely on their lit side.
//!
//! Irradiance at a point p of patch i: E(p) = ∫ κ(p, q) B(q) dA, κ = cosθ cosθ′ V/(π r²) (1/m²), B = M + ρ E. A ray with density cosθ/π from p
//! meets q with density κ(p, q) per area. A ray that ends on a back, or nowhere, brings nothing. Lengths in metres, exitance in W/m².

use crate::MonteCarloError;
use crate::density::{Cosine, DirectionDensity, Frame, LampDensity, SurfaceDensity};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use std::f64::consts::FRAC_1_PI;

/// A point of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// The patch.
    pub patch: usize,
    /// The point, m.
    pub point: Vec3,
}

/// Patches with their materials, ready to be traced.
#[derive(Clone, Debug)]
pub struct Enclosure {
    patches: Vec<Patch>,
    frames: Vec<Frame>,
    surfaces: Vec<SurfaceDensity>,
    occluders: Occluders,
    bands: usize,
    reflectance: Vec<f64>,
    exitance: Vec<f64>,
    exposed: Vec<f64>,
    survival: Vec<f64>,
    lamps: LampDensity,
}

impl Enclosure {
    /// Takes patches, and for each and every band reflectance and exitance (W/m²), patch-major.
    ///
    /// # Errors
    /// [`MonteCarloError::Length`] for vectors of other lengths, [`MonteCarloError::Range`] for a reflectance outside [0, 1) or an exitance that is
    /// negative or not finite, [`MonteCarloError::NoLight`], [`MonteCarloError::Visibility`].
    pub fn new(
        patches: Vec<Patch>,
        bands: usize,
        reflectance: Vec<f64>,
        exitance: Vec<f64>,
    ) -> Result<Self, MonteCarloError> {
        let values = patches.len() * bands;
        check("the reflectance", "[0, 1)", &reflectance, values, bands, |x| (0.0..1.0).contains(&x))?;
        check("the exitance", "[0, ∞)", &exitance, values, bands, |x| x >= 0.0 && x.is_finite())?;
        let mean = |row: &[f64]| row.iter().sum::<f64>() / bands as f64;
        let power: Vec<f64> = exitance
            .chunks(bands.max(1))
            .zip(&patches)
            .map(|(row, patch)| mean(row) * patch.area())
            .collect();
        let lamps = LampDensity::new(&patches, &power).ok_or(MonteCarloError::NoLight)?;
        let largest = |row: &[f64]| row.iter().copied().fold(0.0, f64::max);
        Ok(Self {
            frames: patches.iter().map(|patch| Frame::about(patch.normal())).collect(),
            surfaces: patches.iter().map(SurfaceDensity::new).collect(),
            occluders: Occluders::new(&patches)?,
            survival: reflectance.chunks(bands.max(1)).map(largest).collect(),
            exposed: vec![1.0; patches.len()],
            bands,
            reflectance,
            exitance,
            lamps,
            patches,
        })
    }

    /// The same with the exposed share of each patch, which patch-wise walks need: what is buried reflects nothing.
    ///
    /// # Errors
    /// [`MonteCarloError::Length`], [`MonteCarloError::Range`] for a share outside [0, 1].
    pub fn with_exposed(mut self, shares: Vec<f64>) -> Result<Self, MonteCarloError> {
        check("the exposed share", "[0, 1]", &shares, self.patches.len(), 1, |x| (0.0..=1.0).contains(&x))?;
        self.exposed = shares;
        Ok(self)
    }

    /// The patches.
    #[must_use]
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// Number of patches.
    #[must_use]
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there is no patch; such an enclosure cannot be made.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
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

    /// Largest reflectance of a patch over the bands: the probability to go on that keeps weights from growing.
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
        Site { patch, point: self.surfaces[patch].sample(numbers) }
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
        self.ray(from, Cosine.sample(numbers))
    }

    /// The lit side that a ray meets first; the direction is in the frame of the patch, its normal z.
    #[must_use]
    pub fn ray(&self, from: Site, direction: Vec3) -> Option<Site> {
        self.cast(from.point, self.frames[from.patch].world(direction))
    }

    /// Unit direction to a point, in the frame of the patch.
    #[must_use]
    pub fn direction(&self, from: Site, to: Vec3) -> Vec3 {
        self.frames[from.patch].local((to - from.point).normalize_or_zero())
    }

    /// The lit side that a ray from anywhere meets first.
    #[must_use]
    pub fn cast(&self, origin: Vec3, direction: Vec3) -> Option<Site> {
        let hit = self.occluders.closest(origin, direction, f64::INFINITY)?;
        let lit = self.patches[hit.patch].normal().dot(direction) < 0.0;
        lit.then_some(Site { patch: hit.patch, point: hit.point })
    }

    /// cosθ cosθ′/(π r²) between two sites that face each other, else 0; 1/m². Visibility is not asked.
    #[must_use]
    pub fn kernel(&self, p: Site, q: Site) -> f64 {
        let between = q.point - p.point;
        let square = between.length_squared();
        let out = self.patches[p.patch].normal().dot(between);
        let back = -self.patches[q.patch].normal().dot(between);
        if out > 0.0 && back > 0.0 { out * back * FRAC_1_PI / (square * square) } else { 0.0 }
    }

    /// Whether nothing lies between two sites.
    #[must_use]
    pub fn sees(&self, p: Site, q: Site) -> bool {
        self.occluders.unoccluded(p.point, q.point)
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
