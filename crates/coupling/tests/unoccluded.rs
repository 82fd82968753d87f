//! Many exchanges at once: against closed forms, the contour integral pair by pair, and the closure
//! of a cube.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;
#[allow(dead_code, reason = "the generator serves other tests too")]
#[path = "random_pairs/generator.rs"]
mod generator;
#[allow(dead_code, reason = "the generator needs what faces the other patch only")]
#[path = "random_pairs/reference.rs"]
mod reference;

use common::{patch, v};
use fredholm_coupling::form_factor::{Exchange, Method, Unoccluded, Work, contour_integral};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use generator::{Kind, Random, moved, pair};
use std::f64::consts::PI;

const EMPTY: Exchange =
    Exchange { value: f64::NAN, error: f64::NAN, deviation: 0.0, method: Method::Sampled };

/// Exchanges of the first patch with all others.
fn exchanges(patches: &[Patch], tolerance: f64) -> Vec<Exchange> {
    let list: Vec<&Patch> = patches.iter().collect();
    let others: Vec<u32> = (1..patches.len() as u32).collect();
    let (mut work, mut out) = (Work::default(), vec![EMPTY; others.len()]);
    Unoccluded::new(&list, tolerance).row(0, &others, &mut work, &mut out);
    out
}

/// Counts hidden pairs, those by Gauss points and close ones.
fn count(ways: &mut [usize; 3], exchange: &Exchange) {
    let way = [Method::Hidden, Method::Gauss, Method::Contour].iter().position(|way| *way == exchange.method);
    ways[way.unwrap()] += 1;
}

fn exchange(pair: &[Patch; 2], tolerance: f64) -> Exchange {
    exchanges(pair, tolerance)[0]
}

/// A_i A_j / (π d²), at most the smaller area.
fn facing([a, b]: &[Patch; 2]) -> f64 {
    let open = a.area() * b.area() / (PI * a.centroid().distance_squared(b.centroid()));
    open.min(a.area()).min(b.area())
}

/// The contour integral pair by pair, as far as rounding lets it.
fn exact(pair: &[Patch; 2]) -> Estimate {
    let [a, b] = pair;
    contour_integral(&reference::front(a, b), &reference::front(b, a), 1e-14 * facing(pair))
}

/// A parallelogram on the first three corners of a patch.
fn straightened(p: &Patch) -> Patch {
    let [a, b, c] = [0, 1, 2].map(|k| p.corner(k));
    patch(&[a, b, c, a + (c - b)])
}

/// Random pairs of one kind, every other one of parallelograms.
fn pairs(kind: Kind, count: usize) -> Vec<[Patch; 2]> {
    let mut random = Random::new(7);
    let mut one = |k: usize| {
        let p = pair(kind, &mut random);
        if k.is_multiple_of(2) { p } else { [straightened(&p[0]), straightened(&p[1])] }
    };
    (0..count).map(&mut one).collect()
}

fn corners(value: &toml::Value) -> Vec<Vec3> {
    let number = |x: &toml::Value| x.as_float().or(x.as_integer().map(|i| i as f64)).unwrap();
    let point = |p: &toml::Value| {
        let p: Vec<f64> = p.as_array().unwrap().iter().map(number).collect();
        v(p[0], p[1], p[2])
    };
    value.as_array().unwrap().iter().map(point).collect()
}

/// Closed forms of the catalogue (Howell C-11 to C-15).
#[test]
fn every_catalogued_pair_agrees_to_its_last_digit() {
    let cases: toml::Table = include_str!("data/form_factors.toml").parse().unwrap();
    let cases = cases["case"].as_array().unwrap();
    assert_eq!(cases.len(), 7);
    for case in cases {
        let p = [patch(&corners(&case["a"])), patch(&corners(&case["b"]))];
        let exact = case["f_ab"].as_float().unwrap() * p[0].area();
        // One value of the catalogue has ten digits, the others fourteen.
        let digits = if case["name"].as_str() == Some("triangle_parallel") { 1e-9 } else { 1e-12 };
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-13] {
            let got = exchange(&p, tolerance);
            let off = (got.value - exact).abs();
            assert!(off <= got.error + digits * exact, "{}: {got:?} against {exact}", case["name"]);
            assert!(off <= tolerance * facing(&p) + digits * exact, "{}: {got:?}", case["name"]);
        }
    }
}

