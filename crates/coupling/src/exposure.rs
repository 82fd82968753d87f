//! The exposed share w of every element: the part that sees a lit side or the open.
//!
//! A box that stands on a floor has no bottom, so the floor under it is a patch of which every ray
//! ends on the back of a side. Such a part is buried: it receives nothing and nothing sees it. w is
//! the share of points, on a grid over the element, of which at least one ray of a fixed bundle
//! meets a lit side or nothing at all. Dimensionless; the grid is refined where both kinds of point
//! occur.

use crate::pair_sample::scattered;
use crate::polygon::folded;
use crate::radiosity::Extent;
use crate::rays::Bundle;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use rayon::prelude::*;

/// Points along a side of the first grid, and of the one for elements that are partly buried.
const POINTS_ALONG_GRIDS: [usize; 2] = [8, 32];

/// Exposed shares in [0, 1] of the patches of a mesh; `lit` holds these patches, in order.
#[must_use]
pub fn exposed_shares(patches: &[&Patch], lit: &Occluders) -> Vec<f64> {
    patches.par_iter().map(|patch| share(patch, patches, lit)).collect()
}

/// Seconds that [`exposed_shares`] takes one thread, from patches in all parts of the mesh;
/// `budget` and `spent` as in [`assembly_seconds`](crate::assembly_seconds).
#[must_use]
pub fn exposure_seconds(patches: &[&Patch], lit: &Occluders, budget: f64, spent: &dyn Fn() -> f64) -> f64 {
    let started = spent();
    let mut done = 0;
    for patch in scattered(patches.len()).map(|at| patches[at]) {
        std::hint::black_box(share(patch, patches, lit));
        done += 1;
        if spent() - started > budget {
            break;
        }
    }
    if done == 0 { 0.0 } else { (spent() - started) * patches.len() as f64 / f64::from(done) }
}

/// Areas and exposed areas (m²) of patches with given shares; `rows` are the sums Σ_j G_ij (m²).
///
/// What a patch exchanges cannot exceed what it exposes, Σ_j G_ij ≤ w A, which is sharper than a
/// grid where little is exposed.
#[must_use]
pub fn extents(patches: &[&Patch], shares: &[f64], rows: &[f64]) -> Vec<Extent> {
    let of = |((patch, &share), &row): ((&&Patch, &f64), &f64)| {
        let area = patch.area();
        Extent { area, exposed: if share < 1.0 { (share * area).max(row.min(area)) } else { area } }
    };
    patches.iter().zip(shares).zip(rows).map(of).collect()
}

fn share(patch: &Patch, patches: &[&Patch], lit: &Occluders) -> f64 {
    let first = exposed_share(patch, POINTS_ALONG_GRIDS[0], patches, lit);
    if first > 0.0 && first < 1.0 { exposed_share(patch, POINTS_ALONG_GRIDS[1], patches, lit) } else { first }
}

/// Exposed share in [0, 1] of one patch, from a grid of n × n points; it may be a part of one of
/// those that `lit` holds in order.
#[must_use]
pub fn exposed_share(patch: &Patch, n: usize, patches: &[&Patch], lit: &Occluders) -> f64 {
    let bundle = Bundle::of(patch);
    let exposed = grid(patch, n).filter(|&point| !bundle.buried(point, patches, lit)).count();
    exposed as f64 / (n * n) as f64
}

/// Midpoints of an n × n grid.
fn grid(patch: &Patch, n: usize) -> impl Iterator<Item = Vec3> {
    let middle = move |k: usize| (k as f64 + 0.5) / n as f64;
    (0..n * n).map(move |k| {
        let (u, v) = folded(patch, middle(k / n), middle(k % n));
        patch.point(u, v)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(corners: [[f64; 3]; 4]) -> Patch {
        Patch::quad(corners.map(Vec3::from)).unwrap().unwrap()
    }

    /// A floor [0, 1]² with a bottomless unit-high box standing on [0, x] × [0, 1], lit outside.
    fn floor_and_box(x: f64) -> Vec<Patch> {
        vec![
            quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]),
            quad([[0., 0., 1.], [x, 0., 1.], [x, 1., 1.], [0., 1., 1.]]),
            quad([[0., 0., 0.], [x, 0., 0.], [x, 0., 1.], [0., 0., 1.]]),
            quad([[x, 0., 0.], [x, 1., 0.], [x, 1., 1.], [x, 0., 1.]]),
            quad([[x, 1., 0.], [0., 1., 0.], [0., 1., 1.], [x, 1., 1.]]),
            quad([[0., 1., 0.], [0., 0., 0.], [0., 0., 1.], [0., 1., 1.]]),
        ]
    }

    fn shares(patches: &[Patch]) -> Vec<f64> {
        exposed_shares(&patches.iter().collect::<Vec<_>>(), &Occluders::new(patches).unwrap())
    }

    #[test]
    fn the_floor_under_a_box_is_buried() {
        for x in [0.25, 0.5, 0.6] {
            let shares = shares(&floor_and_box(x));
            assert!((shares[0] - (1.0 - x)).abs() < 1.0 / 32.0, "{x}: {}", shares[0]);
            assert!(shares[1..].iter().all(|&w| w >= 1.0), "the box itself is exposed: {shares:?}");
        }
    }

    #[test]
    fn a_sliver_that_the_grid_misses_is_as_large_as_its_exchange() {
        let patch = floor_and_box(0.5)[0];
        let sizes = extents(&[&patch; 3], &[0.0, 0.5, 1.0], &[0.01, 0.4, 0.9]);
        let exposed: Vec<f64> = sizes.iter().map(|size| size.exposed).collect();
        assert_eq!(exposed, [0.01, 0.5, 1.0]);
    }

    #[test]
    fn a_plate_of_two_faces_buries_nothing() {
        let mut patches = floor_and_box(0.5);
        patches.truncate(1);
        let plate = quad([[-1., -1., 0.5], [2., -1., 0.5], [2., 2., 0.5], [-1., 2., 0.5]]);
        patches.extend([plate, plate.flipped()]);
        assert!(shares(&patches).iter().all(|&w| w >= 1.0));
    }
}
