//! One order e^{jnφ} of the waves in concentric layers.
//!
//! In a layer the longitudinal fields E_z and H_z are J_n(κρ) a + H_n⁽²⁾(κρ) b with two pairs of
//! amplitudes b = T a. What goes on through a border is E_z, η₀H_z, E_φ and η₀H_φ, with
//!
//! ```text
//! E_φ = n k_z/(κ²ρ) E_z + (jk₀/κ²) ∂η₀H_z/∂ρ,   η₀H_φ = n k_z/(κ²ρ) η₀H_z − (jεk₀/κ²) ∂E_z/∂ρ
//! ```
//!
//! so that u and u′ of both are known on its other side, and J H′ − J′ H = −2j/(πκρ) gives a and b
//! there: T = b a⁻¹. From the inner to the outer radius of a layer nothing grows, since the
//! exponentials are taken out of J and H (`bessel`): layers may be thick and lossy.

use super::bessel;
use crate::WaveError;
use num_complex::Complex64;
use std::f64::consts::FRAC_PI_2;

/// Two by two, by rows: of E_z and η₀H_z.
pub(super) type Matrix = [[Complex64; 2]; 2];

const ZERO: Matrix = [[Complex64::ZERO; 2]; 2];
const UNIT: Matrix = [[Complex64::ONE, Complex64::ZERO], [Complex64::ZERO, Complex64::ONE]];

/// A medium of a cylinder seen along z.
#[derive(Clone, Copy)]
pub(super) struct Filling {
    pub permittivity: Complex64,
    pub kappa: Complex64,
    pub kz: f64,
    pub k: f64,
}

impl Filling {
    /// κ with Im κ ≤ 0.
    pub fn new(permittivity: Complex64, k: f64, cosine: f64) -> Self {
        let kappa = (permittivity - cosine * cosine).sqrt() * k;
        let kappa = if kappa.im > 0.0 { -kappa } else { kappa };
        Self { permittivity, kappa, kz: k * cosine, k }
    }
}

/// The radial functions of a medium at a radius, without their exponentials.
pub(super) struct Radial {
    filling: Filling,
    radius: f64,
    pub regular: Vec<Complex64>,
    pub outgoing: Vec<Complex64>,
}

/// The fields of two independent waves at a radius: E_z, η₀H_z, E_φ and η₀H_φ, a column each.
pub(super) type Tangential = [[Complex64; 2]; 4];

impl Radial {
    /// At ρ > 0 up to the order `last`.
    pub fn new(filling: Filling, radius: f64, last: usize) -> Result<Self, WaveError> {
        let z = filling.kappa * radius;
        let (regular, outgoing) = (bessel::regular(z, last + 1)?, bessel::outgoing(z, last + 1)?);
        Ok(Self { filling, radius, regular, outgoing })
    }

    /// The derivative along ρ of a cylinder function of order |n|.
    fn slope(&self, values: &[Complex64], m: usize) -> Complex64 {
        values[m] * m as f64 / self.radius - self.filling.kappa * values[m + 1]
    }

    /// n k_z/(κ²ρ), jk₀/κ² and −jεk₀/κ².
    fn coupling(&self, n: i32) -> [Complex64; 3] {
        let Filling { permittivity, kappa, kz, k } = self.filling;
        let square = kappa * kappa;
        let turned = Complex64::new(0.0, k) / square;
        [f64::from(n) * kz / (square * self.radius), turned, -turned * permittivity]
    }

    /// Whether nothing within this radius is seen outside it in the order m, which is true where
    /// the functions leave the range of numbers.
    fn hidden(&self, m: usize) -> bool {
        self.regular[m].norm() == 0.0 || !self.outgoing[m + 1].is_finite()
    }

    /// The fields of the waves J + H T.
    fn tangential(&self, n: i32, t: &Matrix) -> Tangential {
        let m = n.unsigned_abs() as usize;
        let [mixed, of_h, of_e] = self.coupling(n);
        let of = |j: Complex64, h: Complex64| -> Matrix {
            // A wave that is not there has no infinite value either.
            let out = |t: Complex64| if t == Complex64::ZERO { t } else { h * t };
            [[j + out(t[0][0]), out(t[0][1])], [out(t[1][0]), j + out(t[1][1])]]
        };
        let [e, h] = of(self.regular[m], self.outgoing[m]);
        let [e_slope, h_slope] = of(self.slope(&self.regular, m), self.slope(&self.outgoing, m));
        let column = |i: usize| [mixed * e[i] + of_h * h_slope[i], mixed * h[i] + of_e * e_slope[i]];
        let [[e0, h0], [e1, h1]] = [column(0), column(1)];
        [e, h, [e0, e1], [h0, h1]]
    }

