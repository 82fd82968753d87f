//! Pictures with the light of lamps at every pixel: the solution's own part of it is taken out, and
//! the factors put in.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use fredholm_mesh::{Mesh, MeshBuilder, Patch, Vec3};
use fredholm_report::{
    Camera, DIRECTION_GROUPS, Exposure, Field, Gathering, LampLight, Lighter, Lit, LitPicture, Points, Seen,
    Where, render_lit,
};
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

    fn lighter(&self, _points: Points) -> Lighter<'_> {
        Box::new(|_, points, factors| {
            for (factor, point) in factors.values.iter_mut().zip(points) {
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

    fn lighter(&self, _points: Points) -> Lighter<'_> {
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
    let lit = Lit {
        light: &Half,
        exitance: &[6.0],
        reflectance: &reflectance,
        direct: Some(&direct),
        gathering: None,
    };
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
    let lit = Lit {
        light: &Dark,
        exitance: &[],
        reflectance: &reflectance,
        direct: Some(&direct),
        gathering: None,
    };
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

    fn lighter(&self, _points: Points) -> Lighter<'_> {
        Box::new(|_, _, _| {})
    }

    fn go_on(&self) -> ControlFlow<()> {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        if left.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn a_picture_that_is_not_wanted_any_more_is_none_or_has_rough_borders() {
    let (mesh, bands) = (square(3), vec!["grey".to_owned()]);
    let values = vec![1.5; mesh.len()];
    let field = Field::new(&mesh, &bands, &values, &values).unwrap();
    // Two looks at each of four tiles, and one more where there are borders.
    for (asks, whole) in [(0, None), (3, None), (6, Some(false)), (100, Some(true))] {
        let light = Impatient(AtomicUsize::new(asks));
        let lit = Lit { light: &light, exitance: &[], reflectance: &values, direct: None, gathering: None };
        let camera = Camera { width: 128, height: 128, ..camera() };
        let drawn = render_lit(&field, &camera, Exposure::Fixed(0.2), &lit, false).unwrap();
        assert_eq!(drawn.map(|drawn| drawn.whole), whole, "{asks}");
    }
}

#[test]
fn vectors_that_do_not_fit_are_refused() {
    let (mesh, bands) = (square(2), vec!["grey".to_owned()]);
    let field = Field::new(&mesh, &bands, &[1.0; 4], &[1.0; 4]).unwrap();
    let lit = Lit {
        light: &Half,
        exitance: &[6.0],
        reflectance: &[0.5; 4],
        direct: Some(&[1.0; 3]),
        gathering: None,
    };
    let error = render_lit(&field, &camera(), Exposure::Auto, &lit, false).err().unwrap();
    assert!(error.to_string().contains("direct irradiance"), "{error}");
}

/// A shining square above the lower one.
const HEIGHT: f64 = 0.75;

/// Looks along random directions from the lower square to the upper one, which is element 16.
struct Above;

impl Gathering for Above {
    fn meet(&self, number: u32, _: usize, point: Vec3, met: &mut Vec<Seen>) {
        met.clear();
        let mut state = u64::from(number);
        // SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014, doi:10.1145/2660193.2660195).
        let mut random = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        met.extend((0..DIRECTION_GROUPS * 64).map(|_| {
            let (sine, turn) = (random().sqrt(), std::f64::consts::TAU * random());
            let slope = HEIGHT * sine / (1.0 - sine * sine).sqrt();
            let at = point + Vec3::new(slope * turn.cos(), slope * turn.sin(), HEIGHT);
            (at.x.abs() < 1.0 && at.y.abs() < 1.0).then_some((16, at))
        }));
    }

    fn onward(&self, _: u32, _: u32, from: &[(usize, Vec3)], met: &mut Vec<Seen>) {
        met.clear();
        met.resize(from.len(), None);
    }
}

/// View factor from a point of the lower square to the upper one (J. R. Howell, catalogue of
/// configuration factors, B-3: the sum over its four parts about the point above).
fn factor(x: f64, y: f64) -> f64 {
    let part = |a: f64, b: f64| {
        let (a, b) = (a / HEIGHT, b / HEIGHT);
        let (p, q) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        (a / p * (b / p).atan() + b / q * (a / q).atan()) / std::f64::consts::TAU
    };
    [1.0 - x, 1.0 + x].iter().flat_map(|&a| [part(a, 1.0 - y), part(a, 1.0 + y)]).sum()
}

fn gathered(light: &dyn LampLight, side: u32) -> LitPicture {
    gathered_where(Where::Everywhere, light, side, 0.4)
}

/// The square of 4 × 4 faces, and one of one face above it, which looks down.
fn floor_and_ceiling(height: f64) -> Mesh {
    let line = |i: usize| 0.5 * i as f64 - 1.0;
    let corner = |i: usize, j: usize| Vec3::new(line(i), line(j), 0.0);
    let mut builder = MeshBuilder::default();
    builder.surface("floor", 0);
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let ring = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        builder.face(&[Patch::quad(ring).unwrap().unwrap()]).unwrap();
    }
    builder.surface("ceiling", 1);
    let above = [corner(0, 0), corner(0, 4), corner(4, 4), corner(4, 0)].map(|p| p + Vec3::Z * height);
    builder.face(&[Patch::quad(above).unwrap().unwrap()]).unwrap();
    builder.build()
}

/// The same where so much is sent on by a corner of the floor.
fn gathered_where(place: Where, light: &dyn LampLight, side: u32, corner_sends: f64) -> LitPicture {
    let (mesh, bands) = (floor_and_ceiling(HEIGHT), vec!["grey".to_owned()]);
    let mut radiosity = vec![0.4; 17];
    (radiosity[0], radiosity[16]) = (corner_sends, 6.0);
    let field = Field::new(&mesh, &bands, &radiosity, &radiosity).unwrap();
    let lit =
        Lit { light, exitance: &[], reflectance: &[0.5; 17], direct: None, gathering: Some((&Above, place)) };
    let camera = Camera { width: side, height: side, ..camera() };
    render_lit(&field, &camera, Exposure::Fixed(0.2), &lit, true).unwrap().unwrap()
}

#[test]
fn light_is_gathered_where_elements_are_too_large_for_it() {
    let even = gathered_where(Where::Uneven, &Dark, 64, 0.4);
    assert_eq!(even.places, 0);
    assert!(even.standard_error.is_empty(), "no error is known of what is interpolated");
    let at = |drawn: &LitPicture, x: usize, y: usize| f64::from(drawn.linear[64 * y + x][0]);
    assert!((17..47).all(|k| (at(&even, k, 30) - 0.4).abs() < 1e-6));
    // The corner at −1, −1 is to the left and below.
    let step = gathered_where(Where::Uneven, &Dark, 64, 0.1);
    assert!(step.places > 10, "{}", step.places);
    let exact = |x: usize, y: usize| {
        let place = |at: f64| (at + 0.5 - 32.0) / 16.0;
        3.0 * factor(place(x as f64), -place(y as f64))
    };
    let (near, far) = (at(&step, 20, 43), at(&step, 44, 20));
    assert!((near / exact(20, 43) - 1.0).abs() < 0.15, "{near} {}", exact(20, 43));
    assert!((far - 0.4).abs() < 1e-6, "{far}");
}

#[test]
fn gathered_light_is_that_of_the_closed_form_and_its_error_the_stated_one() {
    let side = 160;
    let drawn = gathered(&Dark, side as u32);
    assert!(drawn.whole && drawn.places > 100 && drawn.places < 2000, "{}", drawn.places);
    let (mut squares, mut scores, mut count, mut worst) = (0.0, 0.0, 0.0, 0.0_f64);
    for (y, x) in (41..119).flat_map(|y| (41..119).map(move |x| (y, x))) {
        let place = |at: usize| (at as f64 + 0.5 - 80.0) / 40.0;
        // 0.5 of what 6 W/m² bring.
        let exact = 3.0 * factor(place(x), place(y));
        let off = f64::from(drawn.linear[y * side + x][0]) - exact;
        squares += (off / exact).powi(2);
        scores += (off / f64::from(drawn.standard_error[y * side + x][0])).powi(2);
        worst = worst.max((off / exact).abs());
        count += 1.0;
    }
    let (off, score) = ((squares / count).sqrt(), (scores / count).sqrt());
    // Places have 5 to 10 %, and each pixel up to sixteen of them.
    assert!(off < 0.025 && worst < 0.12, "{off} {worst}");
    assert!(score > 0.5 && score < 1.5, "{score}");
}

/// Meets a ceiling close above the floor, and from there a corner of the floor.
struct Gap;

impl Gathering for Gap {
    fn meet(&self, _: u32, _: usize, point: Vec3, met: &mut Vec<Seen>) {
        met.clear();
        met.resize(DIRECTION_GROUPS * 4, Some((16, point.with_z(0.1))));
    }

    fn onward(&self, _: u32, _: u32, from: &[(usize, Vec3)], met: &mut Vec<Seen>) {
        met.clear();
        met.resize(from.len(), Some((0, Vec3::new(-0.75, -0.75, 0.0))));
    }
}

/// A lamp of which all see a quarter.
struct Quarter;

impl LampLight for Quarter {
    fn lamps(&self) -> usize {
        1
    }

    fn lighter(&self, _points: Points) -> Lighter<'_> {
        Box::new(|_, _, factors| factors.values.fill(0.25))
    }
}

#[test]
fn what_is_met_nearby_sends_on_the_light_of_lamps_and_of_one_more_direction() {
    let (mesh, bands) = (floor_and_ceiling(0.1), vec!["grey".to_owned()]);
    // The solution has far too much light in the ceiling.
    let mut radiosity = vec![0.4; 17];
    radiosity[16] = 100.0;
    let field = Field::new(&mesh, &bands, &radiosity, &radiosity).unwrap();
    let lit = Lit {
        light: &Quarter,
        exitance: &[6.0],
        reflectance: &[0.5; 17],
        direct: Some(&[0.2; 17]),
        gathering: Some((&Gap, Where::Everywhere)),
    };
    let camera = Camera { eye: Vec3::new(0.0, 0.0, 2.0), width: 64, height: 64, ..camera() };
    let drawn = render_lit(&field, &camera, Exposure::Fixed(0.2), &lit, true).unwrap().unwrap();
    // ρ (6/4 + ρ (6/4 + 0.4)), the corner at −0.75 being too far from the ceiling above the rest.
    let found = f64::from(drawn.linear[64 * 20 + 40][0]);
    assert!((found - 0.5 * (1.5 + 0.5 * 1.9)).abs() < 1e-6, "{found}");
}

#[test]
fn threads_do_not_change_what_is_gathered() {
    let with = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let drawn = pool.install(|| gathered(&Dark, 64));
        (drawn.picture, drawn.linear, drawn.standard_error, drawn.places)
    };
    let one = with(1);
    assert!(one == with(2) && one == with(3));
}

