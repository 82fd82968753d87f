//! Boundary elements: the electric field integral equation of conductors, thin sheets and bodies
//! with a surface impedance, the combined one of conductors, and the equations of dielectric bodies
//! and conductors together, with Rao–Wilton–Glisson functions on triangles (crate `moments`,
//! docs/moments.md), their matrix stored, compressed or by multipoles (crate `compressed`).

use std::slice;

use fredholm_compressed::{
    BlockDiagonal, CompressionError, Diagonal, Factors, Hierarchical, MultipoleSettings, MultipoleSummary,
    Preconditioned, Settings,
};
use fredholm_linop::{Dense, LinearOperator, MultiVector, Solver};
use fredholm_mesh::{Shape, Vec3};
use fredholm_moments::{
    Basis, Composite, Condition, Conductor, Currents, Curve, Equation, Filling, Imperfect, MomentsError,
    Operator, Order, Placed, Regions, Surface, Topology,
};
use fredholm_report::{MonostaticRow, WaveCurrents};
use fredholm_scene::ErrorKind as SceneFault;
use fredholm_scene::waves::{About, Places};
use fredholm_waves::material::Material;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{
    Complex64, ComplexVector, Current, FarField, Field, Grounded, Indicator, Kind, Source, even_directions,
    incident, inside_points, left_inside, of_closed_elements, of_closed_first_order,
};

use super::balance::{Balancing, Reciprocity, power};
use super::compute::{current, directions, far_row, near_rows};
use super::estimate::{Estimated, SweepError};
use super::geometry::Geometry;
use super::model::{BY_MATRIX, BY_SYMMETRIC_MATRIX, Band};
use super::monostatic::plane_waves;
use super::record::Solved;
use super::registry::{build, by_products};
use super::solving::{Solution, of_solvers, rhs_count, solved};
use super::{CouplingStorage, Method, Model, Outcome};
use crate::error::{Error, ErrorKind};
use crate::memory::Plan;
use crate::problem::scene_failure;
use crate::size::Bytes;
use crate::stages::{Signals, Stages};

/// Relative error of the integrals over each pair of triangles: below that of usual meshes. The
/// combined equation is of the second kind, and takes no harm from more.
fn integral_error(model: &Model, equations: Equations) -> f64 {
    match (order(model), equations) {
        (Order::Lowest, _) | (Order::First, Equations::Combined) => 1e-3,
        (Order::First, Equations::Electric | Equations::Dielectric) => 1e-4,
    }
}

/// Relative error of the blocks of a compressed matrix.
fn compression_error(order: Order) -> f64 {
    match order {
        Order::Lowest => 1e-3,
        Order::First => 1e-4,
    }
}

/// The order of the functions.
pub(super) fn order(model: &Model) -> Order {
    if model.scene.settings().order == Some(1) { Order::First } else { Order::Lowest }
}

/// The solvers of compressed matrices where the scene names none: by their diagonal blocks, which
/// leave tens of iterations, and by their factors, which leave a few.
const COMPRESSED_SOLVERS: [&str; 2] = ["gmres:restart=100", "gmres:restart=30"];
/// Right-hand sides that are solved for together by a compressed matrix: a product of so many takes
/// hardly longer than that of a few, and an iterative solver holds tens of vectors for each.
const RHS_TOGETHER: usize = 16;
/// Vectors for each of those that preconditioned products hold.
const PRODUCT_VECTORS: usize = 3;
/// Relative error of the blocks of the factors that precondition it: a few iterations are left, and
/// finer factors cost more than they save (docs/notes/moments.md).
const FACTOR_ERROR: f64 = 1e-2;
/// Most bytes of the factors over those of the matrix: 0.72 to 0.95 were measured.
const FACTOR_SHARE: f64 = 1.2;
/// Unknowns from which on compressing the matrix takes less time than to store and to factorise it,
/// for few and for many right-hand sides (docs/notes/moments.md).
const LEAST_COMPRESSED_UNKNOWNS: [usize; 2] = [6_000, 15_000];
/// Bytes an unknown that the smallest compressed matrix takes for which there is a better choice:
/// multipoles that take more have too many unknowns near each other (docs/notes/moments.md).
const MOST_BYTES_OF_MULTIPOLES: u64 = 17_000;
/// Right-hand sides that are few.
const MOST_RHS_OF_COMPRESSED: usize = 8;
/// Directions in which the mean scattered field is taken that errors are compared with.
const DIRECTIONS: usize = 200;

/// The functions on the triangles of a mesh.
fn basis(model: &Model, geometry: &Geometry, equations: Equations) -> Result<Basis, Error> {
    let order = order(model);
    let mut surface = Surface::from_mesh(&geometry.mesh).map_err(|error| refused(model, &error))?;
    if order == Order::First {
        // Vertices that lie within edges would be moved away from these, and leave gaps.
        Topology::new(&surface).check(&surface).map_err(|error| refused(model, &error))?;
        let curves: Vec<Option<Curve>> = geometry.shapes().map(|shape| shape.and_then(curve)).collect();
        let curved = surface.on_curves(&on_triangles(geometry, &curves));
        surface = curved.map_err(|error| refused(model, &error))?;
    }
    let basis = if equations == Equations::Dielectric {
        let fillings = fillings(model, geometry)?;
        let regions = Regions::new(&surface, &fillings);
        let regions = regions.map_err(|error| refused_bodies(model, geometry, &error))?;
        Basis::between_of_order(regions, order)
    } else {
        Basis::of_order(surface, order)
    };
    let above = |basis: Basis| match model.scene.ground() {
        Some(ground) => basis.above(ground),
        None => Ok(basis),
    };
    basis.and_then(above).map_err(|error| refused(model, &error))
}

/// What the facets of a curved shape stand for.
fn curve(shape: &Shape) -> Option<Curve> {
    match *shape {
        Shape::Sphere { centre, radius, .. } => Some(Curve::Sphere { centre, radius }),
        Shape::Cylinder { base, axis, radius, .. } => Some(Curve::Cylinder { base, axis, radius }),
        Shape::Disc { centre, radius, .. } => Some(Curve::Disc { centre, radius }),
        _ => None,
    }
}

