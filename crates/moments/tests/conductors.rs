//! Conductors against the series of Mie and stored references, power, reciprocity, the same bits
//! for any number of threads.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, currents, mie, reference, relative_error, solved, source, vertical, wave};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{Grading, cuboid, facing_plates, plate, sphere};
use fredholm_moments::{Basis, Conductor, Currents, Equation, MomentsError, Surface};
use fredholm_waves::source::HertzianDipole;
use fredholm_waves::{Complex64, ConductingSphere, Source};

const TOLERANCE: f64 = 1e-3;

/// The error at 25 m of a sphere of half a wavelength, and radiated over extinguished power.
fn sphere_error(per_wavelength: f64, equation: Equation) -> (f64, f64) {
    let radius = 0.5 * WAVELENGTH;
    let basis = Basis::new(sphere(radius, WAVELENGTH / per_wavelength).unwrap()).unwrap();
    let conductor = Conductor::new(&basis, wave(), equation, TOLERANCE).unwrap();
    let currents = currents(&conductor, &basis);
    let fields = currents.fields(&circle()).unwrap();
    let power = currents.radiated_power().unwrap() / currents.extinguished_power(&source()).unwrap();
    (relative_error(&vertical(&fields), &mie(radius)), power)
}

#[test]
fn spheres_converge_to_the_series_with_the_second_order() {
    for (equation, bound, balance) in [
        (Equation::Electric, 0.004, 1e-3),
        (Equation::default(), 0.004, 1e-3),
        (Equation::Magnetic, 0.004, 1e-3),
    ] {
        let errors = [5.0, 10.0].map(|per_wavelength| sphere_error(per_wavelength, equation));
        let order = (errors[0].0 / errors[1].0).log2();
        assert!(errors[1].0 < bound && order > 1.4, "{equation:?}: {errors:?}, order {order}");
        assert!((errors[1].1 - 1.0).abs() < balance, "{equation:?}: {errors:?}");
    }
}

/// Closer than an edge to the surface, and in it, where the total field is 0.
#[test]
fn near_and_inside_a_sphere_the_field_is_that_of_the_series() {
    let radius = 0.5 * WAVELENGTH;
    let basis = Basis::new(sphere(radius, WAVELENGTH / 10.0).unwrap()).unwrap();
    let conductor = Conductor::new(&basis, wave(), Equation::Electric, TOLERANCE).unwrap();
    let currents = currents(&conductor, &basis);
    let ways = (0..40).map(|i| {
        let (height, turn) = ((f64::from(i) + 0.5) / 20.0 - 1.0, 2.4 * f64::from(i));
        let ring = (1.0 - height * height).sqrt();
        Vec3::new(ring * turn.cos(), ring * turn.sin(), height)
    });
    let ways: Vec<Vec3> = ways.collect();
    let ball = ConductingSphere::new(radius).unwrap();
    let at = |share: f64| ways.iter().map(|way| *way * (share * radius)).collect::<Vec<_>>();
    for (share, bound) in [(1.2, 0.02), (1.5, 0.01), (3.0, 0.01)] {
        let fields = currents.fields(&at(share)).unwrap();
        let (mut difference, mut size) = (0.0, 0.0);
        for (field, p) in fields.iter().zip(at(share)) {
            let exact = ball.scattered(&wave(), &source(), p);
            difference += (field.e - exact).norm_squared();
            size += exact.norm_squared();
        }
        assert!((difference / size).sqrt() < bound, "{share}: {}", (difference / size).sqrt());
    }
    for (field, p) in currents.fields(&at(0.5)).unwrap().iter().zip(at(0.5)) {
        let total = *field + source().field(&wave(), p);
        assert!(total.e.norm() < 0.03 && total.h.norm() * 376.7 < 0.03, "{p}: {total:?}");
    }
}

/// The stored references have rooftops on graded cells; coarser cells here, for time.
/// docs/notes/moments.md has the fine ones.
#[test]
fn plates_agree_with_the_stored_method_of_moments() {
    let plate = |per: f64, halvings| plate(5.0 * WAVELENGTH, WAVELENGTH / per, Grading { halvings }).unwrap();
    let error = |surface: Surface, name: &str| {
        let basis = Basis::new(surface).unwrap();
        let conductor = Conductor::new(&basis, wave(), Equation::Electric, TOLERANCE).unwrap();
        let currents = currents(&conductor, &basis);
        relative_error(&vertical(&currents.fields(&circle()).unwrap()), &reference(name))
    };
    let name = "plate_5lambda_normal.csv";
    let even = error(plate(5.0, 0), name);
    let graded = error(plate(5.0, 2), name);
    assert!(even < 0.033 && graded < 0.014, "{even} {graded}");
    let two = facing_plates(5.0 * WAVELENGTH, 2.0, WAVELENGTH / 5.0, Grading { halvings: 1 }).unwrap();
    let two = error(two, "two_plates_normal.csv");
    assert!(two < 0.06, "{two}");
}

