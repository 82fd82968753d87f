//! Complex vectors of space: a + j b with real vectors a and b.

use fredholm_mesh::Vec3;
use num_complex::Complex64;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A vector with three complex components, kept as real and imaginary part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ComplexVector {
    /// Real part.
    pub re: Vec3,
    /// Imaginary part.
    pub im: Vec3,
}

impl ComplexVector {
    /// 0.
    pub const ZERO: Self = Self { re: Vec3::ZERO, im: Vec3::ZERO };

    /// A real vector times a complex number.
    #[must_use]
    pub fn along(direction: Vec3, value: Complex64) -> Self {
        Self { re: direction * value.re, im: direction * value.im }
    }

    /// From three components.
    #[must_use]
    pub fn from_components([x, y, z]: [Complex64; 3]) -> Self {
        Self { re: Vec3::new(x.re, y.re, z.re), im: Vec3::new(x.im, y.im, z.im) }
    }

    /// The components x, y, z.
    #[must_use]
    pub fn components(self) -> [Complex64; 3] {
        [0, 1, 2].map(|c| Complex64::new(self.re[c], self.im[c]))
    }

    /// The bilinear product with a real vector (nothing is conjugated).
    #[must_use]
    pub fn dot(self, other: Vec3) -> Complex64 {
        Complex64::new(self.re.dot(other), self.im.dot(other))
    }

    /// `a` × self.
    #[must_use]
    pub fn crossed_by(self, a: Vec3) -> Self {
        Self { re: a.cross(self.re), im: a.cross(self.im) }
    }

    /// √(Σ |component|²).
    #[must_use]
    pub fn norm(self) -> f64 {
        self.norm_squared().sqrt()
    }

    /// Σ |component|².
    #[must_use]
    pub fn norm_squared(self) -> f64 {
        self.re.length_squared() + self.im.length_squared()
    }

    /// Conjugate of every component.
    #[must_use]
    pub fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// Real part of self × conj(other): twice the mean power density where these are E and H, W/m².
    #[must_use]
    pub fn flow(self, other: Self) -> Vec3 {
        self.re.cross(other.re) + self.im.cross(other.im)
    }

    /// Neither NaN nor infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

impl Add for ComplexVector {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl AddAssign for ComplexVector {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for ComplexVector {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Neg for ComplexVector {
    type Output = Self;

    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl Mul<f64> for ComplexVector {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
}

impl Mul<Complex64> for ComplexVector {
    type Output = Self;

    fn mul(self, factor: Complex64) -> Self {
        Self { re: self.re * factor.re - self.im * factor.im, im: self.re * factor.im + self.im * factor.re }
    }
}

impl Sum for ComplexVector {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::ZERO, Add::add)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_agree_with_those_of_the_components() {
        let v = ComplexVector { re: Vec3::new(1.0, -2.0, 0.5), im: Vec3::new(0.25, 3.0, -1.0) };
        let z = Complex64::new(0.75, -1.5);
        let product = v.components().map(|c| c * z);
        assert_eq!((v * z).components(), product);
        assert_eq!(ComplexVector::from_components(v.components()), v);
        let a = Vec3::new(2.0, 1.0, -3.0);
        let [x, y, zc] = v.components();
        assert_eq!(v.crossed_by(a).components()[0], zc * a.y - y * a.z);
        assert_eq!(v.dot(a), x * a.x + y * a.y + zc * a.z);
    }
}
