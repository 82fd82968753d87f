//! Blocks of eight things of one kind (pairs, points, edges, segments): one lane each, every
//! quantity an array over the lanes.
//!
//! Loops run over lanes with additions, multiplications, divisions and roots only, never fused, so
//! that a result has the same bits whatever the width of the machine's vectors and whatever stands
//! beside it.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

use fredholm_mesh::Vec3;

/// Lanes of a block.
pub(crate) const LANES: usize = 8;

/// One number a lane.
pub(crate) type Lanes = [f64; LANES];

/// One vector a lane, by components.
pub(crate) type Lanes3 = [Lanes; 3];

/// The value of every lane.
#[inline(always)]
pub(crate) fn each(mut value: impl FnMut(usize) -> f64) -> Lanes {
    // `array::from_fn` stays a call of its own, compiled without the wide vectors.
    let mut lanes = [0.0; LANES];
    for (m, lane) in lanes.iter_mut().enumerate() {
        *lane = value(m);
    }
    lanes
}

/// The patches on one side of a block.
pub(super) enum Places {
    /// The same patch in every lane.
    Same(usize),
    /// Consecutive patches from this one on.
    Run(usize),
    /// Any patches.
    Any([u32; LANES]),
}

impl Places {
    /// The patches of `ids`; `length` is the number of patches there are.
    #[inline(always)]
    pub(super) fn new(ids: [u32; LANES]) -> Self {
        let first = ids[0];
        if ids.iter().all(|&id| id == first) {
            Self::Same(first as usize)
        } else if ids.iter().zip(0..).all(|(&id, k)| id == first.wrapping_add(k)) {
            Self::Run(first as usize)
        } else {
            Self::Any(ids)
        }
    }

    /// The values of a field at these patches.
    #[inline(always)]
    pub(super) fn of(&self, field: &[f64]) -> Lanes {
        match self {
            Self::Same(id) => [field[*id]; LANES],
            Self::Run(first) => {
                let run = &field[*first..*first + LANES];
                each(|m| run[m])
            }
            Self::Any(ids) => each(|m| field[ids[m] as usize]),
        }
    }

    /// The values of the three components of a field.
    #[inline(always)]
    pub(super) fn vectors(&self, field: &[Vec<f64>; 3]) -> Lanes3 {
        [self.of(&field[0]), self.of(&field[1]), self.of(&field[2])]
    }
}

/// a·b in every lane.
#[inline(always)]
pub(super) fn dot(a: &Lanes3, b: &Lanes3) -> Lanes {
    each(|m| a[0][m] * b[0][m] + a[1][m] * b[1][m] + a[2][m] * b[2][m])
}

/// a − b in every lane.
#[inline(always)]
pub(super) fn difference(a: &Lanes3, b: &Lanes3) -> Lanes3 {
    [each(|m| a[0][m] - b[0][m]), each(|m| a[1][m] - b[1][m]), each(|m| a[2][m] - b[2][m])]
}

/// a + b in every lane.
#[inline(always)]
pub(super) fn sum(a: &Lanes3, b: &Lanes3) -> Lanes3 {
    [each(|m| a[0][m] + b[0][m]), each(|m| a[1][m] + b[1][m]), each(|m| a[2][m] + b[2][m])]
}

/// a × b in every lane.
#[inline(always)]
pub(super) fn cross(a: &Lanes3, b: &Lanes3) -> Lanes3 {
    [
        each(|m| a[1][m] * b[2][m] - b[1][m] * a[2][m]),
        each(|m| a[2][m] * b[0][m] - b[2][m] * a[0][m]),
        each(|m| a[0][m] * b[1][m] - b[0][m] * a[1][m]),
    ]
}

/// A vector in every lane.
#[inline(always)]
pub(crate) fn same(v: Vec3) -> Lanes3 {
    [[v.x; LANES], [v.y; LANES], [v.z; LANES]]
}

/// Heights n·x − c of points.
#[inline(always)]
pub(crate) fn heights(n: &Lanes3, c: &Lanes, x: &Lanes3) -> Lanes {
    let over = dot(n, x);
    each(|m| over[m] - c[m])
}

/// A yes (all bits) or no (none) a lane.
pub(crate) type Mask = [u64; LANES];

/// The answer of every lane.
#[inline(always)]
pub(crate) fn ask(mut answer: impl FnMut(usize) -> bool) -> Mask {
    let mut mask = [0; LANES];
    for (m, lane) in mask.iter_mut().enumerate() {
        *lane = if answer(m) { u64::MAX } else { 0 };
    }
    mask
}

/// Whether any lane says yes.
#[inline(always)]
pub(crate) fn any(mask: &Mask) -> bool {
    let mut all = 0;
    for lane in mask {
        all |= lane;
    }
    all != 0
}

/// The least and the largest number of any lane.
#[inline(always)]
pub(crate) fn range(lanes: &Lanes) -> [f64; 2] {
    let (mut low, mut high) = (*lanes, *lanes);
    // Halves against halves: one after the other takes as many steps as there are lanes.
    for half in [LANES / 2, LANES / 4, LANES / 8] {
        for m in 0..half {
            low[m] = if low[m + half] < low[m] { low[m + half] } else { low[m] };
            high[m] = if high[m + half] > high[m] { high[m + half] } else { high[m] };
        }
    }
    [low[0], high[0]]
}

/// The number where the mask says yes, and 0 elsewhere.
#[inline(always)]
pub(super) fn only(mask: &Mask, number: &Lanes) -> Lanes {
    each(|m| f64::from_bits(number[m].to_bits() & mask[m]))
}
