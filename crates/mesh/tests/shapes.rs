//! Areas, normals, order and closedness of the shapes, against closed forms.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use std::f64::consts::PI;

use common::{area, area_vector, assert_close, assert_near, border_edges, counts, mesh, v, volume, whole};
use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Patch, Shape, Vec3};

const SEGMENTS: [usize; 6] = [3, 4, 7, 12, 17, 40];

fn unit_square() -> Shape {
    Shape::Quad { corners: [Vec3::ZERO, Vec3::X, v(1.0, 1.0, 0.0), Vec3::Y], skip: vec![] }
}

/// The saddle z = x y over the unit square.
fn saddle() -> Shape {
    Shape::Quad { corners: [Vec3::ZERO, Vec3::X, v(1.0, 1.0, 1.0), Vec3::Y], skip: vec![] }
}

fn sphere(segments: usize, inward: bool) -> Shape {
    Shape::Sphere { centre: v(1.0, -2.0, 0.5), radius: 1.5, inward, segments }
}

fn cylinder(segments: usize, caps: bool, inward: bool) -> Shape {
    Shape::Cylinder { base: v(0.3, 0.1, -1.0), axis: v(1.0, 2.0, 2.0), radius: 0.7, caps, inward, segments }
}

fn disc(segments: usize) -> Shape {
    Shape::Disc { centre: v(3.0, 2.0, 1.0), normal: v(0.0, 3.0, 4.0), radius: 0.8, segments }
}

fn cuboid(inward: bool) -> Shape {
    Shape::Box { min: v(-1.0, 0.0, 2.0), max: v(1.0, 3.0, 7.0), inward }
}

#[test]
fn quad_faces_run_along_v_first() {
    let mesh = mesh(&unit_square(), &counts(2, 3));
    assert_eq!(mesh.faces().len(), 6);
    for (index, face) in mesh.faces().iter().enumerate() {
        let (i, j) = ((index / 3) as f64, (index % 3) as f64);
        assert_near(face.centroid, v(0.25 + 0.5 * i, (j + 0.5) / 3.0, 0.0), 1e-15);
        assert_close(face.area, 1.0 / 6.0, 1e-15);
    }
    assert!(mesh.patches().all(|patch| patch.normal() == Vec3::Z && patch.sides() == 4));
}

#[test]
fn explicit_lines_place_the_faces() {
    let lines = Lines::Explicit { u: vec![0.0, 0.2, 1.0], v: vec![0.0, 0.5, 1.0] };
    let mesh = mesh(&unit_square(), &Cutting { lines, ..whole() });
    let areas: Vec<f64> = mesh.faces().iter().map(|face| face.area).collect();
    for (found, expected) in areas.iter().zip([0.1, 0.1, 0.4, 0.4]) {
        assert_close(*found, expected, 1e-15);
    }
    assert_eq!(areas.len(), 4);
    assert_near(mesh.faces()[2].centroid, v(0.6, 0.25, 0.0), 1e-15);
}

#[test]
fn elements_of_a_face_fill_it_and_stay_together() {
    let cutting = Cutting { elements_per_side: 3, ..counts(2, 2) };
    let mesh = mesh(&unit_square(), &cutting);
    assert_eq!((mesh.faces().len(), mesh.len()), (4, 36));
    for face in 0..4 {
        let leaves = mesh.leaves_of_face(face);
        assert_eq!(leaves, 9 * face..9 * face + 9);
        let centroid: Vec3 = leaves.map(|leaf| mesh.patch(leaf).centroid() / 9.0).sum();
        assert_near(centroid, mesh.faces()[face].centroid, 1e-15);
    }
}

#[test]
fn a_flat_quad_is_one_occluder_and_a_quad_with_a_gap_is_its_cells() {
    let full = mesh(&unit_square(), &counts(5, 5));
    assert_eq!(full.occluders().len(), 1);
    assert_close(full.occluders()[0].area(), 1.0, 1e-15);

    let corners = [Vec3::ZERO, Vec3::X, v(1.0, 1.0, 0.0), Vec3::Y];
    let holed = mesh(&Shape::Quad { corners, skip: vec![[1, 2], [1, 2], [0, 0]] }, &counts(2, 3));
    assert_eq!((holed.faces().len(), holed.occluders().len()), (4, 4));
    assert_close(area(&holed), 4.0 / 6.0, 1e-15);
    assert_near(holed.faces()[0].centroid, v(0.25, 0.5, 0.0), 1e-15);
    assert_near(holed.faces()[3].centroid, v(0.75, 0.5, 0.0), 1e-15);
}

