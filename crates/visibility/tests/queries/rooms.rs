//! In an empty convex room every two points see each other.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

use crate::scenes::{Random, cuboid, sphere, triangle, triangulated};

fn pairs(patches: &[Patch], count: usize) -> Vec<(Vec3, Vec3)> {
    let mut random = Random(11);
    let mut point = |k: usize| random.on(&patches[k % patches.len()]);
    (0..count).map(|k| (point(k), point(k / patches.len()))).collect()
}

fn hidden(patches: &[Patch], count: usize) -> usize {
    let occluders = Occluders::new(patches).unwrap();
    occluders.unoccluded_batch(&pairs(patches, count)).iter().filter(|&&free| !free).count()
}

#[test]
fn a_box_of_quads_and_of_triangles() {
    for (scale, centre) in [(1.0, Vec3::ZERO), (1e-3, Vec3::ONE), (10.0, Vec3::splat(1000.0))] {
        for turn in [0.0, 0.6] {
            let quads = cuboid(centre, Vec3::new(1.0, 1.5, 0.5) * scale, turn, true);
            assert_eq!(hidden(&quads, 200_000), 0, "scale {scale}, turn {turn}");
            assert_eq!(hidden(&triangulated(&quads), 200_000), 0, "scale {scale}, turn {turn}");
        }
    }
}

#[test]
fn the_inside_of_a_sphere() {
    let patches: Vec<Patch> = sphere(3).iter().map(|&t| triangle(t)).collect();
    assert_eq!(hidden(&patches, 200_000), 0);
}

#[test]
fn corners_and_edges_of_a_box() {
    let quads = cuboid(Vec3::ZERO, Vec3::ONE, 0.6, true);
    let ends: Vec<Vec3> = quads
        .iter()
        .flat_map(|q| (0..4).flat_map(|i| [q.corner(i), 0.5 * (q.corner(i) + q.corner(i + 1))]))
        .collect();
    for patches in [quads.clone(), triangulated(&quads)] {
        let occluders = Occluders::new(&patches).unwrap();
        for &p in &ends {
            assert!(occluders.unoccluded_from(p, &ends).iter().all(|&free| free));
        }
    }
}
