//! Dielectric bodies, alone, in layers, touching each other and conductors: against the series of
//! Mie and against the same bodies cut otherwise, near and far, with the power that they take.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::{WAVELENGTH, circle, relative_error, solved, source, vertical, wave};
use fredholm_mesh::Vec3;
use fredholm_moments::meshing::{Grading, cuboid, plate, rectangle, sphere};
use fredholm_moments::{
    Basis, Composite, Conductor, Currents, Equation, Filling, MomentsError, Regions, Surface,
};
use fredholm_waves::{Complex64, DielectricSphere, Field, LayeredSphere, Source};

const TOLERANCE: f64 = 1e-3;
/// Corners closer than this are one, m.
const SAME: f64 = 1e-9;

/// Surfaces with what they bound, together.
fn together(parts: &[(&Surface, Filling)]) -> (Surface, Vec<Filling>) {
    let fillings =
        parts.iter().flat_map(|(surface, filling)| vec![*filling; surface.triangles().len()]).collect();
    let mut all = parts[0].0.clone();
    for (surface, _) in &parts[1..] {
        all = all.with(surface).unwrap();
    }
    (all.welded(SAME).unwrap(), fillings)
}

fn regions(parts: &[(&Surface, Filling)]) -> Result<Regions, MomentsError> {
    let (surface, fillings) = together(parts);
    Regions::new(&surface, &fillings)
}

/// What scatters, solved for.
struct Found {
    far: Vec<Complex64>,
    /// Radiated over extinguished power.
    power: f64,
    /// E_z at points near the bodies, and the total E inside.
    near: Vec<Complex64>,
    inside: Vec<Option<Field>>,
    unknowns: usize,
}

fn found(regions: &Regions, permittivities: &[Complex64], near: &[Vec3], inside: &[Vec3]) -> Found {
    let basis = Basis::between(regions.clone()).unwrap();
    let body = Composite::new(&basis, wave(), permittivities, TOLERANCE).unwrap();
    let source = source();
    let b = body.right_hand_side(&[&[&source as &dyn Source]]);
    let currents = body.currents(&solved(&body.operator().coupling().unwrap(), &b).vector(0));
    Found {
        far: vertical(&currents.fields(&circle()).unwrap()),
        power: currents.radiated_power().unwrap() / currents.extinguished_power(&source).unwrap(),
        near: vertical(&currents.fields(near).unwrap()),
        inside: body.fields_inside(&currents, inside).unwrap(),
        unknowns: body.operator().dim(),
    }
}

/// Points around the bodies, at 1.5 radii.
fn around(radius: f64) -> Vec<Vec3> {
    circle().iter().map(|p| *p * (1.5 * radius / 25.0)).collect()
}

fn of_series(points: &[Vec3], scattered: impl Fn(Vec3) -> fredholm_waves::ComplexVector) -> Vec<Complex64> {
    points.iter().map(|&p| scattered(p).components()[2]).collect()
}

#[test]
fn spheres_agree_with_the_series_near_and_far() {
    let radius = 0.5 * WAVELENGTH;
    for permittivity in [2.0.into(), 4.0.into(), Complex64::new(10.0, -5.0)] {
        let ball = sphere(radius, WAVELENGTH / 12.0).unwrap();
        let regions = regions(&[(&ball, Filling::Dielectric(0))]).unwrap();
        let close: Vec<Vec3> = circle().iter().step_by(15).map(|p| p.normalize() * radius).collect();
        let [outside, within_close] = [1.02, 0.98].map(|f| close.iter().map(|p| *p * f).collect::<Vec<_>>());
        let found_close = found(&regions, &[permittivity], &outside, &within_close);
        let within: Vec<Vec3> = circle().iter().map(|p| *p * (0.5 * radius / 25.0)).collect();
        let found = found(&regions, &[permittivity], &around(radius), &within);
        let sphere_of_mie = DielectricSphere::new(radius, permittivity).unwrap();
        let error = |points: &[Vec3], e: &[Complex64]| {
            relative_error(e, &of_series(points, |p| sphere_of_mie.scattered(&wave(), &source(), p)))
        };
        let (far, near) = (error(&circle(), &found.far), error(&around(radius), &found.near));
        let inside: Vec<Field> = found.inside.into_iter().map(Option::unwrap).collect();
        let exact = of_series(&within, |p| sphere_of_mie.inside(&wave(), &source(), p));
        let inside = relative_error(&vertical(&inside), &exact);
        println!(
            "{permittivity}: far {far:.5}, near {near:.5}, inside {inside:.5}, power {:.5}",
            found.power
        );
        assert!(far < 0.01 && near < 0.01 && inside < 0.01, "{permittivity}: {far} {near} {inside}");
        let lossless = permittivity.im == 0.0;
        assert!(if lossless { (found.power - 1.0).abs() < 2e-3 } else { found.power < 0.9 });
        // Close to the surface, where the charges of single triangles are felt.
        let inside: Vec<Field> = found_close.inside.into_iter().map(Option::unwrap).collect();
        let exact = of_series(&within_close, |p| sphere_of_mie.inside(&wave(), &source(), p));
        let close = [error(&outside, &found_close.near), relative_error(&vertical(&inside), &exact)];
        println!("    close: {close:.4?}");
        assert!(close.iter().all(|error| *error < 0.04), "{permittivity}: {close:?}");
    }
}

