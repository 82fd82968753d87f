//! A box on the floor of a room, and a smaller one on top of it: what they stand on sees nothing,
//! all else sees the whole room. A hollow box sees itself.

use crate::exact::assembled;
use fredholm_mesh::{Patch, Vec3};

/// The faces of a box from `min` to `max`, n × n patches each.
fn faces(min: Vec3, max: Vec3, n: usize, inward: bool) -> Vec<Patch> {
    let at = |t: [usize; 3]| min + (max - min) * (Vec3::from_array(t.map(|k| k as f64)) / n as f64);
    let cell = |k: usize| {
        let (axis, far, [i, j]) = (k / (2 * n * n), k / (n * n) % 2, [k / n % n, k % n]);
        let corner = |i: usize, j: usize| {
            let mut t = [far * n; 3];
            (t[(axis + 1) % 3], t[(axis + 2) % 3]) = (i, j);
            at(t)
        };
        let cell = Patch::quad([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
        let cell = cell.unwrap().unwrap();
        if (far == 1) == inward { cell.flipped() } else { cell }
    };
    (0..6 * n * n).map(cell).collect()
}

/// Largest distance of a row sum from 0 or 1, whichever is nearer.
fn defect(patches: &[Patch], tolerance: f64) -> f64 {
    let sums = assembled(patches, tolerance).matrix.row_sums();
    let shares = sums.iter().zip(patches).map(|(sum, patch)| sum / patch.area());
    shares.map(|share| (share - 1.0).abs().min(share.abs())).fold(0.0, f64::max)
}

fn room() -> Vec<Patch> {
    let mut patches = faces(Vec3::ZERO, Vec3::splat(4.0), 4, true);
    patches.extend(faces(Vec3::new(1.0, 1.0, 0.0), Vec3::new(3.0, 3.0, 1.5), 2, false));
    patches
}

#[test]
fn a_box_on_the_floor_hides_what_it_stands_on() {
    let defect = defect(&room(), 1e-4);
    println!("a box on the floor: rows sum to 0 or 1 within {defect:.1e}");
    assert!(defect < 1e-4);
}

#[test]
fn a_box_on_a_box_hides_what_it_stands_on() {
    let mut patches = room();
    patches.extend(faces(Vec3::new(1.0, 1.0, 1.5), Vec3::new(2.0, 2.0, 2.5), 2, false));
    let defect = defect(&patches, 1e-4);
    println!("a box on a box: rows sum to 0 or 1 within {defect:.1e}");
    assert!(defect < 1e-4);
}

/// The inner sides of a box lie on its outer sides.
#[test]
fn a_hollow_box_sees_itself() {
    let mut patches = faces(Vec3::ZERO, Vec3::splat(4.0), 4, true);
    let box_ = |inward| faces(Vec3::new(1.0, 1.0, 1.0), Vec3::new(3.0, 3.0, 2.5), 2, inward);
    patches.extend([false, true].into_iter().flat_map(box_));
    let defect = defect(&patches, 1e-4);
    println!("a hollow box: rows sum to 1 within {defect:.1e}");
    assert!(defect < 1e-4);
}
