//! Sampled fields against the radiation integral, one and two bounces.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use fredholm_mesh::Vec3;
use fredholm_montecarlo::waves::{
    Aim, AmplitudeParticles, Bounces, FieldEstimate, FieldEstimator, FieldParticles, Scattering,
    SurfaceSampling, estimate,
};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{cube, facing_plates, plate};
use fredholm_waves::{
    ComplexVector, Current, Gate, PhysicalOptics, Radiator, Sampling, Scatterer, Shadow, Source,
    SurfaceCurrent, Wave,
};

const PRECISE: Sampling = Sampling::Tolerance(1e-6);

/// A circle of radius 25 m in the plane z = 0.
fn circle(points: u32, turn: f64) -> Vec<Vec3> {
    let at = |i: u32| (360.0 * f64::from(i) / f64::from(points) + turn).to_radians().sin_cos();
    (0..points).map(|i| Vec3::new(25.0 * at(i).1, 25.0 * at(i).0, 0.0)).collect()
}

/// The first currents of the facets on one side of the plane x = 0, as they light the other side.
struct Half<'a> {
    scatterer: &'a Scatterer,
    optics: &'a PhysicalOptics<'a>,
    sign: f64,
}

impl SurfaceCurrent for Half<'_> {
    fn at(&self, facet: usize, q: Vec3) -> Current {
        if self.scatterer.facets()[facet].centre.x * self.sign > 0.0 {
            self.optics.at(facet, q)
        } else {
            Current::default()
        }
    }
}

/// J₁ + 2 n × H of the other half's first current, of two sheets that hide nothing from each other.
struct Twice<'a> {
    scatterer: &'a Scatterer,
    optics: &'a PhysicalOptics<'a>,
    halves: [Radiator<'a>; 2],
}

impl SurfaceCurrent for Twice<'_> {
    fn at(&self, facet: usize, q: Vec3) -> Current {
        let shape = &self.scatterer.facets()[facet];
        let other = usize::from(shape.centre.x < 0.0);
        let h = self.halves[other].fields(&[q]).unwrap()[0].h;
        // The other plate lies across the plane x = 0.
        let side = shape.side(Vec3::new(-2.0 * shape.centre.x, 0.0, 0.0));
        let first = self.optics.at(facet, q).j;
        Current { j: first + h.crossed_by(shape.normal * side) * 2.0, m: ComplexVector::ZERO }
    }
}

fn deterministic(
    scatterer: &Scatterer,
    optics: &PhysicalOptics<'_>,
    wave: Wave,
    bounces: Bounces,
    receivers: &[Vec3],
) -> Vec<ComplexVector> {
    let radiate = |current: &dyn SurfaceCurrent| {
        let fields = Radiator::new(scatterer, wave, current, Gate::Open, PRECISE).fields(receivers).unwrap();
        fields.iter().map(|field| field.e).collect()
    };
    if bounces == Bounces::One {
        return radiate(optics);
    }
    let [left, right] = [-1.0, 1.0].map(|sign| Half { scatterer, optics, sign });
    let halves = [&left, &right].map(|half| Radiator::new(scatterer, wave, half, Gate::Open, PRECISE));
    radiate(&Twice { scatterer, optics, halves })
}

/// ‖a − b‖/‖b‖ over the receivers.
fn distance(a: &[ComplexVector], b: &[ComplexVector]) -> f64 {
    let size: f64 = b.iter().map(|e| e.norm_squared()).sum();
    let gap: f64 = a.iter().zip(b).map(|(a, b)| (*a - *b).norm_squared()).sum();
    (gap / size).sqrt()
}

/// Σ |mean − exact|²/Σ s²: 1 where errors are what they are stated to be.
fn ratio(found: &FieldEstimate, exact: &[ComplexVector]) -> f64 {
    let stated: f64 = found.standard_errors().iter().map(|s| s * s).sum();
    let gap: f64 = found.mean().iter().zip(exact).map(|(a, b)| (*a - *b).norm_squared()).sum();
    gap / stated
}

