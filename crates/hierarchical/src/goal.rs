//! Goals: the mean irradiance of some surfaces alone, and what every element matters to it.
//!
//! With the exchanges G (m²), D = ρ/A, and x = M + D G x, the mean irradiance of the goal is Q =
//! ⟨w, G x⟩, w = 1/A_goal on the goal and 0 elsewhere (1/m²). The *importance* z = w + D G z is
//! what the radiosity would be if the goal shone with w: the same links serve, since G is
//! symmetric, and ⟨w, G x⟩ = ⟨M, G z⟩. An error δG of the exchanges changes the goal by δQ = ⟨z, δG
//! x⟩, to first order: an error e of the irradiance of an area A matters z A e. So the change from
//! one operator to the next is weighed ([`Estimate`]).
//!
//! A relative error ε of the irradiance of a face matters I ε, I = A z E/Q. Such errors add up,
//! mostly with one sign, and a face that may have the error ε costs about 1/ε. The least cost for Σ
//! I ε has ε ∝ 1/√I: the oracle weighs by √(I/I_max), on a cluster by the root of the area mean of
//! I/I_max.
//!
//! B. Smits, J. Arvo, D. Salesin, *An importance-driven radiosity algorithm*, SIGGRAPH 1992,
//! doi:10.1145/142920.134080; R. Becker, R. Rannacher, Acta Numerica 10 (2001),
//! doi:10.1017/S0962492901000010.

use crate::driver::{Stated, THRESHOLD_RATIO};
use crate::light::ambient;
use crate::{HierarchyError, Surfaces, Tree};
use fredholm_coupling::Radiosity;
use fredholm_linop::{LinearOperator, LinopError, MultiVector, SecondKind};
use fredholm_mesh::Mesh;

/// Stated error over the last change. The errors of a goal have mostly one sign, since light is
/// lost or gained behind the same edges, and fall more slowly than those of faces.
const CONFIDENCE: f64 = 2.5;

/// Surfaces whose mean irradiance is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Goal {
    names: Vec<String>,
    /// Numbers of the surfaces, in order.
    surfaces: Vec<usize>,
}

impl Goal {
    /// All surfaces of these names.
    ///
    /// # Errors
    /// [`HierarchyError::Goal`] for a name that no surface has, or no names.
    pub fn new<S: AsRef<str>>(mesh: &Mesh, names: &[S]) -> Result<Self, HierarchyError> {
        let named = |name: &str| mesh.surfaces().iter().any(|surface| surface.name == name);
        let names: Vec<String> = names.iter().map(|name| name.as_ref().to_owned()).collect();
        let unknown = names.iter().find(|name| !named(name)).cloned();
        if let Some(name) = unknown.or_else(|| names.is_empty().then(String::new)) {
            let mut known: Vec<&str> = mesh.surfaces().iter().map(|surface| surface.name.as_str()).collect();
            known.dedup();
            return Err(HierarchyError::Goal { name, known: known.join(", ") });
        }
        let chosen = mesh.surfaces().iter().enumerate().filter(|(_, surface)| names.contains(&surface.name));
        let surfaces = chosen.map(|(index, _)| index).collect();
        Ok(Self { names, surfaces })
    }

    /// The names, as they were given.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Numbers of the surfaces.
    pub(crate) fn surfaces(&self) -> &[usize] {
        &self.surfaces
    }

    fn holds(&self, mesh: &Mesh, face: usize) -> bool {
        self.surfaces.binary_search(&mesh.faces()[face].surface).is_ok()
    }

    /// Area, m².
    #[must_use]
    pub fn area(&self, mesh: &Mesh) -> f64 {
        (0..mesh.faces().len())
            .filter(|&face| self.holds(mesh, face))
            .map(|face| mesh.faces()[face].area)
            .sum()
    }

    /// Area means over the goal of values of the faces, faces × bands.
    #[must_use]
    pub fn means(&self, mesh: &Mesh, faces: &[f64], bands: usize) -> Vec<f64> {
        let (mut means, area) = (vec![0.0; bands], self.area(mesh));
        for (face, row) in faces.chunks_exact(bands.max(1)).enumerate() {
            if self.holds(mesh, face) {
                let share = mesh.faces()[face].area / area;
                means.iter_mut().zip(row).for_each(|(mean, value)| *mean += share * value);
            }
        }
        means
    }

    /// The dual problem: the same reflectances, and w in the place of the exitance.
    pub(crate) fn dual(&self, mesh: &Mesh, surfaces: &Surfaces) -> Surfaces {
        let weight = 1.0 / self.area(mesh);
        let w = |k: usize, _| if self.holds(mesh, mesh.face_of(k)) { weight } else { 0.0 };
        let exitance = MultiVector::from_fn(mesh.len(), surfaces.exitance.rhs_count(), w);
        Surfaces { reflectance: surfaces.reflectance.clone(), exitance }
    }
}

/// √(I/I_max) of all nodes from the importance and the irradiance on all nodes; where there is no
/// irradiance yet it is taken to be the same everywhere.
pub(crate) fn weights(tree: &Tree, z: &MultiVector<f64>, irradiance: Option<&MultiVector<f64>>) -> Vec<f64> {
    let matter = |node: u32, band: usize| {
        let e = irradiance.map_or(1.0, |e| e.row(node as usize)[band]);
        (tree.nodes()[node as usize].area() * z.row(node as usize)[band] * e).max(0.0)
    };
    let most = |band| tree.roots().iter().map(|&root| matter(root, band)).fold(0.0, f64::max);
    let most: Vec<f64> = (0..z.rhs_count()).map(most).collect();
    let share = |root: u32| {
        let bands = most.iter().enumerate();
        bands
            .map(|(band, most)| if *most > 0.0 { matter(root, band) / most } else { 1.0 })
            .fold(0.0, f64::max)
    };
    let mut squares = vec![0.0; tree.nodes().len()];
    tree.roots().iter().for_each(|&root| squares[root as usize] = share(root));
    spread(tree, &mut squares);
    squares.into_iter().map(f64::sqrt).collect()
}

