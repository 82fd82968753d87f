//! Pairs with nothing between them.

use crate::generator::{KINDS, Kind, Random, axes, moved, pair, polygon};
use crate::reference;
use fredholm_coupling::form_factor::{Exchange, PairIntegrator, Workspace};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

/// A tolerance that only rounding ends.
const ROUNDING_TOLERANCE: f64 = 1e-13;

fn exchange(a: &Patch, b: &Patch, tolerance: f64) -> Exchange {
    let bvh = Occluders::new(&[]).unwrap();
    let integrator = PairIntegrator::new([a, b], &bvh, tolerance);
    integrator.exchange(0, 1, &mut Workspace::default())
}

fn smaller(pair: &[Patch; 2]) -> f64 {
    pair[0].area().min(pair[1].area())
}

/// What the quadrature of the reference resolves, as a part of the smaller area: it is coarse where
/// the integrand has a narrow layer.
fn resolved(kind: Kind) -> f64 {
    match kind {
        Kind::Gap(_) | Kind::Plates(_) | Kind::SliverEdge(_) => 2e-4,
        _ => 2e-6,
    }
}

#[test]
fn the_contour_integral_agrees_with_quadrature_of_point_to_polygon() {
    for kind in KINDS {
        let mut random = Random::new(1);
        for k in 0..8 {
            let p = pair(kind, &mut random);
            let got = exchange(&p[0], &p[1], ROUNDING_TOLERANCE);
            let goal = 1e-5 * got.value.max(1e-6 * smaller(&p));
            let exact = reference::exchange(&p[0], &p[1], &[], goal);
            let off = (got.value - exact.value).abs() - got.error;
            assert!(off <= resolved(kind) * smaller(&p), "{kind:?} {k}: {got:?} against {exact:?}");
        }
    }
}

/// The defect of the whole against the sum of its 16 parts and against the reverse order, and the
/// sum of the stated errors.
fn defect(p: &[Patch; 2]) -> (f64, f64) {
    let (whole, back) =
        (exchange(&p[0], &p[1], ROUNDING_TOLERANCE), exchange(&p[1], &p[0], ROUNDING_TOLERANCE));
    assert!(whole.value >= 0.0 && whole.value <= smaller(p) * (1.0 + 1e-9), "{whole:?}");
    let (mut sum, mut stated) = (0.0, whole.error);
    for part in p[0].split().unwrap() {
        for other in p[1].split().unwrap() {
            let exchange = exchange(&part, &other, ROUNDING_TOLERANCE);
            sum += exchange.value;
            stated += exchange.error;
        }
    }
    ((whole.value - sum).abs().max((whole.value - back.value).abs()), stated)
}

#[test]
fn parts_add_up_and_both_orders_agree_within_the_stated_error() {
    // Far from the origin the corners of the parts are rounded themselves.
    for (scale, shift, allowed) in [(1.0, 0.0, 1.0), (1e-6, 0.0, 1.0), (1e6, 0.0, 1.0), (1.0, 1e3, 30.0)] {
        for kind in KINDS {
            let mut random = Random::new(2);
            let (mut tested, mut worst) = (0, 0f64);
            for k in 0..20 {
                let p = pair(kind, &mut random);
                let Some(p) = moved(&p, scale, random.direction() * shift) else { continue };
                let (defect, stated) = defect(&p);
                assert!(
                    defect <= allowed * stated,
                    "{kind:?} × {scale} + {shift}, {k}: {defect:e} > {stated:e}"
                );
                worst = worst.max(defect / smaller(&p));
                tested += 1;
            }
            assert!(tested >= 10, "{kind:?}");
            println!("{kind:?} × {scale} + {shift}: largest defect of F {worst:.1e}");
        }
    }
}

#[test]
fn patches_in_one_plane_exchange_nothing() {
    let mut random = Random::new(4);
    for _ in 0..200 {
        let n = random.direction();
        let [u, v] = axes(n, &mut random);
        let aside = u * random.between(2.0, 9.0) + v * random.between(-9.0, 9.0);
        let a = polygon(Vec3::ZERO, n, 1.0, 1.0, &mut random);
        let b = polygon(aside, n, 1.0, 1.0, &mut random);
        for b in [b, b.flipped()] {
            assert!(exchange(&a, &b, 1e-6).value == 0.0);
        }
    }
}
