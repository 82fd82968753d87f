//! The couplings between the elements of a scene, for solvers and analyses of one's own.

use std::sync::Arc;

use fredholm_coupling::Radiosity;
use fredholm_linop::{PackedSymmetric, Stop, Watch};
use fredholm_mesh::Mesh;
use fredholm_scene::Scene;

use crate::error::Error;
use crate::options::{Precision, ProblemOptions, SceneSource};
use crate::problem::Problem;
use crate::solution::{form_factors, system};
use crate::stages::Stages;
use crate::watcher::Watcher;

/// What the elements of a scene exchange, and the system (I − R F) B = M of it.
#[derive(Debug)]
pub struct Couplings {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The elements.
    pub mesh: Mesh,
    /// G_ij = A_i F_ij, m², the diagonal included.
    pub exchange: PackedSymmetric<f64>,
    /// Stated error of the form factors of each row: an estimate of Σ_j |ΔF_ij|.
    pub row_error: Vec<f64>,
    /// Areas, reflectances and exitances of the elements.
    pub radiosity: Radiosity,
}

/// Computes the couplings of the elements of a scene, in double precision.
///
/// # Errors
/// What is wrong with the scene or the options; [`Resources`](crate::ErrorKind::Resources) before
/// memory is taken that the limit does not allow; [`Interrupted`](crate::ErrorKind::Interrupted)
/// for a run that was cancelled.
pub fn couplings(
    source: impl Into<SceneSource>,
    asked: &ProblemOptions,
    watch: &dyn Watch,
) -> Result<Couplings, Error> {
    couplings_scene(&source.into(), asked, watch)
}

/// [`couplings`], compiled once and not for each kind of source.
fn couplings_scene(
    source: &SceneSource,
    asked: &ProblemOptions,
    watch: &dyn Watch,
) -> Result<Couplings, Error> {
    let mut stages = Stages::new(watch);
    let asked = ProblemOptions { storage: Some(Precision::F64), ..asked.clone() };
    let problem = Problem::load(source, &asked, &|plan, _, _| plan, &mut stages)?;
    problem.require_radiosity("couplings")?;
    let watcher = Watcher::to(&stages, Stop { tolerance: 0.0, max_iterations: 0 });
    let assembled = stages.run("assembly", || form_factors::<f64>(&problem, watcher))?;
    let radiosity = stages.run("exposure", || system(&problem, &assembled.matrix))?;
    stages.check()?;
    let rows = assembled.error.iter().zip(problem.mesh.patches());
    let row_error = rows.map(|(error, patch)| error / patch.area()).collect();
    let Problem { scene, mesh, .. } = problem;
    Ok(Couplings { scene, mesh, exchange: assembled.matrix, row_error, radiosity })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quiet;

    #[test]
    fn rows_of_a_closed_room_sum_to_their_areas() {
        let text = r#"
            [materials.wall]
            reflectance = 0.5
            exitance = 1
            [[surface]]
            name = "room"
            material = "wall"
            box = { min = [0, 0, 0], max = [1, 1, 1], inward = true }
        "#;
        let scene = Scene::from_str(text, "room.toml").unwrap();
        let found = couplings(scene, &ProblemOptions::default(), &Quiet).unwrap();
        for (sum, extent) in found.exchange.row_sums().iter().zip(found.radiosity.elements()) {
            assert!((sum / extent.area - 1.0).abs() < 1e-6, "{sum}");
        }
        assert_eq!((found.mesh.len(), found.scene.bands().len()), (6, 1));
        assert!(found.row_error.iter().all(|error| *error < 1e-2));
    }
}
