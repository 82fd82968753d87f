//! A perfectly conducting plane without end under everything, by exact images.
//!
//! With S the mirror image in the plane z = h, a field E(p), H(p) of currents above it has the image
//! −S E(S p), S H(S p): both together have no tangential E and no normal H on the plane, and are the
//! field above it. Image currents are −S J and S M (C. A. Balanis, Advanced Engineering
//! Electromagnetics, 2nd ed., Wiley 2012, § 7.4).

use crate::source::PlaneWave;
use crate::{ComplexVector, Field, Origin, Source, Wave, WaveError};
use fredholm_mesh::Vec3;
use num_complex::Complex64;

/// The plane z = height (m); everything is above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    height: f64,
}

impl Ground {
    /// The plane of this height, m.
    ///
    /// # Errors
    /// [`WaveError::NotFinite`] unless the height is finite.
    pub fn new(height: f64) -> Result<Self, WaveError> {
        if height.is_finite() {
            return Ok(Self { height });
        }
        Err(WaveError::NotFinite { what: "the height of the ground" })
    }

    /// z of the plane, m.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// The mirror image of a point, m.
    #[must_use]
    pub fn image(&self, p: Vec3) -> Vec3 {
        // As a difference of differences, a point on the plane is its own image to the bit.
        Vec3::new(p.x, p.y, self.height - (p.z - self.height))
    }

    /// The field of the image at a point, from that of the original at the image of the point.
    #[must_use]
    pub fn field_of_image(&self, original: Field) -> Field {
        Field { e: turned(original.e) * -1.0, h: turned(original.h) }
    }

    /// The field above the plane at a point (m), from that without the plane at any point.
    pub fn field(&self, p: Vec3, bare: impl Fn(Vec3) -> Field) -> Field {
        bare(p) + self.field_of_image(bare(self.image(p)))
    }

    /// The far amplitude F (V) above the plane in the direction of the unit vector u, from that
    /// without the plane in any direction.
    pub fn far(&self, wave: &Wave, u: Vec3, bare: impl Fn(Vec3) -> ComplexVector) -> ComplexVector {
        let phase = Complex64::cis(2.0 * wave.wavenumber() * self.height * u.z);
        bare(u) + turned(bare(mirrored(u))) * -phase
    }

    /// The plane wave that the plane sends back.
    ///
    /// # Errors
    /// None that the wave did not have.
    pub fn reflected(&self, wave: &Wave, source: &PlaneWave) -> Result<PlaneWave, WaveError> {
        let phase = Complex64::cis(-2.0 * wave.wavenumber() * self.height * source.travel().z);
        PlaneWave::new(
            mirrored(source.travel()),
            -mirrored(source.polarisation()),
            source.amplitude() * phase,
        )
    }
}

/// The mirror image of a direction.
fn mirrored(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, -v.z)
}

fn turned(v: ComplexVector) -> ComplexVector {
    let [x, y, z] = v.components();
    ComplexVector::from_components([x, y, -z])
}

/// A source above a ground plane: its field is that with the plane, and without anything else.
pub struct Grounded {
    source: Box<dyn Source>,
    ground: Ground,
}

impl Grounded {
    /// The source and the plane under it.
    #[must_use]
    pub fn new(source: Box<dyn Source>, ground: Ground) -> Self {
        Self { source, ground }
    }
}

impl Source for Grounded {
    fn field(&self, wave: &Wave, p: Vec3) -> Field {
        self.ground.field(p, |p| self.source.field(wave, p))
    }

    fn origin(&self) -> Origin {
        self.source.origin()
    }

    fn wire(&self, wave: &Wave) -> Option<[Vec3; 2]> {
        self.source.wire(wave)
    }

    fn far_amplitude(&self, wave: &Wave, u: Vec3) -> Option<ComplexVector> {
        // All directions have an amplitude, or none.
        self.source.far_amplitude(wave, u)?;
        let bare = |u: Vec3| self.source.far_amplitude(wave, u).unwrap_or(ComplexVector::ZERO);
        Some(self.ground.far(wave, u, bare))
    }