#[test]
fn layers_agree_with_the_series() {
    let radii = [0.2 * WAVELENGTH, 0.3 * WAVELENGTH];
    let balls = radii.map(|radius| sphere(radius, WAVELENGTH / 14.0).unwrap());
    let coating = Complex64::new(2.5, -0.1);
    for (core, filling) in [(None, Filling::Conductor), (Some(5.0.into()), Filling::Dielectric(1))] {
        let regions = regions(&[(&balls[0], filling), (&balls[1], Filling::Dielectric(0))]).unwrap();
        let permittivities = [coating, core.unwrap_or_default()];
        let found = found(&regions, &permittivities, &around(radii[1]), &[Vec3::ZERO]);
        let exact = match core {
            None => LayeredSphere::new(Some(radii[0]), vec![(radii[1], coating)]),
            Some(core) => LayeredSphere::new(None, vec![(radii[0], core), (radii[1], coating)]),
        }
        .unwrap();
        let error = |points: &[Vec3], e: &[Complex64]| {
            relative_error(e, &of_series(points, |p| exact.scattered(&wave(), &source(), p)))
        };
        let (far, near) = (error(&circle(), &found.far), error(&around(radii[1]), &found.near));
        let [extinction, scattering] = exact.cross_sections(&wave());
        println!("core {core:?}: {} unknowns, far {far:.5}, near {near:.5}", found.unknowns);
        println!("    power {:.5}, exact {:.5}", found.power, scattering / extinction);
        assert!(far < 0.015 && near < 0.015, "{far} {near}");
        assert!((found.power - scattering / extinction).abs() < 5e-3);
        assert_eq!(found.inside[0].unwrap() == Field::ZERO, core.is_none());
        // A conductor has no magnetic current.
        let count = balls.each_ref().map(|ball| 3 * ball.triangles().len() / 2);
        let kinds = if core.is_none() { 1 } else { 2 };
        assert_eq!(found.unknowns, kinds * count[0] + 2 * count[1]);
    }
}

/// The part of a sphere above or below z = 0, its cells those of an octahedron.
fn half_sphere(radius: f64, cells: usize, sign: f64) -> Surface {
    let place = |i: f64, j: f64| {
        let n = cells as f64;
        let p = Vec3::new(i / n, j / n, sign * (n - i.abs() - j.abs()) / n);
        p.normalize() * radius
    };
    over_square(cells, sign, place)
}

/// The triangles of |i| + |j| ≤ n, seen from above or below.
fn over_square(cells: usize, sign: f64, place: impl Fn(f64, f64) -> Vec3) -> Surface {
    let n = cells as i32;
    let mut corners: Vec<[[i32; 2]; 3]> = Vec::new();
    for [x, y] in [[1, 1], [-1, 1], [-1, -1], [1, -1]] {
        for i in 0..n {
            for j in 0..n - i {
                let turn = |list: [[i32; 2]; 3]| {
                    let list = list.map(|[a, b]| [x * a, y * b]);
                    if x * y > 0 { list } else { [list[0], list[2], list[1]] }
                };
                corners.push(turn([[i, j], [i + 1, j], [i, j + 1]]));
                if i + j + 2 <= n {
                    corners.push(turn([[i + 1, j], [i + 1, j + 1], [i, j + 1]]));
                }
            }
        }
    }
    let vertices = corners.iter().flatten().map(|[i, j]| place(f64::from(*i), f64::from(*j))).collect();
    let triangle = |at: usize| {
        let [a, b, c] = [0, 1, 2].map(|i| (3 * at + i) as u32);
        if sign > 0.0 { [a, b, c] } else { [a, c, b] }
    };
    let triangles = (0..corners.len()).map(triangle).collect();
    Surface::new(vertices, triangles).unwrap().welded(SAME).unwrap()
}

