//! Two plates at a right angle, bounce by bounce and then by GMRES, beside the stored method of
//! moments: relative L² error of the scattered E_z on the circle, with edge currents of the
//! incident wave in round brackets and of the bounces too in square ones (they complete the
//! electric form only). `cargo run --release -p fredholm-waves --example two_plates`, from the
//! repository.

use fredholm_iterative::Gmres;
use fredholm_linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::facing_plates;
use fredholm_waves::{Bounced, Complex64, EdgeCurrents, Field, PhysicalOptics, Shadow, Source, System, Wave};
use std::error::Error;

/// The column `mom` of the reference.
fn reference() -> Result<Vec<Complex64>, Box<dyn Error>> {
    let text = std::fs::read_to_string("tests/data/wave/two_plates_normal.csv")?;
    let value = |line: &str| {
        let numbers = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        Ok(Complex64::new(numbers[1], numbers[2]))
    };
    text.lines().skip(1).map(value).collect()
}

/// x by GMRES, to a residual of 1e-6.
fn all_bounces(
    system: &System<'_>,
    b: &MultiVector<Complex64>,
) -> Result<MultiVector<Complex64>, Box<dyn Error>> {
    let a = SecondKind::new(system.coupling(), MultiVector::from_fn(b.dim(), 1, |_, _| Complex64::ONE))?;
    let mut x = MultiVector::zeros(b.dim(), 1);
    let stop = Stop { tolerance: 1e-6, max_iterations: 100 };
    Solver::solve(&Gmres { restart: 30 }, &a, b, &mut x, &stop, &mut Quiet)?;
    Ok(x)
}

fn main() -> Result<(), Box<dyn Error>> {
    let wave = Wave::new(1e9)?;
    let plates = facing_plates(5.0 * wave.wavelength(), 2.0, wave.wavelength() / 10.0)?;
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into())?;
    let sources: [&dyn Source; 1] = [&source];
    let expected = reference()?;
    let circle: Vec<Vec3> = (0..360)
        .map(|degree| f64::from(degree).to_radians().sin_cos())
        .map(|(sin, cos)| Vec3::new(25.0 * cos, 25.0 * sin, 0.0))
        .collect();
    for shadow in [Shadow::Geometric, Shadow::Radiated, Shadow::Thesis] {
        let first = PhysicalOptics::new(&plates, wave, &sources, shadow)?;
        let system = System::lazy(&plates, wave, shadow)?;
        let b = system.right_hand_side(&[&first]);
        let mut x = b.clone();
        let edges = EdgeCurrents::new(&plates, wave, &sources)?.fields(&circle);
        let size: f64 = expected.iter().map(Complex64::norm_sqr).sum();
        let error = |fields: &[Field], with: f64| {
            let totals =
                fields.iter().zip(&edges).map(|(field, edge)| (*field + *edge * with).e.components()[2]);
            let gaps: f64 = totals.zip(&expected).map(|(ours, theirs)| (ours - theirs).norm_sqr()).sum();
            (gaps / size).sqrt()
        };
        print!("{:<10}", shadow.name());
        for _ in 1..=6 {
            let currents = Bounced::new(&plates, &first, &system.currents(&x, 0));
            let fields = system.radiator(&currents).fields(&circle)?;
            print!("  {:.4} ({:.4})", error(&fields, 0.0), error(&fields, 1.0));
            let mut product = MultiVector::zeros(x.dim(), 1);
            system.coupling().apply(&x, &mut product);
            x = MultiVector::from_fn(x.dim(), 1, |i, l| b.row(i)[l] + product.row(i)[l]);
        }
        let gmres = all_bounces(&system, &b)?;
        let currents = Bounced::new(&plates, &first, &system.currents(&gmres, 0));
        let fields = system.radiator(&currents).fields(&circle)?;
        print!("  gmres {:.4} ({:.4})", error(&fields, 0.0), error(&fields, 1.0));
        let bounced = EdgeCurrents::of_bounces(&plates, wave, &sources, &currents)?;
        let both: Vec<Field> =
            fields.iter().zip(bounced.fields(&circle)).map(|(&field, edge)| field + edge).collect();
        println!(" [{:.4}]", error(&both, 0.0));
    }
    Ok(())
}
