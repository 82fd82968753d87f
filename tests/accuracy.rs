//! Asking for twice the accuracy never makes form factors worse, on any of the shipped scenes.
//!
//! Worse: the largest error of a factor, or the root of their mean square, is larger at T/2 than at
//! T. Errors are against T = 1e-7, over a sample of the pairs of each scene, as parts of what
//! leaves the smaller patch.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use fredholm::coupling::form_factor::{Method, PairIntegrator, Workspace};
use fredholm::coupling::sample_pairs;
use fredholm::mesh::Mesh;
use fredholm::scene::Scene;
use fredholm::visibility::Occluders;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Tolerance of the first step; each next one is half as large.
const FIRST_TOLERANCE: f64 = 1e-2;
const STEPS: i32 = 8;
/// Tolerance of what counts as true.
const REFERENCE_TOLERANCE: f64 = 1e-7;
/// Pairs of each kind in a sample, and how many are looked at to find them.
const MOST_PAIRS: usize = 200;
const PAIRS_LOOKED_AT: usize = 4000;
/// As much of scenes of more patches, where a pair takes a hundred times as long.
const MANY_PATCHES: usize = 10_000;
const FEWER_PAIRS: usize = 12;
const FEWER_LOOKED_AT: usize = 500;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

/// Computes factors of a sample of the pairs of one mesh.
struct Sample<'a> {
    mesh: &'a Mesh,
    occluders: &'a Occluders,
    pairs: Vec<[usize; 2]>,
}

impl<'a> Sample<'a> {
    /// As many pairs with something between as pairs with nothing between, as far as a scene has
    /// them.
    fn new(mesh: &'a Mesh, occluders: &'a Occluders) -> Self {
        let integrator = PairIntegrator::new(mesh.patches(), occluders, FIRST_TOLERANCE);
        let mut work = Workspace::default();
        let (mut open, mut behind) = (Vec::new(), Vec::new());
        let [most, looked_at] = if mesh.len() > MANY_PATCHES {
            [FEWER_PAIRS, FEWER_LOOKED_AT]
        } else {
            [MOST_PAIRS, PAIRS_LOOKED_AT]
        };
        for [i, j] in sample_pairs(mesh.len()).take(looked_at) {
            match integrator.exchange(i, j, &mut work).method {
                Method::Hidden => {}
                Method::Gauss | Method::Contour => open.push([i, j]),
                Method::Clipped | Method::Sampled | Method::Segments => behind.push([i, j]),
            }
        }
        open.truncate(most);
        behind.truncate(most);
        Self { mesh, occluders, pairs: [open, behind].concat() }
    }

    /// What of the smaller patch's light goes to the other, to a tolerance.
    fn factors(&self, tolerance: f64) -> Vec<f64> {
        let integrator = PairIntegrator::new(self.mesh.patches(), self.occluders, tolerance);
        let factor = |work: &mut Workspace, &[i, j]: &[usize; 2]| {
            integrator.exchange(i, j, work).value / integrator.smaller_area(i, j)
        };
        self.pairs.par_iter().map_init(Workspace::default, factor).collect()
    }

    /// Largest error of a factor, and root of the mean square, at each step.
    fn errors(&self) -> Vec<[f64; 2]> {
        let exact = self.factors(REFERENCE_TOLERANCE);
        let error = |step| {
            let found = self.factors(FIRST_TOLERANCE * 0.5f64.powi(step));
            let errors = || found.iter().zip(&exact).map(|(found, exact)| (found - exact).abs());
            let squares: f64 = errors().map(|error| error * error).sum();
            [errors().fold(0.0, f64::max), (squares / exact.len() as f64).sqrt()]
        };
        (0..STEPS).map(error).collect()
    }
}

fn check(file: &Path) {
    let mesh = Scene::load(file).unwrap().mesh().unwrap();
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let sample = Sample::new(&mesh, &occluders);
    assert!(sample.pairs.len() >= FEWER_PAIRS, "{}: {} pairs", file.display(), sample.pairs.len());
    let errors = sample.errors();
    let shown: Vec<String> = errors.iter().map(|[largest, _]| format!("{largest:.1e}")).collect();
    println!("{}: {} pairs, errors {}", file.display(), sample.pairs.len(), shown.join(", "));
    for steps in errors.windows(2) {
        assert!((0..2).all(|k| steps[1][k] <= steps[0][k]), "{}: {errors:?}", file.display());
    }
}

#[test]
fn twice_the_accuracy_is_never_worse() {
    let files = scenes();
    assert!(files.len() >= 6, "{files:?}");
    files.par_iter().for_each(|file| check(file));
}
