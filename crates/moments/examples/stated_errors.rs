//! Indicators of the error beside the true one, as CSV: what `fredholm_waves::Indicator` is
//! calibrated on.
//!
//!     cargo run --release -p fredholm-moments --example stated_errors > tests/data/wave/stated_errors.csv
//!
//! With `facets`, `sheets` or `closed` behind it that part alone.

#![allow(clippy::unwrap_used, reason = "an example shows the way, not what may go wrong on it")]

#[path = "../tests/common/mod.rs"]
mod common;
mod wave_cases;

use common::{WAVELENGTH, solved, wave};
use fredholm_iterative::Gmres;
use fredholm_linop::{LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_moments::{Basis, Composite, Conductor, Currents, Equation, Filling, Regions};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{
    Bounced, Complex64, ComplexVector, DielectricSphere, EdgeCurrents, Indicator, PhysicalOptics, Scatterer,
    Shadow, Source, System, field_inside, inside_points, left_inside, of_closed_elements,
};
use wave_cases::{Body, Case, calibration, directions, error, small_bodies, small_sheets};

type Vectors = MultiVector<Complex64>;
/// What several excitations give.
type RightHandSide<'a> = dyn Fn(&[&[&dyn Source]]) -> Vectors + 'a;
/// A part of the calibration, seen from some directions.
type Part = fn(&[Vec3]);

fn all(system: &System<'_>, b: &Vectors) -> Vectors {
    let one = Vectors::from_fn(b.dim(), 1, |_, _| Complex64::ONE);
    let a = SecondKind::new(system.coupling(), one).unwrap();
    let mut x = Vectors::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-4, max_iterations: 300 };
    Gmres { restart: 60 }.solve(&a, b, &mut x, &stop, &mut Quiet).unwrap();
    x
}

fn norm(a: &[ComplexVector]) -> f64 {
    a.iter().map(|a| a.norm_squared()).sum::<f64>().sqrt()
}

/// The name, the treatment, the indicator and the true error.
fn row(case: &Case, shadow: Shadow, indicator: Indicator, true_error: f64) {
    let kind = format!("{indicator:?}");
    let kind = kind.split('(').next().unwrap();
    println!("{},{},{kind},{:.5},{true_error:.5}", case.name, shadow.name(), indicator.value());
}

fn run(case: &Case, body: &Scatterer, shadow: Shadow, truth: &[ComplexVector], u: &[Vec3]) {
    let source = case.source();
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(body, wave(), &sources, shadow).unwrap();
    let system = System::lazy(body, wave(), shadow).unwrap();
    let currents = system.currents(&all(&system, &system.right_hand_side(&[&first])), 0);
    let currents = Bounced::new(body, &first, &currents);
    let radiator = system.radiator(&currents);
    let far: Vec<ComplexVector> =
        radiator.far_field(u).unwrap().into_iter().map(|far| far.amplitude).collect();
    if let Some(inside) = field_inside(body, &wave(), &sources, &radiator).unwrap() {
        let indicator = if shadow.is_equation() {
            Indicator::InsideEquation(inside)
        } else {
            Indicator::InsideOptics(inside)
        };
        return row(case, shadow, indicator, error(&far, truth));
    }
    let edges = EdgeCurrents::of_bounces(body, wave(), &sources, &currents).unwrap();
    let edge: Vec<ComplexVector> = u.iter().map(|&u| edges.far_amplitude(u)).collect();
    let both: Vec<ComplexVector> = far.iter().zip(&edge).map(|(far, edge)| *far + *edge).collect();
    row(case, shadow, Indicator::EdgesLeft(norm(&edge) / norm(&far)), error(&far, truth));
    row(case, shadow, Indicator::EdgesAdded(norm(&edge) / norm(&both)), error(&both, truth));
}

/// The electric field equation on even cells of several sizes, beside cells far finer and graded.
fn boundary_elements(u: &[Vec3]) {
    for bodies in small_sheets() {
        let truths = Case::truths(&bodies, u, 20.0, 2);
        for per in [4.5, 6.0, 8.0, 10.0] {
            let indicator = Indicator::BoundaryElements(bodies[0].longest_edge(per));
            for ((case, far), truth) in bodies.iter().zip(Case::truths(&bodies, u, per, 0)).zip(&truths) {
                println!(
                    "{},efie,BoundaryElements,{:.5},{:.5}",
                    case.name,
                    indicator.value(),
                    error(&far, truth)
                );
            }
        }
    }
}