/// What every triangle bounds, for the equations of dielectrics: those of one material are one
/// dielectric.
fn fillings(model: &Model, geometry: &Geometry) -> Result<Vec<Filling>, Error> {
    let materials: Vec<usize> = geometry.materials().collect();
    // What a material is does not depend on the frequency.
    let Some(band) = model.bands.first() else { return Ok(Vec::new()) };
    let mut fillings = Vec::with_capacity(materials.len());
    for (surface, (&material, kind)) in materials.iter().zip(&geometry.kinds()).enumerate() {
        fillings.push(match (&band.materials[material], kind) {
            (Material::Conductor, Kind::Closed) => Filling::Conductor,
            (Material::Conductor, Kind::Sheet) => Filling::Sheet,
            (Material::HalfSpace(_), Kind::Closed) => Filling::Dielectric(material),
            (Material::HalfSpace(_), Kind::Sheet) => {
                let what = "a half_space fills a closed body, and this is a thin sheet";
                let help =
                    "close it, or take sheet = { permittivity = …, thickness_m = … } in method = \"efie\"";
                return Err(scene_failure(model.scene.error(
                    About::Surface(surface),
                    SceneFault::Value,
                    what,
                    help,
                )));
            }
            _ => {
                return Err(unsuited(
                    model,
                    surface,
                    "knows dielectric bodies and conductors only",
                    "give it a half_space, or none; method = \"efie\" knows sheets and surface impedances",
                ));
            }
        });
    }
    if !fillings.iter().any(|filling| matches!(filling, Filling::Dielectric(_))) {
        let what = "is for dielectric bodies, and there is none";
        let help = "give the material of a closed body a half_space, whose permittivity fills it, or take method = \"efie\" or \"cfie\"";
        return Err(unsuited(model, 0, what, help));
    }
    Ok(on_triangles(geometry, &fillings))
}

/// What is said of every surface, of each of the triangles.
fn on_triangles<T: Copy>(geometry: &Geometry, of_surface: &[T]) -> Vec<T> {
    let mesh = &geometry.mesh;
    let of_leaf = |(leaf, patch): (usize, &fredholm_mesh::Patch)| {
        // Quadrilaterals are two triangles.
        std::iter::repeat_n(of_surface[mesh.surface_of(leaf)], patch.sides() - 2)
    };
    mesh.patches().enumerate().flat_map(of_leaf).collect()
}

/// What is wrong with bodies, at the surface that it is about.
fn refused_bodies(model: &Model, geometry: &Geometry, error: &MomentsError) -> Error {
    let numbers: Vec<usize> = (0..geometry.kinds().len()).collect();
    let surface_of = on_triangles(geometry, &numbers);
    let names: Vec<&str> = model.scene.surface_names().collect();
    let name = |triangle: usize| names[surface_of[triangle]];
    let (triangle, what) = match *error {
        MomentsError::Unmatched { first, second } => {
            let [a, b] = [first, second].map(name);
            (
                second,
                format!("faces of `{a}` and `{b}` lie on each other, but are cut into different triangles"),
            )
        }
        MomentsError::Crossing { first, second } => {
            (second, format!("`{}` and `{}` cross", name(first), name(second)))
        }
        MomentsError::Repeated { first, second } => {
            (second, format!("`{}` and `{}` have the same face twice", name(first), name(second)))
        }
        MomentsError::NotClosed { triangle, .. } => (
            triangle,
            format!("the body with `{}` is not closed by surfaces of its material", name(triangle)),
        ),
        MomentsError::InsideOut { triangle } => {
            (triangle, format!("the normals of the body with `{}` point inwards", name(triangle)))
        }
        _ => return refused(model, error),
    };
    let help = error.help().unwrap_or("correct the surfaces");
    scene_failure(model.scene.error(About::Surface(surface_of[triangle]), SceneFault::Geometry, what, help))
}

/// What the library of boundary elements says.
fn refused(model: &Model, error: &MomentsError) -> Error {
    let help = error.help().unwrap_or("correct the surfaces");
    scene_failure(model.scene.error(About::Method, SceneFault::Geometry, error.to_string(), help))
}

/// Which equations are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Equations {
    /// The electric field equation of conductors, thin sheets and bodies with a surface impedance.
    Electric,
    /// The combined field equation of closed conductors.
    Combined,
    /// Those of dielectric bodies, and conductors with them.
    Dielectric,
}

impl Equations {
    /// The solver of their matrix where the scene names none: that of the combined equation alone
    /// is not symmetric.
    pub(super) fn direct_solver(self) -> &'static str {
        match self {
            Self::Electric | Self::Dielectric => BY_SYMMETRIC_MATRIX,
            Self::Combined => BY_MATRIX,
        }
    }
}

/// Computes everything that the model asks for at some of its frequencies on one of its meshes.
pub(super) fn run(
    model: &Model,
    bands: &[Band],
    (geometry, name): (&Geometry, &str),
    equations: Equations,
    (stages, outcome): (&mut Stages, &mut Outcome),
) -> Result<(), Error> {
    let basis = basis(model, geometry, equations)?;
    let first = name.is_empty();
    for band in bands {
        let body = Body::new(model, (geometry, &basis), band, equations)?;
        let name = format!("{} MHz{name}", band.wave.frequency() / 1e6);
        let known = if first { Known::of(geometry, &basis, band, equations) } else { None };
        Task { model, geometry, basis: &basis, band, body, known, first }
            .carry_out(&name, stages, outcome)?;
    }
    Ok(())
}

/// Rows of a matrix that are integrated for the time that it takes, in groups.
const SAMPLED_GROUPS: usize = 6;

/// Seconds that `spent` tells the matrices of the model take at its frequencies, from some rows.
pub(super) fn assembly(model: &Model, equations: Equations, spent: &dyn Fn() -> f64) -> Result<f64, Error> {
    let basis = basis(model, &model.geometry, equations)?;
    let mut seconds = 0.0;
    for band in &model.bands {
        let body = Body::new(model, (&model.geometry, &basis), band, equations)?;
        let began = spent();
        let share = body.operator().sample(SAMPLED_GROUPS);
        seconds += (spent() - began) / share;
    }
    Ok(seconds)
}