#[test]
fn gathering_that_is_stopped_leaves_a_whole_picture_of_what_there_is() {
    // Four tiles are asked for, then every place.
    for asks in [5, 12] {
        let light = Impatient(AtomicUsize::new(asks));
        let drawn = gathered(&light, 128);
        assert!(!drawn.whole && drawn.places == asks - 4, "{}", drawn.places);
        let at = |x: usize, y: usize| f64::from(drawn.linear[128 * y + x][0]);
        assert!((34..94).all(|k| at(k, 60) > 0.3 && at(k, 60) < 4.0), "all is lit");
        let untold = drawn.standard_error.iter().filter(|error| error[0].is_nan()).count();
        assert!(untold > 0, "where light is interpolated no error is known");
    }
}

/// The lamp of [`Half`], known to within an error of so much.
struct Noisy(f64);

impl LampLight for Noisy {
    fn lamps(&self) -> usize {
        1
    }

    fn lighter(&self, _points: Points) -> Lighter<'_> {
        Box::new(|_, points, factors| {
            let found = factors.values.iter_mut().zip(&mut factors.errors);
            for ((factor, error), point) in found.zip(points) {
                let whole = if point.x < 0.0 { 0.5 } else { 0.2 };
                // A number in [-1, 1), even but for its pattern.
                let even =
                    2.0 * ((point.x * 917.3).sin() * 43_758.5 + point.y * 7_919.7).rem_euclid(1.0) - 1.0;
                (*factor, *error) = (whole + 3_f64.sqrt() * self.0 * even, self.0);
            }
        })
    }
}

