//! How far the field still moves with the mesh: an estimate of the discretisation error.
//!
//! With k × k elements a face, the same equations are solved a second time with one element a face (the coarse matrix is an exact sum of the fine
//! one). The error falls with the first power of the element size where light is cut by contact and shadow edges, with the second where it is
//! smooth; for the first power the fine error is |E_fine − E_coarse| / (k − 1), which is what is stated. In W/m².

use crate::radiosity::Extent;
use fredholm_linop::MultiVector;

/// Estimated discretisation error of the irradiance of faces, per band.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshError {
    /// √(Σ A δ² / Σ A E²), per band.
    pub relative_l2: Vec<f64>,
    /// Largest δ, W/m², per band.
    pub largest: Vec<f64>,
    /// δ of every face, faces × bands, W/m².
    pub per_face: Vec<f64>,
}

/// Compares the face means of the irradiance of a fine solution with a coarse one; `refinement` is k, at least 2.
#[must_use]
pub fn mesh_error(
    fine: &MultiVector<f64>,
    coarse: &MultiVector<f64>,
    faces: &[Extent],
    refinement: f64,
) -> MeshError {
    let bands = fine.lanes();
    let differences = fine.as_slice().iter().zip(coarse.as_slice()).map(|(a, b)| (a - b).abs());
    let per_face: Vec<f64> = differences.map(|d| d / (refinement - 1.0).max(1.0)).collect();
    let (mut errors, mut squares, mut largest) = (vec![0.0; bands], vec![0.0; bands], vec![0.0; bands]);
    for (i, face) in faces.iter().enumerate() {
        for l in 0..bands {
            let (delta, value) = (per_face[i * bands + l], fine.row(i)[l]);
            errors[l] += face.area * delta * delta;
            squares[l] += face.area * value * value;
            largest[l] = delta.max(largest[l]);
        }
    }
    let relative = |(e, s): (&f64, &f64)| if *s > 0.0 { (e / s).sqrt() } else { 0.0 };
    let relative_l2 = errors.iter().zip(&squares).map(relative).collect();
    MeshError { relative_l2, largest, per_face }
}
