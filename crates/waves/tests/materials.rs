//! Several bounces between materials: the limit of conductors, closed forms of two bounces, and
//! what gets through.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, wave};
use fredholm_linop::{LinearOperator, MultiVector, Quiet};
use fredholm_mesh::{Cutting, Lines, MeshBuilder, Shape, Vec3};
use fredholm_waves::material::{Layer, Material};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{dihedral, facing_plates};
use fredholm_waves::{
    Bounces, Complex64, Current, Discretisation, Kind, MaterialCoupling, NystromCoupling, PhysicalOptics,
    Sampling, Scatterer, Shadow, Source, System,
};
use std::f64::consts::FRAC_PI_2;

type Vectors = MultiVector<Complex64>;

fn glass() -> Material {
    Material::Slab(vec![Layer { permittivity: Complex64::new(6.3, -0.2), thickness: 0.006 }])
}

fn product(a: &dyn LinearOperator<Complex64>, x: &Vectors) -> Vectors {
    let mut y = Vectors::zeros(x.dim(), x.rhs_count());
    a.apply(x, &mut y);
    y
}

/// An impedance of 0 is a conductor, whose coupling is computed by other code.
#[test]
fn a_surface_without_impedance_couples_as_a_conductor() {
    let metal = dihedral(0.9 * WAVELENGTH, 0.7 * WAVELENGTH, FRAC_PI_2, WAVELENGTH / 8.0).unwrap();
    let smooth = metal.clone().made_of(vec![Material::Impedance(Complex64::ZERO); 2]).unwrap();
    for shadow in [Shadow::Geometric, Shadow::Radiated] {
        let conductors = NystromCoupling::new(&metal, wave(), shadow).unwrap();
        let materials = MaterialCoupling::new(&smooth, wave(), shadow).unwrap();
        let value = |i: usize| Complex64::new((0.37 * i as f64).sin(), (0.91 * i as f64).cos());
        let x = Vectors::from_fn(conductors.dim(), 1, |i, _| value(i));
        let electric = |i: usize| i % 4 < 2;
        let padded = Vectors::from_fn(materials.dim(), 1, |i, _| {
            if electric(i) { value(i / 4 * 2 + i % 4) } else { Complex64::ZERO }
        });
        let (expected, found) = (product(&conductors, &x), product(&materials, &padded));
        for i in 0..found.dim() {
            let exact = if electric(i) { expected.row(i / 4 * 2 + i % 4)[0] } else { Complex64::ZERO };
            assert!((found.row(i)[0] - exact).norm() < 1e-12 * expected.norms()[0], "{shadow:?} {i}");
        }
    }
}

#[test]
fn rows_columns_and_products_are_those_of_the_stored_matrix_for_any_threads() {
    let pair = facing_plates(0.8 * WAVELENGTH, 0.3, WAVELENGTH / 5.0).unwrap();
    let pair = pair.made_of(vec![glass(), Material::HalfSpace(Complex64::new(4.0, -1.0))]).unwrap();
    let coupling = MaterialCoupling::new(&pair, wave(), Shadow::Radiated).unwrap();
    let dense = coupling.dense_matrix().unwrap();
    let x = Vectors::from_fn(dense.dim(), 2, |i, l| Complex64::new((i as f64).sin(), l as f64 - 0.5));
    let y = product(&coupling, &x);
    let gap = product(&dense, &x);
    let largest = y.as_slice().iter().map(|v| v.norm()).fold(0.0, f64::max);
    assert!(largest > 1e-2);
    assert!(y.as_slice().iter().zip(gap.as_slice()).all(|(a, b)| (a - b).norm() < 1e-12 * largest));
    let mut line = vec![Complex64::ZERO; dense.dim()];
    for i in [0, 3, dense.dim() / 2 + 1, dense.dim() - 2] {
        coupling.row(i, 0, &mut line);
        assert_eq!(line, dense.row_slice(i));
        coupling.column(i, 0, &mut line);
        assert!(line.iter().enumerate().all(|(k, entry)| *entry == dense.get(k, i)));
    }
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| product(&coupling, &x)), y);
    }
}

/// A flat pane sends nothing to itself, however fine its mesh.
#[test]
fn a_flat_sheet_has_no_second_bounce() {
    let sheet = fredholm_waves::surface::plate(WAVELENGTH, WAVELENGTH / 12.0).unwrap();
    let sheet = sheet.made_of(vec![glass()]).unwrap();
    let coupling = MaterialCoupling::new(&sheet, wave(), Shadow::Geometric).unwrap();
    let x = Vectors::from_fn(coupling.dim(), 1, |i, _| Complex64::new((0.3 * i as f64).sin(), 0.5));
    assert!(product(&coupling, &x).norms()[0] < 1e-12 * x.norms()[0]);
}

/// The far field straight back from a dihedral after two bounces.
fn two_bounces(side: f64, material: &Material, polarisation: Vec3) -> Complex64 {
    let side = side * WAVELENGTH;
    let pair = dihedral(side, side, FRAC_PI_2, WAVELENGTH / 6.0).unwrap();
    let pair = pair.made_of(vec![material.clone(); 2]).unwrap();
    let source = PlaneWave::new(Vec3::NEG_X, polarisation, 1.0.into()).unwrap();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(&pair, wave(), &sources, Shadow::Geometric).unwrap();
    let system = System::lazy(&pair, wave(), Shadow::Geometric).unwrap();
    let sum = Bounces::sum(system.coupling(), &system.right_hand_side(&[&first]), 2, &Quiet).unwrap();
    let currents = system.currents(&sum.x, 0);
    system.radiator(&currents).far_field(&[Vec3::X]).unwrap()[0].amplitude.dot(polarisation)
}

