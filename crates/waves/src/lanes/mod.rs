//! Several numbers in one register: arithmetic written as for one.
//!
//! Kernels of surface integrals are written over [`Lanes`] once and compiled for every instruction
//! set by `pulp`. Every operation rounds once, as it does in one lane alone, so that no result
//! depends on the width of the registers.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

mod decay;
mod phase;

pub use decay::{decay, halvings};
pub use phase::cos_sin;

use pulp::Simd;
use std::ops::{Add, Mul, Neg, Sub};

/// A register of f64 of the instruction set S.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// The same number in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// One number a lane; `values` has as many as there are lanes.
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, values: &[f64]) -> Self {
        Self { simd, value: simd.partial_load_f64s(values) }
    }

    /// One number a lane: register `at` of those that `values` fills, whole ones only.
    ///
    /// # Panics
    /// There is no such register.
    #[inline(always)]
    #[must_use]
    pub fn register(simd: S, values: &[f64], at: usize) -> Self {
        Self { simd, value: S::as_simd_f64s(values).0[at] }
    }

    /// Writes one number a lane.
    #[inline(always)]
    pub fn store(self, values: &mut [f64]) {
        self.simd.partial_store_f64s(values, self.value);
    }

    /// The instruction set.
    #[inline(always)]
    #[must_use]
    pub fn simd(self) -> S {
        self.simd
    }

    /// The same number in all lanes, of the same instruction set.
    #[inline(always)]
    #[must_use]
    pub fn constant(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// self · b + c, rounded once.
    #[inline(always)]
    #[must_use]
    pub fn mul_add(self, b: Self, c: Self) -> Self {
        Self { simd: self.simd, value: self.simd.mul_add_f64s(self.value, b.value, c.value) }
    }

    /// √.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self { simd: self.simd, value: self.simd.sqrt_f64s(self.value) }
    }

    /// 1/self.
    #[inline(always)]
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { simd: self.simd, value: self.simd.div_f64s(self.simd.splat_f64s(1.0), self.value) }
    }

    /// |self|. (`Simd::abs_f64s` and `Simd::select_f64s` stay calls of their own, compiled for narrow vectors.)
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.max(-self)
    }

    /// The larger of two.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.max_f64s(self.value, other.value) }
    }

    /// The smaller of two.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.min_f64s(self.value, other.value) }
    }

    /// 1 in the lanes where self > 0, else 0. Positive numbers below 1e-200 count as something
    /// between.
    #[inline(always)]
    #[must_use]
    pub fn step(self) -> Self {
        (self * self.constant(1e200)).max(self.constant(0.0)).min(self.constant(1.0))
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.add_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.sub_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.mul_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { simd: self.simd, value: self.simd.neg_f64s(self.value) }
    }
}
