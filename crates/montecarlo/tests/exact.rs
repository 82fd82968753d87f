//! Every estimator of light against closed forms: means, and the distribution of their scores over
//! many seeds.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod common;

use common::{SQUARES, furnace, method, run, samples, single, sphere, squares, whole};
use fredholm_linop::Quiet;
use fredholm_mesh::{Patch, Vec3};
use fredholm_montecarlo::light::pixels::{PixelSampling, pixel};
use fredholm_montecarlo::light::{
    Control, Estimator, METHODS, PIXEL_METHODS, PathTracing, ResidualShooting, Switches, point_estimator,
};
use fredholm_montecarlo::points::PointSet;
use fredholm_montecarlo::statistics::{Suite, normal_score};
use fredholm_montecarlo::{Enclosure, Groups};

/// A scene and the exact mean irradiance of its group 0.
struct Case {
    name: &'static str,
    scene: Enclosure,
    groups: fn(&Enclosure) -> Groups,
    exact: f64,
    patchwise: bool,
}

impl Case {
    fn methods(&self) -> impl Iterator<Item = &'static str> {
        METHODS.into_iter().filter(|name| !self.patchwise || method(name, &self.scene).patchwise())
    }
}

fn cases() -> Vec<Case> {
    let mirrored = SQUARES / (1.0 - 0.64 * SQUARES * SQUARES);
    vec![
        // B = M/(1 − ρ), E = B.
        Case { name: "furnace", scene: furnace(0.5), groups: whole, exact: 2.0, patchwise: false },
        // E = F M.
        Case { name: "squares", scene: squares(0.0), groups: single, exact: SQUARES, patchwise: false },
        // E = F (M + ρ F ρ E), one constant a square.
        Case { name: "mirrored", scene: squares(0.8), groups: single, exact: mirrored, patchwise: true },
        // All that is emitted is absorbed: Σ A E (1 − ρ) = Σ A M, half of the area emitting 1.
        Case { name: "sphere", scene: sphere(0.6, 5), groups: whole, exact: 0.5 / 0.4, patchwise: false },
    ]
}

/// Scores of the first group over seeds.
fn scores(case: &Case, name: &str, seeds: u64) -> Vec<f64> {
    let estimator = method(name, &case.scene);
    let samples = samples(&*estimator, &case.scene, 8);
    let score = |seed: u64| {
        let state = run(&case.scene, &*estimator, (case.groups)(&case.scene), (seed, samples, 32));
        let (mean, error) = (state.groups.mean()[0], state.groups.standard_errors()[0]);
        normal_score((mean - case.exact) / error, 31.0)
    };
    (0..seeds).map(score).collect()
}

fn check(seeds: u64, level: f64) {
    for case in cases() {
        for name in case.methods() {
            let scores = scores(&case, name, seeds);
            let (suite, shape) = (Suite::new(&scores), Suite::shape_p(&scores));
            println!(
                "{:8} {name:15} mean {:+.3} (p {:.3}), variance {:.3} (p {:.3}), shape p {shape:.3}",
                case.name, suite.mean, suite.mean_p, suite.variance, suite.variance_p
            );
            assert!(suite.mean_p > level && suite.variance_p > level, "{} {name}", case.name);
        }
    }
}

#[test]
fn scores_over_seeds_have_mean_0_and_variance_1() {
    check(10, 1e-4);
}

/// The whole: `cargo test --release -p fredholm-montecarlo --test exact -- --ignored --nocapture`.
#[test]
#[ignore = "a thousand seeds take minutes"]
fn scores_over_a_thousand_seeds_have_mean_0_and_variance_1() {
    check(1000, 1e-3);
}

#[test]
fn means_are_within_three_standard_errors_of_the_exact_values() {
    for case in cases() {
        for name in case.methods() {
            let estimator = method(name, &case.scene);
            let samples = samples(&*estimator, &case.scene, 32);
            let state = run(&case.scene, &*estimator, (case.groups)(&case.scene), (1, samples, 64));
            let (mean, error) = (state.groups.mean()[0], state.groups.standard_errors()[0]);
            let exact = case.exact;
            println!("{:8} {name:15} {mean:.6} ± {error:.1e}, exact {exact:.6}", case.name);
            assert!((mean - exact).abs() < 3.0 * error && error < 0.03 * exact, "{} {name}", case.name);
        }
    }
}

