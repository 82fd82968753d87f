//! Source × receiver interactions per second of the radiation integral (E and H, all terms, f64),
//! on one thread, beside the plain scalar formula:
//! `cargo run --release -p fredholm-waves --example radiation_rate`.

use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::plate;
use fredholm_waves::{
    ComplexVector, Field, PhysicalOptics, Sampling, Shadow, Source, SurfaceCurrent, Wave, electric_element,
};
use std::hint::black_box;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let wave = Wave::new(1e9)?;
    let scatterer = plate(5.0 * wave.wavelength(), wave.wavelength() / 20.0)?;
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into())?;
    let sources: [&dyn Source; 1] = [&source];
    let optics = PhysicalOptics::new(&scatterer, wave, &sources, Shadow::Geometric)?;
    let radiator = optics.radiator(Sampling::Midpoint);
    let point = |i: u32| Vec3::new(f64::from(i % 64), -25.0, f64::from(i / 64)) * 0.5;
    let points: Vec<Vec3> = (0..4096).map(point).collect();

    let start = Instant::now();
    black_box(radiator.fields(&points)?);
    let vectorised = (points.len() * radiator.elements()) as f64 / start.elapsed().as_secs_f64();

    let moments: Vec<(Vec3, ComplexVector)> = (scatterer.facets().iter().enumerate())
        .map(|(i, facet)| (facet.centre, optics.at(i, facet.centre).j * facet.area))
        .collect();
    let start = Instant::now();
    for &p in &points[..256] {
        let sum: Field = moments.iter().map(|&(q, moment)| electric_element(&wave, moment, p - q)).sum();
        black_box(sum);
    }
    let scalar = (256 * moments.len()) as f64 / start.elapsed().as_secs_f64();
    println!("vectorised {:.1} million interactions/s, scalar {:.1}", vectorised / 1e6, scalar / 1e6);
    Ok(())
}
