//! The predicted number of elements is the true one, and hopeless requests are refused before
//! memory is taken.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{counts, mesh, v, whole};
use fredholm_mesh::{Cutting, Lines, MeshBuilder, MeshError, Ring, Shape, Vec3};

fn square() -> [Vec3; 4] {
    [Vec3::ZERO, Vec3::X, v(1.0, 1.0, 0.0), Vec3::Y]
}

fn quad(corners: [Vec3; 4]) -> Shape {
    Shape::Quad { corners, skip: vec![] }
}

fn shapes() -> Vec<Shape> {
    let outline =
        vec![v(0.0, 0.0, 0.0), v(3.0, 0.0, 0.0), v(3.0, 1.0, 0.0), v(1.0, 1.0, 0.0), v(1.0, 2.0, 0.0)];
    let hole = vec![v(0.5, 0.2, 0.0), v(0.8, 0.2, 0.0), v(0.8, 0.4, 0.0)];
    let cylinder = |caps, segments| Shape::Cylinder {
        base: Vec3::ZERO,
        axis: v(0.0, 1.0, 2.0),
        radius: 0.5,
        caps,
        inward: false,
        segments,
    };
    let mut shapes = vec![
        quad(square()),
        quad([Vec3::ZERO, Vec3::X, v(1.0, 1.0, 0.7), Vec3::Y]),
        Shape::Triangle { corners: [Vec3::X, Vec3::Y, Vec3::Z] },
        Shape::Polygon { outline: outline.clone(), holes: vec![] },
        Shape::Polygon { outline, holes: vec![hole] },
        Shape::Box { min: Vec3::ZERO, max: v(1.0, 2.0, 3.0), inward: true },
    ];
    for segments in [3, 5, 11, 12, 13, 24, 31] {
        shapes.push(Shape::Sphere { centre: Vec3::ZERO, radius: 1.0, inward: false, segments });
        shapes.push(Shape::Disc { centre: Vec3::ZERO, normal: Vec3::Z, radius: 1.0, segments });
        shapes.extend([cylinder(false, segments), cylinder(true, segments)]);
    }
    shapes
}

fn cuttings() -> Vec<Cutting> {
    let lines =
        [Lines::Whole, Lines::Counts { u: 3, v: 3 }, Lines::LargestEdge(0.35), Lines::LargestEdge(1.0)];
    let with = |lines: Lines, n| Cutting { lines, elements_per_side: n, flipped: n == 2 };
    lines.into_iter().flat_map(|lines| [1, 2].map(|n| with(lines.clone(), n))).collect()
}

#[test]
fn the_count_is_what_is_made() {
    let mut compared = 0;
    for shape in shapes() {
        for cutting in cuttings() {
            let expected = shape.count(&cutting).unwrap();
            assert_eq!(mesh(&shape, &cutting).len() as u128, expected, "{shape:?} {cutting:?}");
            compared += 1;
        }
    }
    assert_eq!(compared, 34 * 8);
}

#[test]
fn skipped_cells_are_not_counted() {
    let shape = Shape::Quad { corners: square(), skip: vec![[0, 1], [2, 2], [0, 1]] };
    let cutting = Cutting { elements_per_side: 2, ..counts(3, 3) };
    assert_eq!(shape.count(&cutting), Ok(7 * 4));
    assert_eq!(mesh(&shape, &cutting).len(), 28);
}

#[test]
fn huge_counts_are_exact_and_refused() {
    let shape = quad(square());
    let million = Cutting { elements_per_side: 1000, ..counts(1000, 1_000_000) };
    assert_eq!(shape.count(&million), Ok(10_u128.pow(15)));
    let sphere = Shape::Sphere { centre: Vec3::ZERO, radius: 1.0, inward: false, segments: 500 };
    assert_eq!(sphere.count(&Cutting { elements_per_side: 100_000, ..whole() }), Ok(20 * 10_u128.pow(14)));

    let mut builder = MeshBuilder::default();
    builder.surface("quad", 0);
    for cutting in [million, counts(usize::MAX, usize::MAX), counts(65536, 65536)] {
        assert!(matches!(builder.add(&shape, &cutting), Err(MeshError::TooLarge { .. })));
    }
    let beyond = Cutting { elements_per_side: 2, ..counts(usize::MAX, usize::MAX) };
    assert!(matches!(shape.count(&beyond), Err(MeshError::TooLarge { .. })));
    assert!(builder.build().is_empty());
}

#[test]
fn an_error_on_the_way_leaves_nothing_behind() {
    // At 1e15 m coordinates are an eighth of a metre apart: the cells of this square have no area.
    let far = square().map(|corner| corner + Vec3::splat(1e15));
    let mut builder = MeshBuilder::default();
    builder.surface("far", 0);
    builder.add(&quad(square()), &counts(2, 2)).unwrap();
    assert!(matches!(builder.add(&quad(far), &counts(100, 100)), Err(MeshError::NoArea { .. })));
    let mesh = builder.build();
    assert_eq!((mesh.len(), mesh.faces().len(), mesh.elements().len(), mesh.occluders().len()), (4, 4, 4, 1));
}

