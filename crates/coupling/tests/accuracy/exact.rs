//! Every entry of the matrices of a cube, and of a cube with a box inside, against exact ones.

use crate::symmetry::renumberings;
use crate::view3d::{patches, read};
use fredholm_coupling::form_factor::PairIntegrator;
use fredholm_coupling::{Assembled, assemble};
use fredholm_linop::Quiet;
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;

pub fn assembled(patches: &[Patch], tolerance: f64) -> Assembled<f64> {
    let occluders = Occluders::new(patches).unwrap();
    let integrator = PairIntegrator::new(patches, &occluders, tolerance);
    assemble(&integrator, &Quiet).unwrap()
}

/// One pair of each class of pairs that symmetries of the cube map onto each other: i, j and F_ij.
fn classes(name: &str) -> Vec<(usize, usize, f64)> {
    let text = read(name);
    let parse = |line: &str| {
        let mut words = line.split(',');
        let mut next = || words.next().unwrap().to_owned();
        (next().parse().unwrap(), next().parse().unwrap(), next().parse().unwrap())
    };
    text.lines().skip(1).map(parse).collect()
}

/// Largest difference of an entry F_ij over the largest entry; every entry off the diagonal is
/// looked at.
fn compare(name: &str, tolerance: f64) -> f64 {
    let patches = patches(&format!("{name}.vs3"));
    let matrix = assembled(&patches, tolerance).matrix;
    let images = renumberings(&patches);
    let n = patches.len();
    let (mut looked_at, mut worst, mut largest) = (vec![false; n * n], 0f64, 0f64);
    for (i, j, factor) in classes(&format!("{name}_exact.csv")) {
        let exact = factor * patches[i].area();
        largest = largest.max(factor);
        for (i, j) in images.iter().flat_map(|to| [(to[i], to[j]), (to[j], to[i])]) {
            looked_at[i * n + j] = true;
            worst = worst.max((matrix.get(i, j) - exact).abs() / patches[i].area());
        }
    }
    assert_eq!(looked_at.iter().filter(|looked_at| **looked_at).count(), n * (n - 1));
    println!("{name} at T = {tolerance:e}: entries within {:.1e} of the largest", worst / largest);
    worst / largest
}

#[test]
fn every_entry_of_an_empty_cube_is_exact() {
    for tolerance in [1e-6, 1e-9, 1e-12] {
        assert!(compare("cube8", tolerance) < tolerance);
    }
}

/// The reference behind the box is itself off by 6.6e-7 of the largest entry, as its row sums show.
#[test]
fn every_entry_of_a_cube_with_a_box_is_exact() {
    for (tolerance, allowed) in [(1e-3, 1e-4), (1e-4, 2e-5), (1e-6, 1e-6), (1e-8, 1e-6)] {
        assert!(compare("cubebox8", tolerance) < allowed);
    }
}

#[test]
fn rows_of_a_cube_with_a_box_add_up_to_one() {
    let patches = patches("cubebox8.vs3");
    for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
        let got = assembled(&patches, tolerance);
        let row = |(sum, patch): (f64, &Patch)| (sum / patch.area() - 1.0).abs();
        let worst = got.matrix.row_sums().into_iter().zip(&patches).map(row).fold(0.0, f64::max);
        println!("cubebox8 at T = {tolerance:e}: row sums within {worst:.1e}");
        assert!(worst < 0.1 * tolerance);
    }
}

/// Closed forms of rectangles face to face, superposed: unit squares at distance 1 behind a square
/// of side 0.5 halfway.
const BLOCKED: f64 = 0.099_506_294_598_985;

#[test]
fn a_square_halfway_is_exact() {
    let patches = patches("blocked.vs3");
    for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
        let got = assembled(&patches, tolerance);
        let (off, stated) = ((got.matrix.get(0, 1) - BLOCKED).abs(), got.largest);
        println!("blocked at T = {tolerance:e}: off by {off:.1e}, stated {stated:.1e}");
        assert!(off <= stated.max(1e-14) && off < tolerance.max(1e-14));
    }
}