/// The ring of z = 0 between two radii, over the borders of discs.
fn ring(radii: [f64; 2], cells: usize, sign: f64) -> Surface {
    let border = |k: usize| {
        let (quarter, i) = (k / cells % 4, (k % cells) as f64);
        let (a, b) = (cells as f64 - i, i);
        let p = [Vec3::new(a, b, 0.0), Vec3::new(-b, a, 0.0), Vec3::new(-a, -b, 0.0), Vec3::new(b, -a, 0.0)];
        p[quarter].normalize()
    };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..4 * cells {
        let first = vertices.len() as u32;
        let [p, q] = [border(k), border(k + 1)];
        vertices.extend([p * radii[0], p * radii[1], q * radii[1], q * radii[0]]);
        let quad = [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| first + i));
        triangles.extend(quad.map(|[a, b, c]| if sign > 0.0 { [a, b, c] } else { [a, c, b] }));
    }
    Surface::new(vertices, triangles).unwrap().welded(SAME).unwrap()
}

fn joined(parts: &[Surface]) -> Surface {
    let parts: Vec<(&Surface, Filling)> = parts.iter().map(|part| (part, Filling::Sheet)).collect();
    together(&parts).0
}

#[test]
fn a_coating_in_two_halves_agrees_with_the_series() {
    // Three media meet at the equator of the core.
    let radii = [0.18 * WAVELENGTH, 0.27 * WAVELENGTH];
    let permittivities: [Complex64; 3] = [2.5.into(), 2.5.into(), 5.0.into()];
    let mut errors = Vec::new();
    for cells in [4, 8] {
        // The area of the polyhedron is that of the sphere.
        let area: f64 = {
            let unit = half_sphere(1.0, cells, 1.0);
            (0..unit.triangles().len()).map(|t| unit.area(t)).sum()
        };
        let scale = (std::f64::consts::TAU / area).sqrt();
        let [inner, outer] = radii.map(|radius| radius * scale);
        let core = joined(&[half_sphere(inner, cells, 1.0), half_sphere(inner, cells, -1.0)]);
        // Seen from the coating, the core's half is turned over.
        let coat = |sign: f64| {
            let inward = half_sphere(inner, cells, sign);
            let turned = inward.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
            let inward = Surface::new(inward.vertices().to_vec(), turned).unwrap();
            joined(&[half_sphere(outer, cells, sign), inward, ring([inner, outer], cells, -sign)])
        };
        let (north, south) = (coat(1.0), coat(-1.0));
        let regions = regions(&[
            (&north, Filling::Dielectric(0)),
            (&south, Filling::Dielectric(1)),
            (&core, Filling::Dielectric(2)),
        ])
        .unwrap();
        assert_eq!(regions.media(), [None, Some(0), Some(1), Some(2)]);
        let found = found(&regions, &permittivities, &around(radii[1]), &[Vec3::ZERO]);
        let layers = vec![(radii[0], permittivities[2]), (radii[1], permittivities[0])];
        let exact = LayeredSphere::new(None, layers).unwrap();
        let error =
            relative_error(&found.far, &of_series(&circle(), |p| exact.scattered(&wave(), &source(), p)));
        println!("{cells} cells: {} unknowns, far {error:.5}, power {:.5}", found.unknowns, found.power);
        assert!((found.power - 1.0).abs() < 2e-3, "{}", found.power);
        errors.push(error);
    }
    assert!(errors[1] < 0.012 && errors[0] / errors[1] > 2.5, "{errors:?}");
}

/// A box between two corners.
fn box_between(low: Vec3, high: Vec3, edge: f64) -> Surface {
    let whole = cuboid(high - low, edge, Grading::default()).unwrap();
    let vertices = whole.vertices().iter().map(|v| *v + 0.5 * (low + high)).collect();
    Surface::new(vertices, whole.triangles().to_vec()).unwrap()
}

