//! Where a solution stands between two rounds: all that is needed to go on to the same bits.

use crate::driver::{Problem, Round, Stated};
use crate::{HierarchyError, Link, Tree};
use fredholm_linop::MultiVector;
use std::sync::Arc;

/// A solution between two rounds.
#[derive(Clone, Debug)]
pub struct State {
    pub(crate) tree: Tree,
    pub(crate) links: Arc<Vec<Link>>,
    /// Radiosity of the exposed parts of the leaves, W/m².
    pub(crate) radiosity: MultiVector<f64>,
    /// Importance of the exposed parts of the leaves, 1/m²; without a goal no column.
    pub(crate) importance: MultiVector<f64>,
    /// Surfaces of the goal; none without one.
    pub(crate) goal: Vec<usize>,
    /// Irradiance of the faces, W/m².
    pub(crate) faces: Vec<f64>,
    /// What a link may leave in the next round.
    pub(crate) threshold: f64,
    pub(crate) rounds: Vec<Round>,
    pub(crate) error: Option<Stated>,
    pub(crate) limited: bool,
}

impl State {
    /// The start.
    pub(crate) fn new(problem: &Problem, threshold: f64) -> Result<Self, HierarchyError> {
        let bands = problem.surfaces.exitance.rhs_count();
        let (expected, surfaces) = (problem.mesh.len(), problem.surfaces);
        for (what, rows) in [("the reflectance", &surfaces.reflectance), ("the exitance", &surfaces.exitance)]
        {
            if rows.dim() != expected {
                return Err(HierarchyError::Shape { what, found: rows.dim(), expected });
            }
        }
        let goal = problem.goal.map_or(Vec::new(), |goal| goal.surfaces().to_vec());
        let columns = if goal.is_empty() { 0 } else { bands };
        Ok(Self {
            tree: Tree::new(problem.mesh, problem.occluders.tolerance())?,
            links: Arc::default(),
            radiosity: MultiVector::zeros(problem.mesh.len(), bands),
            importance: MultiVector::zeros(problem.mesh.len(), columns),
            goal,
            faces: Vec::new(),
            threshold,
            rounds: Vec::new(),
            error: None,
            limited: false,
        })
    }

    /// The rounds so far.
    #[must_use]
    pub fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    /// Estimated error of the irradiance of the faces or of the goal, where there are two rounds.
    #[must_use]
    pub fn error(&self) -> Option<&Stated> {
        self.error.as_ref()
    }

    /// Irradiance of the faces after the last round, faces × bands, W/m².
    #[must_use]
    pub fn irradiance(&self) -> &[f64] {
        &self.faces
    }

    /// Radiosity of all nodes, area means of that of the leaves.
    pub(crate) fn nodes_radiosity(&self) -> MultiVector<f64> {
        self.nodes_means(&self.radiosity)
    }

    /// Area means over all nodes of values of the leaves.
    pub(crate) fn nodes_means(&self, values: &MultiVector<f64>) -> MultiVector<f64> {
        let nodes = self.tree.nodes();
        let mut means = MultiVector::zeros(nodes.len(), values.rhs_count());
        for (i, leaf) in self.tree.leaves().into_iter().enumerate() {
            means.row_mut(leaf as usize).copy_from_slice(values.row(i));
        }
        for (index, node) in nodes.iter().enumerate().rev() {
            if let Some(parent) = node.parent() {
                let share = node.area() / nodes[parent as usize].area();
                let row = means.row(index).to_vec();
                means.row_mut(parent as usize).iter_mut().zip(row).for_each(|(to, x)| *to += share * x);
            }
        }
        means
    }
}
