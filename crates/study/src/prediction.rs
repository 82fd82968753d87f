//! Memory that a solution will take, known before any is taken.
//!
//! The bytes an element takes are measured: `cargo test --release --test memory -- --ignored`
//! compares every prediction with what was held.

use fredholm_coupling::{Constants, waiting_bytes};
use fredholm_linop::{PackedSymmetric, Storage};

use crate::directions::BYTES_OF_A_MET_ELEMENT;
use crate::error::Error;
use crate::lamplight::MOST_GATHERED_ELEMENTS;
use crate::memory::{Limit, Plan};
use crate::options::Precision;
use crate::options::{ProblemSettings, USUAL_DISCRETISATION};
use crate::registry::SolverEntry;
use crate::size::Bytes;
use crate::stages::Stages;

/// Bytes of an element from the scene on: its patch, the scene's surfaces, what blocks the view.
pub(crate) const BYTES_OF_AN_ELEMENT: u128 = 600;
/// Bytes of an element while its exchanges are computed: quadrature points, clusters, error sums.
pub(crate) const BYTES_OF_AN_ASSEMBLED_ELEMENT: u128 = 800;
/// Bytes of an element that is shot from: quadrature points, groups, the tree of elements. Of each
/// of its values while shots go on; of it and of each of its values while errors are followed.
const BYTES_OF_A_SHOT_ELEMENT: u128 = 1450;
const BYTES_OF_A_SHOT_VALUE: u128 = 200;
const BYTES_OF_A_FOLLOWED_ELEMENT: u128 = 130;
const BYTES_OF_A_FOLLOWED_VALUE: u128 = 630;
/// Of the entries on their way, many small pieces, the C library still has one in so many when they
/// have arrived.
const RETAINED_ONE_IN: u128 = 2;
/// Bytes while results are written: of any, for the page and the plots; of an element and of each
/// of its values, for welded corners and the composed file of arrays.
const BYTES_OF_PAGE: u128 = 2 << 20;
const BYTES_OF_A_WRITTEN_ELEMENT: u128 = 650;
const BYTES_A_VALUE: u128 = 50;
/// Bytes of an element while pictures are drawn: what rays are cast at, how it lies to eight parts
/// of lamps. Of each of its values where lamps light the picture: colours at corners, reflectance
/// and direct light. Of a pixel there: what is seen through its middle, its linear colours, and
/// either once more in the tiles that it is put together from.
const BYTES_OF_A_DRAWN_ELEMENT: u128 = 500;
const BYTES_OF_A_LIT_VALUE: u128 = 24;
const BYTES_OF_A_LIT_PIXEL: u128 = 37;
/// Bytes of a pixel of which the light is gathered: errors, the file, and places where many are.
/// Of a value of the elements: what rays find there.
const BYTES_OF_A_GATHERED_PIXEL: u128 = 70;
const BYTES_OF_A_SENT_VALUE: u128 = 40;
/// Bytes of a pixel while the exposure is found, and in each picture: while it is drawn, and when
/// all are taken apart. Besides, what the last rows take.
const BYTES_OF_A_METERED_PIXEL: u128 = 14;
const BYTES_OF_A_PICTURE_PIXEL: u128 = 6;
const BYTES_OF_LAST_ROWS: u128 = 2;
/// Vectors of all bands held at once: system and results, and six sources of errors with their
/// system, iterates and residuals.
const VECTORS_HELD: u128 = 48;
/// Vectors of all bands more while errors are followed.
const VECTORS_OF_ERRORS: u128 = 150;

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
    /// What is known of a number of elements before they are there: other discretisations may have
    /// any number of unknowns.
    pub(crate) fn before_mesh(elements: usize, options: &ProblemSettings) -> Self {
        let radiosity = options.discretisation == USUAL_DISCRETISATION;
        let (unknowns, dense) = if radiosity { (elements, None) } else { (0, Some(Dense { bytes: 0 })) };
        Self { elements, unknowns, dense }
    }
}

/// Memory by use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prediction {
    size: Size,
    matrix: u128,
    /// Entries on their way into the matrix.
    waiting: u128,
    mesh: u128,
    vectors: u128,
    solver: u128,
    /// Addresses that the threads set aside for the solver.
    aside: u128,
    /// What the residual of the solution takes.
    residual: u128,
}

