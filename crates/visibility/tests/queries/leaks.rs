//! No segment leaves a closed surface, wherever it is aimed.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

use crate::scenes::{Random, cuboid, sphere, triangle};

/// A place between the corners, on an edge or at a corner.
fn target(random: &mut Random, corners: &[Vec3], kind: usize) -> Vec3 {
    let i = random.index(corners.len());
    let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
    match kind {
        0 => a,
        1 => 0.5 * (a + b),
        _ => a + (b - a) * random.unit(),
    }
}

/// Aims segments from the inside at edges and corners of the first patches, and counts those that
/// get out.
fn leaks(patches: &[Patch], targets: usize, centre: Vec3, radius: f64, segments: usize) -> usize {
    let occluders = Occluders::new(patches).unwrap();
    let mut random = Random(7);
    let mut pairs = Vec::new();
    for k in 0..segments {
        let aim = target(&mut random, patches[k % targets].corners(), k % 3);
        let start = if k % 4 == 0 { centre } else { centre + random.cube() * (0.3 * radius) };
        pairs.push((start, start + (aim - start) * (1.5 + 3.0 * random.unit())));
    }
    occluders.unoccluded_batch(&pairs).iter().filter(|&&free| free).count()
}

#[test]
fn a_million_segments_through_edges_and_corners_of_a_sphere() {
    let patches: Vec<Patch> = sphere(4).iter().map(|&t| triangle(t)).collect();
    assert_eq!(leaks(&patches, patches.len(), Vec3::ZERO, 1.0, 1_000_000), 0);
}

/// Spheres of five scales and offsets.
fn scaled_spheres(segments: usize) {
    let offset = Vec3::new(1000.0, -1000.0, 1000.0);
    let far = Vec3::new(-3e4, 2e4, 1e5);
    for (scale, centre) in [(1e-3, Vec3::ZERO), (1.0, offset), (1e-3, offset), (1e4, offset), (0.3, far)] {
        let patches: Vec<Patch> = sphere(3).iter().map(|t| triangle(t.map(|p| centre + p * scale))).collect();
        let free = leaks(&patches, patches.len(), centre, scale, segments);
        assert_eq!(free, 0, "scale {scale}, centre {centre}");
    }
}

#[test]
fn small_spheres_and_distant_ones() {
    scaled_spheres(100_000);
}

#[test]
#[ignore = "20 CPU seconds: a million segments at each of five scales and offsets"]
fn a_million_segments_at_each_of_five_scales_and_offsets() {
    scaled_spheres(1_000_000);
}

#[test]
fn a_tiny_sphere_in_a_large_room() {
    for (scale, centre) in [(1e-3, Vec3::new(0.3, 0.2, -0.1)), (1e-5, Vec3::new(-0.7, 0.1, 0.6))] {
        let mut patches: Vec<Patch> =
            sphere(3).iter().map(|t| triangle(t.map(|p| centre + p * scale))).collect();
        let targets = patches.len();
        patches.extend(cuboid(Vec3::ZERO, Vec3::ONE, 0.3, true));
        assert_eq!(leaks(&patches, targets, centre, scale, 100_000), 0, "scale {scale}");
    }
}

#[test]
fn turned_boxes_of_quads() {
    for turn in [0.0, 0.4, 1.1] {
        let centre = Vec3::new(0.1, 0.2, 0.3);
        let patches = cuboid(centre, Vec3::new(1.0, 0.7, 0.4), turn, true);
        assert_eq!(leaks(&patches, patches.len(), centre, 0.4, 100_000), 0, "turn {turn}");
    }
}

#[test]
fn prisms_of_trapezoids() {
    let outer = cuboid(Vec3::ZERO, Vec3::ONE, 0.4, false);
    // Two opposite sides of a box, one made smaller, and the trapezoids that join them.
    let taper = |p: Vec3| {
        let n = outer[0].normal();
        let height = p.dot(n);
        n * height + (p - n * height) * (0.7 + 0.3 * height)
    };
    let tapered = |side: &Patch| Patch::quad([0, 1, 2, 3].map(|i| taper(side.corner(i)))).unwrap();
    let patches: Vec<Patch> = outer.iter().filter_map(tapered).collect();
    assert_eq!(patches.len(), 6);
    assert_eq!(leaks(&patches, patches.len(), Vec3::ZERO, 1.0, 100_000), 0);
}
