//! What a solution is seen by: pictures of the elements and of links, and the light that points
//! gather.

use std::ops::ControlFlow;
use std::sync::Arc;

use fredholm_hierarchical::{Gather, HierarchyError, Leaves, Link, Sender, Tree, senders};
use fredholm_linop::MultiVector;
use fredholm_mesh::{Patch, Vec3};
use fredholm_report::{Link as Drawn, Linked, PointTable, Wanted};

use crate::error::{Error, ErrorKind};
use crate::options::SolveSettings;
use crate::problem::Problem;
use crate::solution::Solution;
use crate::stages::Signals;

/// Error that a node may leave in the irradiance of a pixel, over the accuracy asked for.
const NODE_ERROR_OVER_ACCURACY: f64 = 0.1;
/// The same where no accuracy was asked for.
const USUAL_NODE_ERROR: f64 = 1e-3;

/// Elements and clusters of a solution, and the links between them.
#[derive(Debug)]
pub(crate) struct Hierarchy {
    pub(crate) tree: Tree,
    pub(crate) links: Arc<Vec<Link>>,
}

/// Which files are wanted of a solution.
pub(crate) fn wanted(options: &SolveSettings, solution: &Solution) -> Wanted {
    Wanted {
        image: !options.no_pictures,
        page: !options.no_report,
        links: solution.tree.is_some() && !options.no_pictures,
        gather: options.final_gather && !options.no_pictures,
        false_colour: options.false_colour.is_some() && !options.no_pictures,
        points: !options.points.is_empty(),
        shadows: options.discontinuity,
        also: options.also.iter().map(|file| file.name()).collect(),
    }
}

/// What pictures are made from.
pub(crate) struct Source<'a> {
    problem: &'a Problem,
    solution: &'a Solution,
    hierarchy: Option<&'a Hierarchy>,
    light: Option<Light>,
}

/// What gathering needs besides the solution.
struct Light {
    /// The tree over the elements, where the solution has none.
    tree: Option<Tree>,
    exitance: MultiVector<f64>,
    /// Irradiance and radiosity of the exposed parts of the elements, W/m².
    irradiance: MultiVector<f64>,
    radiosity: MultiVector<f64>,
    /// m².
    exposed: Vec<f64>,
}

impl<'a> Source<'a> {
    /// Prepares the pictures of a solution.
    pub(crate) fn new(
        problem: &'a Problem,
        options: &SolveSettings,
        solution: &'a Solution,
    ) -> Result<Self, Error> {
        let hierarchy = solution.tree.as_ref();
        let wanted = options.discontinuity || !options.points.is_empty();
        let light = wanted.then(|| Light::new(problem, solution)).transpose()?;
        Ok(Self { problem, solution, hierarchy, light })
    }

    /// What gathers, where that was asked for.
    pub(crate) fn gather<'s>(
        &'s self,
        options: &SolveSettings,
        signals: &'s Signals<'s>,
    ) -> Result<Option<Gathered<'s>>, Error> {
        let Some(light) = &self.light else { return Ok(None) };
        let tree = light.tree.as_ref().or(self.hierarchy.map(|h| &h.tree));
        let Some(tree) = tree else { return Ok(None) };
        let Light { radiosity, irradiance, exposed, .. } = light;
        let leaves = Leaves { radiosity, irradiance, exposed };
        let share = options.accuracy.map_or(USUAL_NODE_ERROR, |accuracy| NODE_ERROR_OVER_ACCURACY * accuracy);
        let points: Vec<Vec3> = options.points.iter().map(|receiver| receiver.point).collect();
        let gather = Gather::new(tree, &leaves, &self.problem.occluders, &points, share).map_err(failure)?;
        Ok(Some(Gathered { problem: self.problem, light, gather, signals }))
    }

    /// The links of an element as they are drawn.
    pub(crate) fn linked(&self, element: usize) -> Linked {
        let mut linked = Linked { links: Vec::new(), link_of: vec![None; self.problem.mesh.len()] };
        let Some(Hierarchy { tree, links }) = self.hierarchy else { return linked };
        let leaves = tree.leaves();
        let mut place = vec![None; tree.nodes().len()];
        leaves.iter().enumerate().for_each(|(i, &leaf)| place[leaf as usize] = Some(i));
        for sender in senders(tree, links, leaves[element]) {
            let patch = tree.nodes()[sender.node as usize].patch().copied();
            let below = below(tree, &place, sender.node);
            for &i in &below {
                linked.link_of[i] = Some(linked.links.len());
            }
            let share = self.share(tree, &sender, &below, element);
            linked.links.push(Drawn { patch, centre: self.middle(&below), level: sender.level, share });
        }
        linked
    }

    /// Centroid of some elements, m.
    fn middle(&self, below: &[usize]) -> Vec3 {
        let patches = || below.iter().map(|&i| self.problem.mesh.patch(i));
        let moment: Vec3 = patches().map(|patch| patch.centroid() * patch.area()).sum();
        moment / patches().map(Patch::area).sum::<f64>()
    }

    /// Share of the irradiance of an element that a sender brings, in the band where it is most.
    fn share(&self, tree: &Tree, sender: &Sender, below: &[usize], element: usize) -> f64 {
        let means = &self.solution.means;
        let area: f64 = below.iter().map(|&i| self.problem.mesh.patch(i).area()).sum();
        let share = |band: usize| {
            let weighted = |&i: &usize| self.problem.mesh.patch(i).area() * means.radiosity.row(i)[band];
            let sent = below.iter().map(weighted).sum::<f64>() / area;
            let brought = sender.exchange / tree.nodes()[sender.receiver as usize].area() * sent;
            let all = means.irradiance.row(element)[band];
            if all > 0.0 { brought / all } else { 0.0 }
        };
        (0..means.irradiance.rhs_count()).map(share).fold(0.0, f64::max)
    }
}

