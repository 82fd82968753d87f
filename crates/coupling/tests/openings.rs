//! Small things seen through openings: both orders of integration find them.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;

use common::{patch, v};
use fredholm_coupling::form_factor::{PairIntegrator, Workspace};
use fredholm_coupling::sky;
use fredholm_mesh::{Bounds, Patch};
use fredholm_visibility::Occluders;

/// A unit cube without its ceiling, one patch a wall, seen from inside.
fn court() -> Vec<Patch> {
    [
        [v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)],
        [v(0., 0., 0.), v(0., 1., 0.), v(0., 1., 1.), v(0., 0., 1.)],
        [v(1., 0., 0.), v(1., 0., 1.), v(1., 1., 1.), v(1., 1., 0.)],
        [v(0., 0., 0.), v(0., 0., 1.), v(1., 0., 1.), v(1., 0., 0.)],
        [v(0., 1., 0.), v(1., 1., 0.), v(1., 1., 1.), v(0., 1., 1.)],
    ]
    .map(|corners| patch(&corners))
    .to_vec()
}

#[test]
fn a_wall_and_the_sky_exchange_the_same_in_either_order() {
    let walls = court();
    let bounds = Bounds { min: v(0., 0., 0.), max: v(1., 1., 1.) };
    let all: Vec<Patch> = walls.iter().copied().chain(sky(bounds).unwrap()).collect();
    let occluders = Occluders::new(&walls).unwrap();
    for tolerance in [1e-3, 1e-6] {
        let integrator = PairIntegrator::new(&all, &occluders, tolerance);
        let mut work = Workspace::default();
        for (i, k) in (0..5).flat_map(|i| (5..11).map(move |k| (i, k))) {
            let there = integrator.exchange_from(i, k, &mut work);
            for other in [integrator.exchange_from(k, i, &mut work), integrator.exchange(i, k, &mut work)] {
                let off = (there.value - other.value).abs();
                assert!(
                    off <= there.error + other.error + 1e-15,
                    "{tolerance:e} {i} {k}: {there:?} {other:?}"
                );
            }
        }
        for (i, wall) in walls.iter().enumerate() {
            let sum: f64 = (5..11).map(|k| integrator.exchange(i, k, &mut work).value).sum();
            let exact = if wall.normal().z > 0.5 { 0.199_824_895_698_387_5 } else { 0.200_043_776_075_403_1 };
            assert!((sum - exact).abs() < 6.0 * tolerance, "{tolerance:e} {i}: {sum}");
        }
    }
}