/// What the error is stated from.
enum Known {
    /// The mesh alone, of sheets and what is with them.
    Mesh(Indicator),
    /// Points inside closed bodies, and the indicator from the field there over the incident one.
    Inside { points: Vec<Vec3>, indicator: Box<dyn Fn(f64) -> Indicator> },
}

impl Known {
    /// Of everything but dielectrics with sheets, and with functions of the first full order of
    /// conductors only.
    fn of(geometry: &Geometry, basis: &Basis, band: &Band, equations: Equations) -> Option<Self> {
        let denser = |material: &Material| match material {
            Material::HalfSpace(permittivity) => permittivity.sqrt().norm(),
            _ => 1.0,
        };
        let shortest = band.wave.wavelength() / band.materials.iter().map(denser).fold(1.0, f64::max);
        let (surface, topology) = (basis.surface(), basis.topology());
        let edge = topology.relative_edge(surface, shortest);
        let (first, perfect) = (basis.order() == Order::First, is_perfect(geometry, band));
        let is_sheet = |material: usize| matches!(band.materials[material], Material::Sheet(_));
        if geometry.kinds().contains(&Kind::Sheet) || geometry.materials().any(is_sheet) {
            let indicator = match (topology.is_open(), first) {
                (true, true) => perfect.then_some(Indicator::OpenOfFirstOrder(edge)),
                (true, false) => Some(Indicator::BoundaryElements(edge)),
                (false, true) => None,
                (false, false) => Some(Indicator::ShellElements(of_closed_elements(0.0, edge))),
            };
            return indicator.filter(|_| equations == Equations::Electric).map(Self::Mesh);
        }
        let indicator = match equations {
            Equations::Dielectric if first => return None,
            Equations::Electric if first && !perfect => return None,
            _ if first => Indicator::InsideOfFirstOrder,
            Equations::Electric if perfect => Indicator::InsideElectric,
            Equations::Electric => Indicator::InsideImpedance,
            Equations::Combined => Indicator::InsideCombined,
            Equations::Dielectric => Indicator::InsideDielectric,
        };
        let of_closed = if first { of_closed_first_order } else { of_closed_elements };
        let scatterer = geometry.scatterer(&band.materials).ok()?;
        let stated = move |inside: f64| indicator(of_closed(inside, edge));
        inside_points(&scatterer, &band.wave)
            .map(|points| Self::Inside { points, indicator: Box::new(stated) })
    }
}

/// Whether all surfaces are perfect conductors.
fn is_perfect(geometry: &Geometry, band: &Band) -> bool {
    geometry.materials().all(|material| band.materials[material] == Material::Conductor)
}

/// What scatters, with its equations at one frequency.
enum Body<'a> {
    Conductor(Conductor<'a>),
    Imperfect(Imperfect<'a>),
    Dielectric(Composite<'a>),
}

impl<'a> Body<'a> {
    fn new(
        model: &Model,
        (geometry, basis): (&Geometry, &'a Basis),
        band: &Band,
        equations: Equations,
    ) -> Result<Self, Error> {
        let tolerance = integral_error(model, equations);
        let conductor = |equation| {
            all_of(model, band, |material| *material == Material::Conductor)?;
            Conductor::new(basis, band.wave, equation, tolerance)
                .map(Self::Conductor)
                .map_err(|error| refused(model, &error))
        };
        match equations {
            Equations::Electric if is_perfect(geometry, band) => conductor(Equation::Electric),
            Equations::Electric => {
                let conditions = conditions(model, geometry, band)?;
                Imperfect::new(basis, band.wave, conditions, tolerance)
                    .map(Self::Imperfect)
                    .map_err(|error| refused(model, &error))
            }
            Equations::Combined => conductor(Equation::default()),
            Equations::Dielectric => {
                let permittivity = |material: &Material| match material {
                    Material::HalfSpace(permittivity) => *permittivity,
                    // Of no region.
                    _ => Complex64::ONE,
                };
                let permittivities: Vec<Complex64> = band.materials.iter().map(permittivity).collect();
                Composite::new(basis, band.wave, &permittivities, tolerance)
                    .map(Self::Dielectric)
                    .map_err(|error| refused(model, &error))
            }
        }
    }

    fn operator(&self) -> &Operator<'a> {
        match self {
            Self::Conductor(body) => body.operator(),
            Self::Imperfect(body) => body.operator(),
            Self::Dielectric(body) => body.operator(),
        }
    }

    fn right_hand_side(&self, excitations: &[&[&dyn Source]]) -> MultiVector<Complex64> {
        match self {
            Self::Conductor(body) => body.right_hand_side(excitations),
            Self::Imperfect(body) => body.right_hand_side(excitations),
            Self::Dielectric(body) => body.right_hand_side(excitations),
        }
    }

    fn currents(&self, x: &[Complex64]) -> Currents<'a> {
        match self {
            Self::Conductor(body) => Currents::new(body.basis(), body.wave(), x, None),
            Self::Imperfect(body) => body.currents(x),
            Self::Dielectric(body) => body.currents(x),
        }
    }

    /// What the matrix by multipoles is made of, where there is one.
    fn multipole_summary(&self) -> Result<MultipoleSummary, MomentsError> {
        match self {
            Self::Conductor(body) => body.multipole_summary(multipole_settings(body.basis().order())),
            Self::Imperfect(_) | Self::Dielectric(_) => Err(MomentsError::Imperfect),
        }
    }

    /// Power that is absorbed, W; none where it is not computed.
    fn absorbed(&self, currents: &Currents<'a>) -> Option<f64> {
        match self {
            Self::Conductor(_) => Some(0.0),
            Self::Imperfect(body) => Some(body.absorbed_power(currents)),
            Self::Dielectric(_) => None,
        }
    }
}

/// What every triangle is made of, for the electric equation.
fn conditions(model: &Model, geometry: &Geometry, band: &Band) -> Result<Vec<Condition>, Error> {
    let materials: Vec<usize> = geometry.materials().collect();
    let kinds = geometry.kinds();
    let mut conditions = Vec::with_capacity(materials.len());
    for (surface, (&material, kind)) in materials.iter().zip(&kinds).enumerate() {
        conditions.push(match (&band.materials[material], kind) {
            (Material::Conductor, _) => Condition::Conductor,
            (Material::Sheet(z), _) => Condition::Sheet(*z),
            (Material::Impedance(z), Kind::Closed) => Condition::Body(*z),
            (Material::Impedance(_), Kind::Sheet) => {
                let what = "a surface impedance is that of a closed body, and this is a thin sheet";
                let help = "take sheet = { resistance_ohm = … }, or method = \"physical-optics\"";
                return Err(scene_failure(model.scene.error(
                    About::Surface(surface),
                    SceneFault::Value,
                    what,
                    help,
                )));
            }
            (Material::HalfSpace(_) | Material::Slab(_), _) => {
                return Err(unsuited(
                    model,
                    surface,
                    "knows conductors, thin sheets and surface impedances only",
                    "take one of these, method = \"pmchwt\" for a solid dielectric, or \"physical-optics\"",
                ));
            }
        });
    }
    Ok(on_triangles(geometry, &conditions))
}

/// An equation and a surface that do not go together.
fn unsuited(model: &Model, surface: usize, what: &str, help: &str) -> Error {
    let what = format!("{} {what}", model.method_name());
    scene_failure(model.scene.error(About::Surface(surface), SceneFault::Value, what, help))
}

/// Refuses a surface whose material does not suit.
fn all_of(model: &Model, band: &Band, suits: impl Fn(&Material) -> bool) -> Result<(), Error> {
    let other = |&material: &usize| !suits(&band.materials[material]);
    let Some(surface) = model.scene.materials_of_surfaces().position(|material| other(&material)) else {
        return Ok(());
    };
    let help = "leave the material out, or take method = \"efie\" for thin sheets and surface impedances, \"pmchwt\" for solid dielectrics, \"physical-optics\" for any material";
    Err(unsuited(model, surface, "knows perfect conductors only", help))
}

/// One frequency.
struct Task<'a> {
    model: &'a Model,
    geometry: &'a Geometry,
    basis: &'a Basis,
    band: &'a Band,
    body: Body<'a>,
    /// What the error is stated from, where it is.
    known: Option<Known>,
    /// Whether this is the run itself, not one that errors are estimated from.
    first: bool,
}