fn refusal(shape: &Shape, cutting: &Cutting) -> MeshError {
    let error = shape.count(cutting).unwrap_err();
    let mut builder = MeshBuilder::default();
    builder.surface("bad", 0);
    assert_eq!(builder.add(shape, cutting), Err(error.clone()));
    assert!(!error.to_string().is_empty());
    error
}

#[test]
fn quads_that_make_no_sense_are_refused() {
    let [a, b, c, d] = square();
    let refused = |corners| refusal(&quad(corners), &whole());
    assert_eq!(refused([a, c, b, d]), MeshError::BowTie);
    assert_eq!(refused([a, b, d, c]), MeshError::BowTie);
    assert_eq!(refused([a, v(3.0, 3.0, 0.0), b, d]), MeshError::BowTie);
    assert_eq!(refused([a, b, b, c]), MeshError::RepeatedCorner { first: 1, second: 2 });
    assert_eq!(refused([a, b, a, c]), MeshError::RepeatedCorner { first: 0, second: 2 });
    assert_eq!(refused([a, b, v(f64::NAN, 0.0, 0.0), c]), MeshError::NotFinite { corner: 2 });
    assert_eq!(refused([a, b, c, v(0.0, f64::INFINITY, 0.0)]), MeshError::NotFinite { corner: 3 });
    assert!(matches!(refused([a, b, b * 2.0, b * 3.0]), MeshError::NoArea { .. }));
    let dart = quad([a, b, v(0.2, 0.2, 0.0), d]);
    assert_eq!(refusal(&dart, &counts(2, 2)), MeshError::NotConvex { corner: 2 });
    assert_eq!(dart.count(&whole()), Ok(2));
}

#[test]
fn cells_and_counts_that_make_no_sense_are_refused() {
    let holed = |skip: Vec<[usize; 2]>| Shape::Quad { corners: square(), skip };
    assert_eq!(
        refusal(&holed(vec![[2, 0]]), &counts(2, 2)),
        MeshError::NoSuchCell { i: 2, j: 0, u: 2, v: 2 }
    );
    assert_eq!(refusal(&holed(vec![[0, 0]]), &whole()), MeshError::NothingLeft);
    assert!(matches!(refusal(&holed(vec![]), &counts(0, 2)), MeshError::NoPieces { .. }));
    let none = Cutting { elements_per_side: 0, ..whole() };
    assert!(matches!(refusal(&holed(vec![]), &none), MeshError::NoPieces { .. }));
    let triangle = Shape::Triangle { corners: [Vec3::X, Vec3::Y, Vec3::Z] };
    assert_eq!(refusal(&triangle, &counts(2, 3)), MeshError::UnequalCounts { u: 2, v: 3 });
    let explicit = Lines::Explicit { u: vec![0.0, 1.0], v: vec![0.0, 1.0] };
    assert_eq!(refusal(&triangle, &Cutting { lines: explicit, ..whole() }), MeshError::LinesOnTriangles);
    assert!(matches!(MeshBuilder::default().add(&triangle, &whole()), Err(MeshError::NoSurface)));
}

#[test]
fn curved_shapes_that_make_no_sense_are_refused() {
    let sphere = |radius, segments| Shape::Sphere { centre: Vec3::ZERO, radius, inward: false, segments };
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refusal_of(&sphere(radius, 8)), MeshError::Length { quantity: "the radius", .. }));
    }
    assert_eq!(refusal_of(&sphere(1.0, 2)), MeshError::TooFewSegments { segments: 2 });
    assert!(matches!(refusal_of(&sphere(1.0, usize::MAX)), MeshError::TooManySegments { .. }));
    let disc = |normal| Shape::Disc { centre: Vec3::ZERO, normal, radius: 1.0, segments: 8 };
    assert!(matches!(refusal_of(&disc(Vec3::ZERO)), MeshError::Length { .. }));
    assert!(matches!(refusal_of(&disc(v(f64::NAN, 0.0, 1.0))), MeshError::Length { .. }));
    let cylinder = Shape::Cylinder {
        base: Vec3::ZERO,
        axis: Vec3::ZERO,
        radius: 1.0,
        caps: true,
        inward: false,
        segments: 8,
    };
    assert!(matches!(refusal_of(&cylinder), MeshError::Length { .. }));
    let flat = Shape::Box { min: Vec3::ZERO, max: v(1.0, 0.0, 1.0), inward: false };
    assert!(matches!(refusal_of(&flat), MeshError::Length { quantity: "the box's extent along y", .. }));
    let centre = Shape::Sphere { centre: v(0.0, f64::NAN, 0.0), radius: 1.0, inward: false, segments: 8 };
    assert!(matches!(refusal_of(&centre), MeshError::NotFinite { .. }));
}

fn refusal_of(shape: &Shape) -> MeshError {
    shape.count(&whole()).unwrap_err()
}

#[test]
fn messages_name_borders() {
    assert_eq!(Ring::Outline.to_string(), "the outline");
    // Counted from 0 inside, from 1 in messages.
    assert_eq!(Ring::Hole(2).to_string(), "hole 3");
}