/// A body in a wave along y, polarised along z.
fn with<R>(scatterer: &Scatterer, wave: Wave, work: impl FnOnce(&PhysicalOptics<'_>) -> R) -> R {
    let source = PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap();
    let sources: [&dyn Source; 1] = [&source];
    let optics = PhysicalOptics::new(scatterer, wave, &sources, Shadow::Geometric).unwrap();
    work(&optics)
}

fn bodies(wave: Wave) -> [(&'static str, Scatterer, Bounces); 3] {
    let (side, edge) = (5.0 * wave.wavelength(), 0.25 * wave.wavelength());
    [
        ("plate", plate(side, edge).unwrap(), Bounces::One),
        ("cube", cube(side, edge).unwrap(), Bounces::One),
        ("two plates", facing_plates(side, 2.0, edge).unwrap(), Bounces::Two),
    ]
}

/// Receivers that no plate is seen edge-on from.
fn receivers(bounces: Bounces) -> Vec<Vec3> {
    circle(12, if bounces == Bounces::One { 15.0 } else { 0.0 })
}

/// Samples of a batch, from few to many.
const SIZES: [u32; 4] = [16, 64, 256, 1024];
/// Independent runs of each size, whose squared errors are averaged.
const SEEDS: u64 = 2;

/// Slope of ln error against ln N by least squares.
fn slope(errors: &[f64]) -> f64 {
    let x: Vec<f64> = SIZES.iter().map(|&n| f64::from(n).ln()).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let y: Vec<f64> = errors.iter().map(|e| e.ln()).collect();
    let (a, b) = (mean(&x), mean(&y));
    let covariance: f64 = x.iter().zip(&y).map(|(x, y)| (x - a) * (y - b)).sum();
    covariance / x.iter().map(|x| (x - a).powi(2)).sum::<f64>()
}

/// Errors fall with the root of the number of samples, or faster where the order of the points
/// helps; they are what is stated, and on the two plates small enough to say something.
#[test]
fn particles_and_surface_samples_converge_to_the_radiation_integral() {
    let wave = Wave::new(1e9).unwrap();
    let aims = [Aim::Lobe(None), Aim::Facets].map(FieldParticles::new);
    let methods: [(&str, &dyn FieldEstimator); 3] =
        [("surface", &SurfaceSampling), ("particles, lobe", &aims[0]), ("particles, facets", &aims[1])];
    for (name, scatterer, bounces) in bodies(wave) {
        let receivers = receivers(bounces);
        with(&scatterer, wave, |optics| {
            let exact = deterministic(&scatterer, optics, wave, bounces, &receivers);
            let problem = Scattering::new(&scatterer, optics, wave, bounces).unwrap();
            for (method, estimator) in methods {
                let (mut errors, mut ratios) = (Vec::new(), Vec::new());
                for samples in SIZES {
                    let runs = (1..=SEEDS)
                        .map(|seed| estimate(&problem, estimator, &receivers, (seed, 32, samples)))
                        .map(|found| (distance(&found.mean(), &exact).powi(2), ratio(&found, &exact)));
                    let (square, sum) = runs.fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
                    errors.push((square / SEEDS as f64).sqrt());
                    ratios.push(sum / SEEDS as f64);
                }
                let slope = slope(&errors);
                println!(
                    "{name:10} {method:17} {errors:.4?}, over the stated {ratios:.1?}, slope {slope:.2}"
                );
                // Weights of a lobe are not bounded, and their standard errors less sure.
                let highest = if method == "particles, lobe" { 4.0 } else { 2.5 };
                assert!(ratios.iter().all(|&ratio| ratio < highest), "{name} {method}: {ratios:?}");
                assert!((-0.85..-0.35).contains(&slope), "{name} {method}: {slope}");
                let most = if method == "particles, lobe" { 0.2 } else { 0.05 };
                assert!(errors[3] < most, "{name} {method}: {errors:?}");
            }
        });
    }
}

/// Half a degree off the plane of a plate the particles burst, and the samples of the surface do
/// not.
#[test]
fn surface_samples_have_no_burst_in_the_plane_of_a_plate() {
    let wave = Wave::new(1e9).unwrap();
    let plate = plate(5.0 * wave.wavelength(), 0.25 * wave.wavelength()).unwrap();
    let receivers: Vec<Vec3> = circle(360, 0.5).into_iter().take(21).collect();
    with(&plate, wave, |optics| {
        let problem = Scattering::new(&plate, optics, wave, Bounces::One).unwrap();
        let spread = |method: &dyn FieldEstimator| {
            let errors = estimate(&problem, method, &receivers, (1, 64, 256)).standard_errors();
            // Half a degree beside the plane, over twenty.
            errors[0] / errors[20]
        };
        let (surface, particles) = (spread(&SurfaceSampling), spread(&FieldParticles::new(Aim::Lobe(None))));
        println!(
            "error beside the plane over that 20° off it: surface {surface:.2}, particles {particles:.1}"
        );
        assert!(surface < 2.0 && particles > 4.0 * surface);
    });
}

/// The three densities of the thesis, of equally many directions: what is aimed is worth more.
#[test]
fn densities_that_know_where_the_body_is_have_less_variance() {
    let wave = Wave::new(1e9).unwrap();
    let plate = plate(5.0 * wave.wavelength(), 0.25 * wave.wavelength()).unwrap();
    // Nearer than elsewhere, or the sphere would hardly hit.
    let receivers: Vec<Vec3> = circle(12, 15.0).iter().map(|p| *p * 0.2).collect();
    with(&plate, wave, |optics| {
        let exact = deterministic(&plate, optics, wave, Bounces::One, &receivers);
        let problem = Scattering::new(&plate, optics, wave, Bounces::One).unwrap();
        let errors = [Aim::Sphere, Aim::Cosine, Aim::Lobe(None), Aim::Facets].map(|aim| {
            let found = estimate(&problem, &FieldParticles::new(aim), &receivers, (1, 64, 1024));
            let (error, ratio) = (distance(&found.mean(), &exact), ratio(&found, &exact));
            println!("{aim:?}: {error:.2e}, error²/stated² {ratio:.2}");
            assert!(ratio < 2.5, "{aim:?}: {ratio}");
            error
        });
        assert!(
            errors[1] < errors[0] && errors[2] < 0.5 * errors[1] && errors[3] < 0.5 * errors[2],
            "{errors:?}"
        );
    });
}

/// The bias of merged impacts, on the plate, the cube and, with both bounces, the two plates.
#[test]
fn amplitude_particles_agree_up_to_the_size_of_their_cells() {
    let wave = Wave::new(1e9).unwrap();
    for (name, scatterer, bounces) in bodies(wave) {
        let receivers: Vec<Vec3> = receivers(bounces).into_iter().step_by(2).collect();
        // Every cell of the first impacts sends rays of its own.
        let samples = if bounces == Bounces::One { 8192 } else { 1024 };
        with(&scatterer, wave, |optics| {
            let exact = deterministic(&scatterer, optics, wave, bounces, &receivers);
            let problem = Scattering::new(&scatterer, optics, wave, bounces).unwrap();
            let errors = [0.4, 0.1].map(|radius| {
                let method = AmplitudeParticles::new(radius * wave.wavelength(), 16);
                let found = estimate(&problem, &method, &receivers, (1, 32, samples));
                let stated = found.standard_errors().iter().map(|s| s * s).sum::<f64>();
                let size = exact.iter().map(|e| e.norm_squared()).sum::<f64>();
                let (error, noise) = (distance(&found.mean(), &exact), (stated / size).sqrt());
                println!("{name:10} cells of {radius:.2} λ: {error:.3}, of which noise {noise:.3}");
                (error, noise)
            });
            // What is left is noise, where cells are small.
            assert!(errors[1].0 < 2.0 * errors[1].1 + 0.02, "{name}: {errors:?}");
        });
    }
}
