//! Lines of shadows against similar triangles, and against where the irradiance begins and ends.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod common;

use common::Bench;
use fredholm_hierarchical::shadow_edges;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::Bodies;

/// A square lamp of half width 0.1 at height 1 over a plate of half width 0.2 at height ½, both
/// over the middle of a unit floor; on the floor stands a box.
fn scene() -> Bench {
    Bench::text(
        "[materials.black]\nreflectance = 0\n[materials.lamp]\nreflectance = 0\nexitance = 1\n\
         [[surface]]\nname = \"floor\"\nmaterial = \"black\"\nquad = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]\n\
         [[surface]]\nname = \"plate\"\nmaterial = \"black\"\n\
         quad = [[-0.2, -0.2, 0.5], [0.2, -0.2, 0.5], [0.2, 0.2, 0.5], [-0.2, 0.2, 0.5]]\ntwo_sided = true\n\
         [[surface]]\nname = \"box\"\nmaterial = \"black\"\nbox = { min = [0.7, 0.7, 0], max = [0.8, 0.9, 0.1] }\n\
         [[surface]]\nname = \"lamp\"\nmaterial = \"lamp\"\n\
         quad = [[-0.1, -0.1, 1], [-0.1, 0.1, 1], [0.1, 0.1, 1], [0.1, -0.1, 1]]\n",
    )
}

/// The lines on the floor, and the patches.
fn lines(bench: &Bench) -> Vec<[Vec3; 2]> {
    let patches: Vec<&Patch> = bench.mesh.patches().collect();
    let bodies = Bodies::new(&bench.occluders, &patches, &[]);
    let lamp = *patches.iter().find(|patch| patch.centroid().z > 0.9).unwrap();
    let floor = patches.iter().find(|patch| patch.area() > 3.0).unwrap();
    shadow_edges(&[*lamp], &bodies, floor)
}

/// Whether a line passes through two places.
fn holds(lines: &[[Vec3; 2]], from: [f64; 2], to: [f64; 2]) -> bool {
    let on = |[a, b]: &[Vec3; 2], [x, y]: [f64; 2]| {
        let p = Vec3::new(x, y, 0.0);
        let t = (p - *a).dot(*b - *a) / a.distance_squared(*b);
        (-1e-9..1.0 + 1e-9).contains(&t) && p.distance(a.lerp(*b, t)) < 1e-9
    };
    lines.iter().any(|line| on(line, from) && on(line, to))
}

#[test]
fn umbra_and_penumbra_end_where_similar_triangles_say() {
    let lines = lines(&scene());
    // From the lamp's edge at ±0.1 past the plate's edge at 0.2 half-way down: to 0.2 · 2 ∓ 0.1.
    for end in [0.3, 0.5] {
        for sign in [1.0, -1.0] {
            assert!(holds(&lines, [sign * end, -0.2], [sign * end, 0.2]), "x = {}", sign * end);
            assert!(holds(&lines, [-0.2, sign * end], [0.2, sign * end]), "y = {}", sign * end);
        }
    }
    // A corner of the plate from an edge of the lamp.
    assert!(holds(&lines, [0.3, 0.3], [0.5, 0.3]));
    // The box meets the floor.
    assert!(holds(&lines, [0.7, 0.7], [0.8, 0.7]) && holds(&lines, [0.8, 0.7], [0.8, 0.9]));
    assert!(lines.iter().flatten().all(|x| x.z.abs() < 1e-12), "all lie on the floor");
}

#[test]
fn what_is_beside_the_lamp_or_above_it_casts_no_shadow() {
    let bench = scene();
    let patches: Vec<&Patch> = bench.mesh.patches().collect();
    let bodies = Bodies::new(&bench.occluders, &patches, &[]);
    let floor = patches.iter().find(|patch| patch.area() > 3.0).unwrap();
    let low =
        Patch::quad([[-0.1, -0.1], [-0.1, 0.1], [0.1, 0.1], [0.1, -0.1]].map(|[x, y]| Vec3::new(x, y, 0.05)));
    let found = shadow_edges(&[low.unwrap().unwrap()], &bodies, floor);
    // Below the lamp is nothing but the lower half of the box, whose shadow points away from it.
    assert!(found.iter().flatten().all(|x| x.x > 0.69 && x.y > 0.69), "{found:?}");
    assert!(!found.is_empty());
}

#[test]
fn a_lamp_below_a_polygon_casts_no_shadow_on_it() {
    let bench = scene();
    let patches: Vec<&Patch> = bench.mesh.patches().collect();
    let bodies = Bodies::new(&bench.occluders, &patches, &[]);
    let square = |half: f64, z: f64| {
        let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
        Patch::quad(corners.map(|[x, y]| Vec3::new(x, y, z))).unwrap().unwrap()
    };
    // The box reaches from below the polygon to above it.
    assert!(shadow_edges(&[square(0.1, 0.02)], &bodies, &square(1.0, 0.05)).is_empty());
    assert!(!shadow_edges(&[square(0.1, 0.9)], &bodies, &square(1.0, 0.05)).is_empty());
}