#[test]
fn a_lamp_fits_its_hole_without_a_gap() {
    let lines = Lines::Explicit { u: vec![0.0, 0.3, 0.6, 1.0], v: vec![0.0, 0.1, 0.7, 1.0] };
    let corners = [Vec3::ZERO, Vec3::X, v(1.0, 1.0, 0.0), Vec3::Y];
    let lamp = [v(0.3, 0.1, 0.0), v(0.6, 0.1, 0.0), v(0.6, 0.7, 0.0), v(0.3, 0.7, 0.0)];
    let mut builder = MeshBuilder::default();
    builder.surface("ceiling", 0);
    builder.add(&Shape::Quad { corners, skip: vec![[1, 1]] }, &Cutting { lines, ..whole() }).unwrap();
    builder.surface("lamp", 1);
    builder.add(&Shape::Quad { corners: lamp, skip: vec![] }, &whole()).unwrap();
    let mesh = builder.build();
    assert_close(area(&mesh), 1.0, 1e-15);
    assert_eq!(border_edges(&mesh), 12);
    assert_eq!(mesh.surface_of(8), 1);
}

#[test]
fn the_back_of_a_surface_meets_its_front() {
    for shape in [unit_square(), saddle(), disc(9), Shape::Triangle { corners: [Vec3::X, Vec3::Y, Vec3::Z] }]
    {
        let cutting = Cutting { elements_per_side: 2, ..counts(2, 2) };
        let front = mesh(&shape, &cutting);
        let back = mesh(&shape, &Cutting { flipped: true, ..cutting });
        assert_eq!(front.len(), back.len());
        assert!(back.occluders().is_empty() && !front.occluders().is_empty());
        for (a, b) in front.patches().zip(back.patches()) {
            assert_eq!(a.normal(), -b.normal());
            assert!(a.corners().iter().all(|corner| b.corners().contains(corner)));
        }
    }
}

#[test]
fn triangle_is_cut_into_congruent_ones() {
    let corners = [v(0.0, 0.0, 1.0), v(2.0, 0.0, 1.0), v(0.0, 1.0, 1.0)];
    let mesh = mesh(&Shape::Triangle { corners }, &Cutting { elements_per_side: 2, ..counts(3, 3) });
    assert_eq!((mesh.faces().len(), mesh.len(), mesh.occluders().len()), (9, 36, 1));
    assert!(
        mesh.patches().all(|patch| (patch.area() - 1.0 / 36.0).abs() < 1e-15 && patch.normal() == Vec3::Z)
    );
    let centroid: Vec3 = mesh.patches().map(|patch| patch.centroid() / 36.0).sum();
    assert_near(centroid, v(2.0 / 3.0, 1.0 / 3.0, 1.0), 1e-14);
    assert_eq!(border_edges(&mesh), 18);
}

#[test]
fn largest_edge_holds_everywhere() {
    for shape in [unit_square(), cuboid(true), sphere(10, false), disc(12), cylinder(9, true, false)] {
        let mesh = mesh(&shape, &Cutting { lines: Lines::LargestEdge(0.3), ..whole() });
        for patch in mesh.patches() {
            let longest = (0..patch.sides()).map(|i| patch.corner(i).distance(patch.corner(i + 1)));
            assert!(longest.fold(0.0, f64::max) <= 0.3 * (1.0 + 1e-9));
        }
    }
    let room = mesh(&cuboid(true), &Cutting { lines: Lines::LargestEdge(1.0), ..whole() });
    assert_eq!(room.len(), 2 * (2 * 3 + 3 * 5 + 5 * 2));
}

