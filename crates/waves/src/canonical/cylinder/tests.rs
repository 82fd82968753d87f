use super::*;
use crate::canonical::tests::{from, maxwell_gap, oblique, wave_of};

const LOSSY: Complex64 = Complex64::new(3.0, -0.7);

fn place(rho: f64, phi: f64) -> Vec3 {
    Vec3::new(rho * phi.cos(), rho * phi.sin(), 0.35)
}

fn total(wave: &Wave, source: &PlaneWave, cylinder: &LayeredCylinder, p: Vec3) -> Field {
    cylinder.scattered(wave, source, p).unwrap() + Medium::free_space(wave).incident(source, p)
}

fn difference(a: Field, b: Field) -> f64 {
    ((a.e - b.e).norm() + (a.h - b.h).norm() * IMPEDANCE) / (a.e.norm() + a.h.norm() * IMPEDANCE)
}

fn across(travel_z: f64, electric: bool) -> PlaneWave {
    let polarisation = if electric { [0.0, 0.0, 1.0] } else { [-0.6, 0.8, 0.0] };
    from([0.8, 0.6, travel_z], polarisation)
}

/// C. A. Balanis, Advanced Engineering Electromagnetics, § 11.5.
#[test]
fn the_current_of_a_conductor() {
    let (wave, cylinder) = (wave_of(2.0), ConductingCylinder::new(0.5).unwrap());
    let [electric, magnetic] =
        [from([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), from([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])];
    let amplitude = Complex64::new(0.8, -0.6) / IMPEDANCE;
    // Values of mpmath 1.4.1: 2/(π ka) Σ j⁻ⁿ e^{jnφ}/H_n⁽²⁾(ka), ka = 1, φ = 2; and j 2/(π ka) Σ
    // j⁻ⁿ e^{jnφ}/H_n⁽²⁾′(ka).
    let expected = [
        Complex64::new(1.584_955_854_564_943_9, -0.110_333_400_785_789_72) * amplitude,
        Complex64::new(-1.145_257_496_948_738, -0.933_888_768_866_213_9) * amplitude,
    ];
    let j = cylinder.current(&wave, &electric, 2.0, 0.3).unwrap();
    assert!((j.dot(Vec3::Z) - expected[0]).norm() < 1e-13 * expected[0].norm(), "{j:?} {}", expected[0]);
    let j = cylinder.current(&wave, &magnetic, 2.0, 0.3).unwrap();
    let around = j.dot(Vec3::new(-2f64.sin(), 2f64.cos(), 0.0));
    assert!((around - expected[1]).norm() < 1e-13 * expected[1].norm(), "{around} {}", expected[1]);
}

#[test]
fn on_a_conductor_the_field_is_normal() {
    for ka in [1e-3, 0.7, 9.0, 60.0] {
        let wave = wave_of(ka);
        let bare = LayeredCylinder::new(Some(1.0), vec![]).unwrap();
        let coated = LayeredCylinder::new(Some(1.0), vec![(1.2, LOSSY), (1.3, 2.0.into())]).unwrap();
        for cylinder in [bare, coated] {
            for phi in [0.0_f64, 1.0, 2.5, -2.0] {
                let p = place(1.0 + 1e-15, phi);
                let field = total(&wave, &oblique(), &cylinder, p);
                let tangential = field.e.crossed_by(Vec3::new(phi.cos(), phi.sin(), 0.0)).norm();
                assert!(tangential < 1e-11 * (1.0 + field.e.norm()), "{ka} {phi}: {tangential:e}");
            }
        }
    }
}

#[test]
fn across_every_border_the_tangential_fields_and_the_normal_flux_are_continuous() {
    let layers = vec![(0.3, 2.0.into()), (0.7, LOSSY), (0.8, Complex64::new(0.4, -0.1)), (1.0, 6.0.into())];
    for k in [0.1, 3.0, 20.0] {
        for core in [None, Some(0.2)] {
            let cylinder = LayeredCylinder::new(core, layers.clone()).unwrap();
            for (i, (radius, inner)) in layers.iter().enumerate() {
                let outer = layers.get(i + 1).map_or(Complex64::ONE, |layer| layer.1);
                let normal = Vec3::new(0.6, -0.8, 0.0);
                let at = |r: f64| total(&wave_of(k), &oblique(), &cylinder, normal * r + Vec3::Z * 0.4);
                let (a, b) = (at(radius * (1.0 - 1e-14)), at(radius * (1.0 + 1e-14)));
                let size = a.e.norm() + a.h.norm() * IMPEDANCE;
                let gaps = [
                    (a.e - b.e).crossed_by(normal).norm(),
                    (a.h - b.h).norm() * IMPEDANCE,
                    (a.e.dot(normal) * inner - b.e.dot(normal) * outer).norm(),
                ];
                assert!(gaps.iter().all(|gap| *gap < 1e-10 * size), "{k} {core:?} {radius}: {gaps:?}");
            }
        }
    }
}

#[test]
fn maxwell_holds_outside_and_in_the_layers() {
    let (wave, layers) = (wave_of(4.0), [(0.6, 2.0.into()), (1.0, LOSSY)]);
    let cylinder = LayeredCylinder::new(Some(0.2), layers.to_vec()).unwrap();
    for (rho, permittivity) in [(0.4, 2.0.into()), (0.8, LOSSY), (1.7, Complex64::ONE)] {
        let medium = Medium::of(&wave, permittivity).unwrap();
        let gap = maxwell_gap(&medium, place(rho, 2.0), |p| total(&wave, &oblique(), &cylinder, p));
        assert!(gap < 1e-9, "{rho}: {gap:e}");
    }
    let solid = LayeredCylinder::new(None, layers.to_vec()).unwrap();
    let medium = Medium::of(&wave, 2.0.into()).unwrap();
    let gap = maxwell_gap(&medium, Vec3::ZERO, |p| total(&wave, &oblique(), &solid, p));
    assert!(gap < 1e-9, "on the axis: {gap:e}");
}

#[test]
fn what_is_not_absorbed_is_scattered_from_any_side() {
    let clear = vec![(0.4, 2.0.into()), (0.8, 6.0.into()), (1.0, 1.5.into())];
    let lossy = vec![(0.4, 2.0.into()), (0.8, LOSSY), (1.0, 1.5.into())];
    for core in [None, Some(0.3)] {
        for k in [0.2, 2.0, 11.0, 40.0] {
            for source in [oblique(), across(0.0, true), across(0.0, false)] {
                let absorbed = |layers: &Vec<(f64, Complex64)>| {
                    let cylinder = LayeredCylinder::new(core, layers.clone()).unwrap();
                    let [extinction, scattering] = cylinder.widths(&wave_of(k), &source).unwrap();
                    (extinction - scattering) / extinction
                };
                assert!(absorbed(&clear).abs() < 1e-10, "{core:?} {k}: {:e}", absorbed(&clear));
                assert!(absorbed(&lossy) > 1e-3, "{core:?} {k}: {:e}", absorbed(&lossy));
            }
        }
    }
}

#[test]
fn one_material_is_the_same_however_it_is_cut_and_nothing_is_nothing() {
    for permittivity in [Complex64::from(4.0), LOSSY, Complex64::new(10.0, -8.0)] {
        for k in [0.3, 4.0, 15.0, 300.0] {
            let of = |radii: &[f64]| {
                LayeredCylinder::new(None, radii.iter().map(|r| (*r, permittivity)).collect()).unwrap()
            };
            let (whole, cut) = (of(&[1.0]), of(&[1e-4, 0.2, 0.21, 0.9, 1.0]));
            for p in [place(1.01, 0.4), place(3.0, -2.0), place(0.95, 2.0)] {
                let [a, b] = [&whole, &cut].map(|c| c.scattered(&wave_of(k), &oblique(), p).unwrap());
                assert!(difference(a, b) < 1e-10, "{permittivity} {k} {p}: {:e}", difference(a, b));
            }
        }
    }
    let air = LayeredCylinder::new(None, vec![(0.5, Complex64::ONE), (1.0, Complex64::ONE)]).unwrap();
    for p in [place(0.7, 1.0), place(2.0, 0.4)] {
        assert!(air.scattered(&wave_of(5.0), &oblique(), p).unwrap().e.norm() < 1e-13);
    }
}

#[test]
fn a_conductor_is_itself_in_air_and_hides_in_a_dense_coat() {
    let wave = wave_of(4.0);
    let coat = (1.0, Complex64::new(2.5, -0.2));
    let dense = Complex64::new(1e12, -1e12);
    for (core, layers, other_core, others, tolerance) in [
        (Some(0.7), vec![], Some(0.7), vec![(1.0, Complex64::ONE)], 1e-12),
        (Some(1.0), vec![], Some(0.7), vec![(1.0, dense)], 1e-5),
        (Some(0.7), vec![coat], None, vec![(0.7, dense), coat], 1e-5),
    ] {
        let [a, b] = [LayeredCylinder::new(core, layers), LayeredCylinder::new(other_core, others)]
            .map(Result::unwrap);
        for p in [place(1.01, 0.4), place(3.0, -2.0), place(200.0, 1.0)] {
            let [a, b] = [&a, &b].map(|c| c.scattered(&wave, &oblique(), p).unwrap());
            assert!(difference(a, b) < tolerance, "{p}: {:e}", difference(a, b));
        }
    }
}

/// A thin dielectric cylinder is a line of dipoles, (ε − 1) πa² along z and 2 (ε − 1)/(ε + 1) πa²
/// across it (Bohren and Huffman, § 8.4.4), and J₀/H₀ of a thin conductor has a logarithm.
#[test]
fn thin_cylinders() {
    let (wave, radius) = (wave_of(1.0), 1e-4);
    let area = std::f64::consts::PI * radius * radius;
    let thin = LayeredCylinder::new(None, vec![(radius, 4.0.into())]).unwrap();
    for (electric, polarisability, mean) in [(true, 3.0 * area, 1.0), (false, 1.2 * area, 0.5)] {
        let [_, scattering] = thin.widths(&wave, &across(0.0, electric)).unwrap();
        // k³ |α|²/4 times the mean of sin² around the dipole.
        let expected = polarisability * polarisability * 0.25 * mean;
        assert!((scattering / expected - 1.0).abs() < 1e-5, "{scattering:e} {expected:e}");
    }
    let wire = ConductingCylinder::new(radius).unwrap();
    let [extinction, scattering] = wire.widths(&wave, &across(0.0, true)).unwrap();
    let log = 0.577_215_664_901_532_9 + (0.5 * radius).ln();
    let expected = 4.0 / (1.0 + (2.0 / std::f64::consts::PI * log).powi(2));
    assert!((scattering / expected - 1.0).abs() < 1e-6, "{scattering} {expected}");
    assert!((extinction / scattering - 1.0).abs() < 1e-11);
}

/// The far amplitude of E_z from one direction towards another is that of the way back.
#[test]
fn reciprocity_and_rotation() {
    let (wave, r) = (wave_of(3.0), 1e7);
    let cylinder = LayeredCylinder::new(Some(0.3), vec![(0.6, LOSSY), (1.0, 2.0.into())]).unwrap();
    let amplitude = |travel: f64, towards: f64, polarisation: [f64; 3]| {
        let source = from([travel.cos(), travel.sin(), 0.0], polarisation);
        let p = Vec3::new(r * towards.cos(), r * towards.sin(), 0.0);
        cylinder.scattered(&wave, &source, p).unwrap().e.dot(Vec3::Z)
    };
    let up = [0.0, 0.0, 1.0];
    let there = amplitude(0.3, 2.0, up);
    let back = amplitude(2.0 + std::f64::consts::PI, 0.3 + std::f64::consts::PI, up);
    let turned = amplitude(1.3, 3.0, up);
    assert!((there - back).norm() < 1e-7 * there.norm(), "{there} {back}");
    assert!((there - turned).norm() < 1e-7 * there.norm(), "{there} {turned}");
}

#[test]
fn what_is_no_cylinder_or_no_wave_for_it_is_refused() {
    for (core, layers) in [
        (None, &[][..]),
        (Some(0.0), &[]),
        (Some(1.0), &[(0.9, 2.0)]),
        (None, &[(1.0, 2.0), (1.0, 3.0)]),
        (None, &[(f64::NAN, 2.0)]),
    ] {
        let layers = layers.iter().map(|&(r, e)| (r, e.into())).collect();
        assert!(matches!(LayeredCylinder::new(core, layers), Err(WaveError::Length { .. })), "{core:?}");
    }
    let gain = LayeredCylinder::new(None, vec![(1.0, Complex64::new(2.0, 0.1))]);
    assert!(matches!(gain, Err(WaveError::Material { .. })));
    let along = from([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let found = ConductingCylinder::new(1.0).unwrap().scattered(&wave_of(1.0), &along, Vec3::X * 2.0);
    assert!(matches!(found, Err(WaveError::Travel { .. })));
}
