//! Whole enclosures: rows sum to 1, whatever the scale and place.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;

use common::{patch, v, with_integrator};
use fredholm_coupling::{Assembled, Emitters, Groups, assemble};
use fredholm_linop::{Columns, Quiet, Watch};
use fredholm_mesh::{Mesh, MeshBuilder, Patch, Vec3};
use fredholm_visibility::Occluders;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// An n × n grid on each wall of a box seen from inside (or outside).
fn add_box(builder: &mut MeshBuilder, min: Vec3, max: Vec3, n: usize, inward: bool) {
    let at = |x: f64, y: f64, z: f64| min + (max - min) * v(x, y, z);
    let walls: [[[f64; 3]; 4]; 6] = [
        [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
        [[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]],
        [[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]],
        [[1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]],
        [[0., 0., 0.], [0., 0., 1.], [1., 0., 1.], [1., 0., 0.]],
        [[0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]],
    ];
    for wall in walls {
        let whole = patch(&wall.map(|[x, y, z]| at(x, y, z)));
        let whole = if inward { whole } else { whole.flipped() };
        builder.occluder(whole);
        for cell in grid(&whole, n) {
            builder.face(&[cell]).unwrap();
        }
    }
}

fn grid(whole: &Patch, n: usize) -> Vec<Patch> {
    let at = |i: usize, j: usize| whole.point(i as f64 / n as f64, j as f64 / n as f64);
    let cell = |i, j| patch(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
    (0..n * n).map(|k| cell(k / n, k % n)).collect()
}

fn solve(mesh: &Mesh, tolerance: f64) -> (Assembled<f64>, f64) {
    let assembled: Assembled<f64> =
        with_integrator(mesh, tolerance, |pairs| assemble(pairs, &Quiet).unwrap());
    let sums = assembled.matrix.row_sums();
    let closure = sums.iter().zip(mesh.patches()).map(|(sum, patch)| sum / patch.area() - 1.0);
    let worst = closure.fold(0.0, |worst: f64, x| worst.max(x.abs()));
    (assembled, worst)
}

fn cube(origin: Vec3, size: f64, n: usize) -> Mesh {
    let mut builder = MeshBuilder::default();
    builder.surface("walls", 0);
    add_box(&mut builder, origin, origin + Vec3::splat(size), n, true);
    builder.build()
}

#[test]
fn rows_of_an_empty_cube_sum_to_one_at_any_scale_and_place() {
    for (origin, size) in [(Vec3::ZERO, 1.0), (Vec3::ZERO, 1e-6), (Vec3::ZERO, 1e6), (Vec3::splat(1e3), 1.0)]
    {
        let (assembled, worst) = solve(&cube(origin, size, 4), 1e-12);
        println!("size {size:e} at {origin}: row sums within {worst:.1e}, {:?}", assembled.methods);
        assert!(worst < 1e-11, "size {size:e}: {worst:e}");
        assert_eq!(assembled.methods.clipped + assembled.methods.sampled, 0);
    }
}

#[test]
fn rows_of_a_cube_with_a_box_inside_sum_to_one_within_the_stated_error() {
    let mut builder = MeshBuilder::default();
    builder.surface("walls", 0);
    add_box(&mut builder, Vec3::ZERO, Vec3::ONE, 4, true);
    builder.surface("box", 0);
    add_box(&mut builder, Vec3::splat(0.3), Vec3::splat(0.7), 2, false);
    let mesh = builder.build();
    let (assembled, worst) = solve(&mesh, 1e-3);
    let stated = assembled.error.iter().zip(mesh.patches()).map(|(e, p)| e / p.area()).fold(0.0, f64::max);
    println!("row sums within {worst:.1e}, stated {stated:.1e}, {:?}", assembled.methods);
    assert!(assembled.methods.clipped > 0 && worst < 1e-3 && worst <= stated);
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let mesh = cube(Vec3::ZERO, 1.0, 5);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&mesh, 1e-6)).0
    };
    let one = on(1);
    for threads in [2, 4] {
        let other = on(threads);
        assert!(other.matrix == one.matrix && other.error == one.error);
    }
}

/// Has had enough after a tenth of the way.
#[derive(Default)]
struct Impatient(AtomicBool);

impl Watch for Impatient {
    fn advance(&self, share: f64, _: &dyn Fn() -> String) {
        self.0.fetch_or(share > 0.1, Ordering::Relaxed);
    }

