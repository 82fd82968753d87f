//! What is compared: the irradiance of every face, of every surface and of the whole, in every
//! band.
//!
//! A surface or the whole averages over many paths, so that deviations are found there that no face
//! shows by itself. Its stated error is the root mean square of those of its faces, which is what
//! the error of a mean is at most.

use fredholm_mesh::Mesh;
use fredholm_montecarlo::light::Estimator;
use fredholm_montecarlo::{Enclosure, Groups, State};

use crate::error::Error;
use crate::problem::Problem;
use crate::stochastic::failure;

/// Faces, then surfaces, then the whole, each with its bands.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    bands: usize,
    surface_of: Vec<usize>,
    /// m².
    areas: Vec<f64>,
    surfaces: usize,
}

/// A place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Face(usize),
    Surface(usize),
    Whole,
}

impl Places {
    pub(super) fn new(problem: &Problem) -> Self {
        let (mesh, bands) = (&problem.mesh, problem.scene.bands().len());
        let surface_of = mesh.faces().iter().map(|face| face.surface).collect();
        let areas = mesh.faces().iter().map(|face| face.area).collect();
        Self { bands, surface_of, areas, surfaces: mesh.surfaces().len() }
    }

    /// Places of these areas (of any unit), each on one of so many surfaces.
    pub(crate) fn of(bands: usize, (surface_of, surfaces): (Vec<usize>, usize), areas: Vec<f64>) -> Self {
        Self { bands, surface_of, areas, surfaces }
    }

    /// The same groups of the elements that are traced, whose faces are the same.
    pub(super) fn groups(&self, mesh: &Mesh, scene: &Enclosure) -> Result<Groups, Error> {
        let all = || 0..mesh.len();
        Groups::new(scene, all().map(|leaf| mesh.face_of(leaf)).collect(), self.faces())
            .and_then(|groups| {
                groups.and(scene, all().map(|leaf| mesh.surface_of(leaf)).collect(), self.surfaces)
            })
            .and_then(|groups| groups.and(scene, vec![0; mesh.len()], 1))
            .map_err(failure)
    }

    fn faces(&self) -> usize {
        self.areas.len()
    }

    /// Numbers of faces and bands: what stands before surfaces and the whole.
    pub(crate) fn of_faces(&self) -> usize {
        self.faces() * self.bands
    }

    /// Place and band of a number.
    pub(crate) fn at(&self, index: usize) -> (Place, usize) {
        let (number, band) = (index / self.bands, index % self.bands);
        let place = match number.checked_sub(self.faces()) {
            None => Place::Face(number),
            Some(surface) if surface < self.surfaces => Place::Surface(surface),
            Some(_) => Place::Whole,
        };
        (place, band)
    }

    /// Values of faces, followed by their means over surfaces and the whole.
    pub(crate) fn means(&self, faces: &[f64]) -> Vec<f64> {
        self.followed(faces, |x| x, |x| x)
    }

    /// Errors of faces, followed by their root mean squares.
    pub(crate) fn root_mean_squares(&self, faces: &[f64]) -> Vec<f64> {
        self.followed(faces, |x| x * x, f64::sqrt)
    }

    /// Errors of faces that have nothing to do with each other, followed by those of the means:
    /// √(Σ A² δ²)/Σ A.
    pub(crate) fn independent(&self, faces: &[f64]) -> Vec<f64> {
        let of = |face: usize| self.areas[face];
        let weighed: Vec<f64> =
            faces.iter().enumerate().map(|(at, error)| error * of(at / self.bands).sqrt()).collect();
        let roots = self.root_mean_squares(&weighed);
        let areas = self.all_areas();
        let mean = |(at, root): (usize, &f64)| match areas[at / self.bands] {
            area if at >= faces.len() && area > 0.0 => root / area.sqrt(),
            _ => *root,
        };
        let mut errors: Vec<f64> = roots.iter().enumerate().map(mean).collect();
        errors[..faces.len()].copy_from_slice(faces);
        errors
    }