impl Prediction {
    pub(crate) fn new(size: Size, bands: usize, storage: Precision, solver: &SolverEntry) -> Self {
        let Size { elements, unknowns, dense } = size;
        let (packed, waiting) = match storage {
            Precision::F64 => (PackedSymmetric::<f64>::bytes(elements), waiting::<f64>(elements, false)),
            Precision::F32 => (PackedSymmetric::<f32>::bytes(elements), waiting::<f32>(elements, false)),
        };
        let n = elements as u128;
        Self {
            size,
            matrix: dense.map_or(packed.into(), |dense| dense.bytes),
            waiting: if dense.is_none() { waiting.into() } else { 0 },
            mesh: n * BYTES_OF_AN_ELEMENT,
            vectors: elements.max(unknowns) as u128 * VECTORS_HELD * 8 * bands as u128,
            solver: solver.solver.bytes(unknowns, bands).into(),
            aside: of_threads(solver.solver.addresses()),
            residual: if dense.is_none() { residual(elements, bands) } else { 0 },
        }
    }

    /// What is held when, by a computation that keeps no matrix for its results.
    pub(crate) fn plan(&self) -> Plan {
        let Self { matrix, waiting, mesh, vectors, solver, residual, .. } = *self;
        let Size { elements, unknowns, .. } = self.size;
        let (assembly, retained) =
            (waiting + elements as u128 * BYTES_OF_AN_ASSEMBLED_ELEMENT, waiting / RETAINED_ONE_IN);
        let what = match self.size.dense {
            None => format!("{} of form factors of {elements} elements", Bytes(matrix)),
            Some(_) => format!("{} of matrices of {unknowns} unknowns on {elements} elements", Bytes(matrix)),
        };
        Plan::default()
            .hold("scene, mesh and vectors", mesh.saturating_add(vectors))
            .stage(
                format!("{what} and {} on their way there", Bytes(assembly)),
                matrix.saturating_add(assembly),
            )
            .stage(
                format!("{what} and {} of the solver", Bytes(solver)),
                matrix.saturating_add(solver).saturating_add(retained),
            )
            .stage(
                format!("{what} and {} of its residual", Bytes(residual)),
                matrix.saturating_add(residual).saturating_add(retained),
            )
            .aside(self.aside)
    }

    /// The same with a solver of so many bytes.
    pub(crate) fn with_solver(self, solver: u128) -> Self {
        Self { solver, ..self }
    }

    /// Refuses what is above the limit, and says what to change.
    pub(crate) fn admit(&self, plan: &Plan, options: &ProblemSettings, stages: &Stages) -> Result<(), Error> {
        let limit = options.memory_limit();
        stages.admit(plan, limit, &self.help(plan, limit, options))
    }

    /// How to need less.
    fn help(&self, plan: &Plan, limit: Limit, options: &ProblemSettings) -> String {
        let mut text = "use fewer elements (elements_per_face, divide, largest_edge in the scene)".to_owned();
        let single = Bytes(plan.peak().0.saturating_sub(self.matrix / 2));
        if self.size.dense.is_none() && options.storage == Precision::F64 && single <= limit.bytes() {
            text.push_str(", --storage f32");
        }
        if self.solver > self.matrix {
            text.push_str(", a solver that needs less than ");
            text.push_str(&options.solver);
        }
        text.push_str(", solve with --accuracy 5%, which needs no matrix");
        text
    }
}

/// Bytes of what follows the residual of a solution: besides what is sampled of it, the products of
/// its six sources in every band, in parts.
fn residual(elements: usize, bands: usize) -> u128 {
    let followed = elements as u128 * (bands as u128) * 8 * VECTORS_OF_ERRORS;
    u128::from(Constants::bytes(elements, bands)).saturating_add(followed)
}

/// Addresses that all threads of this run set aside, where each does so many.
pub(crate) fn of_threads(addresses: u64) -> u128 {
    u128::from(addresses) * rayon::current_num_threads() as u128
}

/// Bytes of the entries on their way into a matrix; more than 2³¹ elements, whose pairs cannot be
/// counted, have none that would fit.
pub(crate) fn waiting<S: Storage>(elements: usize, errors: bool) -> u64 {
    waiting_bytes::<S>(elements.min(1 << 31), errors)
}