/// Numbers of the elements below a node.
fn below(tree: &Tree, place: &[Option<usize>], node: u32) -> Vec<usize> {
    let (mut found, mut stack) = (Vec::new(), vec![node]);
    while let Some(node) = stack.pop() {
        found.extend(place[node as usize]);
        stack.extend(tree.nodes()[node as usize].children());
    }
    found
}

impl Light {
    fn new(problem: &Problem, solution: &Solution) -> Result<Self, Error> {
        let Problem { mesh, scene, occluders, .. } = problem;
        let tree = match solution.tree {
            Some(_) => None,
            None => Some(Tree::new(mesh, occluders.tolerance()).map_err(failure)?),
        };
        let nodes = solution.tree.as_ref().map_or(2 * mesh.len(), |h| h.tree.nodes().len());
        admit(problem, nodes)?;
        let (reflectance, exitance) =
            (problem.multivector(scene.reflectance(mesh))?, problem.multivector(scene.exitance(mesh))?);
        let (bands, means) = (scene.bands().len(), &solution.means.irradiance);
        // Means are over whole elements; what is buried receives nothing.
        let of_exposed = |i: usize, band: usize| match solution.exposed[i] {
            share if share > 0.0 => means.row(i)[band] / share,
            _ => 0.0,
        };
        let irradiance = MultiVector::from_fn(mesh.len(), bands, of_exposed);
        let radiosity = MultiVector::from_fn(mesh.len(), bands, |i, band| {
            exitance.row(i)[band] + reflectance.row(i)[band] * irradiance.row(i)[band]
        });
        let exposed = mesh.patches().zip(&solution.exposed).map(|(p, share)| p.area() * share).collect();
        Ok(Self { tree, exitance, irradiance, radiosity, exposed })
    }
}

/// Bytes of a node of the tree over elements.
const BYTES_OF_A_NODE: u128 = 320;
/// Vectors of all elements and bands that gathering needs.
const GATHERING_VECTORS: u128 = 5;

/// Bytes of what gathers light from so many elements, of which a tree is made.
pub(crate) fn gathering(elements: usize, bands: usize) -> u128 {
    let nodes = elements.saturating_mul(2);
    u128::from(Gather::bytes(nodes, bands))
        + nodes as u128 * BYTES_OF_A_NODE
        + elements as u128 * 8 * GATHERING_VECTORS * bands as u128
}

/// Refuses to gather where the memory does not allow it.
fn admit(problem: &Problem, nodes: usize) -> Result<(), Error> {
    let bytes = Gather::bytes(nodes, problem.scene.bands().len());
    let plan = problem.plan.clone().hold("gathering", bytes.into());
    plan.admit(problem.options.memory_limit(), "leave out --discontinuity, --point and --plane")
}

/// Gathers the light of points on the elements.
pub(crate) struct Gathered<'a> {
    pub(crate) problem: &'a Problem,
    light: &'a Light,
    pub(crate) gather: Gather<'a>,
    signals: &'a Signals<'a>,
}

impl Gathered<'_> {
    /// Whether an element is a lamp.
    pub(crate) fn emits(&self, element: usize) -> bool {
        self.light.exitance.row(element).iter().any(|m| *m > 0.0)
    }

    /// Whether the run goes on; asked often.
    pub(crate) fn go_on(&self) -> ControlFlow<()> {
        self.signals.watch.go_on()
    }

    /// Irradiance of an element, of each band, W/m².
    pub(crate) fn expected(&self, element: usize) -> &[f64] {
        self.light.irradiance.row(element)
    }

    /// The irradiance of the points that were asked for; nothing where the run was cancelled before
    /// the end.
    pub(crate) fn points(&self, options: &SolveSettings) -> Result<Option<PointTable>, Error> {
        if options.points.is_empty() {
            return Ok(None);
        }
        let usual = self.gather.usual();
        let usual = MultiVector::from_fn(options.points.len(), usual.len(), |_, band| usual[band]);
        // What comes of the first time tells how exact the second one has to be.
        let gathered = |expected: &_| self.gather.irradiance(&options.points, expected, self.signals.watch);
        let found = match gathered(&usual).and_then(|first| gathered(&first)) {
            Err(HierarchyError::Interrupted) => return Ok(None),
            found => found.map_err(failure)?,
        };
        let points = options.points.iter().map(|receiver| [receiver.point, receiver.normal]).collect();
        Ok(Some(PointTable { points, irradiance: found.as_slice().to_vec() }))
    }
}

fn failure(error: HierarchyError) -> Error {
    Error::new(ErrorKind::Input, error)
}
