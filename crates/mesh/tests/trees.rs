//! Splitting, welding and figures of meshes.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{area, area_vector, assert_close, assert_near, border_edges, counts, mesh, v, volume, whole};
use fredholm_mesh::{Cutting, Mesh, MeshBuilder, MeshError, Patch, Quality, Shape, Vec3, Weld};

fn sphere(segments: usize) -> Shape {
    Shape::Sphere { centre: v(0.2, 0.0, 0.0), radius: 1.0, inward: false, segments }
}

fn cuboid() -> Shape {
    Shape::Box { min: Vec3::ZERO, max: v(1.0, 2.0, 3.0), inward: false }
}

fn split_all(mesh: &mut Mesh) {
    for element in mesh.leaves().to_vec() {
        mesh.split(element).unwrap();
    }
}

#[test]
fn splitting_conserves_area_normal_and_centroid() {
    for corners in [
        vec![v(0.0, 0.0, 1.0), v(3.0, 0.2, 1.0), v(2.0, 2.0, 1.0), v(-0.5, 1.0, 1.0)],
        vec![v(0.0, 0.0, 1.0), v(3.0, 0.2, 1.0), v(2.0, 2.0, 1.0)],
    ] {
        let patch = match corners[..] {
            [a, b, c, d] => Patch::quad([a, b, c, d]).unwrap().unwrap(),
            _ => Patch::triangle([corners[0], corners[1], corners[2]]).unwrap(),
        };
        let parts = patch.split().unwrap();
        assert_close(parts.iter().map(Patch::area).sum(), patch.area(), 1e-14);
        let centroid: Vec3 = parts.iter().map(|part| part.centroid() * (part.area() / patch.area())).sum();
        assert_near(centroid, patch.centroid(), 1e-14);
        for part in parts {
            assert_eq!((part.normal(), part.sides()), (patch.normal(), patch.sides()));
            assert_close(part.diameter(), part.diameter().min(0.75 * patch.diameter()), 0.0);
        }
    }
}

#[test]
fn split_meshes_stay_watertight() {
    for shape in [sphere(10), cuboid()] {
        let mut mesh = mesh(&shape, &whole());
        let (before, enclosed, leaves) = (area(&mesh), volume(&mesh), mesh.len());
        split_all(&mut mesh);
        split_all(&mut mesh);
        assert_eq!(mesh.len(), 16 * leaves);
        assert_close(area(&mesh), before, 1e-12);
        assert_close(volume(&mesh), enclosed, 1e-12);
        assert!(area_vector(&mesh).length() < 1e-12);
        assert_eq!(border_edges(&mesh), 0);
    }
}

#[test]
fn leaves_do_not_depend_on_the_order_of_the_splits() {
    let positions = |order: [usize; 3]| {
        let mut mesh = mesh(&cuboid(), &whole());
        for element in order {
            mesh.split(element).unwrap();
        }
        mesh.patches().map(Patch::centroid).collect::<Vec<_>>()
    };
    assert_eq!(positions([0, 2, 5]), positions([5, 0, 2]));
    assert_eq!(positions([0, 2, 5]).len(), 15);
}

#[test]
fn trees_know_parents_children_and_faces() {
    let mut mesh = mesh(&cuboid(), &Cutting { elements_per_side: 2, ..whole() });
    assert_eq!(mesh.roots_of_face(1), 4..8);
    let children = mesh.split(5).unwrap();
    let grandchildren = mesh.split(children[2]).unwrap();
    assert_eq!(mesh.children(5).collect::<Vec<_>>(), children);
    assert_eq!(mesh.children(children[2]), grandchildren[0]..grandchildren[3] + 1);
    assert_eq!(mesh.ancestors(grandchildren[1]).collect::<Vec<_>>(), [children[2], 5]);
    assert_eq!(mesh.elements()[grandchildren[1]].level, 2);
    assert!(mesh.children(4).is_empty() && mesh.children(10_000).is_empty());

    let [a, b, _, d] = children;
    let [e, f, g, h] = grandchildren;
    assert_eq!(mesh.leaves()[3..14], [3, 4, a, b, e, f, g, h, d, 6, 7]);
    assert_eq!(mesh.leaves_of_face(1), 4..14);
    assert_eq!(mesh.roots_of_face(1), 4..8);
    assert_eq!(mesh.leaves_of_face(2), 14..18);
    assert!(mesh.leaves_of_face(6).is_empty() && mesh.leaves_of_face(usize::MAX).is_empty());
    for leaf in 0..mesh.len() {
        assert_eq!(mesh.leaf_of(mesh.leaves()[leaf]), Some(leaf));
    }
    assert_eq!(mesh.leaf_of(5), None);
    assert_eq!(mesh.split(5), Err(MeshError::NotALeaf { element: 5 }));
    assert_eq!(mesh.split(10_000), Err(MeshError::NotALeaf { element: 10_000 }));
}