    /// Against its own image, too.
    fn supplied(&self, wave: &Wave, other: &dyn Fn(Vec3) -> ComplexVector) -> Option<f64> {
        let image = |p: Vec3| self.ground.field_of_image(self.source.field(wave, self.ground.image(p))).e;
        self.source.supplied(wave, &|p| other(p) + image(p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{HalfWaveDipole, HertzianDipole};
    use crate::{radiated, sphere_rule};

    fn wave() -> Wave {
        Wave::new(1e9).unwrap()
    }

    fn dipole(height: f64, axis: Vec3) -> HertzianDipole {
        HertzianDipole::new(Vec3::new(0.1, -0.2, height), axis, Complex64::new(0.3, 0.4)).unwrap()
    }

    #[test]
    fn on_the_plane_e_is_normal_and_h_along_it() {
        let ground = Ground::new(-0.3).unwrap();
        let sources: [Box<dyn Source>; 3] = [
            Box::new(dipole(0.1, Vec3::new(0.3, 0.5, 0.7))),
            Box::new(HalfWaveDipole::new(Vec3::Z * 0.2, Vec3::new(1.0, 0.0, 0.4), Complex64::ONE).unwrap()),
            Box::new(PlaneWave::new(Vec3::new(1.0, 0.4, -0.7), Vec3::Y, Complex64::I).unwrap()),
        ];
        for source in sources {
            let grounded = Grounded::new(source, ground);
            for p in [Vec3::new(0.2, 0.1, -0.3), Vec3::new(-2.0, 5.0, -0.3)] {
                let field = grounded.field(&wave(), p);
                let ([ex, ey, ez], [_, _, hz]) = (field.e.components(), field.h.components());
                assert!(ex.norm() + ey.norm() < 1e-12 * ez.norm() && hz.norm() < 1e-12 * field.h.norm());
            }
        }
    }

    #[test]
    fn a_reflected_plane_wave_is_the_image() {
        let ground = Ground::new(0.7).unwrap();
        let source = PlaneWave::new(Vec3::new(1.0, 0.4, -0.7), Vec3::Y, Complex64::new(0.2, 2.0)).unwrap();
        let reflected = ground.reflected(&wave(), &source).unwrap();
        let p = Vec3::new(0.3, 1.0, 2.0);
        let both = source.field(&wave(), p) + reflected.field(&wave(), p);
        let image = Grounded::new(Box::new(source), ground).field(&wave(), p);
        assert!((both.e - image.e).norm() < 1e-12 && (both.h - image.h).norm() < 1e-14);
    }

    #[test]
    fn the_far_field_is_the_limit_of_the_field() {
        let ground = Ground::new(0.4).unwrap();
        let grounded = Grounded::new(Box::new(dipole(0.9, Vec3::new(0.3, 0.5, 0.7))), ground);
        let (u, r) = (Vec3::new(0.48, 0.64, 0.6), 1e5);
        let limit = grounded.field(&wave(), u * r).e * (Complex64::cis(wave().wavenumber() * r) * r);
        let far = grounded.far_amplitude(&wave(), u).unwrap();
        assert!((limit - far).norm() < 1e-4 * far.norm());
    }

    /// A vertical dipole of moment Il at the height h radiates πη |Il/λ|² [⅓ − cos(2kh)/(2kh)² +
    /// sin(2kh)/(2kh)³] (Balanis, Antenna Theory, 3rd ed., Wiley 2005, eq. 4-102), all of it upwards,
    /// and supplies as much.
    #[test]
    fn a_dipole_over_ground_radiates_what_the_textbook_says() {
        let ground = Ground::new(0.0).unwrap();
        for height in [0.03, 0.11, 0.4] {
            let grounded = Grounded::new(Box::new(dipole(height, Vec3::Z)), ground);
            let twice = 2.0 * wave().wavenumber() * height;
            let bracket = 1.0 / 3.0 - twice.cos() / twice.powi(2) + twice.sin() / twice.powi(3);
            let moment = (0.5 / wave().wavelength()).powi(2);
            let expected = std::f64::consts::PI * crate::medium::IMPEDANCE * moment * bracket;
            let supplied = grounded.supplied(&wave(), &|_| ComplexVector::ZERO).unwrap();
            let rule = sphere_rule(&wave(), height + 0.4);
            let far: Vec<ComplexVector> =
                rule.iter().map(|(u, _)| grounded.far_amplitude(&wave(), *u).unwrap()).collect();
            // The other half of the sphere has the mirror image.
            let up = 0.5 * radiated(&rule, &far);
            assert!((supplied / expected - 1.0).abs() < 1e-9, "{height}: {supplied} {expected}");
            assert!((up / expected - 1.0).abs() < 1e-4, "{height}: {up} {expected}");
        }
    }
}
