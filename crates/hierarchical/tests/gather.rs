//! Final gather against closed forms, an independent way to the same factors, and particle tracing.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod common;

use common::Bench;
use fredholm_coupling::{Receiver, Targets};
use fredholm_hierarchical::{Gather, Leaves, Solution, Tree};
use fredholm_linop::{MultiVector, Quiet};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::TAU;

/// Exposed areas of the leaves, m².
fn exposed(solution: &Solution) -> Vec<f64> {
    solution.system.elements().iter().map(|size| size.exposed).collect()
}

/// Points on the middles of leaves and near their corners, with the numbers of the leaves.
fn receivers(solution: &Solution, step: usize) -> Vec<(usize, Receiver)> {
    let leaves = solution.tree.leaves();
    let open =
        |i: &usize| solution.system.elements()[*i].exposed > 0.999 * solution.system.elements()[*i].area;
    let chosen = (0..leaves.len()).step_by(step).filter(open);
    let places = chosen.flat_map(|i| [(i, 0.5, 0.5), (i, 0.03, 0.05), (i, 0.2, 0.7)]);
    let at = |(i, u, v): (usize, f64, f64)| {
        let patch = solution.tree.nodes()[leaves[i] as usize].patch().unwrap();
        (i, Receiver::new(patch.point(u, v), patch.normal()).unwrap())
    };
    places.map(at).collect()
}

/// Irradiance of receivers on leaves, from a radiosity of the leaves.
fn gathered(
    bench: &Bench,
    solution: &Solution,
    radiosity: &MultiVector<f64>,
    receivers: &[(usize, Receiver)],
    share: f64,
) -> MultiVector<f64> {
    let (irradiance, exposed) = (&solution.means.irradiance, exposed(solution));
    let leaves = Leaves { radiosity, irradiance, exposed: &exposed };
    let gather = Gather::new(&solution.tree, &leaves, &bench.occluders, &[], share).unwrap();
    let points: Vec<Receiver> = receivers.iter().map(|(_, receiver)| *receiver).collect();
    let expected = MultiVector::from_fn(points.len(), irradiance.rhs_count(), |k, band| {
        irradiance.row(receivers[k].0)[band]
    });
    gather.irradiance(&points, &expected, &Quiet).unwrap()
}

/// Factor from a point to a parallel rectangle at height h over it whose corner is over the point
/// (Howell B-3).
fn corner(a: f64, b: f64, h: f64) -> f64 {
    let (a, b) = (a / h, b / h);
    let side = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
    (side(a, b) + side(b, a)) / TAU
}

#[test]
fn under_a_rectangular_lamp_the_closed_form_is_met() {
    let bench = Bench::text(
        "[materials.black]\nreflectance = 0\n[materials.lamp]\nreflectance = 0\nexitance = 3\n\
         [[surface]]\nname = \"floor\"\nmaterial = \"black\"\nquad = [[0, 0, 0], [3, 0, 0], [3, 2, 0], [0, 2, 0]]\n\
         [[surface]]\nname = \"lamp\"\nmaterial = \"lamp\"\nquad = [[1, 1, 1.5], [1, 1.5, 1.5], [2, 1.5, 1.5], [2, 1, 1.5]]\n",
    );
    let solution = bench.solve(0.1);
    let floor: Vec<(usize, Receiver)> =
        receivers(&solution, 1).into_iter().filter(|(_, r)| r.normal.z > 0.5).collect();
    let found = gathered(&bench, &solution, &solution.radiosity, &floor, 1e-2);
    for ((_, receiver), row) in floor.iter().zip(found.rows()) {
        let (x, y) = (receiver.point.x, receiver.point.y);
        let area = |x1: f64, y1: f64| corner(x1 - x, y1 - y, 1.5);
        let exact = 3.0 * (area(2.0, 1.5) - area(1.0, 1.5) - area(2.0, 1.0) + area(1.0, 1.0));
        assert!((row[0] - exact).abs() < 1e-13, "{receiver:?}: {} {exact}", row[0]);
    }
    assert!(floor.len() > 12);
}

#[test]
fn in_a_furnace_every_point_receives_the_same() {
    let bench = Bench::text(&common::room(0.5));
    let solution = bench.solve(0.05);
    let radiosity = MultiVector::from_fn(solution.radiosity.dim(), 1, |_, _| 2.0);
    let points = receivers(&solution, 1);
    for share in [1e-2, 0.0] {
        let found = gathered(&bench, &solution, &radiosity, &points, share);
        for ((_, receiver), row) in points.iter().zip(found.rows()) {
            assert!((row[0] - 2.0).abs() < 1e-11, "{receiver:?}: {:e}", row[0] - 2.0);
        }
    }
    assert!(points.len() > 40);
}

