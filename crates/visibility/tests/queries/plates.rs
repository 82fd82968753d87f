//! Ends on surfaces: what a patch that contains an end does, and what it does not.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

use crate::scenes::{cuboid, quad};

fn square(z: f64) -> Patch {
    quad([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z)))
}

/// A plate without thickness: two coincident squares of opposite order.
fn plate() -> Occluders {
    Occluders::new(&[square(0.0), square(0.0).flipped()]).unwrap()
}

#[test]
fn a_plate_hides_what_is_behind_it_from_both_sides() {
    let (above, below) = (Vec3::new(0.1, 0.2, 1.0), Vec3::new(-0.3, 0.1, -1.0));
    assert!(!plate().unoccluded(above, below));
    assert!(!plate().unoccluded(below, above));
    assert!(plate().unoccluded(above + 3.0 * Vec3::X, below + 3.0 * Vec3::X));
}

#[test]
fn a_segment_that_ends_on_a_plate_is_free_on_either_side() {
    let on = Vec3::new(0.25, -0.5, 0.0);
    for away in [Vec3::new(0.3, 0.2, 1.0), Vec3::new(0.3, 0.2, -1.0), Vec3::new(5.0, 0.0, 0.01)] {
        assert!(plate().unoccluded(on, on + away));
        assert!(plate().unoccluded(on + away, on));
    }
}

#[test]
fn an_end_within_the_tolerance_is_on_the_plate_and_one_beyond_is_not() {
    let plate = plate();
    let tolerance = plate.tolerance();
    assert!((2.0e-9..2.1e-9).contains(&tolerance));
    let above = Vec3::new(0.0, 0.3, 1.0);
    assert!(plate.unoccluded(above, Vec3::new(0.0, 0.0, -0.9 * tolerance)));
    assert!(!plate.unoccluded(above, Vec3::new(0.0, 0.0, -1.1 * tolerance)));
}

#[test]
fn a_segment_in_the_plane_of_a_plate_is_free() {
    assert!(plate().unoccluded(Vec3::new(-3.0, 0.1, 0.0), Vec3::new(3.0, 0.2, 0.0)));
}

#[test]
fn another_plate_between_is_not_forgiven() {
    let stack = Occluders::new(&[square(0.0), square(0.0).flipped(), square(1e-6)]).unwrap();
    let (on, above) = (Vec3::new(0.2, 0.1, 0.0), Vec3::new(0.2, 0.3, 1.0));
    assert!(!stack.unoccluded(on, above));
    assert!(stack.unoccluded(on, Vec3::new(0.2, 0.3, -1.0)));
}

#[test]
fn an_end_on_a_shared_edge_is_free_inside_and_blocked_across() {
    let occluders = Occluders::new(&cuboid(Vec3::ZERO, Vec3::ONE, 0.0, false)).unwrap();
    let edge = Vec3::new(1.0, 1.0, 0.3);
    assert!(occluders.unoccluded(edge, Vec3::new(3.0, 2.0, 0.0)));
    assert!(occluders.unoccluded(edge, Vec3::new(0.0, 3.0, 0.0)));
    assert!(!occluders.unoccluded(edge, Vec3::new(-3.0, 0.0, 0.0)));
    // The inside of the box: both sides that share the edge contain the end.
    assert!(occluders.unoccluded(edge, Vec3::new(0.2, 0.1, 0.0)));
}
