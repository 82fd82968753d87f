//! Polygons with holes: areas against the shoelace formula, borders, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use std::f64::consts::{PI, TAU};

use common::{area, assert_close, assert_near, border_edges, counts, mesh, v, whole};
use fredholm_mesh::{Cutting, Lines, MeshError, Ring, Shape, Vec3};

fn flat(points: &[[f64; 2]]) -> Vec<Vec3> {
    points.iter().map(|&[x, y]| v(x, y, 0.0)).collect()
}

fn square(x: f64, y: f64, side: f64) -> Vec<Vec3> {
    flat(&[[x, y], [x + side, y], [x + side, y + side], [x, y + side]])
}

fn plain(points: &[[f64; 2]]) -> Shape {
    Shape::Polygon { outline: flat(points), holes: vec![] }
}

fn holed(holes: Vec<Vec<Vec3>>) -> Shape {
    Shape::Polygon { outline: square(0.0, 0.0, 4.0), holes }
}

fn refusal(shape: &Shape) -> MeshError {
    shape.count(&whole()).unwrap_err()
}

#[test]
fn an_l_shape_has_its_area_and_centroid() {
    let l = plain(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
    let mesh = mesh(&l, &whole());
    assert_eq!((mesh.faces().len(), mesh.len(), mesh.occluders().len()), (1, 4, 4));
    assert_close(mesh.faces()[0].area, 4.0, 1e-14);
    assert_near(mesh.faces()[0].centroid, v(1.25, 0.75, 0.0), 1e-14);
    assert!(mesh.patches().all(|patch| patch.normal() == Vec3::Z));
    assert_eq!(border_edges(&mesh), 6);
}

#[test]
fn the_order_of_the_outline_decides_the_lit_side_and_that_of_holes_does_not() {
    for (outline_reversed, normal) in [(false, Vec3::Z), (true, Vec3::NEG_Z)] {
        for hole_reversed in [false, true] {
            let (mut outline, mut hole) = (square(0.0, 0.0, 4.0), square(1.0, 1.0, 1.0));
            if outline_reversed {
                outline.reverse();
            }
            if hole_reversed {
                hole.reverse();
            }
            let mesh = mesh(&Shape::Polygon { outline, holes: vec![hole] }, &whole());
            assert_close(area(&mesh), 15.0, 1e-13);
            assert!(mesh.patches().all(|patch| patch.normal().distance(normal) < 1e-15));
        }
    }
}

#[test]
fn two_holes_are_left_open() {
    let triangle = flat(&[[2.2, 0.5], [3.5, 0.5], [2.2, 2.5]]);
    let shape = holed(vec![square(0.5, 0.5, 1.5), triangle]);
    let mesh = mesh(&shape, &Cutting { elements_per_side: 2, ..counts(3, 3) });
    assert_close(area(&mesh), 16.0 - 2.25 - 1.3, 1e-12);
    // Eleven corners and two holes: 11 + 2 · 2 − 2 triangles, cut into 9 faces of 4 elements.
    assert_eq!((mesh.occluders().len(), mesh.faces().len(), mesh.len()), (13, 13 * 9, 13 * 36));
    assert_eq!(border_edges(&mesh), 11 * 6);
    let centroid = mesh.patches().map(|p| p.centroid() * p.area()).sum::<Vec3>() / area(&mesh);
    let moment = v(32.0, 32.0, 0.0) - v(1.25, 1.25, 0.0) * 2.25 - v(7.9 / 3.0, 3.5 / 3.0, 0.0) * 1.3;
    assert_near(centroid, moment / 12.45, 1e-13);
}

#[test]
fn a_polygon_anywhere_in_space_keeps_its_area() {
    let [x, y] = [v(0.6, 0.0, 0.8), v(-0.64, 0.6, 0.48)];
    let place = |p: &Vec3| v(100.0, -50.0, 20.0) + x * p.x + y * p.y;
    let outline = square(0.0, 0.0, 4.0).iter().map(place).collect();
    let holes = vec![square(1.0, 1.0, 2.0).iter().map(place).collect()];
    let mesh = mesh(&Shape::Polygon { outline, holes }, &counts(4, 4));
    assert_close(area(&mesh), 12.0, 1e-11);
    assert!(mesh.patches().all(|patch| patch.normal().distance(x.cross(y)) < 1e-11));
    assert_eq!(border_edges(&mesh), 8 * 4);
}

#[test]
fn a_ring_of_many_corners_tends_to_the_annulus() {
    let circle = |radius: f64, n: u32| -> Vec<Vec3> {
        (0..n).map(|k| TAU * f64::from(k) / f64::from(n)).map(|t| v(t.cos(), t.sin(), 0.0) * radius).collect()
    };
    let n = 500;
    let shape = Shape::Polygon { outline: circle(2.0, n), holes: vec![circle(1.0, n)] };
    let exact = 0.5 * f64::from(n) * (TAU / f64::from(n)).sin() * 3.0;
    assert_close(area(&mesh(&shape, &whole())), exact, 1e-12);
    assert_close(exact, 3.0 * PI, 1e-3);
}

#[test]
fn repeated_and_straight_corners_do_no_harm() {
    let closed = plain(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [0.0, 0.0]]);
    let mesh = mesh(&closed, &whole());
    assert_close(area(&mesh), 2.0, 1e-15);
    assert_eq!((mesh.len(), border_edges(&mesh)), (3, 5));
}

