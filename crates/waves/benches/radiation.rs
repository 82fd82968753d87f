//! Source × receiver interactions of the radiation integral (E and H, all terms, f64) on one
//! thread: vectorised, and the plain formula in the same run. `cargo bench -p fredholm-waves`; the
//! throughput is in interactions.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::plate;
use fredholm_waves::{
    ComplexVector, Field, PhysicalOptics, Sampling, Shadow, Source, SurfaceCurrent, Wave, WaveError,
    electric_element,
};
use std::hint::black_box;

/// Receivers of the vectorised and of the plain sum.
const POINTS: [usize; 2] = [2048, 128];

fn points() -> Vec<Vec3> {
    let point = |i: usize| Vec3::new((i % 64) as f64, -25.0, (i / 64) as f64) * 0.5;
    (0..POINTS[0]).map(point).collect()
}

fn measure(criterion: &mut Criterion) -> Result<(), WaveError> {
    let wave = Wave::new(1e9)?;
    let scatterer = plate(5.0 * wave.wavelength(), wave.wavelength() / 20.0)?;
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into())?;
    let sources: [&dyn Source; 1] = [&source];
    let optics = PhysicalOptics::new(&scatterer, wave, &sources, Shadow::Geometric)?;
    let (radiator, points) = (optics.radiator(Sampling::Midpoint), points());
    let moments: Vec<(Vec3, ComplexVector)> = (scatterer.facets().iter().enumerate())
        .map(|(i, facet)| (facet.centre, optics.at(i, facet.centre).j * facet.area))
        .collect();
    let mut group = criterion.benchmark_group("radiation");
    group.sample_size(20);
    group.throughput(Throughput::Elements((points.len() * radiator.elements()) as u64));
    group.bench_function("vectorised", |bench| bench.iter(|| radiator.fields(black_box(&points))));
    group.throughput(Throughput::Elements((POINTS[1] * moments.len()) as u64));
    group.bench_function("plain", |bench| {
        let field = |p: &Vec3| -> Field {
            moments.iter().map(|&(q, moment)| electric_element(&wave, moment, *p - q)).sum()
        };
        bench.iter(|| points[..POINTS[1]].iter().map(field).sum::<Field>());
    });
    group.finish();
    Ok(())
}

fn radiation(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
    if let Err(error) = measure(criterion) {
        eprintln!("nothing measured: {error}");
    }
    // A pool that another benchmark has made would use more threads.
    assert!(pool.is_ok(), "the measurement is for one thread");
}

criterion_group!(benches, radiation);
criterion_main!(benches);