#[test]
fn the_matrix_has_the_same_bits_for_any_number_of_threads() {
    let basis = Basis::new(sphere(0.5 * WAVELENGTH, WAVELENGTH / 5.0).unwrap()).unwrap();
    for equation in [Equation::Electric, Equation::default()] {
        let conductor = Conductor::new(&basis, wave(), equation, TOLERANCE).unwrap();
        let matrices = [1, 2, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| conductor.operator().dense().unwrap())
        });
        assert!(matrices[0] == matrices[1] && matrices[0] == matrices[2]);
    }
}

/// Dipole a seen by dipole b is dipole b seen by dipole a.
#[test]
fn transmitter_and_receiver_may_be_exchanged() {
    let surface = plate(WAVELENGTH, WAVELENGTH / 6.0, Grading { halvings: 1 }).unwrap();
    let basis = Basis::new(surface).unwrap();
    let conductor = Conductor::new(&basis, wave(), Equation::Electric, 1e-4).unwrap();
    let places = [Vec3::new(0.1, 0.2, -0.05), Vec3::new(-0.2, 0.15, 0.3)];
    let axes = [Vec3::new(1.0, 0.5, 0.2), Vec3::new(0.3, -0.2, 1.0)].map(Vec3::normalize);
    let dipoles = [0, 1].map(|i| HertzianDipole::new(places[i], axes[i], 1.0.into()).unwrap());
    let excitations = dipoles.each_ref().map(|dipole| [dipole as &dyn Source]);
    let b = conductor.right_hand_side(&[&excitations[0], &excitations[1]]);
    let x = solved(&conductor.operator().coupling().unwrap(), &b);
    let seen = [0, 1].map(|i| {
        let currents = Currents::new(&basis, wave(), &x.vector(i), None);
        currents.fields(&[places[1 - i]]).unwrap()[0].e.dot(axes[1 - i])
    });
    assert!((seen[0] - seen[1]).norm() < 1e-5 * seen[0].norm(), "{seen:?}");
}

#[test]
fn the_far_field_is_the_limit_of_the_field() {
    let basis = Basis::new(plate(0.1, 0.03, Grading::default()).unwrap()).unwrap();
    let x: Vec<Complex64> = (0..basis.len()).map(|i| Complex64::cis(i as f64)).collect();
    let m: Vec<Complex64> = x.iter().rev().copied().collect();
    let currents = Currents::new(&basis, wave(), &x, Some(&m));
    let (way, r) = (Vec3::new(0.48, -0.6, 0.64), 1e5);
    let far = currents.far_field(&[way]).unwrap()[0].amplitude;
    let near = currents.fields(&[way * r]).unwrap()[0];
    let limit = near.e * (Complex64::cis(wave().wavenumber() * r) * r);
    assert!((limit - far).norm() < 1e-5 * far.norm(), "{limit:?} {far:?}");
    let magnetic = near.e.crossed_by(way) * (1.0 / fredholm_waves::medium::IMPEDANCE);
    assert!((magnetic - near.h).norm() < 1e-5 * near.h.norm());
    let on = basis.surface().centre(3);
    assert_eq!(currents.fields(&[way, on]).unwrap_err(), MomentsError::OnSurface { point: 1, triangle: 3 });
}

#[test]
fn surfaces_that_do_not_suit_are_refused_with_a_cure() {
    let open = Basis::new(plate(0.3, 0.05, Grading::default()).unwrap()).unwrap();
    let new = |basis: &Basis, equation| Conductor::new(basis, wave(), equation, TOLERANCE).map(|_| ());
    assert!(matches!(new(&open, Equation::default()), Err(MomentsError::NotClosed { .. })));
    assert!(new(&open, Equation::Electric).is_ok());
    let alpha = Equation::Combined { alpha: 1.5 };
    assert!(matches!(new(&open, alpha), Err(MomentsError::Parameter { .. })));
    let coarse = Basis::new(plate(0.3, 0.15, Grading::default()).unwrap()).unwrap();
    assert!(matches!(new(&coarse, Equation::Electric), Err(MomentsError::Coarse { .. })));
    let tolerance = Conductor::new(&open, wave(), Equation::Electric, 0.0).unwrap_err();
    assert!(matches!(tolerance, MomentsError::Parameter { .. }));
    let cube = cuboid(Vec3::splat(0.1), 0.03, Grading { halvings: 1 }).unwrap();
    let triangles: Vec<[u32; 3]> = cube
        .triangles()
        .iter()
        .enumerate()
        .map(|(i, &[a, b, c])| if i < 4 { [a, c, b] } else { [a, b, c] })
        .collect();
    let turned = Surface::new(cube.vertices().to_vec(), triangles).unwrap();
    let refused = new(&Basis::new(turned.clone()).unwrap(), Equation::Magnetic);
    assert!(matches!(refused, Err(MomentsError::Orientation { .. })));
    assert!(new(&Basis::new(turned.oriented()).unwrap(), Equation::Magnetic).is_ok());
}