/// What was found at one tolerance.
#[derive(Default)]
struct Figures {
    gauss: u64,
    close: u64,
    covered: usize,
    worst: f64,
    stated: f64,
}

fn figures(list: &[[Patch; 2]], truth: &[Estimate], tolerance: f64) -> Figures {
    let mut figures = Figures::default();
    for (p, exact) in list.iter().zip(truth) {
        let out = exchanges(p, tolerance);
        let gauss = out[0].method == Method::Gauss;
        figures.gauss += u64::from(gauss);
        figures.close += u64::from(out[0].method == Method::Contour);
        let (off, stated) = ((out[0].value - exact.value).abs(), out[0].error + exact.error);
        figures.covered += usize::from(off <= stated);
        figures.worst = figures.worst.max(off / stated);
        // Below 1e-9 pairs far apart that cross a plane, and slivers, are limited by rounding.
        if tolerance >= 1e-9 {
            let rounding = if gauss { 0.0 } else { 2.0 * exact.error };
            figures.stated = figures.stated.max((out[0].error - rounding) / (tolerance * facing(p)));
        }
    }
    figures
}

#[test]
fn the_stated_error_covers_the_true_one_and_meets_the_tolerance() {
    let kinds = [
        Kind::Apart,
        Kind::Near,
        Kind::Sliver(1e1),
        Kind::Sliver(1e2),
        Kind::Sizes(1e1),
        Kind::Sizes(1e3),
        Kind::SharedEdge,
        Kind::SharedCorner,
        Kind::Crossing,
    ];
    for kind in kinds {
        let list = pairs(kind, 2000);
        let truth: Vec<Estimate> = list.iter().map(exact).collect();
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
            let Figures { gauss, close, covered, worst, stated } = figures(&list, &truth, tolerance);
            println!(
                "{kind:?}, T = {tolerance:e}: {gauss} by Gauss, {close} close, {covered} of {} covered, worst {worst:.2}, \
                 stated {stated:.2} T",
                list.len()
            );
            assert!(covered * 1000 >= list.len() * 995, "{kind:?} {tolerance}: {covered}");
            assert!(gauss + close > 1900 && (gauss > 20 || kind != Kind::Apart));
            assert!(stated <= 1.0, "{kind:?} {tolerance}: {stated}");
        }
    }
}

