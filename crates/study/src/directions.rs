//! What the points of a picture look at to gather their light.

use std::sync::Arc;

use fredholm_mesh::{Patch, Vec3};
use fredholm_montecarlo::points::{Key, PointSet, Samples};
use fredholm_montecarlo::{Site, Surfaces};
use fredholm_report::{DIRECTION_GROUPS, Gathering, Seen, Where};

use crate::problem::Problem;

/// Directions of a group where all is gathered, and where only what is uneven is. Powers of two are
/// where Sobol points are most even.
const EVERYWHERE: u32 = 128;
const WHERE_UNEVEN: u32 = 32;

/// Bytes of an element while rays look for it.
pub(crate) const BYTES_OF_A_MET_ELEMENT: u128 = 400;

/// Casts rays from points of elements.
pub(crate) struct Directions {
    surfaces: Surfaces,
    of_group: u32,
}

impl Directions {
    pub(crate) fn new(problem: &Problem, place: Where) -> Self {
        let patches: Vec<Patch> = problem.mesh.patches().copied().collect();
        let surfaces = Surfaces::blocked_by(Arc::clone(&problem.occluders), patches);
        let of_group = if place == Where::Everywhere { EVERYWHERE } else { WHERE_UNEVEN };
        Self { surfaces, of_group }
    }
}

impl Gathering for Directions {
    fn meet(&self, number: u32, leaf: usize, point: Vec3, met: &mut Vec<Seen>) {
        met.clear();
        let from = Site { patch: leaf, point };
        for group in 0..DIRECTION_GROUPS as u32 {
            let key = Key { seed: 0, batch: group, stream: number };
            let mut samples = Samples::new(PointSet::Sobol, key, self.of_group);
            met.extend((0..self.of_group).map(|sample| {
                let site = self.surfaces.bounce(from, samples.draw(sample).pair())?;
                Some((site.patch, site.point))
            }));
        }
    }

    fn onward(&self, number: u32, step: u32, from: &[(usize, Vec3)], met: &mut Vec<Seen>) {
        met.clear();
        // The points of a sequence that are taken one behind the other are even among themselves.
        let key = Key { seed: 0, batch: DIRECTION_GROUPS as u32 + step, stream: number };
        let mut samples = Samples::new(PointSet::Sobol, key, from.len() as u32);
        met.extend((0..).zip(from).map(|(sample, &(patch, point))| {
            let site = self.surfaces.bounce(Site { patch, point }, samples.draw(sample).pair())?;
            Some((site.patch, site.point))
        }));
    }
}
