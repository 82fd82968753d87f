//! Trees over meshes: every element once, parents before children, areas that add up.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

use fredholm_hierarchical::{HierarchyError, Tree};
use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Shape, Vec3};

fn mesh(shape: &Shape, lines: Lines) -> Mesh {
    let mut builder = MeshBuilder::default();
    builder.surface("it", 0);
    builder.add(shape, &Cutting { lines, ..Cutting::default() }).unwrap();
    builder.build()
}

fn scenes() -> Vec<Mesh> {
    let room = Shape::Box { min: Vec3::ZERO, max: Vec3::new(2.0, 1.0, 3.0), inward: true };
    let sphere = Shape::Sphere { centre: Vec3::ONE, radius: 0.7, segments: 20, inward: false };
    vec![mesh(&room, Lines::Counts { u: 5, v: 3 }), mesh(&sphere, Lines::Whole)]
}

#[test]
fn every_element_is_in_the_tree_once() {
    for mesh in scenes() {
        let tree = Tree::new(&mesh, 1e-9).unwrap();
        let mut leaves = tree.leaves();
        assert_eq!(leaves, tree.roots());
        leaves.sort_unstable();
        leaves.dedup();
        assert_eq!(leaves.len(), mesh.len());
        for (root, &node) in tree.roots().iter().enumerate() {
            let node = &tree.nodes()[node as usize];
            assert_eq!((node.root(), node.face()), (Some(root), Some(mesh.face_of(root))));
            assert_eq!(node.patch().unwrap(), mesh.patch(root));
        }
    }
}

#[test]
fn children_come_later_and_fill_their_parent() {
    for mesh in scenes() {
        let mut tree = Tree::new(&mesh, 1e-9).unwrap();
        for leaf in tree.leaves().into_iter().step_by(3) {
            tree.split(leaf).unwrap();
        }
        for (index, node) in tree.nodes().iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
            let area: f64 = node.children().iter().map(|&child| tree.nodes()[child as usize].area()).sum();
            assert!((area / node.area() - 1.0).abs() < 1e-12);
            for &child in node.children() {
                assert!(child as usize > index);
                assert_eq!(tree.nodes()[child as usize].parent(), Some(index as u32));
            }
            if let Some(patch) = node.patch() {
                assert!((patch.area() / node.area() - 1.0).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn the_walls_of_a_room_are_whole_rectangles() {
    let [room, _] = scenes().try_into().unwrap();
    let tree = Tree::new(&room, 1e-9).unwrap();
    let walls: Vec<f64> = [2.0, 2.0, 3.0, 3.0, 6.0, 6.0].into();
    let top = |node: &&fredholm_hierarchical::Node| {
        node.patch().is_some() && node.parent().is_none_or(|p| tree.nodes()[p as usize].patch().is_none())
    };
    let mut found: Vec<f64> =
        tree.nodes().iter().filter(top).map(fredholm_hierarchical::Node::area).collect();
    found.sort_by(f64::total_cmp);
    assert_eq!(found.len(), 6, "{found:?}");
    assert!(found.iter().zip(walls).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
}

#[test]
fn a_mesh_of_nothing_is_refused() {
    assert!(matches!(Tree::new(&Mesh::default(), 1e-9), Err(HierarchyError::Empty)));
}
