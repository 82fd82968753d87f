//! Irradiances by particle tracing, which shares no more with the links than the rays.

use super::common::Bench;
use fredholm_hierarchical::Solution;
use fredholm_linop::Quiet;
use fredholm_mesh::{Patch, Vec3};
use fredholm_montecarlo::light::{Switches, estimator};
use fredholm_montecarlo::{Enclosure, Groups, Stop, Tracing};

/// Particles of a batch.
const BATCH: u32 = 1 << 16;

/// Faces put together: those of the last surface by where they lie about its middle and whether
/// they look up, those of a wall each by itself or all to one.
pub struct Parts {
    pub of: Vec<usize>,
    pub count: usize,
}

impl Parts {
    pub fn of(bench: &Bench, whole_walls: bool) -> Self {
        let faces = bench.mesh.faces();
        let object = bench.mesh.surfaces().len() - 1;
        let cells = faces.iter().filter(|face| face.surface != object).count();
        let walls = if whole_walls { object } else { cells };
        let mut of = vec![0; faces.len()];
        for (k, patch) in bench.mesh.patches().enumerate() {
            let face = bench.mesh.face_of(k);
            of[face] = match faces[face].surface {
                surface if surface == object => walls + sector(patch),
                surface if whole_walls => surface,
                _ => face,
            };
        }
        Self { of, count: walls + 16 }
    }

    /// Areas, m².
    pub fn areas(&self, bench: &Bench) -> Vec<f64> {
        let mut areas = vec![0.0; self.count];
        bench.mesh.faces().iter().zip(&self.of).for_each(|(face, &part)| areas[part] += face.area);
        areas
    }

    /// Means of a solution of one band, W/m².
    pub fn solved(&self, bench: &Bench, solution: &Solution) -> Vec<f64> {
        let (mut means, areas) = (vec![0.0; self.count], self.areas(bench));
        for ((face, e), &part) in bench.mesh.faces().iter().zip(bench.faces(solution)).zip(&self.of) {
            means[part] += e * face.area / areas[part];
        }
        means
    }

    /// Means by tracing and their standard errors, W/m².
    pub fn traced(&self, bench: &Bench, batches: u64) -> [Vec<f64>; 2] {
        let patches: Vec<Patch> = bench.mesh.patches().copied().collect();
        let of = (0..patches.len()).map(|k| self.of[bench.mesh.face_of(k)]).collect();
        let [reflectance, exitance] = [&bench.surfaces.reflectance, &bench.surfaces.exitance];
        let values = |values: &fredholm_linop::MultiVector<f64>| values.as_slice().to_vec();
        let scene = Enclosure::new(patches, 1, values(reflectance), values(exitance)).unwrap();
        let particles = estimator("light", &scene, Switches::default()).unwrap();
        let groups = Groups::new(&scene, of, self.count).unwrap();
        let tracing = Tracing::new(&scene, &*particles, groups, 1, BATCH).unwrap();
        let mut state = tracing.start();
        let stop = Stop { batches: Some(batches), ..Stop::default() };
        tracing.go_on(&mut state, &stop, &Quiet).unwrap();
        [state.groups.mean().to_vec(), state.groups.standard_errors()]
    }
}

/// One of sixteen.
fn sector(patch: &Patch) -> usize {
    let (Vec3 { x, y, z }, n) = (patch.centroid(), patch.normal());
    [x > 0.0, y > 0.0, z > 0.0, n.z > 0.0].iter().fold(0, |number, &bit| 2 * number + usize::from(bit))
}
