//! Edge currents, measured: one bounce with and without them against the method of moments.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, reference, relative_error, source, wave};
use fredholm_mesh::{Cutting, Lines, MeshBuilder, Shape, Vec3};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, plate};
use fredholm_waves::{
    Complex64, ComplexVector, EdgeCurrents, FacetCurrents, Field, Kind, PhysicalOptics, Sampling, Scatterer,
    Shadow, Source,
};

/// Error of one bounce alone and with edge currents.
fn errors(scatterer: &Scatterer, name: &str) -> [f64; 2] {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let optics = PhysicalOptics::new(scatterer, wave(), &sources, Shadow::Geometric).unwrap();
    let fields = optics.radiator(Sampling::Tolerance(1e-3)).fields(&circle()).unwrap();
    let edges = EdgeCurrents::new(scatterer, wave(), &sources).unwrap();
    assert!(!edges.is_empty());
    let extra = edges.fields(&circle());
    let expected = reference(name, "mom");
    let ez = |with: f64| -> Vec<Complex64> {
        let pairs = fields.iter().zip(&extra);
        pairs.map(|(field, extra)| (*field + *extra * with).e.components()[2]).collect()
    };
    [0.0, 1.0].map(|with| relative_error(&ez(with), &expected))
}

#[test]
fn edge_currents_bring_a_plate_closer_to_the_method_of_moments() {
    let [without, with] =
        errors(&plate(5.0 * WAVELENGTH, WAVELENGTH / 5.0).unwrap(), "plate_5lambda_normal.csv");
    assert!((without - 0.111).abs() < 0.003 && with < 0.015, "{without} {with}");
}

/// Lit squarely, every edge of a cube has a face that the wave grazes, and no current; turned a
/// little, those that see the source have. A body much smaller than the wave has none that the
/// theory knows.
#[test]
fn edges_are_those_that_the_theory_knows() {
    let body = cube(WAVELENGTH, WAVELENGTH / 5.0).unwrap();
    let square = source();
    let edges = EdgeCurrents::new(&body, wave(), &[&square]).unwrap();
    let largest = |fields: Vec<Field>| fields.iter().map(|field| field.e.norm()).fold(0.0, f64::max);
    assert!(largest(edges.fields(&circle())) < 1e-6, "{}", largest(edges.fields(&circle())));
    let turned = PlaneWave::new(Vec3::new(0.3, 0.8, -0.5), Vec3::Z, 1.0.into()).unwrap();
    let edges = EdgeCurrents::new(&body, wave(), &[&turned]).unwrap();
    // Nine of twelve edges see the source, with two rules of five points each.
    assert_eq!((edges.len(), edges.small()), (90, 0));
    assert!(edges.fields(&circle()).iter().all(Field::is_finite));
    let small = plate(0.1 * WAVELENGTH, WAVELENGTH / 20.0).unwrap();
    let edges = EdgeCurrents::new(&small, wave(), &[&turned]).unwrap();
    assert!(edges.is_empty() && edges.small() == 4);
}

/// The scattered field with edges of two plates, in the frame of the plates.
fn turned_plates(turn: &dyn Fn(Vec3) -> Vec3, shift: Vec3, order: [usize; 2]) -> Vec<ComplexVector> {
    let plates = [
        [Vec3::ZERO, Vec3::X * 2.0, Vec3::Z * 1.5],
        [Vec3::new(0.4, 1.0, 0.3), Vec3::X * 1.5, Vec3::new(0.0, 0.5, 1.2)],
    ];
    let cutting = Cutting { lines: Lines::LargestEdge(WAVELENGTH / 3.0), ..Cutting::default() };
    let mut builder = MeshBuilder::default();
    for i in order {
        let [corner, u, v] = plates[i].map(|x| turn(x * WAVELENGTH));
        let corners = [corner, corner + u, corner + u + v, corner + v].map(|p| p + shift);
        builder.surface("", 0);
        builder.add(&Shape::Quad { corners, skip: Vec::new() }, &cutting).unwrap();
    }
    let body = Scatterer::new(&builder.build(), |_| Kind::Sheet).unwrap();
    // The wave runs in the plane of the first plate, and observers are in that of both.
    let source = PlaneWave::new(turn(Vec3::X), turn(Vec3::new(0.0, 0.6, 0.8)), 1.0.into()).unwrap();
    let sources: [&dyn Source; 1] = [&source];
    let optics = PhysicalOptics::new(&body, wave(), &sources, Shadow::Radiated).unwrap();
    let currents = FacetCurrents::sampled(&body, &optics);
    let edges = EdgeCurrents::of_bounces(&body, wave(), &sources, &currents).unwrap();
    let observers = [Vec3::X, Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::Y, Vec3::new(0.0, -0.6, 0.8)];
    let far = |&u: &Vec3| {
        let u = turn(u);
        let optics = optics.radiator(Sampling::Tolerance(1e-3)).far_field(&[u]).unwrap()[0].amplitude;
        let back = Complex64::cis(
            -wave().wavenumber() * u.dot(shift) + wave().wavenumber() * turn(Vec3::X).dot(shift),
        );
        (optics + edges.far_amplitude(u)) * back
    };
    observers.iter().map(far).collect()
}

