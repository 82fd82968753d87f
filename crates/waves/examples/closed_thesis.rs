//! The thesis's model of closed bodies, read in two ways, against the stored columns (relative L²
//! error of E_z on the circle, one bounce, λ/20): lit facets that radiate to both sides, n turned
//! to the observer (`method = "thesis"`), and all facets, each into its own front half-space only
//! (huygens_f_vol of G. Viennot, thesis, Limoges 2012).
//! `cargo run --release -p fredholm-waves --example closed_thesis`, from the repository.

use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, sphere};
use fredholm_waves::{
    Complex64, Field, PhysicalOptics, Sampling, Scatterer, Shadow, Source, Wave, magnetic_element,
};
use std::error::Error;

/// Columns of the exact answer and of the model, E_z.
fn columns(name: &str) -> Result<[Vec<Complex64>; 2], Box<dyn Error>> {
    let text = std::fs::read_to_string(format!("tests/data/wave/{name}"))?;
    let (mut exact, mut model) = (Vec::new(), Vec::new());
    for line in text.lines().skip(1) {
        let numbers = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        exact.push(Complex64::new(numbers[1], numbers[2]));
        model.push(Complex64::new(numbers[3], numbers[4]));
    }
    Ok([exact, model])
}

/// All facets, each to its front.
fn fronts(body: &Scatterer, wave: Wave, source: &dyn Source, p: Vec3) -> Field {
    let seen = body.facets().iter().filter(|facet| facet.normal.dot(p - facet.centre) > 0.0);
    let term = |facet: &fredholm_waves::Facet| {
        let moment = source.field(&wave, facet.centre).e.crossed_by(facet.normal) * (2.0 * facet.area);
        magnetic_element(&wave, moment, p - facet.centre)
    };
    seen.map(term).sum()
}

fn error(fields: &[Field], expected: &[Complex64]) -> f64 {
    let gap: f64 = fields.iter().zip(expected).map(|(f, e)| (f.e.components()[2] - e).norm_sqr()).sum();
    (gap / expected.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt()
}

fn main() -> Result<(), Box<dyn Error>> {
    let wave = Wave::new(1e9)?;
    let (wavelength, source) = (wave.wavelength(), PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into())?);
    let circle: Vec<Vec3> = (0..360)
        .map(|degree| f64::from(degree).to_radians().sin_cos())
        .map(|(sin, cos)| Vec3::new(25.0 * cos, 25.0 * sin, 0.0))
        .collect();
    println!("body    reading             against poM  against the exact answer");
    let bodies = [
        ("cube  ", "cube_5lambda_normal.csv", cube(5.0 * wavelength, wavelength / 20.0)?),
        ("sphere", "sphere_1lambda.csv", sphere(wavelength, wavelength / 20.0)?),
    ];
    for (name, file, body) in &bodies {
        let [exact, model] = columns(file)?;
        let sources: [&dyn Source; 1] = [&source];
        let lit = PhysicalOptics::new(body, wave, &sources, Shadow::Thesis)?;
        let lit = lit.radiator(Sampling::Midpoint).fields(&circle)?;
        let fronts: Vec<Field> = circle.iter().map(|&p| fronts(body, wave, &source, p)).collect();
        for (reading, fields) in [("lit, both sides", &lit), ("all, to their front", &fronts)] {
            println!("{name}  {reading:<19} {:>11.4} {:>25.4}", error(fields, &model), error(fields, &exact));
        }
    }
    Ok(())
}