/// Boundary elements of closed bodies on even cells of several sizes: conductors by both equations,
/// and dielectric balls.
fn closed_elements(u: &[Vec3]) {
    for bodies in small_bodies() {
        let truths = Case::truths(&bodies, u, 14.0, 1);
        for per in [5.0, 7.0, 10.0] {
            let surface = bodies[0].surface(per);
            let basis = Basis::new(surface).unwrap();
            let points = inside_points(&bodies[0].scatterer(per), &wave()).unwrap();
            for equation in [Equation::Electric, Equation::default()] {
                let conductor = Conductor::new(&basis, wave(), equation, 1e-3).unwrap();
                let x = right_hand_sides_solved(
                    &bodies,
                    &conductor.operator().coupling().unwrap(),
                    &|excitations| conductor.right_hand_side(excitations),
                );
                for (rhs, (case, truth)) in bodies.iter().zip(&truths).enumerate() {
                    let currents = Currents::new(&basis, wave(), &x.vector(rhs), None);
                    let electric = equation == Equation::Electric;
                    let of = if electric { Indicator::InsideElectric } else { Indicator::InsideCombined };
                    let name = if electric { "efie" } else { "cfie" };
                    inside_row(case, (name, 1.0, &of), (&currents, &basis), &points, (truth, u));
                }
            }
        }
    }
    for (radius, permittivity) in [(0.15, 2.0), (0.25, 3.0), (0.4, 2.5), (0.25, 5.0)] {
        for lossy in [0.0, -0.5] {
            let permittivity = Complex64::new(permittivity, lossy);
            let ways = &calibration()[0];
            let bodies = [Case { name: "dielectric ball", body: Body::Sphere(radius), ..ways[0].clone() }];
            let exact = DielectricSphere::new(radius * WAVELENGTH, permittivity).unwrap();
            let far = 1e6 * WAVELENGTH;
            let back = Complex64::cis(wave().wavenumber() * far) * far;
            let truth: Vec<ComplexVector> =
                u.iter().map(|&u| exact.scattered(&wave(), &bodies[0].source(), u * far) * back).collect();
            for per in [5.0, 8.0, 11.0] {
                let per = per * permittivity.re.sqrt();
                let surface = bodies[0].surface(per);
                let solid = vec![Filling::Dielectric(0); surface.triangles().len()];
                let regions = Regions::new(&surface, &solid).unwrap();
                let basis = Basis::between(regions).unwrap();
                let points = inside_points(&bodies[0].scatterer(per), &wave()).unwrap();
                let body = Composite::new(&basis, wave(), &[permittivity], 1e-3).unwrap();
                let x =
                    right_hand_sides_solved(&bodies, &body.operator().coupling().unwrap(), &|excitations| {
                        body.right_hand_side(excitations)
                    });
                let currents = body.currents(&x.vector(0));
                let shorter = permittivity.sqrt().norm();
                let of = ("pmchwt", shorter, &Indicator::InsideDielectric as &dyn Fn(f64) -> Indicator);
                inside_row(&bodies[0], of, (&currents, &basis), &points, (&truth, u));
            }
        }
    }
}

/// The solution for every case.
fn right_hand_sides_solved(
    cases: &[Case],
    coupling: &dyn LinearOperator<Complex64>,
    right_hand_side: &RightHandSide<'_>,
) -> Vectors {
    let sources: Vec<PlaneWave> = cases.iter().map(Case::source).collect();
    let excitations: Vec<[&dyn Source; 1]> = sources.iter().map(|source| [source as &dyn Source]).collect();
    let excitations: Vec<&[&dyn Source]> = excitations.iter().map(|sources| &sources[..]).collect();
    solved(coupling, &right_hand_side(&excitations))
}

fn inside_row(
    case: &Case,
    (method, shorter, of): (&str, f64, &dyn Fn(f64) -> Indicator),
    (currents, basis): (&Currents<'_>, &Basis),
    points: &[Vec3],
    (truth, u): (&[ComplexVector], &[Vec3]),
) {
    let source = case.source();
    let inside = left_inside(&wave(), &[&source], points, &currents.fields(points).unwrap()).unwrap();
    let far: Vec<ComplexVector> =
        currents.far_field(u).unwrap().into_iter().map(|far| far.amplitude).collect();
    let edge = basis.topology().longest_edge(basis.surface());
    let value = of_closed_elements(inside, shorter * edge / WAVELENGTH);
    let kind = format!("{:?}", of(value));
    let kind = kind.split('(').next().unwrap();
    println!("{},{method},{kind},{value:.5},{:.5}", case.name, error(&far, truth));
}

/// Currents on facets, after all bounces.
fn facets(u: &[Vec3]) {
    for bodies in calibration() {
        let truths = Case::truths(&bodies, u, 8.0, 1);
        let body = bodies[0].scatterer(8.0);
        for (case, truth) in bodies.iter().zip(&truths) {
            let shadows = if matches!(case.body, Body::Plates(_)) {
                vec![Shadow::Radiated]
            } else {
                vec![Shadow::Geometric, Shadow::ExactDual]
            };
            for shadow in shadows {
                run(case, &body, shadow, truth, u);
            }
        }
    }
}

fn main() {
    let u = directions();
    let wanted = std::env::args().nth(1).unwrap_or_default();
    println!("case,treatment,indicator,value,true_error");
    let parts: [(&str, Part); 3] =
        [("facets", facets), ("sheets", boundary_elements), ("closed", closed_elements)];
    for (_, part) in parts.iter().filter(|(name, _)| name.contains(&wanted)) {
        part(&u);
    }
}