#[test]
fn box_has_its_area_volume_and_order() {
    for (inward, sign) in [(false, 1.0), (true, -1.0)] {
        let mesh = mesh(&cuboid(inward), &counts(2, 3));
        assert_close(area(&mesh), 2.0 * (2.0 * 3.0 + 3.0 * 5.0 + 5.0 * 2.0), 1e-12);
        assert_close(volume(&mesh), sign * 30.0, 1e-12);
        let directions = [-Vec3::X, Vec3::X, -Vec3::Y, Vec3::Y, -Vec3::Z, Vec3::Z];
        for (leaf, patch) in mesh.patches().enumerate() {
            assert_eq!(patch.normal(), directions[leaf / 6] * sign);
        }
    }
    assert_eq!(mesh(&cuboid(false), &whole()).occluders().len(), 6);
}

#[test]
fn curved_shapes_have_the_area_of_the_true_ones() {
    for segments in SEGMENTS {
        let exact = |shape: &Shape, expected: f64| {
            assert_close(area(&mesh(shape, &whole())) / expected, 1.0, 1e-13);
            assert_close(area(&mesh(shape, &counts(2, 2))) / expected, 1.0, 1e-13);
        };
        exact(&sphere(segments, false), 4.0 * PI * 1.5 * 1.5);
        exact(&disc(segments), PI * 0.8 * 0.8);
        exact(&cylinder(segments, false, false), 2.0 * PI * 0.7 * 3.0);
        exact(&cylinder(segments, true, true), 2.0 * PI * 0.7 * (3.0 + 0.7));
    }
}

#[test]
fn closed_shapes_are_closed() {
    let mut shapes = vec![cuboid(false), cuboid(true)];
    for segments in SEGMENTS {
        shapes.extend([sphere(segments, false), sphere(segments, true)]);
        shapes.extend([cylinder(segments, true, false), cylinder(segments, true, true)]);
    }
    for shape in &shapes {
        for cutting in [whole(), counts(3, 3), Cutting { elements_per_side: 2, ..whole() }] {
            let mesh = mesh(shape, &cutting);
            assert!(area_vector(&mesh).length() <= 1e-12, "{shape:?}: {}", area_vector(&mesh));
            assert_eq!(border_edges(&mesh), 0, "{shape:?}");
        }
    }
}

#[test]
fn occluders_close_the_same_solid() {
    for shape in [sphere(12, true), cylinder(9, true, false), cylinder(20, true, true), cuboid(true)] {
        let mesh = mesh(&shape, &counts(2, 2));
        let total: f64 = mesh.occluders().iter().map(Patch::area).sum();
        let vector: Vec3 = mesh.occluders().iter().map(|patch| patch.normal() * patch.area()).sum();
        let content: f64 =
            mesh.occluders().iter().map(|p| p.area() * p.normal().dot(p.centroid()) / 3.0).sum();
        assert_close(total, area(&mesh), 1e-11);
        assert_close(content, volume(&mesh), 1e-11);
        assert!(vector.length() < 1e-12);
    }
}

#[test]
fn sphere_and_cylinder_tend_to_the_true_volume_at_second_order() {
    let defect = |shape: &Shape, exact: f64| 1.0 - volume(&mesh(shape, &whole())) / exact;
    let ball = 4.0 / 3.0 * PI * 1.5_f64.powi(3);
    let ratio = defect(&sphere(20, false), ball) / defect(&sphere(40, false), ball);
    assert!((3.7..4.3).contains(&ratio), "{ratio}");
    let pillar = PI * 0.49 * 3.0;
    let ratio = defect(&cylinder(20, true, false), pillar) / defect(&cylinder(40, true, false), pillar);
    assert!((3.7..4.3).contains(&ratio), "{ratio}");
    assert_close(
        volume(&mesh(&sphere(40, true), &whole())),
        -volume(&mesh(&sphere(40, false), &whole())),
        1e-12,
    );
}

#[test]
fn sphere_facets_are_nearly_equal() {
    let mesh = mesh(&sphere(100, false), &whole());
    assert_eq!(mesh.len(), 20 * 20 * 20);
    let centre = v(1.0, -2.0, 0.5);
    let mut edges = Vec::new();
    for patch in mesh.patches() {
        edges.extend((0..3).map(|i| patch.corner(i).distance(patch.corner(i + 1))));
        assert!(patch.normal().dot((patch.centroid() - centre).normalize()) > 0.999);
    }
    let (least, most) = edges.iter().fold((f64::MAX, 0.0_f64), |(a, b), &edge| (a.min(edge), b.max(edge)));
    assert!(most / least < 1.2, "{}", most / least);
}

