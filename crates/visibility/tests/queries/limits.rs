//! Nothing in the scene, nothing in the query, too much of either.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::{Occluders, VisibilityError};

use crate::scenes::{Random, cuboid, furnished, triangle};

#[test]
fn an_empty_scene_hides_nothing() {
    let empty = Occluders::new(&[]).unwrap();
    assert!(empty.is_empty());
    assert!(empty.unoccluded(Vec3::ZERO, Vec3::ONE));
    assert!(empty.unoccluded(Vec3::ZERO, Vec3::splat(1e9)));
    assert_eq!(empty.closest(Vec3::ZERO, Vec3::X, f64::INFINITY), None);
    let sides = cuboid(Vec3::ZERO, Vec3::ONE, 0.0, true);
    let mut candidates = vec![7];
    empty.shaft(&sides[0], &sides[1], &mut candidates);
    assert_eq!(candidates, []);
}

#[test]
fn ends_that_are_no_places_meet_nothing() {
    let occluders = Occluders::new(&furnished()).unwrap();
    let inside = Vec3::new(0.0, 0.0, 0.5);
    for odd in [Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f64::NAN, 0.0), Vec3::splat(1e300)] {
        assert!(occluders.unoccluded(inside, odd));
        assert!(occluders.unoccluded(odd, inside));
        assert!(occluders.unoccluded_by(odd, inside, &[0, 1, 2]));
        assert_eq!(occluders.closest(odd, Vec3::X, 1.0), None);
    }
    assert!(occluders.unoccluded(inside, inside));
    assert!(occluders.unoccluded_by(inside, 9.0 * Vec3::X, &[1_000_000]));
}

#[test]
fn ends_beyond_all_measure_name_no_facet_that_is_not_there() {
    let occluders = Occluders::new(&[triangle([Vec3::ZERO, Vec3::X, Vec3::Y])]).unwrap();
    for far in [3e35, 3e36, 1e37] {
        let (p, q) = (Vec3::new(0.9, 0.9, -far), Vec3::new(0.9, 0.9, 1.0));
        assert!(occluders.unoccluded(p, q));
        assert_eq!(occluders.closest(q, p - q, 1.0), None);
    }
}

#[test]
fn distant_ends_meet_the_scene() {
    let occluders = Occluders::new(&cuboid(Vec3::ZERO, Vec3::ONE, 0.3, false)).unwrap();
    let mut random = Random(21);
    for distance in [10.0, 1e3, 1e6] {
        for _ in 0..2_000 {
            let direction = random.cube().normalize();
            let centre = random.cube() * 0.4;
            let (p, q) = (centre + direction * distance, centre - direction * distance);
            assert!(!occluders.unoccluded(p, q), "through the box from {distance} m");
            assert!(!occluders.unoccluded(p, centre), "into the box from {distance} m");
            let aside = direction.any_orthonormal_vector() * 3.0;
            assert!(occluders.unoccluded(p + aside, q + aside), "past the box from {distance} m");
        }
    }
}

#[test]
fn scenes_out_of_range_are_refused() {
    let long = Patch::triangle([Vec3::ZERO, Vec3::X * 1e60, Vec3::Y * 1e60]).unwrap();
    let short = Patch::triangle([Vec3::ZERO, Vec3::X * 1e-60, Vec3::Y * 1e-60]).unwrap();
    for patch in [long, short] {
        let error = Occluders::new(&[patch]).unwrap_err();
        assert!(matches!(error, VisibilityError::Span { .. }));
        assert!(error.to_string().contains("scale the scene"), "{error}");
    }
}

#[test]
fn thousands_of_coincident_patches() {
    let patch = triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
    let occluders = Occluders::new(&vec![patch; 5_000]).unwrap();
    assert_eq!(occluders.len(), 5_000);
    let (above, below) = (Vec3::new(0.2, 0.2, 1.0), Vec3::new(0.2, 0.2, -1.0));
    assert!(!occluders.unoccluded(above, below));
    assert!(occluders.unoccluded(above + Vec3::X, below + Vec3::X));
    assert_eq!(occluders.closest(above, -Vec3::Z, 9.0).map(|hit| hit.patch), Some(0));
}