/// Turning, moving and renumbering change nothing, in the planes of faces least of all.
#[test]
fn the_frame_does_not_matter() {
    let straight = turned_plates(&|p| p, Vec3::ZERO, [0, 1]);
    let size = straight.iter().map(|far| far.norm()).fold(0.0, f64::max);
    let angle = 0.7_f64;
    let turn = move |p: Vec3| {
        let (sin, cos) = angle.sin_cos();
        let p = Vec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
        Vec3::new(p.x, cos * p.y - sin * p.z, sin * p.y + cos * p.z)
    };
    let back = |v: Vec3| {
        let (sin, cos) = angle.sin_cos();
        let v = Vec3::new(v.x, cos * v.y + sin * v.z, cos * v.z - sin * v.y);
        Vec3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
    };
    let shift = Vec3::new(0.3, -1.2, 0.7);
    for found in [
        turned_plates(&turn, Vec3::ZERO, [0, 1]),
        turned_plates(&turn, shift, [1, 0]),
        turned_plates(&|p| p, shift, [0, 1]),
        turned_plates(&|p| p, Vec3::ZERO, [1, 0]),
    ]
    .iter()
    .enumerate()
    .map(|(i, found)| {
        let turned_back = |v: &ComplexVector| ComplexVector { re: back(v.re), im: back(v.im) };
        if i < 2 { found.iter().map(turned_back).collect() } else { found.clone() }
    }) {
        for (a, b) in straight.iter().zip(&found) {
            assert!((*a - *b).norm() < 1e-9 * size, "{a:?} {b:?}");
        }
    }
}

/// No jump across the plane of a face, on either side of the edge.
#[test]
fn fields_are_continuous_across_the_planes_of_faces() {
    let source = PlaneWave::new(Vec3::new(0.5, 0.7, -0.3), Vec3::new(1.0, 0.2, 0.4), 1.0.into()).unwrap();
    for (body, planes) in [
        (plate(2.0 * WAVELENGTH, WAVELENGTH / 4.0).unwrap(), vec![0.0]),
        (cube(2.0 * WAVELENGTH, WAVELENGTH / 4.0).unwrap(), vec![-WAVELENGTH, WAVELENGTH]),
    ] {
        let edges = EdgeCurrents::new(&body, wave(), &[&source]).unwrap();
        let at = |p: Vec3| edges.fields(&[p])[0].e;
        let peak = (0..90).map(|i| f64::from(4 * i).to_radians().sin_cos());
        let peak = peak.map(|(sin, cos)| at(Vec3::new(cos, sin, 0.2)).norm()).fold(0.0, f64::max);
        for plane in planes {
            for (x, z) in [(3.0, 0.2), (-2.5, 0.4), (0.3, 2.2), (1.7, -1.9)] {
                let p = Vec3::new(x * WAVELENGTH, plane, z * WAVELENGTH);
                let [below, above] = [-1e-9, 1e-9].map(|d| at(p + Vec3::Y * d));
                assert!((below - above).norm() < 1e-4 * peak, "{p}: {below:?} {above:?}, peak {peak}");
            }
        }
    }
}

#[test]
fn the_far_field_of_edges_is_the_limit_of_the_near_one() {
    let plate = plate(2.0 * WAVELENGTH, WAVELENGTH / 4.0).unwrap();
    let turned = PlaneWave::new(Vec3::new(0.3, 0.8, -0.5), Vec3::Z, 1.0.into()).unwrap();
    let edges = EdgeCurrents::new(&plate, wave(), &[&turned]).unwrap();
    let u = Vec3::new(0.48, -0.6, 0.64);
    let r = 1e6;
    let near = edges.fields(&[u * r])[0].e;
    let far = edges.far_amplitude(u) * (Complex64::cis(-wave().wavenumber() * r) / r);
    assert!((near - far).norm() < 1e-4 * near.norm());
}
