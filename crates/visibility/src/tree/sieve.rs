//! Which boxes of a node reach into all of some half-spaces?
//!
//! A box lies outside N·x ≥ c where even its corner farthest along N does. With the sizes of the
//! coordinates of N scaled to the sum 1 and coordinates in [−½, ½] the f32 value of N·x − c errs by
//! less than 3 ε, less than the padding of the boxes; where c is larger than 1 its sign is beyond
//! doubt.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use super::{Node, WIDTH};
use crate::eight::Eight;
use crate::shaft::{HalfSpace, MOST_PLANES};

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
    sides: [Side; MOST_PLANES],
    count: usize,
}

impl Sieve {
    pub(crate) fn new(planes: &[HalfSpace]) -> Self {
        let mut sieve = Self { sides: [Side::default(); MOST_PLANES], count: planes.len().min(MOST_PLANES) };
        for (side, plane) in sieve.sides.iter_mut().zip(planes) {
            *side = Side::new(plane);
        }
        sieve
    }

    /// Bit i is set where box i may reach into all the half-spaces.
    #[inline(always)]
    pub(crate) fn passes<E: Eight>(&self, eight: E, node: &Node) -> u32 {
        let mut inside = (1 << WIDTH) - 1;
        for side in &self.sides[..self.count] {
            inside &= side.reached(eight, node);
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

    #[inline(always)]
    fn reached<E: Eight>(&self, e: E, node: &Node) -> u32 {
        let ([a, b, c], [i, j, k]) = (self.normal, self.far.map(|side| side & 1));
        let [x, y, z] = &node.planes;
        let along = e.mul(e.load(&z[k]), e.splat(c));
        let along = e.mul_add(e.load(&y[j]), e.splat(b), along);
        let along = e.mul_add(e.load(&x[i]), e.splat(a), along);
        e.less(e.splat(self.offset), along)
    }
}