/// B = M/(1 − ρ) through every pixel of a furnace, here half of each: the mean of many pixels
/// within their errors, and the scores of the single ones with variance near 1. Their mean is below
/// 0, as that of every t of a skewed quantity such as the length of paths.
#[test]
fn pixels_show_the_radiosity_within_their_errors() {
    let scene = furnace(0.5);
    for name in PIXEL_METHODS {
        let estimator = point_estimator(name, Switches::default()).unwrap();
        let half = |patch: usize, [u, v]: [f64; 2]| (u < 0.5).then(|| scene.point(patch, [2.0 * u, v]));
        let difference = |number: u32| {
            let see = |place| half(number as usize % scene.len(), place);
            let sampling = PixelSampling { seed: 3, batches: 32, samples: 4 };
            let found = pixel(&scene, &*estimator, number, sampling, &see);
            assert!((found.covered - 0.5).abs() < 1e-12 && found.standard_error[0] < 0.2, "{found:?}");
            [found.radiosity[0] - 0.5 * 2.0, found.standard_error[0]]
        };
        let all: Vec<[f64; 2]> = (0..4000).map(difference).collect();
        let (sum, square) = all.iter().fold((0.0, 0.0), |(sum, square), [d, s]| (sum + d, square + s * s));
        let together = sum / f64::sqrt(square);
        let suite = Suite::new(&all.iter().map(|[d, s]| normal_score(d / s, 31.0)).collect::<Vec<f64>>());
        println!("{name:15} all {together:+.2}, mean {:+.3}, variance {:.3}", suite.mean, suite.variance);
        assert!(
            together.abs() < 3.0 && (0.8..1.25).contains(&suite.variance),
            "{name}: {together} {suite:?}"
        );
    }
}

/// Two reflecting squares: with the solution of one constant a square as control variate, paths
/// tell what the discretisation missed, with less noise than without.
#[test]
fn a_control_variate_changes_no_mean_and_takes_noise_away() {
    let scene = squares(0.8);
    let below = SQUARES / (1.0 - 0.64 * SQUARES * SQUARES);
    let control = Control::new(&scene, (vec![below, 0.8 * SQUARES * below], &[1.0; 2]), false).unwrap();
    let traced = |estimator: &dyn Estimator, seed| {
        let state = run(&scene, estimator, single(&scene), (seed, 64, 4000));
        [state.groups.mean().to_vec(), state.groups.standard_errors()]
    };
    let plain = PathTracing::continuous(Switches::default());
    let [known, error] = traced(&plain, 1);
    let shooting = ResidualShooting::new(&scene, control, Switches::default());
    let shooting = shooting.shared_out(&scene, &single(&scene), (2, PointSet::Sobol), &Quiet);
    let [found, less] = traced(&shooting, 2);
    for square in 0..2 {
        let z = (found[square] - known[square]) / error[square].hypot(less[square]);
        println!(
            "square {square}: {:.6} ± {:.1e} with, {:.6} ± {:.1e} without, z = {z:+.2}",
            found[square], less[square], known[square], error[square]
        );
        assert!(z.abs() < 3.5, "{z}");
        assert!(less[square] < 0.75 * error[square], "{} {}", less[square], error[square]);
    }
    // The upper one gets its light by way of the lower one, more of it than constants say.
    assert!(found[1] > 0.8 * SQUARES * below + 3.5 * less[1]);
}

/// What lies on a patch: its mean is taken from the paths, whatever the control variate says of it,
/// since a solution knows nothing of the light that rays meet from under there.
#[test]
fn a_control_variate_decides_nothing_where_another_patch_lies() {
    let known = squares(0.8);
    let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0);
    let turned = [corner(0.0, 0.0), corner(0.0, 1.0), corner(0.5, 1.0), corner(0.5, 0.0)];
    let mut patches = known.patches().to_vec();
    patches.push(Patch::quad(turned).unwrap().unwrap());
    let scene = Enclosure::new(patches, 1, vec![0.8, 0.8, 0.0], vec![0.0, 1.0, 0.0]).unwrap();
    let below = 0.5 * SQUARES;
    let control = Control::new(&scene, (vec![below, 0.8 * SQUARES * below, 0.0], &[1.0; 3]), false).unwrap();
    let controlled = ResidualShooting::new(&scene, control, Switches::default());
    let plain = PathTracing::continuous(Switches::default());
    let traced = |estimator: &dyn Estimator, seed| {
        let state = run(&scene, estimator, single(&scene), (seed, 64, 2000));
        (state.groups.mean()[0], state.groups.standard_errors()[0])
    };
    let ((a, s), (b, t)) = (traced(&plain, 1), traced(&controlled, 2));
    println!("{b:.6} ± {t:.1e} with, {a:.6} ± {s:.1e} without");
    assert!((a - b).abs() < 3.5 * s.hypot(t) && t < 0.01 * a, "{a} ± {s}, {b} ± {t}");
}