    fn go_on(&self) -> ControlFlow<()> {
        if self.0.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn the_watch_stops_the_assembly() {
    let mesh = cube(Vec3::ZERO, 1.0, 6);
    let stopped = with_integrator(&mesh, 1e-6, |pairs| assemble::<f64>(pairs, &Impatient::default()));
    assert!(matches!(stopped, Err(fredholm_coupling::CouplingError::Interrupted { .. })));
}

/// Elements of which no Gauss point sees another, though a corner does: the rows must still close
/// within what is stated.
#[test]
fn a_glimpse_past_a_block_is_not_lost() {
    let mut builder = MeshBuilder::default();
    builder.surface("walls", 0);
    add_box(&mut builder, Vec3::ZERO, Vec3::splat(2.0), 3, true);
    builder.surface("block", 0);
    add_box(&mut builder, v(0.5, 0.5, 0.3), v(1.1, 1.2, 0.9), 1, false);
    let mesh = builder.build();
    for tolerance in [1e-3, 1e-4, 1e-5] {
        let (assembled, worst) = solve(&mesh, tolerance);
        let row = |(e, p): (&f64, &Patch)| e / p.area();
        let stated = assembled.error.iter().zip(mesh.patches()).map(row).fold(0.0, f64::max);
        println!("T = {tolerance:e}: row sums within {worst:.1e}, stated {stated:.1e}");
        assert!(worst < stated && worst < 2.0 * tolerance);
    }
}

/// Groups of patches decide together what stands between their members; the pairs must come out as
/// if each was asked alone.
#[test]
fn the_assembly_has_the_exchanges_of_the_pairs() {
    let mut builder = MeshBuilder::default();
    builder.surface("walls", 0);
    add_box(&mut builder, Vec3::ZERO, v(3.0, 2.0, 1.5), 4, true);
    builder.surface("blocks", 0);
    for (min, max) in [([0.4, 0.3, 0.0], [0.9, 0.9, 0.7]), ([1.6, 0.8, 0.3], [2.2, 1.2, 1.0])] {
        add_box(&mut builder, Vec3::from(min), Vec3::from(max), 2, false);
    }
    let mesh = builder.build();
    let (assembled, _) = solve(&mesh, 1e-3);
    assert!(assembled.methods.clipped > 500 && assembled.methods.hidden > 500, "{:?}", assembled.methods);
    with_integrator(&mesh, 1e-3, |pairs| {
        let mut work = fredholm_coupling::form_factor::Workspace::default();
        for i in 0..pairs.len() {
            for (j, &entry) in assembled.matrix.packed_row(i)[..i].iter().enumerate() {
                let alone = pairs.exchange(i, j, &mut work);
                assert!((entry - alone.value).abs() <= alone.error + 1e-7, "{i} {j}: {entry} {alone:?}");
            }
        }
    });
}

#[test]
fn columns_of_groups_are_sums_of_columns_of_the_matrix() {
    let mut builder = MeshBuilder::default();
    builder.surface("walls", 0);
    add_box(&mut builder, Vec3::ZERO, Vec3::ONE, 12, true);
    builder.surface("block", 0);
    add_box(&mut builder, v(0.3, 0.25, 0.2), v(0.7, 0.6, 0.55), 2, false);
    let mesh = builder.build();
    let elements: Vec<&Patch> = mesh.patches().collect();
    let tolerance = 1e-4;
    with_integrator(&mesh, tolerance, |integrator| {
        let assembled: Assembled<f64> = assemble(integrator, &Quiet).unwrap();
        let occluders = Occluders::new(mesh.occluders()).unwrap();
        let groups = Groups::new(&elements, &vec![0; elements.len()], occluders.tolerance());
        let emitters = Emitters::new(elements.clone(), &groups, &occluders, tolerance);
        let mut column = vec![0.0; elements.len()];
        let (mut largest, mut walls) = (0, 0);
        for (group, places) in groups.places().into_iter().enumerate() {
            let members = &groups.order()[places];
            emitters.column(group, &mut column);
            for i in 0..elements.len() {
                let sum: f64 = members.iter().map(|&j| assembled.matrix.get(i, j as usize)).sum();
                let allowed = 2.0 * tolerance * elements[i].area();
                assert!((column[i] - sum).abs() < allowed, "{members:?} {i}: {} {sum}", column[i]);
            }
            walls += usize::from(members.len() == 144);
            largest = largest.max(members.len());
        }
        assert_eq!((largest, walls), (144, 6), "every wall is a group, and nothing is larger");
        assert!(emitters.largest_error() > 0.0 && emitters.largest_error() < 10.0 * tolerance);
    });
}

#[test]
fn elements_of_different_kinds_and_patches_that_fill_no_rectangle_are_no_group() {
    let square =
        |x: f64, y: f64| patch(&[v(x, y, 0.), v(x + 1., y, 0.), v(x + 1., y + 1., 0.), v(x, y + 1., 0.)]);
    let corner = [square(0., 0.), square(1., 0.), square(0., 1.)];
    let elements: Vec<&Patch> = corner.iter().collect();
    let sizes = |kinds: &[u32]| {
        let mut sizes: Vec<usize> =
            Groups::new(&elements, kinds, 1e-9).places().iter().map(ExactSizeIterator::len).collect();
        sizes.sort_unstable();
        sizes
    };
    assert_eq!(sizes(&[0, 0, 0]), [1, 1, 1, 2]);
    assert_eq!(sizes(&[0, 1, 2]), [1, 1, 1]);
}
