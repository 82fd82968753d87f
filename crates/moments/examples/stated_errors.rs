//! Indicators of the error beside the true one, as CSV: what `fredholm_waves::Indicator` is
//! calibrated on.
//!
//!     cargo run --release -p fredholm-moments --example stated_errors > tests/data/wave/stated_errors.csv
//!
//! With `facets`, `sheets`, `closed`, `small` or `imperfect` behind it that part alone.

#![allow(clippy::unwrap_used, reason = "an example shows the way, not what may go wrong on it")]

#[path = "../tests/common/mod.rs"]
mod common;
mod wave_cases;

use common::{WAVELENGTH, solved, wave};
use fredholm_iterative::Gmres;
use fredholm_linop::{LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_moments::{
    Basis, Composite, Condition, Conductor, Currents, Equation, Filling, Imperfect, Order, Regions, Surface,
    Topology,
};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{
    Bounced, Complex64, ComplexVector, DielectricSphere, EdgeCurrents, Field, ImpedanceSphere, Indicator,
    PhysicalOptics, ResistiveShell, Scatterer, Shadow, Source, System, field_inside, inside_points,
    left_inside, of_closed_elements, of_closed_first_order,
};
use wave_cases::{
    Body, Case, calibration, directions, error, far_series, small_bodies, small_sheets, tiny_bodies,
    tiny_sheets,
};

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
            let found = Case::truths(&bodies, u, per, 0);
            sheets(&bodies, (&bodies[0].surface(per), "efie"), &found, &truths);
        }
    }
}

/// The same of bodies that are small beside the wavelength.
fn small(u: &[Vec3]) {
    for (size, bodies) in tiny_bodies() {
        let truths = Case::truths(&bodies, u, 14.0 / size, 1);
        for per in [4.0, 6.0, 9.0] {
            conductors(&bodies, per / size, &truths, u);
        }
    }
    for (size, bodies) in tiny_sheets() {
        let truths = Case::truths(&bodies, u, 20.0 / size, 2);
        for per in [4.5, 6.0, 8.0, 10.0] {
            let found = Case::truths(&bodies, u, per / size, 0);
            sheets(&bodies, (&bodies[0].surface(per / size), "efie"), &found, &truths);
        }
    }
}

/// Rows of sheets whose cells are even.
fn sheets(
    cases: &[Case],
    (surface, treatment): (&Surface, &str),
    found: &[Vec<ComplexVector>],
    truths: &[Vec<ComplexVector>],
) {
    let topology = Topology::new(surface);
    let edge = topology.relative_edge(surface, WAVELENGTH);
    let indicator = if topology.is_open() {
        Indicator::BoundaryElements(edge)
    } else {
        Indicator::ShellElements(of_closed_elements(0.0, edge))
    };
    for ((case, far), truth) in cases.iter().zip(found).zip(truths) {
        element_row(case, treatment, indicator, error(far, truth));
    }
}

/// Surface impedances and resistive sheets: balls, a cube, shells and plates.
fn imperfect(u: &[Vec3]) {
    let impedances =
        [Complex64::new(20.0, 20.0), 100.0.into(), 377.0.into(), Complex64::new(50.0, -150.0), 1500.0.into()];
    for z in impedances {
        for radius in [0.15, 0.3, 0.5] {
            let bodies = [Case { name: "ball", body: Body::Sphere(radius), ..calibration()[0][0].clone() }];
            let ball = ImpedanceSphere::new(radius * WAVELENGTH, z).unwrap();
            let shell = ResistiveShell::new(radius * WAVELENGTH, z).unwrap();
            let source = bodies[0].source();
            let on_ball = [far_series(u, |p| ball.scattered(&wave(), &source, p))];
            let on_shell = [far_series(u, |p| shell.scattered(&wave(), &source, p))];
            for per in [5.0, 7.0, 10.0] {
                let surface = bodies[0].surface(per);
                coated(&bodies, per, (&surface, Condition::Body(z)), &on_ball, u);
                let found = of_condition(&bodies, &surface, Condition::Sheet(z), u);
                sheets(&bodies, (&surface, "shell"), &found, &on_shell);
            }
        }
        for bodies in [small_bodies().remove(0), small_bodies().remove(2)] {
            let fine = bodies[0].finer(14.0, 1);
            let truths = of_condition(&bodies, &fine, Condition::Body(z), u);
            for per in [5.0, 7.0, 10.0] {
                coated(&bodies, per, (&bodies[0].surface(per), Condition::Body(z)), &truths, u);
            }
        }
        for bodies in [small_sheets().remove(1), small_sheets().remove(2)] {
            let truths = of_condition(&bodies, &bodies[0].finer(20.0, 2), Condition::Sheet(z), u);
            for per in [4.5, 6.0, 8.0, 10.0] {
                let surface = bodies[0].surface(per);
                let found = of_condition(&bodies, &surface, Condition::Sheet(z), u);
                sheets(&bodies, (&surface, "sheet"), &found, &truths);
            }
        }
    }
}

