//! Form factors of pairs of patches against closed forms.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;

use common::{exchange, patch, v};
use fredholm_coupling::form_factor::Workspace;
use fredholm_mesh::{Cutting, MeshBuilder, Patch, Shape, Vec3};
use fredholm_quadrature::Estimate;

fn corners(value: &toml::Value) -> Vec<Vec3> {
    let number = |x: &toml::Value| x.as_float().or(x.as_integer().map(|i| i as f64)).unwrap();
    let point = |p: &toml::Value| {
        let p: Vec<f64> = p.as_array().unwrap().iter().map(number).collect();
        v(p[0], p[1], p[2])
    };
    value.as_array().unwrap().iter().map(point).collect()
}

#[test]
fn every_catalogued_pair_agrees_to_its_last_digit() {
    let cases: toml::Table = include_str!("data/form_factors.toml").parse().unwrap();
    let cases = cases["case"].as_array().unwrap();
    assert_eq!(cases.len(), 7);
    for case in cases {
        let (a, b) = (patch(&corners(&case["a"])), patch(&corners(&case["b"])));
        let exact = case["f_ab"].as_float().unwrap();
        // One value of the catalogue has ten digits, the others fourteen.
        let digits = if case["name"].as_str() == Some("triangle_parallel") { 1e-9 } else { 1e-12 };
        let got = exchange(&[a, b], 1e-13);
        let relative = got.value / a.area() / exact - 1.0;
        println!("{:<32} {:.16} {relative:+.1e} {:?}", case["name"].as_str().unwrap(), got.value, got.method);
        assert!(relative.abs() < digits, "{}: off by {relative:e}", case["name"]);
        assert!((got.value - exact * a.area()).abs() <= got.error + digits * exact);
    }
}

#[test]
fn any_tolerance_is_met() {
    let a = patch(&[v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)]);
    let b = patch(&[v(1., 3., 1.), v(2., 3., 1.), v(2., 1., 1.), v(1., 1., 1.)]);
    for exponent in 2..13 {
        let tolerance = 10f64.powi(-exponent);
        let got = exchange(&[a, b], tolerance);
        assert!((got.value - 0.053_847_739_556_581).abs() < tolerance, "{tolerance:e}: {got:?}");
    }
}

fn blocked_squares() -> [Patch; 4] {
    let a = patch(&[v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)]);
    let b = patch(&[v(0., 0., 1.), v(0., 1., 1.), v(1., 1., 1.), v(1., 0., 1.)]);
    let block = patch(&[v(0.25, 0.25, 0.5), v(0.75, 0.25, 0.5), v(0.75, 0.75, 0.5), v(0.25, 0.75, 0.5)]);
    [a, b, block, block.flipped()]
}

/// Unit squares at distance 1 with a centred square of side ½ halfway: by superposition of
/// rectangles.
#[test]
fn a_centred_block_takes_half_away() {
    let exact = 0.099_506_294_598_985;
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
        let got = exchange(&blocked_squares(), tolerance);
        println!(
            "T = {tolerance:e}: {:.15} ± {:.1e}, off by {:+.1e}",
            got.value,
            got.error,
            got.value - exact
        );
        assert!((got.value - exact).abs() <= got.error && got.error < 2.0 * tolerance);
    }
}

/// Element to a coaxial disc R = 1 at H = 1 behind a coaxial disc of radius ¼ halfway: sin² of the
/// outer cone less sin² of the inner one, ½ − 1/5. The discs are polygons of the same area with 128
/// sides.
#[test]
fn an_element_behind_a_disc_sees_a_ring() {
    let half = 1e-3;
    let element = patch(&[v(-half, -half, 0.), v(half, -half, 0.), v(half, half, 0.), v(-half, half, 0.)]);
    let mut builder = MeshBuilder::default();
    builder.surface("element", 0);
    builder.face(&[element]).unwrap();
    builder.surface("disc", 0);
    let disc = |height: f64, radius: f64| Shape::Disc {
        centre: Vec3::Z * height,
        normal: Vec3::NEG_Z,
        radius,
        segments: 128,
    };
    builder.add(&disc(1.0, 1.0), &Cutting::default()).unwrap();
    builder.surface("blocker", 0);
    let blocker = builder.add(&disc(0.5, 0.25), &Cutting::default()).unwrap();
    let mesh = builder.build();
    let mut ring = Estimate::default();
    common::with_integrator(&mesh, 1e-4, |pairs| {
        for leaf in (1..mesh.len()).filter(|&leaf| !blocker.contains(&mesh.face_of(leaf))) {
            let got = pairs.exchange(0, leaf, &mut Workspace::default());
            ring = ring + Estimate { value: got.value / element.area(), error: got.error / element.area() };
        }
    });
    println!("F = {:.6} ± {:.1e}", ring.value, ring.error);
    assert!((ring.value - 0.3).abs() < 1e-3 && (ring.value - 0.3).abs() <= ring.error);
}

#[test]
fn a_patch_behind_or_in_the_plane_of_another_gives_nothing() {
    let a = patch(&[v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)]);
    let beside = patch(&[v(1., 0., 0.), v(2., 0., 0.), v(2., 1., 0.), v(1., 1., 0.)]);
    assert!(exchange(&[a, beside], 1e-6).value == 0.0);
    assert!(exchange(&[a, a.flipped()], 1e-6).value == 0.0);
}