#[test]
fn whole_nodes_stand_for_their_leaves_within_the_error_allowed() {
    let bench = Bench::shipped("cornell_planar.toml");
    let solution = bench.solve(0.1);
    let points = receivers(&solution, 67);
    let leaves = solution.tree.leaves();
    let patches: Vec<&Patch> =
        leaves.iter().map(|&leaf| solution.tree.nodes()[leaf as usize].patch().unwrap()).collect();
    let row_of: Vec<usize> = (0..patches.len()).collect();
    let targets =
        Targets { patches: &patches, row_of: &row_of, rows: patches.len(), occluders: &bench.occluders };
    let list: Vec<Receiver> = points.iter().map(|(_, receiver)| *receiver).collect();
    let factors = targets.factors(&list, &Quiet).unwrap();
    let [all, some] =
        [0.0, 1e-3].map(|share| gathered(&bench, &solution, &solution.radiosity, &points, share));
    let mut squares = 0.0;
    for (k, row) in factors.chunks(patches.len()).enumerate() {
        for band in 0..3 {
            let terms = row.iter().enumerate().map(|(i, f)| f * solution.radiosity.row(i)[band]);
            let exact: f64 = terms.sum();
            assert!((all.row(k)[band] / exact - 1.0).abs() < 1e-10, "{k}: {} {exact}", all.row(k)[band]);
            squares += (some.row(k)[band] / exact - 1.0).powi(2);
        }
    }
    let rms = (squares / (3 * points.len()) as f64).sqrt();
    println!("{} points, {} leaves: {rms:.1e}", points.len(), leaves.len());
    assert!(rms < 5e-3 && rms > 1e-9, "{rms:e}");
}

/// Irradiance of the face with some centroid, of each band, from particle tracing; its noise is
/// 0.14 % in the median.
fn traced(centroid: Vec3) -> [f64; 3] {
    let text = include_str!("../../../tests/data/cornell_planar_reference.csv");
    let numbers =
        |line: &str| -> Vec<f64> { line.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect() };
    let mut rows = text.lines().skip(1).map(numbers);
    let row = rows.find(|row| Vec3::new(row[0], row[1], row[2]).distance(centroid) < 1e-6).unwrap();
    [row[4], row[5], row[6]]
}

#[test]
fn means_of_points_are_those_of_particle_tracing() {
    let bench = Bench::shipped("cornell_planar.toml");
    let solution = bench.solve(0.02);
    let leaves = solution.tree.leaves();
    let face = |i: usize| solution.tree.nodes()[leaves[i] as usize].face().unwrap();
    // 4 × 4 middles of cells of every ninth face, if it is wholly exposed.
    let whole = |i: &usize| {
        let size = solution.system.elements()[*i];
        face(*i) % 9 == 0 && (*i == 0 || face(*i - 1) != face(*i)) && size.exposed >= size.area
    };
    let chosen: Vec<usize> = (0..leaves.len()).filter(whole).collect();
    let place = |k: usize| (f64::from(k as u32) + 0.5) / 4.0;
    let points = chosen.iter().flat_map(|&i| (0..16).map(move |k| (i, place(k / 4), place(k % 4))));
    let at = |(i, u, v): (usize, f64, f64)| {
        let patch = bench.mesh.patch(bench.mesh.leaves_of_face(face(i)).start);
        (i, Receiver::new(patch.point(u, v), patch.normal()).unwrap())
    };
    let points: Vec<(usize, Receiver)> = points.map(at).collect();
    let found = gathered(&bench, &solution, &solution.radiosity, &points, 1e-3);
    let mut squares = 0.0;
    for (c, &i) in chosen.iter().enumerate() {
        let traced = traced(bench.mesh.faces()[face(i)].centroid);
        for (band, traced) in traced.iter().enumerate() {
            let mean: f64 = (0..16).map(|k| found.row(16 * c + k)[band]).sum::<f64>() / 16.0;
            squares += (mean / traced - 1.0).powi(2);
        }
    }
    let rms = (squares / (3 * chosen.len()) as f64).sqrt();
    println!("{} faces: {rms:.2e}", chosen.len());
    assert!(rms < 0.02 && chosen.len() > 40, "{rms:e}");
}