/// Rows of bodies with a surface impedance.
fn coated(
    cases: &[Case],
    per: f64,
    (surface, condition): (&Surface, Condition),
    truths: &[Vec<ComplexVector>],
    u: &[Vec3],
) {
    let points = inside_points(&cases[0].scatterer(per), &wave()).unwrap();
    let (found, inside) = of_condition_at(cases, surface, condition, u, &points);
    let edge = Topology::new(surface).relative_edge(surface, WAVELENGTH);
    for (((case, far), inside), truth) in cases.iter().zip(&found).zip(inside).zip(truths) {
        let source = case.source();
        let left = left_inside(&wave(), &[&source], &points, &inside).unwrap();
        let indicator = Indicator::InsideImpedance(of_closed_elements(left, edge));
        element_row(case, "impedance", indicator, error(far, truth));
    }
}

/// Far fields of every case, and the fields at some points.
type Found = (Vec<Vec<ComplexVector>>, Vec<Vec<Field>>);

/// The far fields alone.
fn of_condition(
    cases: &[Case],
    surface: &Surface,
    condition: Condition,
    u: &[Vec3],
) -> Vec<Vec<ComplexVector>> {
    of_condition_at(cases, surface, condition, u, &[]).0
}

fn of_condition_at(
    cases: &[Case],
    surface: &Surface,
    condition: Condition,
    u: &[Vec3],
    points: &[Vec3],
) -> Found {
    let basis = Basis::new(surface.clone()).unwrap();
    let body = Imperfect::new(&basis, wave(), vec![condition; surface.triangles().len()], 1e-3).unwrap();
    let x = right_hand_sides_solved(cases, &body.operator().coupling().unwrap(), &|excitations| {
        body.right_hand_side(excitations)
    });
    let of = |rhs: usize| {
        let currents = body.currents(&x.vector(rhs));
        let far = currents.far_field(u).unwrap().into_iter().map(|far| far.amplitude).collect();
        (far, currents.fields(points).unwrap())
    };
    (0..cases.len()).map(of).unzip()
}

/// Boundary elements of conductors.
fn conductors(bodies: &[Case], per: f64, truths: &[Vec<ComplexVector>], u: &[Vec3]) {
    let surface = bodies[0].surface(per);
    let basis = Basis::new(surface).unwrap();
    let points = inside_points(&bodies[0].scatterer(per), &wave()).unwrap();
    for equation in [Equation::Electric, Equation::default()] {
        let conductor = Conductor::new(&basis, wave(), equation, 1e-3).unwrap();
        let x = right_hand_sides_solved(bodies, &conductor.operator().coupling().unwrap(), &|excitations| {
            conductor.right_hand_side(excitations)
        });
        for (rhs, (case, truth)) in bodies.iter().zip(truths).enumerate() {
            let currents = Currents::new(&basis, wave(), &x.vector(rhs), None);
            let electric = equation == Equation::Electric;
            let of = if electric { Indicator::InsideElectric } else { Indicator::InsideCombined };
            let name = if electric { "efie" } else { "cfie" };
            inside_row(case, (name, 1.0, &of), (&currents, &basis), &points, (truth, u));
        }
    }
}