#[test]
fn splitting_ends_where_coordinates_do() {
    let far = v(1e6, 0.0, 0.0);
    let corners = [far, far + Vec3::X, far + Vec3::X + Vec3::Y, far + Vec3::Y];
    let mut mesh = mesh(&Shape::Quad { corners, skip: vec![] }, &whole());
    let mut element = 0;
    let mut splits = 0;
    let error = loop {
        match mesh.split(element) {
            Ok(children) => element = children[3],
            Err(error) => break error,
        }
        splits += 1;
    };
    assert!(matches!(error, MeshError::NoArea { .. }));
    // The spacing of numbers near 1e6 is 2⁻³³.
    assert_eq!(splits, 33);
    assert_close(area(&mesh), 1.0, 1e-9);
}

#[test]
fn welding_a_closed_mesh_satisfies_euler() {
    for (shape, cutting) in
        [(sphere(15), whole()), (sphere(5), counts(4, 4)), (cuboid(), counts(3, 3)), (cuboid(), whole())]
    {
        let mesh = mesh(&shape, &cutting);
        let welded = mesh.welded(Weld::Everywhere);
        let corners: usize = welded.patches().map(<[usize]>::len).sum();
        assert_eq!(welded.vertices.len() + welded.len(), corners / 2 + 2);
        for (patch, indices) in mesh.patches().zip(welded.patches()) {
            for (corner, &index) in patch.corners().iter().zip(indices) {
                assert!(corner.distance(welded.vertices[index]) < 1e-8);
            }
        }
    }
}

#[test]
fn smooth_welding_keeps_sharp_edges_and_surfaces_apart() {
    let smooth = Weld::Smooth { degrees: 30.0 };
    let ball = mesh(&sphere(40), &whole());
    assert_eq!(ball.welded(smooth), ball.welded(Weld::Everywhere));

    let segments = 24;
    let cylinder =
        Shape::Cylinder { base: Vec3::ZERO, axis: Vec3::Z, radius: 1.0, caps: true, inward: false, segments };
    let can = mesh(&cylinder, &whole());
    let vertices = |weld| can.welded(weld).vertices.len();
    assert_eq!(vertices(smooth), vertices(Weld::Everywhere) + 2 * segments);

    let mut builder = MeshBuilder::default();
    for (name, x) in [("left", 0.0), ("right", 1.0)] {
        builder.surface(name, 0);
        let corners = [v(x, 0.0, 0.0), v(x + 1.0, 0.0, 0.0), v(x + 1.0, 1.0, 0.0), v(x, 1.0, 0.0)];
        builder.add(&Shape::Quad { corners, skip: vec![] }, &whole()).unwrap();
    }
    let pair = builder.build();
    assert_eq!(pair.welded(Weld::Everywhere).vertices.len(), 6);
    assert_eq!(pair.welded(smooth).vertices.len(), 8);
}

#[test]
fn welding_joins_what_rounding_parted() {
    let mut builder = MeshBuilder::default();
    builder.surface("strips", 0);
    for (k, off) in [(0.0, 0.0), (1.0, 1e-11), (2.0, -1e-11), (3.0, 1e-6)] {
        let (x, y) = (k + off, k + 1.0);
        let corners = [v(x, off, 0.0), v(y, 0.0, 0.0), v(y, 1.0, 0.0), v(x, 1.0 + off, 0.0)];
        builder.face(&[Patch::quad(corners).unwrap().unwrap()]).unwrap();
    }
    assert_eq!(builder.build().welded(Weld::Everywhere).vertices.len(), 10 + 2);
}

#[test]
fn figures_of_a_box() {
    let quality = Quality::of(&mesh(&cuboid(), &whole())).unwrap();
    assert_eq!((quality.surfaces, quality.faces, quality.leaves, quality.occluders), (1, 6, 6, 6));
    let expected = [
        (quality.total_area, 22.0),
        (quality.smallest_area, 2.0),
        (quality.mean_area, 22.0 / 6.0),
        (quality.largest_area, 6.0),
        // The side of 1 × 3: 3 · 8 / (4 · 3).
        (quality.worst_aspect_ratio, 2.0),
        (quality.smallest_angle_degrees, 90.0),
        (quality.shortest_edge, 1.0),
        (quality.bounds.diagonal(), 14.0_f64.sqrt()),
    ];
    for (found, expected) in expected {
        assert_close(found, expected, 1e-13);
    }
    assert_eq!(quality.bounds.centre(), v(0.5, 1.0, 1.5));
    assert_eq!(Quality::of(&Mesh::default()), None);
}

#[test]
fn figures_of_an_equilateral_triangle() {
    let corners = [Vec3::ZERO, Vec3::X, v(0.5, 0.75_f64.sqrt(), 0.0)];
    let quality = Quality::of(&mesh(&Shape::Triangle { corners }, &counts(4, 4))).unwrap();
    assert_close(quality.worst_aspect_ratio, 1.0, 1e-13);
    assert_close(quality.smallest_angle_degrees, 60.0, 1e-12);
    assert_close(quality.shortest_edge, 0.25, 1e-15);
}
