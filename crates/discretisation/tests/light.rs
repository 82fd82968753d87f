//! Diffuse light by every discretisation: against the radiosity system, closed forms and adaptive
//! integration.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_coupling::kernel::lambert;
use fredholm_coupling::{Assembled, Radiosity, assemble, exposed_shares, extents};
use fredholm_direct::DenseLu;
use fredholm_discretisation::{
    Discretisation, DiscretisationError, Equation, FlatLambert, Light, Site, discretisation, discretisations,
};
use fredholm_iterative::GaussSeidel;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Patch, Shape, Vec3};
use fredholm_quadrature::{Goal, adaptive_quad, tensor_quad};
use fredholm_visibility::Occluders;

const STOP: Stop = Stop { tolerance: 1e-13, max_iterations: 10_000 };

fn cut(n: usize) -> Cutting {
    Cutting { lines: Lines::Counts { u: n, v: n }, ..Cutting::default() }
}

/// A room; with a box on its floor that has no bottom, so that part of the floor is buried, where
/// `block` says so.
fn room(n: usize, block: bool) -> Mesh {
    let mut builder = MeshBuilder::default();
    builder.surface("room", 0);
    let walls = Shape::Box { min: Vec3::ZERO, max: Vec3::new(1.0, 1.2, 0.8), inward: true };
    builder.add(&walls, &cut(n)).unwrap();
    if block {
        builder.surface("block", 1);
        let (low, high) = (Vec3::new(0.3, 0.4, 0.0), Vec3::new(0.7, 0.8, 0.4));
        let at = |x: f64, y: f64, z: f64| low + (high - low) * Vec3::new(x, y, z);
        let sides = [
            [at(0., 0., 1.), at(1., 0., 1.), at(1., 1., 1.), at(0., 1., 1.)],
            [at(0., 0., 0.), at(1., 0., 0.), at(1., 0., 1.), at(0., 0., 1.)],
            [at(1., 0., 0.), at(1., 1., 0.), at(1., 1., 1.), at(1., 0., 1.)],
            [at(1., 1., 0.), at(0., 1., 0.), at(0., 1., 1.), at(1., 1., 1.)],
            [at(0., 1., 0.), at(0., 0., 0.), at(0., 0., 1.), at(0., 1., 1.)],
        ];
        for corners in sides {
            builder.add(&Shape::Quad { corners, skip: Vec::new() }, &Cutting::default()).unwrap();
        }
    }
    builder.build()
}

/// Two bands that differ in everything.
fn materials(mesh: &Mesh) -> (MultiVector<f64>, MultiVector<f64>) {
    let of = |i| mesh.surface_of(i);
    let reflectance =
        MultiVector::from_fn(mesh.len(), 2, |i, band| [[0.7, 0.4], [0.5, 0.9]][of(i).min(1)][band]);
    let exitance = MultiVector::from_fn(mesh.len(), 2, |i, band| if i % 7 == band { 3.0 } else { 0.0 });
    (reflectance, exitance)
}

fn largest(a: &MultiVector<f64>, b: &MultiVector<f64>) -> f64 {
    let size = b.as_slice().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let differences = a.as_slice().iter().zip(b.as_slice()).map(|(x, y)| (x - y).abs());
    differences.fold(0.0, f64::max) / size
}

#[test]
fn constants_by_galerkin_are_the_radiosity_system_with_its_buried_parts() {
    let mesh = room(4, true);
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let (reflectance, exitance) = materials(&mesh);
    let patches: Vec<Patch> = mesh.patches().copied().collect();
    let pairs = PairIntegrator::new(&patches, &occluders, 1e-3);
    let assembled: Assembled<f64> = assemble(&pairs, &Quiet).unwrap();
    let shares = exposed_shares(&mesh.patches().collect::<Vec<_>>(), &Occluders::new(&patches).unwrap());
    assert!(shares.iter().any(|&w| w > 0.0 && w < 1.0), "part of the floor is buried");
    let sizes = extents(&mesh.patches().collect::<Vec<_>>(), &shares, &assembled.matrix.row_sums());
    let radiosity = Radiosity::new(sizes, reflectance.clone(), exitance.clone()).unwrap();
    let system = SecondKind::new(&assembled.matrix, radiosity.scaling()).unwrap();
    let mut x = exitance.clone();
    DenseLu.solve(&system, &exitance, &mut x, &STOP, &mut Quiet).unwrap();
    let expected = radiosity.means(&assembled.matrix, &x);

    let light = Light::new(&mesh, &occluders, reflectance, exitance, 1e-3).unwrap();
    let method = discretisation("galerkin-q0").unwrap();
    let lit = light.solve(&*method, &DenseLu, &STOP, &mut Quiet).unwrap();
    let means = lit.means();
    assert!(largest(&means.irradiance, &expected.irradiance) < 1e-14);
    assert!(largest(&means.radiosity, &expected.radiosity) < 1e-14);
}