/// Boundary elements of closed bodies on even cells of several sizes: conductors by both equations,
/// and dielectric balls.
fn closed_elements(u: &[Vec3]) {
    for bodies in small_bodies() {
        let truths = Case::truths(&bodies, u, 14.0, 1);
        for per in [5.0, 7.0, 10.0] {
            conductors(&bodies, per, &truths, u);
        }
    }
    for (radius, permittivity) in [(0.15, 2.0), (0.25, 3.0), (0.4, 2.5), (0.25, 5.0)] {
        for lossy in [0.0, -0.5] {
            let permittivity = Complex64::new(permittivity, lossy);
            let ways = &calibration()[0];
            let bodies = [Case { name: "dielectric ball", body: Body::Sphere(radius), ..ways[0].clone() }];
            let exact = DielectricSphere::new(radius * WAVELENGTH, permittivity).unwrap();
            let source = bodies[0].source();
            let truth = far_series(u, |p| exact.scattered(&wave(), &source, p));
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

/// Functions of the first full order: closed conductors by both equations, and sheets.
fn first_order(u: &[Vec3]) {
    for bodies in small_bodies() {
        let truths = Case::fine_truths(&bodies, u, 6.0, 2);
        for per in [3.1, 4.0, 5.0, 7.0] {
            let surface = bodies[0].of_first_order(per);
            let basis = Basis::of_order(surface, Order::First).unwrap();
            for (equation, name) in [(Equation::Electric, "efie"), (Equation::default(), "cfie")] {
                let conductor = Conductor::new(&basis, wave(), equation, 1e-4).unwrap();
                let x = right_hand_sides_solved(&bodies, &conductor.operator().coupling().unwrap(), &|e| {
                    conductor.right_hand_side(e)
                });
                for (rhs, (case, truth)) in bodies.iter().zip(&truths).enumerate() {
                    let currents = Currents::new(&basis, wave(), &x.vector(rhs), None);
                    of_first_order(case, (name, per), (&currents, &basis), (truth, u));
                }
            }
        }
    }
    for bodies in small_sheets() {
        let truths = Case::fine_truths(&bodies, u, 8.0, 3);
        for per in [3.1, 4.0, 6.0] {
            let surface = bodies[0].of_first_order(per);
            let edge = Topology::new(&surface).relative_edge(&surface, WAVELENGTH);
            let basis = Basis::of_order(surface, Order::First).unwrap();
            let conductor = Conductor::new(&basis, wave(), Equation::Electric, 1e-4).unwrap();
            let x = right_hand_sides_solved(&bodies, &conductor.operator().coupling().unwrap(), &|e| {
                conductor.right_hand_side(e)
            });
            for (rhs, (case, truth)) in bodies.iter().zip(&truths).enumerate() {
                let currents = Currents::new(&basis, wave(), &x.vector(rhs), None);
                let far = currents.far_field(u).unwrap().into_iter().map(|far| far.amplitude);
                let error = error(&far.collect::<Vec<_>>(), truth);
                element_row(case, "efie", Indicator::OpenOfFirstOrder(edge), error);
            }
        }
    }
}

/// A row of a closed body.
fn of_first_order(
    case: &Case,
    (method, per): (&str, f64),
    (currents, basis): (&Currents<'_>, &Basis),
    (truth, u): (&[ComplexVector], &[Vec3]),
) {
    let source = case.source();
    let points = inside_points(&case.scatterer(per), &wave()).unwrap();
    let inside = left_inside(&wave(), &[&source], &points, &currents.fields(&points).unwrap()).unwrap();
    let far: Vec<ComplexVector> =
        currents.far_field(u).unwrap().into_iter().map(|far| far.amplitude).collect();
    let edge = basis.topology().relative_edge(basis.surface(), WAVELENGTH);
    let indicator = Indicator::InsideOfFirstOrder(of_closed_first_order(inside, edge));
    element_row(case, method, indicator, error(&far, truth));
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
    let edge = basis.topology().relative_edge(basis.surface(), WAVELENGTH / shorter);
    element_row(case, method, of(of_closed_elements(inside, edge)), error(&far, truth));
}

/// The name, the equation, the indicator and the true error.
fn element_row(case: &Case, equation: &str, indicator: Indicator, true_error: f64) {
    let kind = format!("{indicator:?}");
    let kind = kind.split('(').next().unwrap();
    println!("{},{equation},{kind},{:.6},{true_error:.6}", case.name, indicator.value());
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
    let parts: [(&str, Part); 6] = [
        ("facets", facets),
        ("sheets", boundary_elements),
        ("closed", closed_elements),
        ("small", small),
        ("imperfect", imperfect),
        ("first", first_order),
    ];
    for (_, part) in parts.iter().filter(|(name, _)| name.contains(&wanted)) {
        part(&u);
    }
}