#[test]
fn disc_lies_flat_around_its_centre_without_slivers() {
    for segments in SEGMENTS {
        let mesh = mesh(&disc(segments), &whole());
        assert_eq!(border_edges(&mesh), segments);
        assert_eq!(mesh.occluders().len(), (segments - 1) / 2);
        let centroid: Vec3 = mesh.patches().map(|p| p.centroid() * (p.area() / area(&mesh))).sum();
        assert_near(centroid, v(3.0, 2.0, 1.0), 1e-14);
        assert!(mesh.patches().all(|patch| patch.normal().distance(v(0.0, 0.6, 0.8)) < 1e-14));
        let blocked: f64 = mesh.occluders().iter().map(Patch::area).sum();
        assert_close(blocked, PI * 0.64, 1e-13);
    }
    let fine = fredholm_mesh::Quality::of(&mesh(&disc(120), &whole())).unwrap();
    assert!(fine.worst_aspect_ratio < 1.5 && fine.smallest_angle_degrees > 40.0, "{fine:?}");
}

#[test]
fn saddle_tends_to_its_area_and_its_occluders_are_its_cells() {
    // ∫∫ √(1 + x² + y²) over the unit square.
    let exact = 3.0_f64.sqrt() / 3.0 + 4.0 / 3.0 * ((1.0 + 3.0_f64.sqrt()) / 2.0_f64.sqrt()).ln() - PI / 18.0;
    let defect = |n| (area(&mesh(&saddle(), &counts(n, n))) - exact).abs();
    let ratio = defect(8) / defect(16);
    assert!((3.8..4.2).contains(&ratio), "{ratio}");

    let mesh = mesh(&saddle(), &Cutting { elements_per_side: 3, ..counts(4, 2) });
    assert_eq!((mesh.faces().len(), mesh.len(), mesh.occluders().len()), (8, 8 * 18, 16));
    let blocked: f64 = mesh.occluders().iter().map(Patch::area).sum();
    assert_close(blocked, area(&mesh), 1e-14);
    assert_near(area_vector(&mesh), v(-0.5, -0.5, 1.0), 1e-14);
}

#[test]
fn a_room_with_a_warped_wall_is_watertight() {
    // The published Cornell box, in metres, without its blocks: its left wall is not flat.
    let points: Vec<Vec3> = [
        [552.8, 0.0, 0.0],
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 559.2],
        [549.6, 0.0, 559.2],
        [556.0, 548.8, 0.0],
        [556.0, 548.8, 559.2],
        [0.0, 548.8, 559.2],
        [0.0, 548.8, 0.0],
    ]
    .map(|p| Vec3::from_array(p) / 1000.0)
    .to_vec();
    let mut builder = MeshBuilder::default();
    builder.surface("room", 0);
    for wall in [[0, 1, 2, 3], [4, 5, 6, 7], [3, 2, 6, 5], [2, 1, 7, 6], [0, 3, 5, 4], [1, 0, 4, 7]] {
        let quad = Shape::Quad { corners: wall.map(|i| points[i]), skip: vec![] };
        builder.add(&quad, &counts(4, 4)).unwrap();
    }
    let mesh = builder.build();
    assert_eq!((mesh.faces().len(), mesh.len()), (96, 96 + 16));
    assert_eq!(mesh.occluders().len(), 5 + 32);
    assert_eq!(border_edges(&mesh), 0);
    assert!(area_vector(&mesh).length() < 1e-14);
}

#[test]
fn a_dart_is_two_triangles() {
    for turn in 0..4 {
        let mut corners = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.2, 0.2, 0.0), v(0.0, 1.0, 0.0)];
        corners.rotate_left(turn);
        let mesh = mesh(&Shape::Quad { corners, skip: vec![] }, &whole());
        assert_eq!((mesh.faces().len(), mesh.len(), mesh.occluders().len()), (1, 2, 2));
        assert_close(area(&mesh), 0.2, 1e-15);
        assert!(mesh.patches().all(|patch| patch.normal() == Vec3::Z));
    }
}

#[test]
fn the_same_shapes_give_the_same_mesh() {
    let room = || -> Mesh { mesh(&sphere(50, true), &counts(2, 2)) };
    assert_eq!(room(), room());
}
