//! The first hit of a ray, compared with every patch tested one by one.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

use crate::scenes::{Random, cuboid, furnished, sphere, triangle, triangulated};

/// Where the ray meets the triangle, by Cramer's rule for o + t d = a + u b + v c
/// (T. Möller, B. Trumbore, doi:10.1080/10867651.1997.10487468).
fn meets(o: Vec3, d: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let (b, c, s) = (b - a, c - a, o - a);
    let det = b.dot(d.cross(c));
    let (u, v, t) = (s.dot(d.cross(c)) / det, d.dot(s.cross(b)) / det, c.dot(s.cross(b)) / det);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// The least t at which a patch is met.
fn first(patches: &[Patch], o: Vec3, d: Vec3) -> Option<f64> {
    let met = |piece: &Patch| meets(o, d, [0, 1, 2].map(|k| piece.corner(k)));
    triangulated(patches).iter().filter_map(met).min_by(f64::total_cmp)
}

#[test]
fn agrees_with_every_patch_tested_alone() {
    let mut spheres = furnished();
    spheres.extend(sphere(2).iter().map(|t| triangle(t.map(|p| p * 0.3))));
    for patches in [furnished(), triangulated(&furnished()), spheres] {
        let occluders = Occluders::new(&patches).unwrap();
        let mut random = Random(1);
        let mut hits = 0;
        for k in 0..4_000 {
            let o = random.cube() * if k % 2 == 0 { 0.99 } else { 4.0 };
            let d = random.cube() - if k % 2 == 0 { Vec3::ZERO } else { o };
            let expected = first(&patches, o, d);
            let found = occluders.closest(o, d, f64::INFINITY);
            assert_eq!(found.is_some(), expected.is_some(), "from {o} along {d}");
            if let (Some(hit), Some(t)) = (found, expected) {
                // A box stands on the floor, so either may be named; what is named must be where
                // the hit is.
                let named = first(&patches[hit.patch..=hit.patch], o, d).unwrap();
                assert!(
                    (hit.t - t).abs() <= 1e-9 && (named - t).abs() <= 1e-9,
                    "{} and {named} for {t}",
                    hit.t
                );
                assert!(hit.point.distance(o + d * t) <= 1e-9);
                hits += 1;
            }
        }
        assert!(hits > 3_000, "{hits}");
    }
}

#[test]
fn agrees_with_segments() {
    let patches = triangulated(&furnished());
    let occluders = Occluders::new(&patches).unwrap();
    let mut random = Random(2);
    for _ in 0..20_000 {
        let (p, q) = (random.cube() * 1.5, random.cube() * 1.5);
        assert_eq!(occluders.closest(p, q - p, 1.0).is_none(), occluders.unoccluded(p, q), "from {p} to {q}");
    }
}

#[test]
fn a_bounded_ray_stops_before_its_end() {
    let occluders = Occluders::new(&cuboid(Vec3::ZERO, Vec3::ONE, 0.0, true)).unwrap();
    assert_eq!(occluders.closest(Vec3::ZERO, Vec3::X, 0.999), None);
    let hit = occluders.closest(Vec3::ZERO, Vec3::X, 1.001).unwrap();
    assert!((hit.t - 1.0).abs() < 1e-12 && hit.point.distance(Vec3::X) < 1e-12);
    assert!((occluders.closest(Vec3::ZERO, 4.0 * Vec3::X, 1.0).unwrap().t - 0.25).abs() < 1e-12);
    for t_max in [0.0, -5.0, f64::NAN] {
        assert_eq!(occluders.closest(Vec3::ZERO, Vec3::X, t_max), None);
    }
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(occluders.closest(Vec3::ZERO, direction, f64::INFINITY), None);
    }
}

#[test]
fn a_ray_may_start_on_a_surface() {
    let sides = cuboid(Vec3::ZERO, Vec3::ONE, 0.4, true);
    let occluders = Occluders::new(&sides).unwrap();
    for side in &sides {
        let hit = occluders.closest(side.centroid(), side.normal(), f64::INFINITY).unwrap();
        assert!((hit.t - 2.0).abs() < 1e-9);
    }
}

#[test]
fn of_two_faces_of_a_plate_the_lit_one_is_seen() {
    let front = triangle([Vec3::ZERO, Vec3::new(1.0, 0.1, 0.3), Vec3::new(0.2, 1.0, -0.2)]);
    let turned = triangle([front.corner(1), front.corner(2), front.corner(0)]);
    let inner = front.centroid();
    for (patches, seen) in [
        (vec![front.flipped(), turned], [1, 0]),
        (vec![front, front.flipped()], [0, 1]),
        (vec![turned, front], [0, 0]),
    ] {
        let occluders = Occluders::new(&patches).unwrap();
        for (sign, patch) in [(1.0, seen[0]), (-1.0, seen[1])] {
            let from = inner + front.normal() * sign + Vec3::new(0.1, 0.2, 0.0);
            let hit = occluders.closest(from, inner - from, f64::INFINITY).unwrap();
            assert_eq!(hit.patch, patch);
            assert!((hit.t - 1.0).abs() < 1e-9);
        }
    }
}
