//! The radiation integral against sums of elements on fine meshes, and its own promises.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, source, wave};
use fredholm_mesh::Vec3;
use fredholm_waves::surface::{cube, rectangle};
use fredholm_waves::{
    ComplexVector, Current, Field, Gate, PhysicalOptics, Radiator, Sampling, Scatterer, Shadow, Source,
    SurfaceCurrent, WaveError, electric_element, magnetic_element,
};

/// A smooth current of both kinds along a surface in the plane z = 0.
struct Ripple;

impl SurfaceCurrent for Ripple {
    fn at(&self, _: usize, q: Vec3) -> Current {
        let phase = ComplexVector { re: Vec3::X, im: Vec3::new(0.3, 1.0, 0.0) };
        let j = phase * (5.0 * q.x - 3.0 * q.y).cos();
        Current { j, m: ComplexVector { re: j.im, im: j.re } * 200.0 }
    }
}

fn panel(edge: f64) -> Scatterer {
    rectangle(Vec3::ZERO, Vec3::X * 0.12, Vec3::Y * 0.12, edge).unwrap()
}

/// The midpoint rule on squares of side 0.12/600.
fn fine_sum(p: Vec3) -> Field {
    let n = 600;
    let step = 0.12 / f64::from(n);
    let mut sum = Field::ZERO;
    for i in 0..n {
        for j in 0..n {
            let q = Vec3::new((f64::from(i) + 0.5) * step, (f64::from(j) + 0.5) * step, 0.0);
            let Current { j, m } = Ripple.at(0, q);
            let area = step * step;
            sum += electric_element(&wave(), j * area, p - q) + magnetic_element(&wave(), m * area, p - q);
        }
    }
    sum
}

/// From two wavelengths away to a hundredth of a facet over its middle, its edge and its corner.
#[test]
fn near_and_far_rules_meet_a_fine_sum() {
    let scatterer = panel(0.03);
    for tolerance in [1e-3, 1e-5] {
        let radiator = Radiator::new(&scatterer, wave(), &Ripple, Gate::Open, Sampling::Tolerance(tolerance));
        for p in [
            Vec3::new(0.4, -0.3, 0.3),
            Vec3::new(0.05, 0.11, 0.1),
            Vec3::new(0.05, 0.11, 0.03),
            Vec3::new(0.045, 0.045, 0.005),
            Vec3::new(0.06, 0.045, 0.005),
            Vec3::new(0.13, 0.05, 0.0),
        ] {
            let (field, expected) = (radiator.fields(&[p]).unwrap()[0], fine_sum(p));
            let error = field - expected;
            let bound = tolerance.max(1e-4);
            assert!(
                error.e.norm() < bound * expected.e.norm(),
                "{p} {tolerance}: {:e}",
                error.e.norm() / expected.e.norm()
            );
            assert!(
                error.h.norm() < bound * expected.h.norm(),
                "{p} {tolerance}: {:e}",
                error.h.norm() / expected.h.norm()
            );
        }
    }
}

#[test]
fn the_far_field_is_the_limit_of_the_near_one() {
    let scatterer = panel(0.03);
    for gate in [Gate::Open, Gate::ObserverSide] {
        let radiator = Radiator::new(&scatterer, wave(), &Ripple, gate, Sampling::Tolerance(1e-6));
        for u in [Vec3::new(0.48, 0.6, 0.64), Vec3::new(-0.6, 0.0, -0.8)] {
            let r = 1e5;
            let near = radiator.fields(&[u * r]).unwrap()[0].e;
            let far = radiator.far_field(&[u]).unwrap()[0].amplitude;
            let phase = fredholm_waves::Complex64::cis(-wave().wavenumber() * r) / r;
            assert!((near - far * phase).norm() < 1e-4 * near.norm());
        }
    }
}

/// Neither the number of threads nor the other receivers change a bit.
#[test]
fn the_same_bits_for_any_threads_and_any_company() {
    let scatterer = cube(2.0 * WAVELENGTH, WAVELENGTH / 8.0).unwrap();
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let points: Vec<Vec3> =
        (0..200).map(|i| Vec3::new(0.4 + 0.01 * f64::from(i), 0.31, 0.02 * f64::from(i % 9))).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let optics = PhysicalOptics::new(&scatterer, wave(), &sources, Shadow::Geometric).unwrap();
            let radiator = optics.radiator(Sampling::Tolerance(1e-3));
            assert!(radiator.elements() > 100);
            (radiator.fields(&points).unwrap(), radiator.fields(&points[137..138]).unwrap())
        })
    };
    let (all, alone) = run(1);
    assert_eq!(all[137], alone[0]);
    for threads in [2, 4] {
        assert_eq!(run(threads), (all.clone(), alone.clone()));
    }
}

#[test]
fn a_receiver_on_the_surface_is_refused() {
    let scatterer = panel(0.03);
    let radiator = Radiator::new(&scatterer, wave(), &Ripple, Gate::Open, Sampling::Midpoint);
    let points = [Vec3::Z, Vec3::new(0.06, 0.06, 0.0)];
    let refused = radiator.fields(&points);
    assert!(matches!(refused, Err(WaveError::OnSurface { receiver: 1, .. })), "{refused:?}");
    assert!(matches!(radiator.fields(&[Vec3::NAN]), Err(WaveError::NotFinite { .. })));
}