#[test]
fn a_border_between_equal_dielectrics_is_none() {
    let (edge, side) = (WAVELENGTH / 12.0, 0.25 * WAVELENGTH);
    let lower = box_between(Vec3::splat(-side), Vec3::new(side, side, 0.0), edge);
    let upper = box_between(Vec3::new(-side, -side, 0.0), Vec3::splat(side), edge);
    let permittivity = Complex64::new(2.0, -0.2);
    let near = around(2.0 * side);
    let inside = [Vec3::new(0.01, 0.02, 0.03), Vec3::new(0.01, -0.02, -0.03)];
    let of = |second: usize| {
        let fillings = [Filling::Dielectric(0), Filling::Dielectric(second)];
        let regions = regions(&[(&lower, fillings[0]), (&upper, fillings[1])]).unwrap();
        let count = regions.surface().triangles().len();
        (count, found(&regions, &[permittivity; 2], &near, &inside))
    };
    // Of the same number the faces between are left out; of two they are there.
    let ((without, one), (with, two)) = (of(0), of(1));
    assert!(with > without, "{with} {without}");
    let error = relative_error(&two.far, &one.far).max(relative_error(&two.near, &one.near));
    println!("{} and {} unknowns: {error:.5}", one.unknowns, two.unknowns);
    assert!(error < 4e-3, "{error}");
    let e = |found: &Found| {
        let fields: Vec<Field> = found.inside.iter().copied().map(Option::unwrap).collect();
        vertical(&fields)
    };
    assert!(relative_error(&e(&two), &e(&one)) < 0.02, "{:?} {:?}", e(&two), e(&one));
}

