//! The magnetic field equation on one and on two surfaces (`exact`, `exact-dual`), measured:
//!
//! - `-- spheres`: spheres of radius λ and 3λ against the series of Mie at 25 m, orders of
//!   convergence;
//! - `-- backscatter`: spheres of ka = 5 to 15, or as given, beside the series, physical optics in
//!   closed form, and its specular part;
//! - `-- resonance`: a sphere and the cube of 5λ near resonances of their interior (from the
//!   repository).
//!
//! `cargo run --release -p fredholm-waves --example exact_equation -- spheres`. Products are
//! computed anew by GMRES: no matrix is stored.

use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_waves::medium::SPEED_OF_LIGHT;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, sphere};
use fredholm_waves::{
    Complex64, ConductingSphere, Field, PhysicalOptics, Scatterer, Shadow, Source, System, Wave,
    cross_section,
};
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::time::Instant;

type Done = Result<(), Box<dyn Error>>;

const EQUATIONS: [Shadow; 2] = [Shadow::Exact, Shadow::ExactDual];

/// What a solution is looked at for.
struct Answer {
    fields: Vec<Field>,
    back: Complex64,
    iterations: usize,
    seconds: f64,
}

fn solve(body: &Scatterer, wave: Wave, shadow: Shadow, points: &[Vec3]) -> Result<Answer, Box<dyn Error>> {
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into())?;
    let sources: [&dyn Source; 1] = [&source];
    let start = Instant::now();
    let first = PhysicalOptics::new(body, wave, &sources, shadow)?;
    let system = System::lazy(body, wave, shadow)?;
    let b = system.right_hand_side(&[&first]);
    let a = SecondKind::new(system.coupling(), MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE))?;
    let mut x = MultiVector::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-5, max_iterations: 400 };
    let report = Solver::solve(&Gmres { restart: 200 }, &a, &b, &mut x, &stop, &mut Quiet)?;
    let currents = system.currents(&x, 0);
    let radiator = system.radiator(&currents);
    let back = radiator.far_field(&[Vec3::NEG_Y])?[0].amplitude.components()[2];
    let iterations = report.history.len().saturating_sub(1);
    Ok(Answer { fields: radiator.fields(points)?, back, iterations, seconds: start.elapsed().as_secs_f64() })
}

fn circle() -> Vec<Vec3> {
    let point = |degree: i32| {
        let (sin, cos) = f64::from(degree).to_radians().sin_cos();
        Vec3::new(25.0 * cos, 25.0 * sin, 0.0)
    };
    (0..360).map(point).collect()
}

/// Relative L² error of E_z.
fn error(fields: &[Field], expected: &[Complex64]) -> f64 {
    let pairs = || fields.iter().zip(expected);
    let gap: f64 = pairs().map(|(field, e)| (field.e.components()[2] - e).norm_sqr()).sum();
    (gap / expected.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt()
}

fn mie(radius: f64, wave: &Wave, points: &[Vec3]) -> Result<Vec<Complex64>, Box<dyn Error>> {
    let (ball, source) = (ConductingSphere::new(radius)?, PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into())?);
    Ok(points.iter().map(|&p| ball.scattered(wave, &source, p).components()[2]).collect())
}

fn spheres() -> Done {
    let (wave, points) = (Wave::new(1e9)?, circle());
    println!("radius  facets  equation    error    order  iterations  seconds");
    for (radius, edges) in [(1.0, [0.36, 0.18, 0.09]), (3.0, [0.48, 0.24, 0.16])] {
        let radius = radius * wave.wavelength();
        let expected = mie(radius, &wave, &points)?;
        for shadow in EQUATIONS {
            let mut before: Option<(f64, f64)> = None;
            for edge in edges {
                let ball = sphere(radius, edge * wave.wavelength())?;
                let answer = solve(&ball, wave, shadow, &points)?;
                let (facets, error) = (ball.facets().len() as f64, error(&answer.fields, &expected));
                let order = before.map_or(f64::NAN, |(n, e)| 2.0 * (e / error).ln() / (facets / n).ln());
                before = Some((facets, error));
                let Answer { iterations, seconds, .. } = answer;
                let (radius, name) = (radius / wave.wavelength(), shadow.name());
                println!(
                    "{radius:>5}λ {facets:>7}  {name:<10} {error:>7.5} {order:>8.2} {iterations:>11} {seconds:>8.1}"
                );
            }
        }
    }
    Ok(())
}

/// Physical optics of a sphere in closed form, with or without what its currents' end at the shadow
/// line radiates: σ/(πa²) = |1 + j/(2x) − j e^{−2jx}/(2x)|², the last term being that of the end.
fn optics(x: f64, with_end: f64) -> f64 {
    let end = Complex64::cis(-2.0 * x) * (0.5 / x * with_end);
    (Complex64::ONE + Complex64::I * (0.5 / x) - Complex64::I * end).norm_sqr()
}