#[test]
fn noise_is_smoothed_and_borders_stay() {
    let (mesh, bands) = (square(3), vec!["grey".to_owned()]);
    let values = vec![1.0; mesh.len()];
    let field = Field::new(&mesh, &bands, &values, &values).unwrap();
    let direct = vec![1.0; mesh.len()];
    let deviations = |error: f64| {
        let light = &Noisy(error);
        let lit =
            Lit { light, exitance: &[1.0], reflectance: &values, direct: Some(&direct), gathering: None };
        let linear = render_lit(&field, &camera(), Exposure::Fixed(0.2), &lit, true).unwrap().unwrap().linear;
        let deviation = |columns: std::ops::Range<usize>, truth: f64| {
            let pixels = (18..46).flat_map(|y| columns.clone().map(move |x| (x, y)));
            let off: Vec<f64> = pixels.map(|(x, y)| f64::from(linear[64 * y + x][0]) - truth).collect();
            let mean = |of: &dyn Fn(f64) -> f64| off.iter().map(|o| of(*o)).sum::<f64>() / off.len() as f64;
            (mean(&|o| o), mean(&|o| o * o).sqrt())
        };
        [deviation(18..32, 0.5), deviation(32..46, 0.2)]
    };
    // 49 pixels of a window have a seventh of the error of one; some differ too much to count.
    for (mean, error) in deviations(0.03) {
        assert!(mean.abs() < 0.005 && error < 0.03 / 3.0, "{mean} {error}");
    }
    for (mean, error) in deviations(0.0) {
        assert!(mean.abs() < 1e-6 && error < 1e-6, "{mean} {error}");
    }
}
