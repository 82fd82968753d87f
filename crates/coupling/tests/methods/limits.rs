//! Limits that every method must have.

use crate::generator::{KINDS, Kind, Random, moved, pair};
use crate::{open, smaller};
use fredholm_coupling::method::{FormFactorMethod, Setting, methods};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;

fn quad(corners: [[f64; 3]; 4]) -> Patch {
    Patch::quad(corners.map(Vec3::from)).unwrap().unwrap()
}

fn usual(method: &dyn FormFactorMethod, pair: &[Patch; 2]) -> fredholm_coupling::method::Evaluated {
    open(method.name(), pair, method.default_setting())
}

/// A_i A_j cosθ cosθ'/(π d²) up to terms of (R/d)², here 1e-4.
#[test]
fn far_patches_have_the_kernel_between_their_centroids() {
    let a = quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    let b = Patch::triangle([[60., 0., 80.], [60., 1., 80.], [60.6, 0., 79.2]].map(Vec3::from)).unwrap();
    let b = if b.normal().z < 0.0 { b } else { b.flipped() };
    let d = b.centroid() - a.centroid();
    let cosines = d.dot(a.normal()) * -d.dot(b.normal()) / d.length_squared();
    let limit = a.area() * b.area() * cosines / (PI * d.length_squared());
    assert!(limit > 1e-5);
    for method in methods().iter().filter(|method| method.name() != "hemicube") {
        let got = usual(method.as_ref(), &[a, b]);
        let noise = if method.name() == "monte-carlo" { 4.0 * got.error } else { 0.0 };
        assert!(
            (got.value - limit).abs() < 3e-4 * limit + noise,
            "{}: {got:?} against {limit}",
            method.name()
        );
        assert!(noise < 0.1 * limit);
    }
    // No pixel of the usual size sees so small a patch for sure; finer ones do.
    let fine = open("hemicube", &[a, b], Setting::Resolution(4096));
    assert!((fine.value - limit).abs() < 0.05 * limit, "{fine:?} against {limit}");
}

#[test]
fn both_orders_give_the_same() {
    // Two see from one side only, and the singular rules of the third treat the two sides
    // differently.
    let one_sided = ["nystrom", "hemicube", "area-gauss"];
    for kind in [Kind::Apart, Kind::Near, Kind::SharedEdge, Kind::Crossing, Kind::Sizes(10.0)] {
        let mut random = Random::new(31);
        for _ in 0..5 {
            let [a, b] = pair(kind, &mut random);
            for method in methods() {
                let (ab, ba) = (usual(method.as_ref(), &[a, b]), usual(method.as_ref(), &[b, a]));
                let rounding = 1e-12 * smaller(&[a, b]);
                let allowed = match method.name() {
                    name if one_sided.contains(&name) => ab.error + ba.error,
                    "monte-carlo" => 5.0 * (ab.error + ba.error),
                    _ => rounding,
                };
                let difference = (ab.value - ba.value).abs();
                assert!(difference <= allowed, "{} {kind:?}: {ab:?} {ba:?}", method.name());
            }
        }
    }
}

#[test]
fn no_length_is_special() {
    for kind in KINDS {
        let mut random = Random::new(32);
        let unit = pair(kind, &mut random);
        for scale in [1e-6, 1e6] {
            let Some(other) = moved(&unit, scale, Vec3::ZERO) else {
                panic!("{kind:?} has no area at {scale}")
            };
            for method in methods() {
                let (one, two) = (usual(method.as_ref(), &unit), usual(method.as_ref(), &other));
                let difference = (two.value / (scale * scale) - one.value).abs();
                // A pixel on the outline may fall to the other side by rounding.
                let pixels = if method.name() == "hemicube" { 0.1 * one.error } else { 0.0 };
                let rounding = 1e-11 * smaller(&unit) + if method.convergent() { one.error } else { 0.0 };
                assert!(
                    difference <= rounding + pixels,
                    "{} {kind:?} × {scale}: {one:?} {two:?}",
                    method.name()
                );
            }
        }
    }
}

#[test]
fn patches_that_do_not_face_each_other_exchange_nothing() {
    let a = quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    let beside = quad([[1., 0., 0.], [2., 0., 0.], [2., 1., 0.], [1., 1., 0.]]);
    let above = quad([[0., 0., 1.], [1., 0., 1.], [1., 1., 1.], [0., 1., 1.]]);
    for other in [beside, a.flipped(), above] {
        for method in methods() {
            assert!(usual(method.as_ref(), &[a, other]).value == 0.0, "{}", method.name());
        }
    }
}

/// A closed tetrahedron: the factors of each face sum to 1, all edges shared, none parallel.
#[test]
fn the_rows_of_a_tetrahedron_sum_to_one() {
    let corners = [[0., 0., 0.], [1.3, 0.1, 0.], [0.2, 0.9, -0.1], [0.3, 0.4, 1.1]].map(Vec3::from);
    let middle = corners.iter().sum::<Vec3>() / 4.0;
    let face = |skip: usize| {
        let [a, b, c] = [1, 2, 3].map(|k| corners[(skip + k) % 4]);
        let patch = Patch::triangle([a, b, c]).unwrap();
        if patch.normal().dot(middle - a) > 0.0 { patch } else { patch.flipped() }
    };
    let faces = [0, 1, 2, 3].map(face);
    for (name, setting, allowed) in [
        ("schroeder-hanrahan", Setting::Fixed, 1e-14),
        ("contour", Setting::Tolerance(1e-14), 1e-13),
        ("point-polygon", Setting::Tolerance(1e-11), 1e-10),
        ("area-gauss", Setting::Order(10), 1e-6),
    ] {
        for i in 0..4 {
            let row = (0..4).filter(|&j| j != i).map(|j| open(name, &[faces[i], faces[j]], setting).value);
            let defect = row.sum::<f64>() / faces[i].area() - 1.0;
            assert!(defect.abs() < allowed, "{name}, face {i}: {defect:e}");
        }
    }
}