fn decibel(ratio: f64) -> f64 {
    10.0 * ratio.log10()
}

fn backscatter() -> Done {
    println!("dB over the series:\n  ka  physical optics  specular part   exact  exact-dual");
    let given = std::env::args().skip(2).map(|ka| ka.parse()).collect::<Result<Vec<f64>, _>>()?;
    let usual = vec![5.0, 5.5, 6.0, 6.5, 7.0, 8.0, 10.0, 12.0, 15.0];
    for ka in if given.is_empty() { usual } else { given } {
        let wave = Wave::new(ka * SPEED_OF_LIGHT / TAU)?;
        let series = ConductingSphere::new(1.0)?.backscatter(&wave);
        let ball = sphere(1.0, wave.wavelength() / 8.0)?;
        let mut errors = Vec::new();
        for shadow in EQUATIONS {
            let back = solve(&ball, wave, shadow, &[])?.back;
            errors.push(decibel(cross_section(back, 1.0.into()) / PI / series));
        }
        let [with, without] = [1.0, 0.0].map(|end| decibel(optics(ka, end) / series));
        println!("{ka:>4} {with:>16.2} {without:>14.2} {:>7.3} {:>11.3}", errors[0], errors[1]);
    }
    let worst = |from: f64, with_end: f64| -> Result<f64, Box<dyn Error>> {
        let mut worst = 0.0_f64;
        for step in 0..500 {
            let ka = from * (1.0 + 1e-3 * f64::from(step));
            let series = ConductingSphere::new(1.0)?.backscatter(&Wave::new(ka * SPEED_OF_LIGHT / TAU)?);
            worst = worst.max(decibel(optics(ka, with_end) / series).abs());
        }
        Ok(worst)
    };
    println!("largest in closed form over half as much again from ka:");
    for ka in [5.0, 10.0, 20.0, 30.0, 40.0, 55.0] {
        println!("{ka:>4} {:>16.2} {:>14.2}", worst(ka, 1.0)?, worst(ka, 0.0)?);
    }
    Ok(())
}

/// The column `mom` of the stored reference of the cube.
fn cube_reference() -> Result<Vec<Complex64>, Box<dyn Error>> {
    let text = std::fs::read_to_string("tests/data/wave/cube_5lambda_normal.csv")?;
    let value = |line: &str| {
        let numbers = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        Ok(Complex64::new(numbers[1], numbers[2]))
    };
    text.lines().skip(1).map(value).collect()
}

fn resonance() -> Done {
    let points = circle();
    println!(
        "sphere, λ/10: error against the series (iterations)\n    ka  {:>16}  {:>16}",
        "exact", "exact-dual"
    );
    for ka in [4.2, 4.4, 4.47, 4.4934, 4.52, 4.6, 4.8] {
        let wave = Wave::new(ka * SPEED_OF_LIGHT / TAU)?;
        let (ball, expected) = (sphere(1.0, wave.wavelength() / 10.0)?, mie(1.0, &wave, &points)?);
        print!("{ka:>6}");
        for shadow in EQUATIONS {
            let answer = solve(&ball, wave, shadow, &points)?;
            print!("  {:>10.4} ({:>3})", error(&answer.fields, &expected), answer.iterations);
        }
        println!();
    }
    let wavelength = Wave::new(1e9)?.wavelength();
    println!(
        "cube of 5λ at 1 GHz, λ/6: largest |E| inside, V/m (iterations); error against the method of moments"
    );
    let body = cube(5.0 * wavelength, wavelength / 6.0)?;
    let inside =
        [Vec3::ZERO, Vec3::new(0.31, 0.22, 0.13), Vec3::new(-0.2, 0.4, -0.35), Vec3::new(0.1, -0.45, 0.4)];
    let reference = cube_reference()?;
    for megahertz in [985.0, 995.0, 1000.0, 1005.0, 1015.0] {
        let wave = Wave::new(megahertz * 1e6)?;
        let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into())?;
        print!("{megahertz:>6}");
        for shadow in EQUATIONS {
            let all: Vec<Vec3> = inside.iter().chain(&points).copied().collect();
            let answer = solve(&body, wave, shadow, &all)?;
            let (within, around) = answer.fields.split_at(inside.len());
            let totals =
                within.iter().zip(inside).map(|(field, p)| (field.e + source.field(&wave, p).e).norm());
            print!("  {:>8.3} ({:>3})", totals.fold(0.0, f64::max), answer.iterations);
            if (megahertz - 1000.0).abs() < 1e-9 {
                print!(" {:.4}", error(around, &reference));
            }
        }
        println!();
    }
    Ok(())
}

fn main() -> Done {
    match std::env::args().nth(1).as_deref() {
        Some("spheres") => spheres(),
        Some("backscatter") => backscatter(),
        Some("resonance") => resonance(),
        _ => Err("ask for spheres, backscatter or resonance".into()),
    }
}