#[test]
fn behind_many_bodies_the_strong_senders_are_cut_and_the_weak_ones_sampled() {
    // A lamp and an even ceiling over a grid of plates over a floor: the factors of both are those
    // of the exact clipping.
    let quad = |name: &str, [x0, x1, y0, y1, z]: [f64; 5], up: bool| {
        let (a, b) = if up { ([x1, y0], [x0, y1]) } else { ([x0, y1], [x1, y0]) };
        format!(
            "[[surface]]\nname = \"{name}\"\nmaterial = \"black\"\nquad = [[{x0}, {y0}, {z}], [{}, {}, {z}], [{x1}, {y1}, {z}], [{}, {}, {z}]]\n",
            a[0], a[1], b[0], b[1]
        )
    };
    let mut text = "[materials.black]\nreflectance = 0\nexitance = 1\n".to_owned();
    text += &quad("floor", [0.0, 1.0, 0.0, 1.0, 0.0], true);
    text += &quad("lamp", [0.3, 0.5, 0.4, 0.6, 1.0], false);
    text += &quad("sky", [-0.5, 1.5, -0.5, 1.5, 1.1], false);
    for k in 0..289 {
        let (x, y) = (f64::from(k % 17) / 17.0, f64::from(k / 17) / 17.0);
        text += &quad(&format!("plate {k}"), [x, x + 0.02, y, y + 0.02, 0.3], false);
    }
    let bench = Bench::text(&text);
    let n = bench.mesh.len();
    let tree = Tree::new(&bench.mesh, bench.occluders.tolerance()).unwrap();
    // Two bands: the lamp alone, and the sky alone, before which there are too many plates.
    let radiosity = MultiVector::from_fn(n, 2, |i, band| if i == band + 1 { [5.0, 0.1][band] } else { 0.0 });
    let ones = MultiVector::from_fn(n, 2, |_, _| 1.0);
    let exposed: Vec<f64> = bench.mesh.patches().map(Patch::area).collect();
    let leaves = Leaves { radiosity: &radiosity, irradiance: &ones, exposed: &exposed };
    let gather = Gather::new(&tree, &leaves, &bench.occluders, &[], 1e-3).unwrap();
    let places =
        (0..25).map(|k| Vec3::new(0.1 + 0.17 * f64::from(k % 5), 0.13 + 0.17 * f64::from(k / 5), 0.0));
    let points: Vec<Receiver> = places.map(|p| Receiver::new(p, Vec3::Z).unwrap()).collect();
    let found = gather.irradiance(&points, &MultiVector::from_fn(25, 2, |_, _| 0.1), &Quiet).unwrap();
    let patches: Vec<&Patch> = bench.mesh.patches().collect();
    let row_of: Vec<usize> = (0..n).map(|i| i.min(3)).collect();
    let targets = Targets { patches: &patches, row_of: &row_of, rows: 4, occluders: &bench.occluders };
    let factors = targets.factors(&points, &Quiet).unwrap();
    let mut hidden = 0.0;
    for (row, exact) in found.rows().zip(factors.chunks(4)) {
        assert!((row[0] - 5.0 * exact[1]).abs() < 1e-12, "{row:?} {exact:?}");
        assert!((row[1] / (0.1 * exact[2]) - 1.0).abs() < 0.06, "{row:?} {exact:?}");
        hidden += exact[3] / 25.0;
    }
    assert!(hidden > 0.05, "the plates hide {hidden}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let bench = Bench::text(&common::room(0.5));
    let solution = bench.solve(0.1);
    let points = receivers(&solution, 5);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| gathered(&bench, &solution, &solution.radiosity, &points, 1e-3))
    };
    let one = with(1);
    assert!(one == with(2) && one == with(4));
}

#[test]
fn lists_of_another_length_are_refused() {
    let bench = Bench::text(&common::room(0.5));
    let solution = bench.solve(0.1);
    let (radiosity, irradiance) = (&solution.radiosity, &solution.means.irradiance);
    let leaves = Leaves { radiosity, irradiance, exposed: &[1.0] };
    let refused = Gather::new(&solution.tree, &leaves, &bench.occluders, &[], 1e-3);
    assert!(refused.unwrap_err().to_string().contains("1 rows"));
    let up = Receiver::new(Vec3::ONE, Vec3::Z).unwrap();
    let exposed = exposed(&solution);
    let gather =
        Gather::new(&solution.tree, &Leaves { exposed: &exposed, ..leaves }, &bench.occluders, &[], 1e-3);
    assert!(gather.unwrap().irradiance(&[up], &MultiVector::zeros(2, 1), &Quiet).is_err());
}