/// The matrix, as it is held.
enum Matrix {
    /// 1 − Z.
    Whole(Dense<Complex64>),
    /// Z, what preconditions it, and the solver.
    Compressed(Box<Compressed>),
}

/// Whether a compressed matrix of so many unknowns takes less time than a whole one.
fn is_quicker_compressed(model: &Model, unknowns: usize) -> bool {
    unknowns > LEAST_COMPRESSED_UNKNOWNS[usize::from(rhs_count(model) > MOST_RHS_OF_COMPRESSED)]
}

/// Whether the scene names a solver that needs the entries of the matrix.
fn needs_matrix(model: &Model) -> bool {
    let named = model.scene.settings().solver.is_some();
    named && !by_products().contains(&model.method.name().as_str())
}

/// Memory with the whole matrix, and how the matrix is held: as asked for, or what fits and is
/// quicker.
fn whole_plan(
    model: &Model,
    (basis, band, body): (&Basis, &Band, &Body<'_>),
    solver: &dyn Solver<Complex64>,
) -> Result<(Plan, CouplingStorage), Error> {
    let unknowns = body.operator().dim();
    let bytes = Dense::<Complex64>::bytes(unknowns);
    let mut plan = of_solvers(model.plan.clone(), (unknowns, rhs_count(model)), &[solver])
        .hold(format!("the matrix of {unknowns} unknowns"), bytes.into());
    if basis.order() == Order::First {
        let triangles = basis.surface().triangles().len() as u128;
        plan = plan.hold("functions at the points of rules", triangles * BYTES_OF_FIRST_ORDER);
    }
    let storage = match model.storage {
        Some(CouplingStorage::Multipole) => match body.multipole_summary() {
            Ok(_) => CouplingStorage::Multipole,
            Err(MomentsError::Compression(CompressionError::Small { .. })) => CouplingStorage::Compressed,
            Err(error) => return Err(refused(model, &error)),
        },
        Some(storage) => storage,
        None if needs_matrix(model) || loses_loops(model, basis, band) => CouplingStorage::Matrix,
        None if is_quicker_compressed(model, unknowns) || !plan.fits(model.limit) => {
            let is_small =
                |summary: MultipoleSummary| summary.bytes <= MOST_BYTES_OF_MULTIPOLES * unknowns as u64;
            if !takes_factors(model) && body.multipole_summary().is_ok_and(is_small) {
                CouplingStorage::Multipole
            } else {
                CouplingStorage::Compressed
            }
        }
        None => CouplingStorage::Matrix,
    };
    Ok((plan, storage))
}

/// Bytes for each triangle that the functions of the first full order take at the points of all
/// rules: 85 points of up to 664 bytes, and half of them once more at the borders of tiles.
const BYTES_OF_FIRST_ORDER: u128 = 85_000;

/// Edges in wavelengths below which a compressed matrix and iterative solvers lose currents around
/// loops: these have no charge, and act (2πh/λ)² times as much as the charges that errors in the
/// currents come with. Measured on spheres (docs/moments.md).
const LEAST_EDGE_OF_LOOPS: f64 = 1.0 / 200.0;

/// Whether a compressed matrix, or an iterative solver, would lose the currents around loops. That
/// of the combined equation has the magnetic one, which sees them.
fn loses_loops(model: &Model, basis: &Basis, band: &Band) -> bool {
    let edge = basis.topology().longest_edge(basis.surface());
    model.galerkin != Some(Equations::Combined) && edge < LEAST_EDGE_OF_LOOPS * band.wave.wavelength()
}

/// Whether a compressed matrix is preconditioned by its factors, and not by the blocks on its
/// diagonal: iterations of all equations but the combined one grow with the number of unknowns, and
/// those of the combined one for a few right-hand sides take as long as its factors.
fn takes_factors(model: &Model) -> bool {
    model.galerkin != Some(Equations::Combined) || rhs_count(model) > MOST_RHS_OF_COMPRESSED
}

/// Memory besides a compressed matrix.
fn besides_compressed(model: &Model, unknowns: usize, solver: &dyn Solver<Complex64>) -> Plan {
    let vectors = |count: usize| (count * unknowns * size_of::<Complex64>()) as u128;
    let (all, together) = (rhs_count(model), rhs_count(model).min(RHS_TOGETHER));
    of_solvers(model.plan.clone(), (unknowns, together), &[solver])
        .hold("what products hold", vectors(PRODUCT_VECTORS * together))
        .hold("the currents of all waves", vectors(2 * all))
}

/// Memory with multipoles and what preconditions them.
fn with_multipoles(plan: Plan, unknowns: usize, summary: &MultipoleSummary) -> Plan {
    plan.hold(format!("the multipoles of {unknowns} unknowns"), summary.bytes.into())
        .hold("the inverses of the blocks on their diagonal", summary.diagonal.into())
}

/// Memory with a compressed matrix and its factors.
fn with_compressed(model: &Model, plan: Plan, unknowns: usize, bytes: u64) -> Plan {
    let plan = plan.hold(format!("the compressed matrix of {unknowns} unknowns"), bytes.into());
    if takes_factors(model) { plan.hold("its factors", factor_bytes(bytes).into()) } else { plan }
}

/// Bytes predicted of the factors of a compressed matrix.
fn factor_bytes(matrix: u64) -> u64 {
    (FACTOR_SHARE * matrix as f64) as u64
}

/// The solver of a compressed matrix with factors or without.
fn of_compressed(model: &Model, with_factors: bool) -> Result<Box<dyn Solver<Complex64>>, Error> {
    let usual = COMPRESSED_SOLVERS[usize::from(with_factors)];
    let asked = model.scene.settings().solver.as_deref().unwrap_or(usual);
    build(asked).map_err(|error| Error::new(ErrorKind::Input, error))
}

/// What to do where it does not fit.
const COMPRESSED_HELP: &str = "take longer edges, or method = \"physical-optics\"";

fn settings(model: &Model) -> Settings {
    Settings { tolerance: compression_error(order(model)), ..Settings::default() }
}

fn multipole_settings(order: Order) -> MultipoleSettings {
    MultipoleSettings { tolerance: compression_error(order), ..MultipoleSettings::default() }
}

/// The memory of a run, how its matrix is held, and the unknowns; that of a compressed matrix from
/// some of its blocks.
pub(super) fn plan(model: &Model, equations: Equations) -> Result<(Plan, CouplingStorage, usize), Error> {
    let (Method::Solver { solver, .. }, Some(band)) = (&model.method, model.bands.first()) else {
        return Err(Error::new(ErrorKind::Input, "an equation is solved, not summed bounce by bounce"));
    };
    let basis = basis(model, &model.geometry, equations)?;
    let body = Body::new(model, (&model.geometry, &basis), band, equations)?;
    let unknowns = body.operator().dim();
    let (plan, storage) = whole_plan(model, (&basis, band, &body), &**solver)?;
    let plan = match storage {
        CouplingStorage::Compressed => {
            let bytes = body.operator().compressed_bytes(settings(model));
            let besides = besides_compressed(model, unknowns, &*of_compressed(model, takes_factors(model))?);
            with_compressed(model, besides, unknowns, bytes.map_err(|error| refused(model, &error))?)
        }
        CouplingStorage::Multipole => {
            let summary = body.multipole_summary().map_err(|error| refused(model, &error))?;
            let besides = besides_compressed(model, unknowns, &*of_compressed(model, false)?);
            with_multipoles(besides, unknowns, &summary)
        }
        CouplingStorage::Matrix | CouplingStorage::Products => plan,
    };
    Ok((plan, storage, unknowns))
}

struct Compressed {
    /// What the matrix is called.
    called: &'static str,
    matrix: Box<dyn LinearOperator<Complex64>>,
    inverse: Inverse,
    method: Method,
}

/// What preconditions a compressed matrix.
enum Inverse {
    Factors(Box<Factors<Complex64>>),
    Blocks(BlockDiagonal<Complex64>),
}

impl Inverse {
    fn operator(&self) -> &dyn LinearOperator<Complex64> {
        match self {
            Self::Factors(factors) => &**factors,
            Self::Blocks(blocks) => blocks,
        }
    }
}

impl Compressed {
    /// How its systems are solved.
    fn name(&self) -> String {
        let with = match self.inverse {
            Inverse::Factors(_) => "the factors of",
            Inverse::Blocks(_) => "the diagonal blocks of",
        };
        format!("{} with {with} {}", self.method.name(), self.called)
    }

    /// The solutions for all right-hand sides, some of them together, and how the worst of these
    /// was found.
    fn solve(&self, b: &MultiVector<Complex64>, signals: &Signals<'_>) -> Result<Solution, Error> {
        let system = Preconditioned::new(&*self.matrix, self.inverse.operator());
        let mut x = MultiVector::zeros(b.dim(), b.rhs_count());
        let mut worst: Option<Solution> = None;
        for first in (0..b.rhs_count()).step_by(RHS_TOGETHER) {
            let count = RHS_TOGETHER.min(b.rhs_count() - first);
            let some = MultiVector::from_fn(b.dim(), count, |i, rhs| b.row(i)[first + rhs]);
            let next = solved(&system, &system.right_hand_side(&some), &self.method, signals)?;
            copy_columns(&next.x, &mut x, first);
            worst = Solution::worse(worst, Some(next));
        }
        let (residuals, reason) =
            worst.map_or_else(Default::default, |worst| (worst.residuals, worst.reason));
        Ok(Solution { x, residuals, reason })
    }
}

/// The blocks on the diagonal as a preconditioner.
fn diagonal_blocks(matrix: &impl Diagonal<Complex64>) -> Result<Inverse, Error> {
    BlockDiagonal::new(matrix).map(Inverse::Blocks).map_err(|error| {
        let help = "--storage matrix, which needs no preconditioner";
        Error::new(ErrorKind::Input, error).with_help(help)
    })
}

/// Copies right-hand sides to those of another from `first` on.
fn copy_columns(from: &MultiVector<Complex64>, to: &mut MultiVector<Complex64>, first: usize) {
    for i in 0..from.dim() {
        to.row_mut(i)[first..first + from.rhs_count()].copy_from_slice(from.row(i));
    }
}

impl Task<'_> {
    fn carry_out(&self, name: &str, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Error> {
        let signals = &stages.signals();
        let matrix = stages.run(&format!("coupling at {name}"), || self.matrix(signals))?;
        if self.model.has_bistatic() {
            let sources = self.model.sources();
            let b = self.body.right_hand_side(&[&sources]);
            let solution = stages.run(&format!("currents at {name}"), || self.solve(&matrix, &b, signals))?;
            let currents = self.body.currents(&solution.x.vector(0));
            let error = self.error(&currents, &sources, solution.residual())?;
            stages.run(&format!("fields at {name}"), || self.receive(&currents, error.as_ref(), outcome))?;
            let values = self.on_facets(&currents).iter().map(current).collect();
            outcome.currents.push(WaveCurrents { name: name.to_owned(), values });
            outcome.solved.push(self.record(&matrix, solution));
        }
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            if let Places::Monostatic(angles) = &receiver.places {
                let sweep = || self.sweep(&matrix, (index, angles), signals);
                let (rows, solution, stated) = stages.run(&format!("sweep at {name}"), sweep)?;
                outcome.stated_errors.extend(stated);
                outcome.reciprocity.extend(Reciprocity::of(&rows));
                outcome.monostatic.extend(rows);
                outcome.solved.push(self.record(&matrix, solution));
            }
        }
        Ok(())
    }

    /// The matrix, whole or compressed: as asked for, or what fits and is quicker.
    fn matrix(&self, signals: &Signals<'_>) -> Result<Matrix, Error> {
        let Method::Solver { solver, .. } = &self.model.method else {
            return Err(Error::new(ErrorKind::Input, "an equation is solved, not summed bounce by bounce"));
        };
        let at = (self.basis, self.band, &self.body);
        let (plan, storage) = whole_plan(self.model, at, &**solver)?;
        match storage {
            CouplingStorage::Compressed => return self.compressed(signals),
            CouplingStorage::Multipole => return self.by_multipoles(signals),
            CouplingStorage::Matrix | CouplingStorage::Products => {}
        }
        let help = if loses_loops(self.model, self.basis, self.band) {
            if by_products().contains(&solver.name()) {
                signals.watch.warn(&format!(
                    "no edge is longer than a two-hundredth of the wavelength: {} may leave out currents around loops, whose field is small beside that of the charges; solver = \"lu\" keeps them",
                    solver.name()
                ));
            }
            "take longer edges, or method = \"cfie\" for closed conductors, whose matrix can be compressed"
        } else {
            "take longer edges, --storage compressed, or method = \"physical-optics\""
        };
        signals.admit(&plan, self.model.limit, help)?;
        let whole = self.body.operator().coupling().map_err(|error| refused(self.model, &error))?;
        Ok(Matrix::Whole(whole))
    }

    /// How systems of a compressed matrix are solved, where it is one that can be compressed.
    fn by_products(&self, with_factors: bool) -> Result<Method, Error> {
        let Method::Solver { solver: named, tolerance, max_iterations } = &self.model.method else {
            return Err(Error::new(ErrorKind::Input, "an equation is solved, not summed bounce by bounce"));
        };
        if needs_matrix(self.model) {
            let what = format!("{} needs all entries of the matrix, which is to be compressed", named.name());
            let help = format!("--storage matrix, or a solver that needs none: {}", by_products().join(", "));
            return Err(Error::new(ErrorKind::Input, what).with_help(help));
        }
        if loses_loops(self.model, self.basis, self.band) {
            let what = "no edge is longer than a two-hundredth of the wavelength: a compressed matrix would lose currents around loops, whose field is small beside that of the charges";
            let help = "--storage matrix, longer edges, or method = \"cfie\" for closed conductors";
            return Err(Error::new(ErrorKind::Input, what).with_help(help));
        }
        let solver = of_compressed(self.model, with_factors)?;
        Ok(Method::Solver { solver, tolerance: *tolerance, max_iterations: *max_iterations })
    }

    /// Memory besides a compressed matrix, which is to fit, and what is left.
    fn besides(&self, method: &Method) -> Result<(Plan, u64), Error> {
        let Method::Solver { solver, .. } = method else {
            return Err(Error::new(ErrorKind::Input, "an equation is solved, not summed bounce by bounce"));
        };
        let plan = besides_compressed(self.model, self.body.operator().dim(), &**solver);
        plan.admit(self.model.limit, COMPRESSED_HELP)?;
        let left = u64::try_from(self.model.limit.bytes().0 - plan.peak().0).unwrap_or(u64::MAX);
        Ok((plan, left))
    }

    fn compressed(&self, signals: &Signals<'_>) -> Result<Matrix, Error> {
        if self.model.storage == Some(CouplingStorage::Multipole) {
            signals.watch.warn(
                "the bodies are too small beside the wavelength for multipoles: the matrix is compressed in blocks",
            );
        }
        let method = self.by_products(takes_factors(self.model))?;
        let (plan, left) = self.besides(&method)?;
        let limit = self.model.limit;
        let with = |bytes: u64| with_compressed(self.model, plan.clone(), self.body.operator().dim(), bytes);
        let share = if takes_factors(self.model) { 1.0 + FACTOR_SHARE } else { 1.0 };
        let settings = Settings { limit: (left as f64 / share) as u64, ..settings(self.model) };
        let matrix = match self.body.operator().compressed(settings, signals.watch) {
            Ok(matrix) => matrix,
            Err(MomentsError::Compression(CompressionError::Memory { needed, .. })) => {
                with(needed).admit(limit, COMPRESSED_HELP)?;
                return Err(Error::new(ErrorKind::Resources, "the compressed matrix does not fit"));
            }
            Err(MomentsError::Compression(CompressionError::Interrupted)) => return Err(Error::cancelled()),
            Err(error) => return Err(refused(self.model, &error)),
        };
        with(matrix.summary().bytes).tell(limit, signals.watch);
        let inverse = self.inverse(&matrix, left.saturating_sub(matrix.summary().bytes), signals)?;
        let matrix = Box::new(matrix);
        Ok(Matrix::Compressed(Box::new(Compressed {
            called: "the compressed matrix",
            matrix,
            inverse,
            method,
        })))
    }

    fn by_multipoles(&self, signals: &Signals<'_>) -> Result<Matrix, Error> {
        let Body::Conductor(body) = &self.body else {
            return Err(refused(self.model, &MomentsError::Imperfect));
        };
        let method = self.by_products(false)?;
        let (plan, _) = self.besides(&method)?;
        let summary = self.body.multipole_summary().map_err(|error| refused(self.model, &error))?;
        let plan = with_multipoles(plan, self.body.operator().dim(), &summary);
        signals.admit(&plan, self.model.limit, COMPRESSED_HELP)?;
        let matrix = match body.multipole(multipole_settings(self.basis.order()), signals.watch) {
            Ok(matrix) => matrix,
            Err(MomentsError::Compression(CompressionError::Interrupted)) => return Err(Error::cancelled()),
            Err(error) => return Err(refused(self.model, &error)),
        };
        let inverse = diagonal_blocks(&matrix)?;
        let matrix = Box::new(matrix);
        Ok(Matrix::Compressed(Box::new(Compressed { called: "the multipoles", matrix, inverse, method })))
    }

    /// What preconditions a compressed matrix: its factors in at most `limit` bytes where they are
    /// worth it and can be had, or the blocks on its diagonal.
    fn inverse(
        &self,
        matrix: &Hierarchical<Complex64>,
        limit: u64,
        signals: &Signals<'_>,
    ) -> Result<Inverse, Error> {
        if takes_factors(self.model) {
            match Factors::new(matrix, FACTOR_ERROR, limit, signals.watch) {
                Ok(factors) => return Ok(Inverse::Factors(Box::new(factors))),
                Err(CompressionError::Interrupted) => return Err(Error::cancelled()),
                Err(CompressionError::Factors { needed, limit }) => {
                    let [needed, limit] = [needed, limit].map(|bytes| Bytes(bytes.into()));
                    signals.watch.warn(&format!(
                        "the factors of the compressed matrix take more than {needed}, and {limit} are left: the blocks on its diagonal precondition it, which takes more iterations; --memory allows more"
                    ));
                }
                Err(error) => signals.watch.warn(&format!(
                    "there are no factors of the compressed matrix: {error}; the blocks on its diagonal precondition it"
                )),
            }
        }
        diagonal_blocks(matrix)
    }

    fn solve(
        &self,
        matrix: &Matrix,
        b: &MultiVector<Complex64>,
        signals: &Signals<'_>,
    ) -> Result<Solution, Error> {
        match matrix {
            Matrix::Whole(coupling) => solved(coupling, b, &self.model.method, signals),
            Matrix::Compressed(parts) => parts.solve(b, signals),
        }
    }

    fn record(&self, matrix: &Matrix, solution: Solution) -> Solved {
        Solved {
            frequency: self.band.wave.frequency(),
            facets: self.geometry.mesh.len(),
            solution: match matrix {
                Matrix::Whole(_) => self.model.method.name(),
                Matrix::Compressed(parts) => parts.name(),
            },
            residuals: solution.residuals,
            reason: solution.reason,
        }
    }

    /// The expected error of the scattered field of these sources, where it is known.
    fn error(
        &self,
        currents: &Currents<'_>,
        sources: &[&dyn Source],
        residual: Option<f64>,
    ) -> Result<Option<MeanError>, Error> {
        let (Some(known), Some(residual)) = (&self.known, residual) else { return Ok(None) };
        let indicator = match known {
            Known::Mesh(indicator) => *indicator,
            Known::Inside { points, indicator } => {
                let scattered = currents.fields(points).map_err(|error| refused(self.model, &error))?;
                let Some(left) = left_inside(&self.band.wave, sources, points, &scattered) else {
                    return Ok(None);
                };
                indicator(left)
            }
        };
        let relative = indicator.error() + residual;
        let far = self.far(currents, &even_directions(DIRECTIONS))?;
        let mean = far.iter().map(|far| far.amplitude.norm_squared()).sum::<f64>() / far.len() as f64;
        let Some(bounds) = self.geometry.mesh.bounds() else { return Ok(None) };
        let centre = 0.5 * (bounds.min + bounds.max);
        Ok(Some(MeanError { relative, mean: mean.sqrt(), centre, radius: bounds.max.distance(centre) }))
    }

    /// Fields at all receivers of the scene's sources.
    fn receive(
        &self,
        currents: &Currents<'_>,
        error: Option<&MeanError>,
        outcome: &mut Outcome,
    ) -> Result<(), Error> {
        let absorbed = self.body.absorbed(currents);
        let power = power(self.model, self.band, &|p| currents.fields(&[p]).ok().map(|fields| fields[0].e));
        if self.first {
            let unknowns = self.basis.len() as f64;
            let balancing = Balancing {
                model: self.model,
                band: self.band,
                geometry: self.geometry,
                elements: unknowns,
                // An entry of the matrix takes some ten times as long as a direction of an element.
                pairs: 10.0 * unknowns * unknowns,
                power,
                absorbed,
            };
            let far = |u: &[Vec3]| Ok(self.far(currents, u)?.into_iter().map(|far| far.amplitude).collect());
            outcome.balances.extend(balancing.balance(&far)?);
        }
        for (index, receiver) in self.model.receivers.iter().enumerate() {
            let relative = match &receiver.places {
                Places::Near { points, .. } => {
                    let scattered = self.near(currents, index, points)?;
                    let rows = near_rows(self.model, self.band, index, points, &scattered);
                    let rows = rows.map_err(|error| self.model.refused(&error, Some(receiver)))?;
                    outcome.near.extend(rows);
                    let squares = scattered.iter().map(|field| field.e.norm_squared());
                    error.map(|error| {
                        error.relative(squares, points.iter().map(|&p| error.centre.distance(p)))
                    })
                }
                Places::Far(angles) => {
                    let far = self.far(currents, &directions(angles))?;
                    let rows = far.iter().zip(angles).enumerate();
                    outcome.far.extend(rows.map(|(i, (far, angles))| {
                        far_row((self.model, self.band, power), [index, i], *angles, far)
                    }));
                    let squares = far.iter().map(|far| far.amplitude.norm_squared());
                    error.map(|error| error.relative_far(squares))
                }
                Places::Monostatic(_) => None,
            };
            if let Some(relative) = relative {
                let frequency = self.band.wave.frequency();
                outcome.stated_errors.push(Estimated { receiver: index, frequency, relative });
            }
        }
        Ok(())
    }

    /// The scattered field; inside of bodies that is the field there less the incident one.
    fn near(&self, currents: &Currents<'_>, receiver: usize, points: &[Vec3]) -> Result<Vec<Field>, Error> {
        let refused = |error: MomentsError| {
            let (about, what) = (About::Receiver(receiver), error.to_string());
            let help = error.help().unwrap_or("move the points");
            scene_failure(self.model.scene.error(about, SceneFault::Geometry, what, help))
        };
        let mut fields = currents.fields(points).map_err(refused)?;
        if let Body::Dielectric(body) = &self.body {
            let found = body.fields_inside(currents, points).map_err(refused)?;
            let sources = self.model.sources();
            for (i, total) in found.into_iter().enumerate() {
                if let Some(total) = total {
                    fields[i] = total - incident(&sources, &self.band.wave, points[i]);
                }
            }
        }
        Ok(fields)
    }

    fn far(&self, currents: &Currents<'_>, directions: &[Vec3]) -> Result<Vec<FarField>, Error> {
        currents.far_field(directions).map_err(|error| refused(self.model, &error))
    }

    /// What plane waves from these directions send back, all solved for together, and the error
    /// stated of it.
    fn sweep(
        &self,
        matrix: &Matrix,
        (receiver, angles): (usize, &[[f64; 2]]),
        signals: &Signals<'_>,
    ) -> Result<(Vec<MonostaticRow>, Solution, Option<Estimated>), Error> {
        let directions = directions(angles);
        let waves = plane_waves(&directions).map_err(|error| self.model.refused(&error, None))?;
        let above = |wave: PlaneWave| -> Box<dyn Source> {
            match self.basis.ground() {
                Some(ground) => Box::new(Grounded::new(Box::new(wave), ground)),
                None => Box::new(wave),
            }
        };
        let waves: Vec<Box<dyn Source>> = waves.into_iter().map(above).collect();
        let sources: Vec<&dyn Source> = waves.iter().map(|wave| &**wave).collect();
        let excitations: Vec<&[&dyn Source]> = sources.iter().map(slice::from_ref).collect();
        let solution = self.solve(matrix, &self.body.right_hand_side(&excitations), signals)?;
        let mut rows = Vec::with_capacity(angles.len());
        let (frequency, mut stated) = (self.band.wave.frequency(), SweepError::default());
        for (index, (&[theta_degrees, phi_degrees], u)) in angles.iter().zip(&directions).enumerate() {
            signals.check()?;
            let mut scattering = [[0.0; 2]; 4];
            for along in 0..2 {
                let x = solution.x.vector(2 * index + along);
                let currents = self.body.currents(&x);
                let back = self.far(&currents, slice::from_ref(u))?;
                for (part, far) in back.iter().flat_map(FarField::polar).enumerate() {
                    scattering[2 * along + part] = [far.re, far.im];
                }
                if SweepError::samples(index, angles.len()) {
                    let last = solution.residual();
                    let error = self.error(&currents, excitations[2 * index + along], last)?;
                    let square = back.iter().map(|far| far.amplitude.norm_squared()).sum();
                    stated.add(error.map(|error| error.square(square)), square);
                }
            }
            rows.push(MonostaticRow { receiver, index, theta_degrees, phi_degrees, frequency, scattering });
        }
        Ok((rows, solution, stated.estimated(receiver, frequency)))
    }

    /// J and M at the centres of the facets, on the side of their normals: of a quadrilateral the
    /// mean of its two triangles.
    fn on_facets(&self, currents: &Currents<'_>) -> Vec<Current> {
        let mut next = 0;
        let mut facet = |sides: usize| {
            let count = sides - 2;
            let triangles = next..next + count;
            next += count;
            let [mut j, mut m] = [ComplexVector::ZERO; 2];
            for current in triangles.filter_map(|triangle| self.on_triangle(currents, triangle)) {
                j += current.j;
                m += current.m;
            }
            let share = 1.0 / count as f64;
            Current { j: j * share, m: m * share }
        };
        self.geometry.mesh.patches().map(|patch| facet(patch.sides())).collect()
    }

    /// J and M on a triangle of the mesh; none where it bounds nothing.
    fn on_triangle(&self, currents: &Currents<'_>, triangle: usize) -> Option<Current> {
        let Some(regions) = self.basis.regions() else {
            return Some(Current { j: currents.electric(triangle), m: currents.magnetic(triangle) });
        };
        let Placed { triangle, turned } = regions.placed()[triangle]?;
        // Of conductors it is the current of both sides.
        let sign = if turned && !regions.faces()[triangle].conductor { -1.0 } else { 1.0 };
        Some(Current { j: currents.electric(triangle) * sign, m: currents.magnetic(triangle) * sign })
    }
}

