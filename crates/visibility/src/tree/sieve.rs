//! Which boxes of a node reach into all of some half-spaces?
//!
//! A box lies outside N·x ≥ c where even its corner farthest along N does. With the sizes of the coordinates of N scaled
//! to the sum 1 and coordinates in [−½, ½] the f32 value of N·x − c errs by less than 3 ε, less than the padding of the
//! boxes; where c is larger than 1 its sign is beyond doubt.

use glam::Vec4;

use super::{Node, VECTORS, WIDTH};
use crate::shaft::{HalfSpace, PLANES};

/// A half-space in the coordinates of the boxes.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    normal: [f32; 3],
    offset: f32,
    /// Of the six planes of a box, the three of the corner farthest along the normal.
    far: [usize; 3],
}

/// Half-spaces in the coordinates of the boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sieve {
    sides: [Side; PLANES],
    count: usize,
}

impl Sieve {
    pub(crate) fn new(planes: &[HalfSpace]) -> Self {
        let mut sieve = Self { sides: [Side::default(); PLANES], count: planes.len().min(PLANES) };
        for (side, plane) in sieve.sides.iter_mut().zip(planes) {
            *side = Side::new(plane);
        }
        sieve
    }

    /// Bit i is set where box i may reach into all the half-spaces.
    #[inline]
    pub(crate) fn passes(&self, node: &Node) -> u32 {
        let mut inside = (1 << WIDTH) - 1;
        for side in &self.sides[..self.count] {
            inside &= side.reached(node);
            if inside == 0 {
                break;
            }
        }
        inside
    }
}

impl Side {
    fn new(plane: &HalfSpace) -> Self {
        let scale = 1.0 / plane.size();
        let normal = (plane.normal * scale).as_vec3().to_array();
        let far = normal.map(|c| usize::from(c > 0.0));
        Self { normal, offset: (plane.offset * scale) as f32, far }
    }

    #[inline]
    fn reached(&self, node: &Node) -> u32 {
        let mut reached = 0;
        for i in 0..VECTORS {
            let [x, y, z] = [0, 1, 2].map(|axis| node.planes[axis][self.far[axis] & 1][i]);
            let along = x * self.normal[0] + y * self.normal[1] + z * self.normal[2];
            reached |= along.cmpgt(Vec4::splat(self.offset)).bitmask() << (4 * i);
        }
        reached
    }
}
