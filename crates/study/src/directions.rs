//! What the points of a picture look at to gather their light.

use fredholm_mesh::{Patch, Vec3};
use fredholm_montecarlo::points::{Key, PointSet, Samples};
use fredholm_montecarlo::{Site, Surfaces};
use fredholm_report::{DIRECTION_GROUPS, Gathering, Seen};

use crate::error::Error;
use crate::problem::Problem;
use crate::stochastic::failure;

/// Directions of a group. Powers of two are where Sobol points are most even.
const DIRECTIONS: u32 = 64;

/// Bytes of an element while rays look for it.
pub(crate) const BYTES_OF_A_MET_ELEMENT: u128 = 400;

/// Casts rays from points of elements.
pub(crate) struct Directions {
    surfaces: Surfaces,
}

impl Directions {
    pub(crate) fn new(problem: &Problem) -> Result<Self, Error> {
        let patches: Vec<Patch> = problem.mesh.patches().copied().collect();
        let surfaces = Surfaces::blocked_by(problem.mesh.occluders(), patches);
        Ok(Self { surfaces: surfaces.map_err(failure)? })
    }
}

impl Gathering for Directions {
    fn meet(&self, number: u32, leaf: usize, point: Vec3, met: &mut Vec<Seen>) {
        met.clear();
        let from = Site { patch: leaf, point };
        for group in 0..DIRECTION_GROUPS as u32 {
            let key = Key { seed: 0, batch: group, stream: number };
            let mut samples = Samples::new(PointSet::Sobol, key, DIRECTIONS);
            met.extend((0..DIRECTIONS).map(|sample| {
                let site = self.surfaces.bounce(from, samples.draw(sample).pair())?;
                Some((site.patch, site.point))
            }));
        }
    }
}