/// Quads on four walls and triangles on two.
fn mixed_room() -> Mesh {
    let whole = room(1, false);
    let mut builder = MeshBuilder::default();
    for (at, patch) in whole.patches().enumerate() {
        builder.surface("wall", 0);
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| patch.corner(i));
        if at < 2 {
            builder.face(&[Patch::triangle([a, b, c]).unwrap()]).unwrap();
            builder.face(&[Patch::triangle([c, d, a]).unwrap()]).unwrap();
        } else {
            builder.face(&[*patch]).unwrap();
        }
    }
    whole.occluders().iter().for_each(|patch| builder.occluder(*patch));
    builder.build()
}

#[test]
fn a_furnace_is_exitance_over_absorptance_by_every_method_and_solver() {
    let mesh = mixed_room();
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let rho = [0.3, 0.9];
    let reflectance = MultiVector::from_fn(mesh.len(), 2, |_, band| rho[band]);
    let exitance = MultiVector::from_fn(mesh.len(), 2, |_, band| 1.0 - rho[band]);
    let light = Light::new(&mesh, &occluders, reflectance, exitance, 1e-10).unwrap();
    for method in discretisations() {
        for solver in [&DenseLu as &dyn Solver<f64>, &GaussSeidel] {
            let lit = light.solve(&*method, solver, &STOP, &mut Quiet).unwrap();
            let nodal = lit.nodal().radiosity;
            let worst = nodal.as_slice().iter().map(|b| (b - 1.0).abs()).fold(0.0, f64::max);
            // All pairs of so coarse a room are near, so that Nyström's weights are corrected
            // everywhere.
            assert!(worst < 1e-9, "{} by {}: {worst:e}", method.name(), solver.name());
        }
    }
}

/// A floor and a wall that share an edge, or with a gap, as one element each.
fn corner(gap: f64) -> Vec<Patch> {
    let v = Vec3::new;
    let floor = [v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)];
    let wall = [v(0., 0., gap), v(0., 1., gap), v(0., 1., 1.), v(0., 0., 1.)];
    [floor, wall].map(|corners| Patch::quad(corners).unwrap().unwrap()).to_vec()
}

/// (H φ_j)(p) for the last basis function of the wall at the first node of the floor, by the matrix
/// and by adaptive integration.
fn entry(name: &str, patches: &[Patch], occluders: &Occluders) -> (f64, f64) {
    let transfer = FlatLambert::new(patches.to_vec(), vec![0, 1], occluders, 1e-6).unwrap();
    let reflectance = MultiVector::from_fn(2, 1, |_, _| 0.5);
    let system = discretisation(name).unwrap();
    let system = system.discretise(Equation::new(&transfer, &reflectance).unwrap()).unwrap();
    let space = system.space();
    let (row, column) = (space.dofs(0)[0], space.dofs(1)[space.dofs(1).len() - 1]);
    let mut entries = vec![0.0; space.dim()];
    system.coupling().row(row, 0, &mut entries);
    let p: Site = space.nodes_of(0)[0];
    let wall = &patches[1];
    let seen = |u: f64, v: f64| {
        let q = wall.point(u, v);
        let open = occluders.unoccluded(p.position, q);
        let phi = space.basis(1).values(u, v)[space.basis(1).len() - 1];
        if open { phi * lambert(p.position, p.normal, q, wall.normal()) * wall.area() } else { 0.0 }
    };
    let exact = adaptive_quad(&tensor_quad(5), Goal { tolerance: 1e-7, cuts: 20_000 }, seen);
    (entries[column], exact.value)
}