#[test]
fn scale_and_place_change_nothing() {
    let mut compared = 0;
    for kind in [Kind::Apart, Kind::Near, Kind::Sizes(1e1), Kind::SharedEdge] {
        for (k, p) in pairs(kind, 100).iter().enumerate() {
            let direction = Random::new(k as u64).direction();
            let plain = exchange(p, 1e-12).value;
            for (scale, shift) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e3), (1e-3, 1.0)] {
                let Some(there) = moved(p, scale, direction * shift) else { continue };
                let value = exchange(&there, 1e-12).value / (scale * scale);
                assert!(
                    (value - plain).abs() <= 1e-9 * facing(p),
                    "{kind:?} × {scale} + {shift}: {value} {plain}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 1500, "{compared}");
}

/// Patches in all directions about a first one.
fn scattered(count: usize) -> Vec<Patch> {
    let mut random = Random::new(11);
    let mut one = |k: usize| {
        let (centre, n) = (random.direction() * random.scale(0.5, 30.0), random.direction());
        let p = generator::polygon(centre, n, random.scale(0.1, 1.0), 1.0, &mut random);
        if k.is_multiple_of(2) { p } else { straightened(&p) }
    };
    (0..count).map(&mut one).collect()
}

#[test]
fn a_pair_has_the_same_bits_in_either_order_and_in_any_company() {
    let patches = scattered(150);
    let list: Vec<&Patch> = patches.iter().collect();
    let all = Unoccluded::new(&list, 1e-6);
    let mut work = Work::default();
    let mut get = |i: u32, js: &[u32]| {
        let mut out = vec![EMPTY; js.len()];
        all.row(i as usize, js, &mut work, &mut out);
        out
    };
    let everyone: Vec<u32> = (0..150).collect();
    let mut ways = [0; 3];
    let backwards: Vec<u32> = (0..150).rev().collect();
    for i in everyone.clone() {
        let (row, reversed) = (get(i, &everyone), get(i, &backwards));
        for (&j, exchange) in everyone.iter().zip(&row) {
            count(&mut ways, exchange);
            assert_eq!(get(i, &[j])[0], *exchange);
            assert_eq!(get(j, &[i])[0], *exchange);
            assert_eq!(reversed[149 - j as usize], *exchange);
        }
    }
    let [hidden, gauss, close] = ways;
    assert!(gauss > 2000 && close > 100 && hidden > 2000, "{ways:?}");
}

#[test]
fn renumbering_changes_rounding_only() {
    for p in pairs(Kind::Apart, 500) {
        let (there, back) = (exchange(&p, 1e-9), exchange(&[p[1], p[0]], 1e-9));
        assert!((there.value - back.value).abs() <= 1e-14 * facing(&p), "{there:?} {back:?}");
    }
}

#[test]
fn patches_behind_or_in_one_plane_exchange_nothing() {
    let square = |x: f64, z: f64| patch(&[v(x, 0., z), v(x + 1., 0., z), v(x + 1., 1., z), v(x, 1., z)]);
    let floor = square(0.0, 0.0);
    let others =
        [square(1.0, 0.0), square(5.0, 0.0), square(0.0, -1.0).flipped(), square(0.0, 1.0), floor.flipped()];
    let patches: Vec<Patch> = std::iter::once(floor).chain(others).collect();
    let out = exchanges(&patches, 1e-6);
    assert!(out.iter().all(|e| e.value == 0.0 && e.error == 0.0 && e.method == Method::Hidden), "{out:?}");
    assert_eq!(out.len(), 5);
    let mut out = [EMPTY];
    Unoccluded::new(&[&floor], 1e-6).row(0, &[0], &mut Work::default(), &mut out);
    assert_eq!(out[0].method, Method::Hidden, "a flat patch does not see itself");
}

/// The unit cube, each wall n × n patches that face inwards.
fn cube(n: usize) -> Vec<Patch> {
    let at = |k: usize| k as f64 / n as f64;
    let put = |wall: usize, u: f64, v: f64| {
        let mut x = [0.0; 3];
        (x[wall / 2], x[(wall / 2 + 1) % 3], x[(wall / 2 + 2) % 3]) = ((wall % 2) as f64, u, v);
        Vec3::from(x)
    };
    let cell = |k: usize| {
        let (wall, i, j) = (k / (n * n), k / n % n, k % n);
        let ends = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| put(wall, at(i), at(j)));
        let p = patch(&ends);
        if wall % 2 == 0 { p } else { p.flipped() }
    };
    (0..6 * n * n).map(cell).collect()
}

#[test]
fn rows_of_a_cube_sum_to_one() {
    let patches = cube(8);
    let list: Vec<&Patch> = patches.iter().collect();
    let all: Vec<u32> = (0..list.len() as u32).collect();
    for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
        let rows = Unoccluded::new(&list, tolerance);
        let (mut work, mut out) = (Work::default(), vec![EMPTY; list.len()]);
        let mut ways = [0; 3];
        for (i, patch) in list.iter().enumerate() {
            rows.row(i, &all, &mut work, &mut out);
            for exchange in &out {
                count(&mut ways, exchange);
            }
            let sum: f64 = out.iter().map(|e| e.value).sum();
            let stated: f64 = out.iter().map(|e| e.error).sum();
            let defect = (sum / patch.area() - 1.0).abs();
            assert!(
                defect <= stated / patch.area() && stated / patch.area() <= 2.0 * tolerance,
                "{defect:e}"
            );
        }
        let [hidden, gauss, close] = ways;
        assert!(hidden == 6 * 64 * 64 && gauss > close, "{ways:?}");
    }
}
