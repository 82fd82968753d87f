//! Memory that a solution will take, known before any is taken.

use std::fmt::Write;

use fredholm_coupling::waiting_bytes;
use fredholm_linop::PackedSymmetric;

use crate::args::Precision;
use crate::failure::{Ending, Failure};
use crate::options::{ProblemOptions, RADIOSITY};
use crate::registry::Entry;
use crate::size::Bytes;

/// Bytes an element takes besides its row of the matrix: geometry, quadrature points, error sums of the assembly.
const PER_ELEMENT: u128 = 4096;
/// Bytes of the program itself, before there is a scene.
const PROGRAM: u128 = 8 << 20;
/// Vectors of all bands held at once: system and results, and six sources of errors with their system, iterates and residuals.
const VECTORS: u128 = 48;

/// Sizes that decide the memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) elements: usize,
    /// Unknowns in each band.
    pub(crate) unknowns: usize,
    /// Matrices of another discretisation than constants on form factors.
    pub(crate) dense: Option<Dense>,
}

/// Dense matrices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dense {
    pub(crate) bytes: u128,
}

impl Size {
    /// What is known of a number of elements before they are there: other discretisations may have any number of unknowns.
    pub(crate) fn before_mesh(elements: usize, options: &ProblemOptions) -> Self {
        let radiosity = options.discretisation == RADIOSITY;
        let (unknowns, dense) = if radiosity { (elements, None) } else { (0, Some(Dense { bytes: 0 })) };
        Self { elements, unknowns, dense }
    }
}

/// Memory by use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prediction {
    size: Size,
    pub(crate) matrix: Bytes,
    /// Entries on their way into the matrix.
    pub(crate) waiting: Bytes,
    pub(crate) mesh: Bytes,
    pub(crate) solver: Bytes,
}

impl Prediction {
    pub(crate) fn new(size: Size, bands: usize, storage: Precision, solver: &Entry) -> Self {
        let Size { elements, unknowns, dense } = size;
        let fine = match storage {
            Precision::F64 => PackedSymmetric::<f64>::bytes(elements),
            Precision::F32 => PackedSymmetric::<f32>::bytes(elements),
        };
        let waiting = match storage {
            Precision::F64 => waiting_bytes::<f64>(elements, false),
            Precision::F32 => waiting_bytes::<f32>(elements, false),
        };
        let matrix = dense.map_or(u128::from(fine), |dense| dense.bytes);
        let vectors = elements.max(unknowns) as u128 * VECTORS * 8 * bands as u128;
        let mesh = elements as u128 * PER_ELEMENT + vectors;
        let solver = solver.solver.bytes(unknowns, bands).into();
        let waiting = Bytes(waiting.into());
        Self { size, matrix: Bytes(matrix), waiting, mesh: Bytes(mesh), solver: Bytes(solver) }
    }

    pub(crate) fn total(&self) -> Bytes {
        Bytes(PROGRAM + self.matrix.0 + self.waiting.0 + self.mesh.0 + self.solver.0)
    }

    /// Refuses what is above the limit, and says what to change.
    pub(crate) fn admit(&self, options: &ProblemOptions) -> Result<(), Failure> {
        let limit = options.memory_limit();
        if self.total() <= limit {
            return Ok(());
        }
        let mut text =
            format!("this scene needs {}, but {limit} are allowed: {self}\n  help: ", self.total());
        // Writing to a string cannot fail.
        let _ = write!(text, "use fewer elements (elements_per_face, divide, largest_edge in the scene)");
        // Entries that wait have a column of 4 bytes besides.
        let single = Bytes(self.total().0 - self.matrix.0 / 2 - self.waiting.0 / 3);
        if self.size.dense.is_none() && options.storage == Precision::F64 && single <= limit {
            text.push_str(", --storage f32");
        }
        if self.solver > self.matrix {
            let _ = write!(text, ", a solver that needs less than {}", options.solver);
        }
        text.push_str(", solve with --accuracy 5%, which needs no matrix, or allow more with --memory");
        Err(Failure::new(Ending::Resources, text))
    }
}

/// Refuses what needs more than the limit without a matrix, where columns may take `kept`; groups of elements take as much as elements.
pub(crate) fn admit_without_matrix(
    elements: usize,
    bands: usize,
    kept: Bytes,
    options: &ProblemOptions,
) -> Result<(), Failure> {
    let limit = options.memory_limit();
    let mesh = Bytes(elements as u128 * (2 * PER_ELEMENT + VECTORS * 8 * bands as u128));
    let total = Bytes(PROGRAM + mesh.0 + kept.0);
    if total <= limit {
        return Ok(());
    }
    let text = format!(
        "this scene needs {total}, but {limit} are allowed: {mesh} for {elements} elements, {kept} for columns that are kept\n  \
         help: keep less with --keep, use fewer elements (elements_per_face, divide, largest_edge in the scene), or allow more with --memory"
    );
    Err(Failure::new(Ending::Resources, text))
}

impl std::fmt::Display for Prediction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { size: Size { elements, unknowns, .. }, matrix, waiting, mesh, solver } = self;
        let program = Bytes(PROGRAM);
        match self.size.dense {
            None => write!(f, "{matrix} for the form factors of {elements} elements")?,
            Some(_) => write!(f, "{matrix} for the matrices of {unknowns} unknowns on {elements} elements")?,
        }
        write!(
            f,
            ", {waiting} on their way there, {mesh} for the mesh, {solver} for the solver and \
             {program} for the program"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::find;

    fn predict(elements: usize, storage: Precision, solver: &str) -> Prediction {
        let size = Size { elements, unknowns: elements, dense: None };
        Prediction::new(size, 3, storage, &find(solver).unwrap())
    }

    #[test]
    fn the_triangle_of_the_matrix_is_counted_in_its_format() {
        assert_eq!(predict(10_000, Precision::F64, "gauss-seidel").matrix, Bytes(50_005_000 * 8));
        assert_eq!(predict(10_000, Precision::F32, "gauss-seidel").matrix, Bytes(50_005_000 * 4));
    }

    #[test]
    fn single_precision_is_advised_where_it_is_enough() {
        let advice = |limit: u64| {
            let options = ProblemOptions {
                discretisation: RADIOSITY.into(),
                solver: "gauss-seidel".into(),
                form_factor_tolerance: 1e-3,
                storage: Precision::F64,
                threads: 1,
                memory_limit_bytes: Some(limit),
            };
            predict(10_000, Precision::F64, "gauss-seidel").admit(&options).err().map(|e| e.to_string())
        };
        // 400 MB of matrix, 246 MB that wait, 45 MB of everything else in double precision.
        assert!(advice(450_000_000).unwrap().contains("--storage f32"));
        assert!(!advice(100_000_000).unwrap().contains("--storage f32"));
        assert_eq!(advice(1_000_000_000), None);
    }

    #[test]
    fn elimination_needs_at_least_the_full_square() {
        assert!(predict(10_000, Precision::F64, "lu").solver >= Bytes(8 * 10_000 * 10_000));
    }
}