#[test]
fn entries_are_integrals_of_kernel_times_basis_near_and_behind_an_occluder() {
    let v = Vec3::new;
    let screen = [v(0.05, 0.2, 0.1), v(0.05, 0.5, 0.1), v(0.05, 0.5, 0.6), v(0.05, 0.2, 0.6)];
    let screen = Patch::quad(screen).unwrap().unwrap();
    for name in ["collocation-1", "collocation-2", "nystrom-2", "nystrom-3"] {
        for (patches, occluder) in [(corner(0.0), None), (corner(0.3), None), (corner(0.0), Some(screen))] {
            let occluders = Occluders::new(occluder.as_slice()).unwrap();
            let (entry, exact) = entry(name, &patches, &occluders);
            assert!(exact.abs() > 5e-4, "{exact}");
            assert!((entry - exact).abs() < 3e-6, "{name}: {entry} against {exact}");
        }
    }
}

#[test]
fn pairs_with_a_common_edge_have_the_closed_form() {
    // Howell C-14: two squares at right angles.
    let exact = 0.200_043_776_075_403;
    let patches = corner(0.0);
    let occluders = Occluders::new(&[]).unwrap();
    let transfer = FlatLambert::new(patches, vec![0, 1], &occluders, 1e-10).unwrap();
    let reflectance = MultiVector::from_fn(2, 1, |_, _| 0.5);
    for (name, tolerance) in [("galerkin-0", 1e-10), ("galerkin-1", 2e-4), ("galerkin-2", 1e-4)] {
        let method = discretisation(name).unwrap();
        let system = method.discretise(Equation::new(&transfer, &reflectance).unwrap()).unwrap();
        let space = system.space();
        let lit = |dof: usize| space.dofs(1).contains(&dof);
        let x = MultiVector::from_fn(space.dim(), 1, |dof, _| f64::from(u8::from(lit(dof))));
        let irradiance = system.irradiance(&|_, _| 0.0, &x);
        // The weights of the nodes integrate the basis exactly.
        let weights = space.basis(0).nodes().iter().map(|p| p.weight);
        let mean: f64 = space.dofs(0).iter().zip(weights).map(|(&dof, w)| w * irradiance.row(dof)[0]).sum();
        assert!((mean - exact).abs() < tolerance, "{name}: {mean}");
    }
}

fn bits(method: &dyn Discretisation, threads: usize) -> Vec<u64> {
    let mesh = room(1, true);
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let (reflectance, exitance) = materials(&mesh);
    let light = Light::new(&mesh, &occluders, reflectance, exitance, 1e-3).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let lit = light.solve(method, &GaussSeidel, &STOP, &mut Quiet).unwrap();
        let all = [lit.unknowns().clone(), lit.means().radiosity, lit.error().per_element];
        all.iter().flat_map(|v| v.as_slice().iter().map(|x| x.to_bits()).collect::<Vec<_>>()).collect()
    })
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for method in discretisations() {
        assert_eq!(bits(&*method, 1), bits(&*method, 3), "{}", method.name());
    }
}

#[test]
fn unknown_names_and_wrong_sizes_are_refused_with_a_reason() {
    let error = discretisation("galerkin-9").err().unwrap();
    assert!(error.to_string().contains("galerkin-2-conforming"), "{error}");
    let mesh = room(1, false);
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let wrong = Light::new(&mesh, &occluders, MultiVector::zeros(6, 2), MultiVector::zeros(6, 1), 1e-3);
    assert!(matches!(wrong, Err(DiscretisationError::Dimension { what: "the exitance", .. })));
}

#[test]
fn elements_of_different_reflectance_share_no_unknown() {
    let mesh = room(2, false);
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let (_, exitance) = materials(&mesh);
    let reflectance = MultiVector::from_fn(mesh.len(), 2, |i, _| if i == 0 { 0.2 } else { 0.5 });
    let light = Light::new(&mesh, &occluders, reflectance, exitance, 1e-3).unwrap();
    let method = discretisation("galerkin-1-conforming").unwrap();
    let refused = light.solve(&*method, &DenseLu, &STOP, &mut Quiet).err().unwrap();
    assert!(matches!(refused, DiscretisationError::Reflectance { .. }), "{refused}");
}