/// The error of a scattered field, spread evenly over all directions.
///
/// What was measured is the error over the whole sphere, relative to the field there. Where a
/// receiver gets less than the mean field, the error is a larger part of it.
struct MeanError {
    /// Over all directions.
    relative: f64,
    /// Root mean square of the far amplitude over all directions, V.
    mean: f64,
    /// Middle of the body, m.
    centre: Vec3,
    /// Radius of a ball that holds the body, m: fields within are not expected to be larger.
    radius: f64,
}

impl MeanError {
    /// The error relative to the field at some points, from |E|² (V²/m²) and the distances from the
    /// middle, m.
    fn relative(&self, squares: impl Iterator<Item = f64>, distances: impl Iterator<Item = f64>) -> f64 {
        let mean = |distance: f64| self.mean / distance.max(self.radius);
        self.over(squares, distances.map(|distance| mean(distance).powi(2)).sum())
    }

    /// The same in directions, from the squares of the amplitudes, V².
    fn relative_far(&self, squares: impl ExactSizeIterator<Item = f64>) -> f64 {
        let count = squares.len() as f64;
        self.over(squares, count * self.mean * self.mean)
    }

    /// The square of the error in one direction, V², of a field whose square is this.
    fn square(&self, found: f64) -> f64 {
        self.relative * self.relative * found.max(self.mean * self.mean)
    }

    fn over(&self, squares: impl Iterator<Item = f64>, expected: f64) -> f64 {
        let found: f64 = squares.sum();
        if found > 0.0 { self.relative * (expected / found).sqrt().max(1.0) } else { self.relative }
    }
}