#[test]
fn largest_edge_cuts_all_triangles_alike() {
    let shape = holed(vec![square(1.0, 1.0, 1.0)]);
    let mesh = mesh(&shape, &Cutting { lines: Lines::LargestEdge(0.5), ..whole() });
    assert_close(area(&mesh), 15.0, 1e-12);
    let longest = mesh.patches().flat_map(|p| (0..3).map(|i| p.corner(i).distance(p.corner(i + 1))));
    assert!(longest.fold(0.0, f64::max) <= 0.5 * (1.0 + 1e-9));
    assert_eq!(border_edges(&mesh) % 8, 0);
}

#[test]
fn borders_that_touch_or_cross_are_refused() {
    let crossing = |hole| MeshError::Crossing { first: Ring::Outline, second: Ring::Hole(hole) };
    // A hole that shares a part of a side, a corner on a side, a corner with a corner; one that
    // sticks out.
    assert_eq!(refusal(&holed(vec![square(1.0, 0.0, 1.0)])), crossing(0));
    assert_eq!(refusal(&holed(vec![flat(&[[2.0, 0.0], [3.0, 1.0], [1.0, 1.0]])])), crossing(0));
    assert_eq!(refusal(&holed(vec![square(0.0, 0.0, 1.0)])), crossing(0));
    assert_eq!(refusal(&holed(vec![square(1.0, 1.0, 1.0), square(3.5, 1.0, 1.0)])), crossing(1));
    let both = holed(vec![square(1.0, 1.0, 1.0), square(1.5, 1.5, 1.0)]);
    assert_eq!(refusal(&both), MeshError::Crossing { first: Ring::Hole(0), second: Ring::Hole(1) });
    let whole_outline = holed(vec![square(0.0, 0.0, 4.0)]);
    assert_eq!(refusal(&whole_outline), crossing(0));
}

#[test]
fn borders_that_cross_themselves_are_refused() {
    let at = |first, second| MeshError::SelfIntersecting { ring: Ring::Outline, first, second };
    let bow_tie = plain(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(refusal(&bow_tie), at(0, 2));
    let spike = plain(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [4.0, 6.0], [4.0, 4.0], [0.0, 4.0]]);
    assert!(matches!(refusal(&spike), MeshError::SelfIntersecting { ring: Ring::Outline, .. }));
    let pinched = plain(&[[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]]);
    assert!(matches!(refusal(&pinched), MeshError::SelfIntersecting { ring: Ring::Outline, .. }));
    for order in [[1.0, 2.0, 3.0], [1.0, 3.0, 2.0], [2.0, 1.0, 3.0], [3.0, 2.0, 1.0]] {
        let line = order.map(|x| v(x, 1.0, 0.0)).to_vec();
        let error = refusal(&holed(vec![line]));
        assert!(matches!(error, MeshError::SelfIntersecting { ring: Ring::Hole(0), .. }));
    }
}

#[test]
fn misplaced_holes_are_refused() {
    assert_eq!(refusal(&holed(vec![square(5.0, 5.0, 1.0)])), MeshError::HoleOutside { hole: 0 });
    assert_eq!(refusal(&holed(vec![square(-1.0, -1.0, 9.0)])), MeshError::HoleOutside { hole: 0 });
    let nested = holed(vec![square(2.0, 2.0, 0.5), square(1.0, 1.0, 2.0)]);
    assert_eq!(refusal(&nested), MeshError::HoleInHole { hole: 0, other: 1 });
}

#[test]
fn outlines_that_make_no_sense_are_refused() {
    let outline = |ring| MeshError::TooFewCorners { ring };
    assert_eq!(refusal(&plain(&[])), outline(Ring::Outline));
    assert!(matches!(refusal(&plain(&[[0.0, 0.0], [1.0, 1.0]])), MeshError::NoArea { .. }));
    assert!(matches!(refusal(&plain(&[[1.0, 1.0]; 5])), MeshError::NoArea { .. }));
    assert!(matches!(refusal(&plain(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]])), MeshError::NoArea { .. }));
    assert_eq!(refusal(&holed(vec![vec![]])), outline(Ring::Hole(0)));
    assert_eq!(refusal(&holed(vec![vec![v(1.0, 1.0, 0.0); 4]])), outline(Ring::Hole(0)));
    assert_eq!(
        refusal(&plain(&[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]])),
        MeshError::NotFinite { corner: 2 }
    );
    let infinite = holed(vec![vec![v(1.0, f64::INFINITY, 0.0); 3]]);
    assert_eq!(refusal(&infinite), MeshError::NotFinite { corner: 4 });
    let bent = Shape::Polygon {
        outline: vec![v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(1.0, 1.0, 0.5), v(0.0, 1.0, 0.0)],
        holes: vec![],
    };
    assert!(matches!(refusal(&bent), MeshError::NotPlanar { ring: Ring::Outline, .. }));
    let floating = holed(vec![square(1.0, 1.0, 1.0).iter().map(|p| *p + Vec3::Z).collect()]);
    assert!(matches!(refusal(&floating), MeshError::NotPlanar { ring: Ring::Hole(0), corner: 0, .. }));
}