    /// What one path brings, W/m²: the emitted power of the band over all paths. Nothing is known
    /// of methods that gather.
    pub(super) fn single(&self, scene: &Enclosure, state: &State, method: &dyn Estimator) -> Vec<f64> {
        let mut power = vec![0.0; self.bands];
        if !method.gathers() {
            for (i, patch) in scene.patches().iter().enumerate() {
                let emitted = power.iter_mut().zip(scene.exitance(i));
                emitted.for_each(|(sum, exitance)| *sum += exitance * patch.area());
            }
        }
        let paths = state.paths.max(1) as f64;
        self.all_areas()
            .iter()
            .flat_map(|area| power.iter().map(move |power| power / (paths * area)))
            .collect()
    }

    /// Largest errors of means, W/m², where only √(Σ A δ²) is stated, in W/m: all of it may be the
    /// error of one place.
    pub(super) fn of_norms(&self, norms: &[f64]) -> Vec<f64> {
        self.all_areas().iter().flat_map(|area| norms.iter().map(move |norm| norm / area.sqrt())).collect()
    }

    /// √(Σ A x²) over the faces, per band.
    pub(super) fn norms(&self, faces: &[f64]) -> Vec<f64> {
        let mut squares = vec![0.0; self.bands];
        for (row, area) in faces.chunks(self.bands).zip(&self.areas) {
            squares.iter_mut().zip(row).for_each(|(sum, x)| *sum += area * x * x);
        }
        squares.into_iter().map(f64::sqrt).collect()
    }

    /// Areas of faces, surfaces and the whole, m².
    fn all_areas(&self) -> Vec<f64> {
        let mut areas = self.areas.clone();
        areas.extend((0..self.surfaces).map(|surface| self.area_of(surface)));
        areas.push(self.areas.iter().sum());
        areas
    }

    fn area_of(&self, surface: usize) -> f64 {
        let own = self.surface_of.iter().zip(&self.areas).filter(|(of, _)| **of == surface);
        own.map(|(_, area)| area).sum()
    }

    fn followed(&self, faces: &[f64], to: fn(f64) -> f64, back: fn(f64) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; (self.surfaces + 1) * self.bands];
        let mut areas = vec![0.0; self.surfaces + 1];
        for (face, row) in faces.chunks(self.bands).enumerate() {
            let area = self.areas[face];
            for level in [self.surface_of[face], self.surfaces] {
                areas[level] += area;
                let sums = sums[level * self.bands..].iter_mut();
                sums.zip(row).for_each(|(sum, &value)| *sum += area * to(value));
            }
        }
        let mean = |(at, sum): (usize, &f64)| {
            let area = areas[at / self.bands];
            if area > 0.0 { back(sum / area) } else { 0.0 }
        };
        faces.iter().copied().chain(sums.iter().enumerate().map(mean)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_means_are_those_of_independent_or_of_common_errors() {
        let places = Places::of(1, (vec![0, 0, 1], 2), vec![1.0, 3.0, 4.0]);
        let (errors, close) = ([0.4, 0.2, 0.1], |a: &[f64], b: [f64; 6]| {
            a.len() == 6 && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15)
        });
        // √(0.4² + (3 × 0.2)²)/4, 0.1, and √(0.4² + (3 × 0.2)² + (4 × 0.1)²)/8.
        let [first, whole] = [0.52_f64.sqrt() / 4.0, 0.68_f64.sqrt() / 8.0];
        assert!(close(&places.independent(&errors), [0.4, 0.2, 0.1, first, 0.1, whole]));
        // √((0.4² + 3 × 0.2²)/4), and √((0.4² + 3 × 0.2² + 4 × 0.1²)/8).
        let [first, whole] = [0.07_f64.sqrt(), 0.04_f64.sqrt()];
        assert!(close(&places.root_mean_squares(&errors), [0.4, 0.2, 0.1, first, 0.1, whole]));
        assert!(close(&places.means(&[8.0, 4.0, 1.0]), [8.0, 4.0, 1.0, 5.0, 1.0, 3.0]));
    }
}