    /// Amplitudes a of J and b of H of the waves with these fields.
    fn amplitudes(&self, n: i32, field: &Tangential) -> [Matrix; 2] {
        let m = n.unsigned_abs() as usize;
        let [mixed, of_h, of_e] = self.coupling(n);
        let [j, h] = [self.regular[m], self.outgoing[m]];
        let [j_slope, h_slope] = [self.slope(&self.regular, m), self.slope(&self.outgoing, m)];
        // 1/(J H′ − J′ H); without the exponentials the product keeps e^{jRe κρ}.
        let turn = Complex64::cis(-self.filling.kappa.re * self.radius);
        let scale = turn * Complex64::new(0.0, self.radius * FRAC_PI_2);
        let (mut a, mut b) = (ZERO, ZERO);
        for i in 0..2 {
            let [e, magnetic, around_e, around_h] = field.map(|row| row[i]);
            let values =
                [(e, (around_h - mixed * magnetic) / of_e), (magnetic, (around_e - mixed * e) / of_h)];
            for (row, (u, slope)) in values.into_iter().enumerate() {
                a[row][i] = scale * (u * h_slope - slope * h);
                b[row][i] = scale * (slope * j - u * j_slope);
            }
        }
        [a, b]
    }
}

/// A layer between two radii; without an inner one it is the core.
pub(super) struct Shell {
    pub inner: Option<Radial>,
    pub outer: Radial,
}

impl Shell {
    /// What the exponentials of J lose from the outer radius to the inner one, and those of T from
    /// the inner to the outer one.
    fn falls(&self) -> [Complex64; 2] {
        let Some(inner) = &self.inner else { return [Complex64::ONE; 2] };
        let across = self.outer.filling.kappa * (self.outer.radius - inner.radius);
        [across.im.exp().into(), (across * -Complex64::I + across.im).exp()]
    }
}

/// What the order n is made of in a layer.
pub(super) struct Amplitudes {
    /// T at the inner radius.
    pub t: Matrix,
    /// a at the outer radius.
    pub a: [Complex64; 2],
}

/// The order n: b outside, and what is in the layers, from within, for waves J a from outside.
/// Without layers the conducting core is met at once.
pub(super) fn solve(
    n: i32,
    incident: [Complex64; 2],
    shells: &[Shell],
    outside: &Radial,
) -> ([Complex64; 2], Vec<Amplitudes>) {
    let m = n.unsigned_abs() as usize;
    // On the conductor H is free, and E is not.
    let mut field = [[Complex64::ZERO; 2], UNIT[0], [Complex64::ZERO; 2], UNIT[1]];
    let through = |radial: &Radial, field: &Tangential| {
        if radial.hidden(m) {
            return [ZERO, ZERO];
        }
        let [a, b] = radial.amplitudes(n, field);
        let inverse = inverse(&a);
        if inverse.as_flattened().iter().all(|value| value.is_finite()) {
            [inverse, product(&b, &inverse)]
        } else {
            // What is within is 0 to all digits.
            [ZERO, ZERO]
        }
    };
    let mut steps = Vec::with_capacity(shells.len());
    for shell in shells {
        let [inverse, t] = shell.inner.as_ref().map_or([ZERO, ZERO], |inner| through(inner, &field));
        let [inwards, outwards] = shell.falls();
        field = shell.outer.tangential(n, &t.map(|row| row.map(|value| value * outwards)));
        steps.push((inverse, t, inwards));
    }
    let [inverse, t] = through(outside, &field);
    // H itself, from H e^{jκρ}.
    let phase = (outside.filling.kappa * outside.radius * Complex64::I).exp();
    let scattered = applied(&t, incident).map(|b| b * phase);
    let mut a = applied(&inverse, incident);
    let mut layers = Vec::with_capacity(shells.len());
    for (inverse, t, inwards) in steps.into_iter().rev() {
        layers.push(Amplitudes { t, a });
        a = applied(&inverse, a.map(|value| value * inwards));
    }
    layers.reverse();
    (scattered, layers)
}

pub(super) fn applied(m: &Matrix, [x, y]: [Complex64; 2]) -> [Complex64; 2] {
    m.map(|[a, b]| a * x + b * y)
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|[x, y]| [x * b[0][0] + y * b[1][0], x * b[0][1] + y * b[1][1]])
}

fn inverse(&[[a, b], [c, d]]: &Matrix) -> Matrix {
    let scale = (a * d - b * c).inv();
    [[d * scale, -b * scale], [-c * scale, a * scale]]
}