/// A computation without a matrix, where columns may take `kept`; groups of elements take as much
/// as elements.
pub(crate) fn without_matrix(elements: usize, bands: usize, kept: Bytes) -> Plan {
    let (n, values) = (elements as u128, elements as u128 * bands as u128);
    Plan::default()
        .hold(
            format!("{elements} elements and groups of them"),
            n * (BYTES_OF_AN_ELEMENT + BYTES_OF_A_SHOT_ELEMENT),
        )
        .stage("columns that are kept, and the field", kept.0.saturating_add(values * BYTES_OF_A_SHOT_VALUE))
        .stage(
            "the errors of the field",
            n * BYTES_OF_A_FOLLOWED_ELEMENT + values * BYTES_OF_A_FOLLOWED_VALUE,
        )
}

/// The pictures of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pictures {
    /// Pixels of each.
    pub(crate) pixels: u128,
    pub(crate) count: usize,
    /// Whether lamps light one of them, so that shadows are seen as they are.
    pub(crate) lit: bool,
    /// Whether the light of one is gathered.
    pub(crate) gathered: bool,
}

/// Bytes of the results of so many elements, with pictures.
pub(crate) fn results(elements: usize, bands: usize, pictures: Pictures) -> u128 {
    let (n, values) = (elements as u128, elements as u128 * bands as u128);
    let files = BYTES_OF_PAGE + n * BYTES_OF_A_WRITTEN_ELEMENT + values * BYTES_A_VALUE;
    let Pictures { pixels, count, lit, gathered } = pictures;
    if count == 0 {
        return files;
    }
    let drawn = n * BYTES_OF_A_DRAWN_ELEMENT + if lit { values * BYTES_OF_A_LIT_VALUE } else { 0 };
    let of_pixels =
        pictured(pixels, count).max(if lit { pixels.saturating_mul(BYTES_OF_A_LIT_PIXEL) } else { 0 });
    let of_elements = if gathered || lit && elements <= MOST_GATHERED_ELEMENTS {
        n * BYTES_OF_A_MET_ELEMENT + values * BYTES_OF_A_SENT_VALUE
    } else {
        0
    };
    let of_places = if gathered { pixels.saturating_mul(BYTES_OF_A_GATHERED_PIXEL) } else { 0 };
    let gathering = of_places.saturating_add(of_elements);
    files.saturating_add(drawn).saturating_add(of_pixels).saturating_add(gathering)
}

/// Bytes of so many pictures of so many pixels.
pub(crate) fn pictured(pixels: u128, pictures: usize) -> u128 {
    pixels.saturating_mul(
        BYTES_OF_A_METERED_PIXEL.max(BYTES_OF_A_PICTURE_PIXEL * pictures as u128 + BYTES_OF_LAST_ROWS),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::limit;
    use crate::registry::find;

    fn predict(elements: usize, storage: Precision, solver: &str) -> Prediction {
        let size = Size { elements, unknowns: elements, dense: None };
        Prediction::new(size, 3, storage, &find(solver).unwrap())
    }

    #[test]
    fn the_triangle_of_the_matrix_is_counted_in_its_format() {
        assert_eq!(predict(10_000, Precision::F64, "gauss-seidel").matrix, 50_005_000 * 8);
        assert_eq!(predict(10_000, Precision::F32, "gauss-seidel").matrix, 50_005_000 * 4);
    }

    #[test]
    fn single_precision_is_advised_where_it_is_enough() {
        let advice = |bytes: u64| {
            let options = ProblemSettings {
                discretisation: USUAL_DISCRETISATION.into(),
                solver: "gauss-seidel".into(),
                form_factor_tolerance: 1e-3,
                storage: Precision::F64,
                threads: 1,
                memory_limit_bytes: Some(bytes),
            };
            let found = predict(10_000, Precision::F64, "gauss-seidel");
            found.help(&found.plan(), limit(Some(Bytes(bytes.into()))), &options)
        };
        // 400 MB of matrix and 150 MB of everything else in double precision.
        assert!(advice(450_000_000).contains("--storage f32"));
        assert!(!advice(100_000_000).contains("--storage f32"));
    }

    #[test]
    fn elimination_needs_at_least_the_full_square() {
        assert!(predict(10_000, Precision::F64, "lu").solver >= 8 * 10_000 * 10_000);
    }

    #[test]
    fn a_large_picture_counts() {
        let pictures = |pixels, count| Pictures { pixels, count, lit: true, gathered: false };
        assert!(results(600, 3, pictures(16_384 * 16_384, 1)) > 2 << 30);
        assert!(results(600, 3, pictures(16_384 * 16_384, 0)) < 4 << 20);
        assert!(results(1 << 60, 3, pictures(u128::MAX, 1)) == u128::MAX);
    }
}
