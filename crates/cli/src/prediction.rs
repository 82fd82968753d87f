//! Memory that a solution will take, known before any is taken.

use std::fmt::Write;

use fredholm_linop::PackedSymmetric;

use crate::args::Precision;
use crate::failure::{Ending, Failure};
use crate::options::ProblemOptions;
use crate::registry::Entry;
use crate::size::Bytes;

/// Bytes an element takes besides its row of the matrix: geometry, quadrature points, error sums of the assembly.
const PER_ELEMENT: u128 = 4096;
/// Bytes of the program itself, before there is a scene.
const PROGRAM: u128 = 8 << 20;
/// Vectors of all bands held at once: system, iterates, residuals, results.
const VECTORS: u128 = 16;

/// Sizes that decide the memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) elements: usize,
    pub(crate) bands: usize,
    /// Patches of the coarser problem that the mesh error is estimated with.
    pub(crate) coarse: usize,
}

/// Memory by use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prediction {
    elements: usize,
    pub(crate) matrix: Bytes,
    pub(crate) mesh: Bytes,
    pub(crate) solver: Bytes,
}

impl Prediction {
    pub(crate) fn new(size: Size, storage: Precision, solver: &Entry) -> Self {
        let Size { elements, bands, coarse } = size;
        let fine = match storage {
            Precision::F64 => PackedSymmetric::<f64>::bytes(elements),
            Precision::F32 => PackedSymmetric::<f32>::bytes(elements),
        };
        let matrix = u128::from(fine) + u128::from(PackedSymmetric::<f64>::bytes(coarse));
        let mesh = elements as u128 * (PER_ELEMENT + VECTORS * 8 * bands as u128);
        let solver = solver.solver.bytes(elements, bands).into();
        Self { elements, matrix: Bytes(matrix), mesh: Bytes(mesh), solver: Bytes(solver) }
    }

    pub(crate) fn total(&self) -> Bytes {
        Bytes(PROGRAM + self.matrix.0 + self.mesh.0 + self.solver.0)
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
        let half = Bytes(self.total().0 - self.matrix.0 / 2);
        if options.storage == Precision::F64 && half <= limit {
            text.push_str(", --storage f32");
        }
        if self.solver > self.matrix {
            let _ = write!(text, ", a solver that needs less than {}", options.solver);
        }
        text.push_str(", or allow more with --memory");
        Err(Failure::new(Ending::Resources, text))
    }
}

impl std::fmt::Display for Prediction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { elements, matrix, mesh, solver } = self;
        let program = Bytes(PROGRAM);
        write!(
            f,
            "{matrix} for the form factors of {elements} elements, {mesh} for the mesh, {solver} for the solver and \
             {program} for the program"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::find;

    fn predict(elements: usize, storage: Precision, solver: &str) -> Prediction {
        Prediction::new(Size { elements, bands: 3, coarse: 0 }, storage, &find(solver).unwrap())
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
                solver: "gauss-seidel".into(),
                form_factor_tolerance: 1e-3,
                storage: Precision::F64,
                threads: 1,
                memory_limit_bytes: Some(limit),
            };
            predict(10_000, Precision::F64, "gauss-seidel").admit(&options).err().map(|e| e.to_string())
        };
        // 400 MB of matrix, 45 MB of everything else in double precision.
        assert!(advice(300_000_000).unwrap().contains("--storage f32"));
        assert!(!advice(100_000_000).unwrap().contains("--storage f32"));
        assert_eq!(advice(1_000_000_000), None);
    }

    #[test]
    fn elimination_needs_at_least_the_full_square() {
        assert!(predict(10_000, Precision::F64, "lu").solver >= Bytes(8 * 10_000 * 10_000));
    }
}
