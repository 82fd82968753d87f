//! Pictures with the light of lamps at every pixel: the solution's own part of it is taken out, and
//! the factors put in.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use fredholm_mesh::{Mesh, MeshBuilder, Patch, Vec3};
use fredholm_report::{Camera, Exposure, Field, LampLight, Lighter, Lit, render_lit};
use rayon::ThreadPoolBuilder;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The square −1 … 1 of n × n faces.
fn square(n: usize) -> Mesh {
    let line = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let mut builder = MeshBuilder::default();
    builder.surface("floor", 0);
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let corner = |i: usize, j: usize| Vec3::new(line(i), line(j), 0.0);
        let ring = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        builder.face(&[Patch::quad(ring).unwrap().unwrap()]).unwrap();
    }
    builder.build()
}

/// Sees the square in columns and rows 16 to 48 of 64.
fn camera() -> Camera {
    Camera {
        eye: Vec3::new(0.0, 0.0, 2.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov_degrees: 90.0,
        width: 64,
        height: 64,
    }
}

/// A lamp of which x < 0 sees half and the rest nothing.
struct Half;

impl LampLight for Half {
    fn lamps(&self) -> usize {
        1
    }

    fn lighter(&self) -> Lighter<'_> {
        Box::new(|_, points, factors| {
            for (factor, point) in factors.iter_mut().zip(points) {
                *factor = if point.x < 0.0 { 0.5 } else { 0.0 };
            }
        })
    }
}

/// No lamp.
struct Dark;

impl LampLight for Dark {
    fn lamps(&self) -> usize {
        0
    }

    fn lighter(&self) -> Lighter<'_> {
        Box::new(|_, _, _| {})
    }
}

fn drawn(cells: usize) -> (Vec<u8>, Vec<[f32; 3]>) {
    let (mesh, bands) = (square(cells), vec!["grey".to_owned()]);
    // The lamp sends 6 W/m², of which the solution has 2 everywhere; 1 W/m² comes besides, and half
    // is reflected.
    let (irradiance, radiosity) = (vec![3.0; mesh.len()], vec![1.5; mesh.len()]);
    let field = Field::new(&mesh, &bands, &irradiance, &radiosity).unwrap();
    let (reflectance, direct) = (vec![0.5; mesh.len()], vec![2.0; mesh.len()]);
    let lit = Lit { light: &Half, exitance: &[6.0], reflectance: &reflectance, direct: Some(&direct) };
    let drawn = render_lit(&field, &camera(), Exposure::Fixed(0.2), &lit, true).unwrap().unwrap();
    (drawn.picture.pixels, drawn.linear)
}

#[test]
fn the_light_of_lamps_takes_the_place_of_what_the_solution_has_of_it() {
    let (pixels, linear) = drawn(3);
    let at = |x: usize, y: usize| linear[64 * y + x][0];
    // ρ (6 · ½ + 1) and ρ · 1.
    assert!((at(20, 30) - 2.0).abs() < 1e-6 && (at(40, 30) - 0.5).abs() < 1e-6);
    assert!(at(2, 2).abs() < 1e-12 && pixels[0] == pixels[3], "nothing is lit beside the square");
    // The border of the shadow lies within the middle element, between columns 31 and 32.
    assert!((at(31, 30) - 2.0).abs() < 1e-6 && (at(32, 30) - 0.5).abs() < 1e-6);
}

#[test]
fn threads_do_not_change_a_pixel() {
    let with = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| drawn(5))
    };
    let one = with(1);
    assert!(one == with(2) && one == with(3));
}

#[test]
fn a_smooth_rest_keeps_its_means_up_to_the_edge() {
    let (mesh, bands) = (square(8), vec!["grey".to_owned()]);
    let radiosity: Vec<f64> = mesh.patches().map(|patch| 2.0 + patch.centroid().x).collect();
    let field = Field::new(&mesh, &bands, &radiosity, &radiosity).unwrap();
    let (reflectance, direct) = (vec![1.0; mesh.len()], vec![0.0; mesh.len()]);
    let lit = Lit { light: &Dark, exitance: &[], reflectance: &reflectance, direct: Some(&direct) };
    let linear = render_lit(&field, &camera(), Exposure::Fixed(0.2), &lit, true).unwrap().unwrap().linear;
    // Corners at the edge of the square that had the mean of their elements would lack 0.125.
    for (x, y) in [(17, 32), (32, 32), (46, 20), (46, 46)] {
        let expected = 2.0 + (x as f64 + 0.5 - 32.0) / 16.0;
        let found = f64::from(linear[64 * y + x][0]);
        assert!((found - expected).abs() < 0.03, "({x}, {y}): {found} {expected}");
    }
}

/// A picture that is wanted until it was asked so often.
struct Impatient(AtomicUsize);

impl LampLight for Impatient {
    fn lamps(&self) -> usize {
        0
    }

    fn lighter(&self) -> Lighter<'_> {
        Box::new(|_, _, _| {})
    }

    fn go_on(&self) -> ControlFlow<()> {
        let left = self.0.fetch_sub(1, Ordering::Relaxed);
        if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn a_picture_that_is_not_wanted_any_more_is_none() {
    let (mesh, bands) = (square(3), vec!["grey".to_owned()]);
    let values = vec![1.5; mesh.len()];
    let field = Field::new(&mesh, &bands, &values, &values).unwrap();
    // Two looks at each of four tiles, and one more where there are borders.
    for (asks, whole) in [(0, false), (3, false), (6, false), (100, true)] {
        let light = Impatient(AtomicUsize::new(asks));
        let lit = Lit { light: &light, exitance: &[], reflectance: &values, direct: None };
        let drawn = render_lit(&field, &camera(), Exposure::Fixed(0.2), &lit, false).unwrap();
        assert_eq!(drawn.is_some(), whole, "{asks}");
    }
}

#[test]
fn vectors_that_do_not_fit_are_refused() {
    let (mesh, bands) = (square(2), vec!["grey".to_owned()]);
    let field = Field::new(&mesh, &bands, &[1.0; 4], &[1.0; 4]).unwrap();
    let lit = Lit { light: &Half, exitance: &[6.0], reflectance: &[0.5; 4], direct: Some(&[1.0; 3]) };
    let error = render_lit(&field, &camera(), Exposure::Auto, &lit, false).err().unwrap();
    assert!(error.to_string().contains("direct irradiance"), "{error}");
}