/// Gives clusters the area mean of their input elements, and parts of those what the whole has.
fn spread(tree: &Tree, values: &mut [f64]) {
    let nodes = tree.nodes();
    for (index, node) in nodes.iter().enumerate().rev() {
        if let (Some(parent), true) = (node.parent(), is_whole(tree, index)) {
            values[parent as usize] += values[index] * node.area() / nodes[parent as usize].area();
        }
    }
    for (index, node) in nodes.iter().enumerate() {
        if let (Some(parent), false) = (node.parent(), is_whole(tree, index)) {
            values[index] = values[parent as usize];
        }
    }
}

/// Whether a node is an input element or a cluster of such.
fn is_whole(tree: &Tree, index: usize) -> bool {
    tree.nodes()[index].root().is_none_or(|root| tree.roots()[root] as usize == index)
}

/// The importance before there is a solution, on the nodes of the input elements: all reflect what
/// the whole scene would have of w if it were spread evenly.
pub(crate) fn expected(tree: &Tree, dual: &Surfaces) -> MultiVector<f64> {
    let even = ambient(tree, dual);
    let mut z = MultiVector::zeros(tree.nodes().len(), even.len());
    for (root, &node) in tree.roots().iter().enumerate() {
        let rows = dual.exitance.row(root).iter().zip(dual.reflectance.row(root)).zip(&even);
        let row = rows.map(|((w, rho), even)| w + rho * if even.is_finite() { *even } else { 0.0 });
        z.row_mut(node as usize).iter_mut().zip(row).for_each(|(z, value)| *z = value);
    }
    z
}

/// The goal of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// Mean irradiance of the goal, W/m², of each band.
    pub irradiance: Vec<f64>,
    /// Importance z of the exposed parts of the leaves, 1/m², leaves × bands.
    pub importance: MultiVector<f64>,
}

/// What the error of a goal is estimated from.
pub(crate) struct Estimate<'a> {
    pub tree: &'a Tree,
    pub operator: &'a dyn LinearOperator<f64>,
    pub leaves: &'a [u32],
    pub radiosity: &'a Radiosity,
    /// The solution of the round before on the leaves, and the irradiance that it had then, W/m².
    pub before: [&'a MultiVector<f64>; 2],
    pub x: &'a MultiVector<f64>,
    pub importance: &'a MultiVector<f64>,
    /// Means of the goal before and now, W/m².
    pub means: [&'a [f64]; 2],
}

impl Estimate<'_> {
    /// [`CONFIDENCE`] times the change of the goal, or the root of the summed squares of what the
    /// input elements have to do with it where that is more, and what the residual of the solver
    /// may do. A change is not believed to be smaller than [`THRESHOLD_RATIO`] times the `earlier`
    /// one, that of the round before, relative and of the worst band: it may be so by chance. So
    /// nothing is stated where there is no earlier one. With it comes the change of this round.
    ///
    /// # Errors
    /// [`LinopError`] where the vectors do not fit.
    pub fn stated(&self, earlier: Option<f64>) -> Result<(Option<Stated>, f64), LinopError> {
        let (shares, unsolved) = (self.shares(), self.unsolved()?);
        let mut stated = Stated { relative_l2: Vec::new(), largest: Vec::new() };
        let mut worst: f64 = 0.0;
        for (band, (share, unsolved)) in shares.into_iter().zip(unsolved).enumerate() {
            let [before, now] = self.means.map(|means| means[band]);
            let change = share.max((now - before).abs());
            let believed = change.max(THRESHOLD_RATIO * earlier.unwrap_or(0.0) * now);
            let error = CONFIDENCE * believed + unsolved;
            stated.relative_l2.push(if now > 0.0 { error / now } else { 0.0 });
            stated.largest.push(error);
            worst = worst.max(if now > 0.0 { change / now } else { 0.0 });
        }
        Ok((earlier.map(|_| stated), worst))
    }

    /// √Σ s², where s = Σ z A ΔE, over the leaves of an input element, is what the new exchanges
    /// change there, as the goal sees it, W/m².
    fn shares(&self) -> Vec<f64> {
        let [x, old] = self.before;
        let new = self.radiosity.means(self.operator, x).irradiance;
        let mut shares = MultiVector::<f64>::zeros(self.tree.roots().len(), x.rhs_count());
        for (i, &leaf) in self.leaves.iter().enumerate() {
            let node = &self.tree.nodes()[leaf as usize];
            let change = new.row(i).iter().zip(old.row(i)).zip(self.importance.row(i));
            let change = change.map(|((new, old), z)| z * node.area() * (new - old));
            let row = shares.row_mut(node.root().unwrap_or(0));
            row.iter_mut().zip(change).for_each(|(share, change)| *share += change);
        }
        shares.norms()
    }

    /// |⟨G z, M − A x⟩|: what the solver has left of the goal, W/m².
    fn unsolved(&self) -> Result<Vec<f64>, LinopError> {
        let a = SecondKind::new(self.operator, self.radiosity.scaling())?;
        let [mut product, mut seen] = [(); 2].map(|()| MultiVector::zeros(self.x.dim(), self.x.rhs_count()));
        a.apply(self.x, &mut product);
        self.operator.apply(self.importance, &mut seen);
        let mut residual = MultiVector::zeros(self.x.dim(), self.x.rhs_count());
        residual.set_difference(self.radiosity.exitance(), &product);
        Ok(seen.dots(&residual).into_iter().map(f64::abs).collect())
    }
}
