//! What points receive of lamps agrees with sums over small parts of the lamps, each seen or not by
//! a ray.

#![allow(clippy::float_cmp, reason = "what is dark is exactly so")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_hierarchical::Lamps;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

fn quad(corners: [[f64; 3]; 4]) -> Patch {
    Patch::quad(corners.map(Vec3::from)).unwrap().unwrap()
}

/// A floor of 4 × 4 m, lit upwards.
fn floor() -> Patch {
    quad([[-2., -2., 0.], [2., -2., 0.], [2., 2., 0.], [-2., 2., 0.]])
}

/// A square lamp at a height of 2 m that shines downwards, of 2 × 2 patches.
fn panel() -> Vec<Patch> {
    let cell = |i: i32, j: i32| {
        let [x, y] = [i, j].map(|k| 0.5 * f64::from(k));
        quad([[x, y, 2.], [x, y + 0.5, 2.], [x + 0.5, y + 0.5, 2.], [x + 0.5, y, 2.]])
    };
    [(-1, -1), (-1, 0), (0, -1), (0, 0)].map(|(i, j)| cell(i, j)).to_vec()
}

/// The six sides of a box, lit outside.
fn block(low: [f64; 3], high: [f64; 3]) -> Vec<Patch> {
    let at = |k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 1 { high[i] } else { low[i] });
    let rings = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    rings.map(|ring| quad(ring.map(at))).to_vec()
}

fn refined(patches: &[Patch], times: usize) -> Vec<Patch> {
    (0..times)
        .fold(patches.to_vec(), |parts, _| parts.iter().flat_map(|part| part.split().unwrap()).collect())
}

/// The same from parts whose middles are seen.
fn counted(x: Vec3, patches: &[Patch], occluders: &Occluders) -> f64 {
    let faces = |part: &&Patch| part.normal().dot(x - part.centroid()) > 0.0;
    let seen = |part: &&Patch| occluders.unoccluded(x, part.centroid());
    refined(patches, 5)
        .iter()
        .filter(faces)
        .filter(seen)
        .map(|part| point_to_polygon(Vec3::Z, part.corners().iter().map(|y| *y - x)))
        .sum()
}

fn compare(lamp: &[Patch], bodies: &[Patch], tolerance: f64) -> [usize; 3] {
    let ground = floor();
    let all: Vec<Patch> = [&[ground][..], lamp, bodies].concat();
    let occluders = Occluders::new(&all).unwrap();
    let lamps = Lamps::new(&[lamp.iter().collect()], all.iter().collect(), &occluders).unwrap().unwrap();
    let mut lighter = lamps.lighter();
    let mut kinds = [0; 3];
    for k in 0..60 {
        let at = |r: f64| (f64::from(k) * r).fract() * 4.0 - 2.0;
        let x = Vec3::new(at(0.754_877_666), at(0.569_840_291), 0.0);
        let mut found = [f64::NAN];
        lighter.factors(0, &[x], &mut found);
        let expected = counted(x, lamp, &occluders);
        let whole = counted(x, lamp, &Occluders::new(&[]).unwrap());
        assert!((found[0] - expected).abs() <= tolerance * whole, "{x}: {} {expected} {whole}", found[0]);
        let kind = if found[0] == 0.0 {
            0
        } else if found[0] < 0.99 * whole {
            1
        } else {
            2
        };
        kinds[kind] += 1;
    }
    kinds
}

#[test]
fn points_looked_at_together_are_as_those_alone() {
    let ground = floor();
    let leg = block([0.7, 0.7, 0.0], [0.71, 0.71, 0.9]);
    let all = [&[ground][..], &panel(), &block([-0.6, -0.5, 0.3], [0.3, 0.6, 1.1]), &leg].concat();
    let occluders = Occluders::new(&all).unwrap();
    let panel = panel();
    let lamps = Lamps::new(&[panel.iter().collect()], all.iter().collect(), &occluders).unwrap().unwrap();
    let mut lighter = lamps.lighter();
    let place = |k: i32| 0.02 * f64::from(k) + 0.003;
    let points: Vec<Vec3> =
        (-90..90).flat_map(|i| (-90..90).map(move |j| Vec3::new(place(i), place(j), 0.0))).collect();
    let mut together = vec![f64::NAN; points.len()];
    lighter.factors(0, &points, &mut together);
    let (mut dark, mut between) = (0, 0);
    for (&x, &found) in points.iter().zip(&together) {
        let mut alone = [f64::NAN];
        lighter.factors(0, &[x], &mut alone);
        // Nearly linear means to half a percent in either direction; edges of the block that pass
        // those of the lamp make bends of that size.
        assert!((found - alone[0]).abs() <= 1e-2 * alone[0], "{x}: {found} {}", alone[0]);
        dark += usize::from(alone[0] == 0.0);
        between += usize::from(found != alone[0]);
    }
    assert!(dark > 100 && between > 10_000, "{dark} {between}");
}

#[test]
fn an_open_lamp_is_seen_whole() {
    assert_eq!(compare(&panel(), &[], 1e-12), [0, 0, 60]);
}

#[test]
fn a_block_before_a_panel_hides_what_rays_find_hidden() {
    let [dark, half, lit] = compare(&panel(), &block([-0.6, -0.5, 0.3], [0.3, 0.6, 1.1]), 0.03);
    assert!(dark > 0 && half > 3 && lit > 3, "{dark} {half} {lit}");
}

#[test]
fn a_solid_lamp_is_seen_by_its_outline() {
    let lamp = block([-0.3, -0.2, 1.5], [0.4, 0.5, 1.9]);
    assert_eq!(compare(&lamp, &[], 1e-12), [0, 0, 60]);
    let plate = quad([[-0.5, -0.5, 0.8], [0.3, -0.5, 0.8], [0.3, 0.2, 0.8], [-0.5, 0.2, 0.8]]);
    let [_, half, lit] = compare(&lamp, &[plate, plate.flipped()], 0.03);
    assert!(half > 3 && lit > 3, "{half} {lit}");
}

#[test]
fn a_point_below_the_lamp_plane_sees_nothing_of_it() {
    let ceiling = quad([[-2., -2., 3.], [-2., 2., 3.], [2., 2., 3.], [2., -2., 3.]]);
    let panel = panel();
    let all: Vec<Patch> = [&[ceiling][..], &panel].concat();
    let occluders = Occluders::new(&all).unwrap();
    let lamps = Lamps::new(&[panel.iter().collect()], all.iter().collect(), &occluders).unwrap().unwrap();
    let mut found = [1.0];
    lamps.lighter().factors(0, &[Vec3::new(0.1, 0.1, 3.0)], &mut found);
    assert!(found[0].abs() < 1e-300);
}