/// The field straight back over that of a conductor, less r²(45°), r that of the polarisation.
fn gap(side: f64, material: &Material, mode: usize) -> f64 {
    let polarisation = [Vec3::Z, Vec3::Y][mode];
    let r = material.coefficients(&wave(), 0.5_f64.sqrt()).reflected[mode];
    let metal = two_bounces(side, &Material::Conductor, polarisation);
    (two_bounces(side, material, polarisation) / metal - r * r).norm()
}

#[test]
fn a_dihedral_returns_the_square_of_the_coefficient() {
    for mode in [0, 1] {
        for material in [Material::Impedance(Complex64::new(150.0, 60.0)), glass()] {
            let gap = gap(4.0, &material, mode);
            assert!(gap < 0.04, "{material:?} {mode}: {gap}");
        }
    }
}

/// The part that is diffracted past the second plate dies out:
/// `cargo test -p fredholm-waves --test materials -- --ignored --nocapture`, a minute.
#[test]
#[ignore = "a minute"]
fn the_square_of_the_coefficient_is_the_limit_of_large_dihedrals() {
    for mode in [0, 1] {
        let material = Material::HalfSpace(Complex64::new(5.24, -0.7));
        let gaps = [2.0, 4.0, 8.0].map(|side| gap(side, &material, mode));
        eprintln!("mode {mode}: {gaps:.4?} at 2, 4, 8λ");
        assert!(gaps[2] < 0.5 * gaps[0] && gaps[2] < 0.025, "{mode}: {gaps:?}");
    }
}

/// A pane before a metal plate, in the treatment where currents radiate the shadow: what arrives at
/// the plate is the incident wave and all that the pane radiates.
#[test]
fn what_gets_through_a_pane_lights_what_is_behind() {
    let pane = |y: f64, side: f64| {
        let corner = Vec3::new(-0.5 * side, y, -0.5 * side);
        let (u, v) = (Vec3::X * side, Vec3::Z * side);
        Shape::Quad { corners: [corner, corner + u, corner + u + v, corner + v], skip: Vec::new() }
    };
    let mut builder = MeshBuilder::default();
    for shape in [pane(0.0, 4.0 * WAVELENGTH), pane(0.35, 0.5 * WAVELENGTH)] {
        builder.surface("", 0);
        let cutting = Cutting { lines: Lines::LargestEdge(WAVELENGTH / 8.0), ..Cutting::default() };
        builder.add(&shape, &cutting).unwrap();
    }
    let mesh = builder.build();
    let scene = Scatterer::new(&mesh, |_| Kind::Sheet).unwrap();
    let scene = scene.made_of(vec![glass(), Material::Conductor]).unwrap();
    let source = PlaneWave::new(Vec3::new(0.2, 1.0, 0.1), Vec3::Z, 1.0.into()).unwrap();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(&scene, wave(), &sources, Shadow::Radiated).unwrap();
    let system = System::stored(&scene, wave(), Shadow::Radiated, Discretisation::Nystrom).unwrap();
    let x = Bounces::sum(system.coupling(), &system.right_hand_side(&[&first]), 2, &Quiet).unwrap().x;
    let currents = system.currents(&x, 0);
    let alone = Scatterer::new(&mesh, |_| Kind::Sheet).unwrap().made_of(vec![glass()]).unwrap();
    let pane_only = PaneOnly { first: &first, panes: &alone };
    let radiator = fredholm_waves::Radiator::new(
        &alone,
        wave(),
        &pane_only,
        Shadow::Radiated.gate(),
        Sampling::Tolerance(1e-4),
    );
    let (mut gap, mut size, mut direct) = (0.0, 0.0, 0.0);
    for (facet, current) in
        scene.facets().iter().zip(currents.values()).filter(|(facet, _)| facet.surface == 1)
    {
        let lit = facet.normal * facet.side(-source.travel());
        // A hair off the plate, whose own current is dark here.
        let pane = radiator.fields(&[facet.centre + lit * 1e-6]).unwrap()[0];
        let incident = source.field(&wave(), facet.centre);
        let expected = (pane + incident).h.crossed_by(lit) * 2.0;
        gap += (current.j - expected).norm_squared();
        size += expected.norm_squared();
        direct += (incident.h.crossed_by(lit) * 2.0 - expected).norm_squared();
    }
    // Without the pane it would be another current.
    assert!((direct / size).sqrt() > 0.3, "{}", (direct / size).sqrt());
    assert!((gap / size).sqrt() < 0.01, "{}", (gap / size).sqrt());
}

/// The one-bounce currents of the pane, nothing on the plate.
struct PaneOnly<'a> {
    first: &'a PhysicalOptics<'a>,
    panes: &'a Scatterer,
}

impl fredholm_waves::SurfaceCurrent for PaneOnly<'_> {
    fn at(&self, facet: usize, q: Vec3) -> Current {
        if self.panes.facets()[facet].surface == 0 { self.first.at(facet, q) } else { Current::default() }
    }
}
