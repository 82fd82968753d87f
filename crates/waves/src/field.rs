//! The electromagnetic field at a point: E (V/m) and H (A/m), peak phasors with time factor
//! e^{+jωt}.

use crate::ComplexVector;
use fredholm_mesh::Vec3;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, Sub};

/// E and H at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Field {
    /// Electric field, V/m.
    pub e: ComplexVector,
    /// Magnetic field, A/m.
    pub h: ComplexVector,
}

impl Field {
    /// No field.
    pub const ZERO: Self = Self { e: ComplexVector::ZERO, h: ComplexVector::ZERO };

    /// Mean power density ½ Re E × H*, W/m².
    #[must_use]
    pub fn power_density(&self) -> Vec3 {
        self.e.flow(self.h) * 0.5
    }

    /// Neither NaN nor infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.e.is_finite() && self.h.is_finite()
    }
}

impl Add for Field {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { e: self.e + other.e, h: self.h + other.h }
    }
}

impl AddAssign for Field {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Field {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { e: self.e - other.e, h: self.h - other.h }
    }
}

impl Mul<f64> for Field {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { e: self.e * factor, h: self.h * factor }
    }
}

impl Sum for Field {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::ZERO, Add::add)
    }
}
