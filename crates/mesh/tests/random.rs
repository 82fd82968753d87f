//! Subdivision of random shapes conserves what an independent formula gives.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use std::f64::consts::TAU;

use common::{area, area_vector, border_edges, counts, mesh, v, whole};
use fredholm_mesh::{Cutting, MeshError, Patch, Shape, Vec3};
use proptest::prelude::*;

fn point() -> impl Strategy<Value = Vec3> {
    [-10.0..10.0, -10.0..10.0, -10.0..10.0].prop_map(Vec3::from_array)
}

/// Two perpendicular unit vectors.
fn frame() -> impl Strategy<Value = [Vec3; 2]> {
    (point(), point()).prop_filter_map("nearly parallel", |(a, b)| {
        let (a, b) = (a.try_normalize()?, b.try_normalize()?);
        (a.cross(b).length() > 0.1).then(|| [a, (b - a * a.dot(b)).normalize()])
    })
}

fn shoelace(points: &[(f64, f64)]) -> f64 {
    let next = points.iter().cycle().skip(1);
    0.5 * points.iter().zip(next).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>()
}

/// Corners seen from the origin in the order of their angles: a simple polygon, rarely convex.
fn star(corners: usize) -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec((0.1..0.9, 0.2..1.0), corners).prop_map(move |polar| {
        let place = |(k, (share, radius)): (usize, &(f64, f64))| {
            let angle = TAU * (k as f64 + share) / polar.len() as f64;
            (radius * angle.cos(), radius * angle.sin())
        };
        polar.iter().enumerate().map(place).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Any surface spanned by a border has the area vector ½ Σ pᵢ × pᵢ₊₁.
    #[test]
    fn quads_keep_their_area_vector(
        corners in [point(), point(), point(), point()], u in 1..6_usize, w in 1..6_usize,
    ) {
        let cutting = Cutting { elements_per_side: 2, ..counts(u, w) };
        let shape = Shape::Quad { corners, skip: vec![] };
        match shape.count(&cutting) {
            Err(error) => prop_assert!(matches!(error, MeshError::BowTie | MeshError::NotConvex { .. }), "{}", error),
            Ok(count) => {
                let mesh = mesh(&shape, &cutting);
                prop_assert_eq!(mesh.len() as u128, count);
                let [a, b, c, d] = corners;
                let exact = 0.5 * (c - a).cross(d - b);
                prop_assert!(area_vector(&mesh).distance(exact) < 1e-9, "{} {}", area_vector(&mesh), exact);
                let blocked: f64 = mesh.occluders().iter().map(Patch::area).sum();
                prop_assert!((blocked - area(&mesh)).abs() < 1e-9);
                prop_assert_eq!(border_edges(&mesh), 4 * (u + w));
            }
        }
    }

    #[test]
    fn flat_quads_keep_their_area(points in star(4), [x, y] in frame(), origin in point(), n in 1..6_usize) {
        let corners = [0, 1, 2, 3].map(|i| origin + x * points[i].0 + y * points[i].1);
        let shape = Shape::Quad { corners, skip: vec![] };
        match shape.count(&counts(n, n)) {
            Err(MeshError::NotConvex { .. }) => prop_assert!(n > 1),
            Err(error) => prop_assert!(false, "{}", error),
            Ok(_) => prop_assert!((area(&mesh(&shape, &counts(n, n))) - shoelace(&points)).abs() < 1e-12),
        }
    }

    #[test]
    fn polygons_keep_their_area(
        points in (3..30_usize).prop_flat_map(star), hole in star(5),
        [x, y] in frame(), origin in point(), n in 1..4_usize,
    ) {
        let place = |scale: f64| move |&(a, b): &(f64, f64)| origin + (x * a + y * b) * scale;
        let outline: Vec<Vec3> = points.iter().map(place(1.0)).collect();
        let shape = |holes| Shape::Polygon { outline: outline.clone(), holes };
        let full = mesh(&shape(vec![]), &counts(n, n));
        prop_assert_eq!(full.len(), (points.len() - 2) * n * n);
        prop_assert!((area(&full) - shoelace(&points)).abs() < 1e-12);
        prop_assert!(full.patches().all(|patch| patch.normal().distance(x.cross(y)) < 1e-6));

        // With six corners or more the outline stays 0.1 away from the origin, and the hole fits.
        let opening: Vec<Vec3> = hole.iter().map(place(0.01)).collect();
        if points.len() >= 6 {
            let holed = mesh(&shape(vec![opening]), &whole());
            prop_assert!((area(&full) - area(&holed) - 1e-4 * shoelace(&hole)).abs() < 1e-12);
            prop_assert_eq!(border_edges(&holed), points.len() + hole.len());
        }
    }

    #[test]
    fn any_list_of_corners_is_meshed_or_refused(
        outline in prop::collection::vec([-2..3_i8, -2..3_i8], 0..9),
        hole in prop::collection::vec([-2..3_i8, -2..3_i8], 0..6),
    ) {
        let place = |points: &[[i8; 2]]| points.iter().map(|p| v(p[0].into(), p[1].into(), 0.0)).collect::<Vec<_>>();
        for holes in [vec![], vec![place(&hole)]] {
            let shape = Shape::Polygon { outline: place(&outline), holes };
            if let Ok(count) = shape.count(&whole()) {
                let mesh = mesh(&shape, &whole());
                prop_assert_eq!(mesh.len() as u128, count);
                prop_assert!(area(&mesh) > 0.0);
            }
        }
    }
}
