//! The exposed part of patches that something stands on: where photons can arrive, m².
//!
//! A patch is cut into [`PARTS_A_SIDE`]² parts of equal area; one of which no ray out of a fixed bundle
//! meets a lit side or nothing is buried. Patches whose exposed share is 0 or 1 need no parts.

use crate::Enclosure;
use fredholm_mesh::Vec3;
use std::collections::BTreeMap;

/// Parts along a side.
const PARTS_A_SIDE: u32 = 32;

/// The exposed parts of a patch.
#[derive(Clone, Debug)]
pub(super) struct ExposedPart {
    middles: Vec<Vec3>,
    /// Area of each, m².
    each: f64,
}

impl ExposedPart {
    fn new(scene: &Enclosure, patch: usize) -> Self {
        let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(PARTS_A_SIDE);
        let sites = (0..PARTS_A_SIDE * PARTS_A_SIDE)
            .map(|k| scene.point(patch, [middle(k / PARTS_A_SIDE), middle(k % PARTS_A_SIDE)]));
        let middles = sites.filter(|&site| scene.is_exposed(site)).map(|site| site.point).collect();
        Self { middles, each: scene.patches()[patch].area() / f64::from(PARTS_A_SIDE * PARTS_A_SIDE) }
    }

    /// Exposed area, m².
    pub(super) fn area(&self) -> f64 {
        self.each * self.middles.len() as f64
    }

    /// Exposed area within `radius` of `centre`, m².
    pub(super) fn within(&self, centre: Vec3, radius: f64) -> f64 {
        let inside = self.middles.iter().filter(|middle| middle.distance_squared(centre) <= radius * radius);
        self.each * inside.count() as f64
    }
}

/// The patches that are neither wholly buried nor wholly exposed.
pub(super) fn partly_buried(scene: &Enclosure) -> BTreeMap<usize, ExposedPart> {
    let partly = |patch: &usize| (f64::MIN_POSITIVE..1.0).contains(&scene.exposed(*patch));
    (0..scene.len()).filter(partly).map(|patch| (patch, ExposedPart::new(scene, patch))).collect()
}