/// Conductors at a box of free space, cut into edges of this length.
fn at_a_box(edge: f64) -> [(&'static str, Surface, Filling); 4] {
    let side = 0.2 * WAVELENGTH;
    let below = box_between(Vec3::new(0.0, 0.0, -side), Vec3::new(2.0 * side, 2.0 * side, 0.0), edge);
    let (u, v) = (Vec3::X * (2.0 * side), Vec3::Z * (2.0 * side));
    let sheet = |corner, u, v| rectangle(corner, u, v, edge, Grading::default()).unwrap();
    let patch = sheet(Vec3::Y * (2.0 * side), u, v);
    let wing = joined(&[patch.clone(), sheet(Vec3::new(0.0, 2.0 * side, 2.0 * side), u, Vec3::Y * side)]);
    let within = sheet(Vec3::splat(0.5 * side), u * 0.5, v * 0.5);
    [
        ("a body that touches it with a face", below, Filling::Conductor),
        ("a sheet on a face of it", patch, Filling::Sheet),
        ("a sheet on a face that goes on outside", wing, Filling::Sheet),
        ("a sheet within", within, Filling::Sheet),
    ]
}

#[test]
fn a_dielectric_of_free_space_at_conductors_vanishes_with_the_edges() {
    let source = source();
    let bare = |surface: &Surface| {
        let basis = Basis::new(surface.clone()).unwrap();
        let body = Conductor::new(&basis, wave(), Equation::Electric, TOLERANCE).unwrap();
        let b = body.right_hand_side(&[&[&source as &dyn Source]]);
        let x = solved(&body.operator().coupling().unwrap(), &b);
        vertical(&Currents::new(&basis, wave(), &x.vector(0), None).fields(&circle()).unwrap())
    };
    // Errors at λ/9 and λ/18: the field is singular at edges of conductors on a border.
    let errors = [9.0, 18.0].map(|per_wavelength| {
        let edge = WAVELENGTH / per_wavelength;
        let airy = box_between(Vec3::ZERO, Vec3::splat(0.4 * WAVELENGTH), edge);
        at_a_box(edge).map(|(name, metal, kind)| {
            let regions = regions(&[(&metal, kind), (&airy, Filling::Dielectric(0))]).unwrap();
            let found = found(&regions, &[1.0.into()], &[], &[]);
            let error = relative_error(&found.far, &bare(&metal));
            println!("{name}: {} unknowns, {error:.5}, power {:.5}", found.unknowns, found.power);
            [error, (found.power - 1.0).abs()]
        })
    });
    let bounds = [0.008, 0.045, 0.012, 0.002];
    for ((coarse, fine), bound) in errors[0].iter().zip(&errors[1]).zip(bounds) {
        assert!(fine[0] < bound && fine[0] < 0.65 * coarse[0], "{fine:?} {coarse:?} {bound}");
        assert!(fine[1] < 2e-3, "{fine:?}");
    }
}

#[test]
fn the_matrix_is_symmetric_and_the_compressed_one_gives_the_same_products() {
    let (edge, side) = (WAVELENGTH / 10.0, 0.2 * WAVELENGTH);
    let lower = box_between(Vec3::splat(-side), Vec3::new(side, side, 0.0), edge);
    let upper = box_between(Vec3::new(-side, -side, 0.0), Vec3::splat(side), edge);
    let regions = regions(&[(&lower, Filling::Conductor), (&upper, Filling::Dielectric(0))]).unwrap();
    let basis = Basis::between(regions).unwrap();
    let body = Composite::new(&basis, wave(), &[Complex64::new(3.0, -0.5)], TOLERANCE).unwrap();
    let operator = body.operator();
    let dense = operator.dense().unwrap();
    let settings = fredholm_compressed::Settings { tolerance: 1e-4, leaf: 16, ..Default::default() };
    let compressed = operator.compressed(settings, &fredholm_linop::Quiet).unwrap();
    let x =
        fredholm_linop::MultiVector::from_fn(operator.dim(), 1, |i, _| Complex64::cis((i * i % 91) as f64));
    let [mut whole, mut parts] = [0, 1].map(|_| fredholm_linop::MultiVector::zeros(operator.dim(), 1));
    fredholm_linop::LinearOperator::apply(&dense, &x, &mut whole);
    fredholm_linop::LinearOperator::apply(&compressed, &x, &mut parts);
    assert!(relative_error(&parts.vector(0), &whole.vector(0)) < 1e-3);
    // Entry by entry, in blocks that know nothing of each other.
    let [some, others] = [0..20, 20..basis.len()].map(|range| operator.prepare(range));
    let widths: usize = (0..20).map(|f| if basis.functions()[f].magnetic { 2 } else { 1 }).sum();
    let rest = operator.dim() - widths;
    let [mut there, mut back] = [0, 1].map(|_| vec![Complex64::ZERO; widths * rest]);
    operator.fill(&some, &others, &mut there);
    operator.fill(&others, &some, &mut back);
    let turned: Vec<Complex64> =
        (0..widths).flat_map(|i| (0..rest).map(move |j| (i, j))).map(|(i, j)| back[j * widths + i]).collect();
    assert!(relative_error(&turned, &there) < 1e-3, "{}", relative_error(&turned, &there));
}

#[test]
fn bodies_that_are_none_are_refused() {
    let filling = Filling::Dielectric(0);
    let open = plate(0.3, 0.05, Grading::default()).unwrap();
    assert!(matches!(regions(&[(&open, filling)]), Err(MomentsError::NotClosed { .. })));
    let ball = sphere(0.3, 0.05).unwrap();
    let ball_regions = regions(&[(&ball, filling)]).unwrap();
    let basis = Basis::between(ball_regions).unwrap();
    let new = |permittivity: Complex64| Composite::new(&basis, wave(), &[permittivity], 1e-3).map(|_| ());
    assert!(matches!(new(400.0.into()), Err(MomentsError::Coarse { .. })));
    assert!(matches!(new(Complex64::new(2.0, 0.5)), Err(MomentsError::Parameter { .. })));
    assert!(matches!(new(Complex64::new(0.0, -0.5)), Err(MomentsError::Parameter { .. })));
    let none = Composite::new(&basis, wave(), &[], 1e-3).map(|_| ());
    assert!(matches!(none, Err(MomentsError::Parameter { .. })));
    let inverted = ball.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let inverted = Surface::new(ball.vertices().to_vec(), inverted).unwrap();
    assert!(matches!(regions(&[(&inverted, filling)]), Err(MomentsError::InsideOut { .. })));
    assert!(matches!(regions(&[(&ball, filling), (&ball, filling)]), Err(MomentsError::Repeated { .. })));
    // Boxes that touch with different cells, and that cross.
    let below = box_between(Vec3::splat(-0.1), Vec3::new(0.1, 0.1, 0.0), 0.06);
    let above =
        |edge: f64, shift: f64| box_between(Vec3::new(-0.1, -0.1, -shift), Vec3::new(0.1, 0.1, 0.1), edge);
    let both = |other: &Surface| regions(&[(&below, filling), (other, Filling::Dielectric(1))]).map(|_| ());
    assert_eq!(both(&above(0.06, 0.0)), Ok(()));
    assert!(matches!(both(&above(0.04, 0.0)), Err(MomentsError::Unmatched { .. })));
    assert!(both(&above(0.06, 0.03)).is_err());
}
