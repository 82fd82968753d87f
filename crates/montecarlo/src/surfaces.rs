//! What rays meet first: the lit sides of patches.
//!
//! A ray that ends on a back, or nowhere, meets nothing. Metres.

use crate::MonteCarloError;
use crate::density::{Cosine, DirectionDensity, Frame};
use crate::locator::Locator;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use std::collections::HashMap;
use std::sync::Arc;

/// A point of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// The patch.
    pub patch: usize,
    /// The point, m.
    pub point: Vec3,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meets {
    /// The lit side of a patch.
    Lit(Site),
    /// A back.
    Back,
    /// Nothing: it leaves the scene.
    Nothing,
}

impl Meets {
    /// The lit side, where one is met.
    #[must_use]
    pub fn lit(self) -> Option<Site> {
        if let Self::Lit(site) = self { Some(site) } else { None }
    }
}

/// Patches that rays are cast at.
#[derive(Clone, Debug)]
pub struct Surfaces {
    patches: Vec<Patch>,
    /// One of every direction that a patch is turned to.
    frames: Vec<Frame>,
    frame_of: Vec<u32>,
    occluders: Arc<Occluders>,
    locator: Option<Locator>,
}

impl Surfaces {
    /// Takes patches, which rays are traced against.
    ///
    /// # Errors
    /// [`MonteCarloError::Visibility`].
    pub fn new(patches: Vec<Patch>) -> Result<Self, MonteCarloError> {
        let occluders = Arc::new(Occluders::new(&patches)?);
        Ok(Self::of(patches, occluders, None))
    }

    /// Takes patches, and pieces that rays are traced against instead, which together they must
    /// cover: as few as possible, as a mesh has them.
    #[must_use]
    pub fn blocked_by(pieces: Arc<Occluders>, patches: Vec<Patch>) -> Self {
        let locator = Locator::new(pieces.patches(), &patches);
        Self::of(patches, pieces, Some(locator))
    }

    fn of(patches: Vec<Patch>, occluders: Arc<Occluders>, locator: Option<Locator>) -> Self {
        let (frames, frame_of) = frames(&patches);
        Self { patches, frames, frame_of, occluders, locator }
    }

    /// The patches.
    #[must_use]
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// What rays are cast at.
    pub(crate) fn occluders(&self) -> &Occluders {
        &self.occluders
    }

    /// The frame of a patch, its normal z.
    pub(crate) fn frame(&self, patch: usize) -> &Frame {
        &self.frames[self.frame_of[patch] as usize]
    }

    /// The lit side that a ray with density cosθ/π meets first.
    #[must_use]
    pub fn bounce(&self, from: Site, numbers: [f64; 2]) -> Option<Site> {
        self.cast(from.point, self.frame(from.patch).world(Cosine.sample(numbers)))
    }

    /// What a ray with density cosθ/π meets first.
    #[must_use]
    pub fn bounce_to(&self, from: Site, numbers: [f64; 2]) -> Meets {
        self.meets(from.point, self.frame(from.patch).world(Cosine.sample(numbers)))
    }

    /// The lit side that a ray from anywhere meets first.
    #[must_use]
    pub fn cast(&self, origin: Vec3, direction: Vec3) -> Option<Site> {
        self.meets(origin, direction).lit()
    }

    /// What a ray from anywhere meets first.
    #[must_use]
    pub fn meets(&self, origin: Vec3, direction: Vec3) -> Meets {
        let Some(hit) = self.occluders.closest(origin, direction, f64::INFINITY) else {
            return Meets::Nothing;
        };
        let patch = match &self.locator {
            Some(locator) => locator.lit(hit.patch, hit.point, hit.is_lit, &self.patches),
            None => hit.is_lit.then_some(hit.patch),
        };
        patch.map_or(Meets::Back, |patch| Meets::Lit(Site { patch, point: hit.point }))
    }
}

/// The frames of all normals, and which one each patch has: a few for a room, which stay near at
/// hand where one of each patch would not.
fn frames(patches: &[Patch]) -> (Vec<Frame>, Vec<u32>) {
    let (mut frames, mut known) = (Vec::new(), HashMap::new());
    let frame_of = patches.iter().map(|patch| {
        let normal = patch.normal();
        *known.entry(normal.to_array().map(f64::to_bits)).or_insert_with(|| {
            frames.push(Frame::about(normal));
            frames.len() as u32 - 1
        })
    });
    let frame_of = frame_of.collect();
    (frames, frame_of)
}
