//! Brightness, contrast and level of the nodes, from a solution or, before the first one, from an
//! estimate.
//!
//! Before there is a solution, every element is taken to receive the ambient irradiance Σ A M/Σ A
//! (1 − ρ), which a closed room of one reflectance has.

use crate::oracle::{LEAST_IRRADIANCE_SHARE, Light};
use crate::tree::Tree;
use crate::{HierarchicalOperator, Link};
use fredholm_linop::MultiVector;

/// What surfaces do to light: of each input element, in each band.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfaces {
    /// ρ, elements × bands.
    pub reflectance: MultiVector<f64>,
    /// M, W/m², elements × bands.
    pub exitance: MultiVector<f64>,
}

impl Light {
    /// The estimate before the first solution.
    pub(crate) fn ambient(tree: &Tree, surfaces: &Surfaces) -> Self {
        let ambient = ambient(tree, surfaces);
        let mut light = Self { nodes: vec![[0.0, 0.0, 1.0]; tree.nodes().len()], weights: None };
        for (root, &node) in tree.roots().iter().enumerate() {
            let rows = surfaces.reflectance.row(root).iter().zip(surfaces.exitance.row(root)).zip(&ambient);
            let relative = rows.clone().map(|((rho, m), e)| if *e > 0.0 { rho + m / e } else { *rho });
            light.nodes[node as usize][0] = relative.fold(0.0, f64::max);
            let reflected = surfaces.reflectance.row(root).iter().copied().fold(0.0, f64::max);
            light.nodes[node as usize][1] = AMBIENT_VARIATION * reflected;
        }
        light.summarise(tree);
        light
    }

    /// From radiosity and irradiance of the nodes and the links that made them.
    pub(crate) fn solved(
        tree: &Tree,
        surfaces: &Surfaces,
        links: &[Link],
        operator: &HierarchicalOperator,
        [radiosity, irradiance]: [&MultiVector<f64>; 2],
    ) -> Self {
        let unit = unit(tree, irradiance);
        let relative = |row: &[f64]| -> Vec<f64> {
            row.iter().zip(&unit).map(|(x, u)| if *u > 0.0 { x / u } else { 0.0 }).collect()
        };
        let mut light = Self { nodes: vec![[0.0; 3]; tree.nodes().len()], weights: None };
        for (index, node) in light.nodes.iter_mut().enumerate() {
            node[0] = relative(radiosity.row(index)).into_iter().fold(0.0, f64::max);
            let level = relative(irradiance.row(index)).into_iter().zip(&unit).filter(|(_, u)| **u > 0.0);
            node[2] = level.map(|(x, _)| x).reduce(f64::min).unwrap_or(0.0);
        }
        light.darken(tree, operator);
        light.deviate(tree, surfaces, links, operator);
        light.contrast(tree);
        light
    }

    /// The level of a cluster is the harmonic mean over its parts: relative errors weigh more where
    /// it is dark. What is buried does not count.
    fn darken(&mut self, tree: &Tree, operator: &HierarchicalOperator) {
        for (index, node) in tree.nodes().iter().enumerate().rev() {
            if operator.is_buried(index) {
                self.nodes[index][2] = 1.0;
            } else if node.root().is_none() {
                let part = |&child: &u32| {
                    let level = self.nodes[child as usize][2].min(1.0) + LEAST_IRRADIANCE_SHARE;
                    tree.nodes()[child as usize].area() / node.area() / level
                };
                self.nodes[index][2] =
                    (node.children().iter().map(part).sum::<f64>().recip() - LEAST_IRRADIANCE_SHARE).max(0.0);
            }
        }
    }

    /// Contrast of the leaves: what their links leave within them, reflected.
    fn deviate(&mut self, tree: &Tree, surfaces: &Surfaces, links: &[Link], operator: &HierarchicalOperator) {
        let mut squares = vec![0.0; self.nodes.len()];
        for link in links {
            for (to, from, deviation) in
                [(link.a, link.b, link.deviation[0]), (link.b, link.a, link.deviation[1])]
            {
                let factor = link.open / tree.nodes()[to as usize].area();
                let deviation = factor * f64::from(deviation) * self.nodes[from as usize][0];
                squares[to as usize] += deviation * deviation;
            }
        }
        for (index, node) in tree.nodes().iter().enumerate() {
            if let Some(parent) = node.parent() {
                let shrink = node.area() / tree.nodes()[parent as usize].area();
                squares[index] += shrink * squares[parent as usize];
            }
        }
        for &leaf in operator.leaves() {
            let root = tree.nodes()[leaf as usize].root().unwrap_or(0);
            let reflectance = surfaces.reflectance.row(root).iter().copied().fold(0.0, f64::max);
            self.nodes[leaf as usize][1] = reflectance * squares[leaf as usize].sqrt();
        }
    }

    /// Contrast of the other nodes from their children: γ² = Σ A (γ² + (β − β̄)²)/Σ A.
    fn contrast(&mut self, tree: &Tree) {
        for (index, node) in tree.nodes().iter().enumerate().rev() {
            if node.is_leaf() {
                continue;
            }
            let mean = self.nodes[index][0];
            let square = |&child: &u32| {
                let [brightness, contrast, _] = self.nodes[child as usize];
                let share = tree.nodes()[child as usize].area() / node.area();
                share * (contrast * contrast + (brightness - mean) * (brightness - mean))
            };
            self.nodes[index][1] = node.children().iter().map(square).sum::<f64>().sqrt();
        }
    }

    /// Brightness of clusters from their children, then their contrast.
    fn summarise(&mut self, tree: &Tree) {
        for (index, node) in tree.nodes().iter().enumerate().rev() {
            if !node.is_leaf() {
                let share = |&child: &u32| {
                    self.nodes[child as usize][0] * tree.nodes()[child as usize].area() / node.area()
                };
                self.nodes[index][0] = node.children().iter().map(share).sum();
            }
        }
        self.contrast(tree);
    }

    /// Gives new children what is known of their parent; contrast halves with the size.
    pub(crate) fn inherit(&mut self, tree: &Tree, parent: u32) {
        if self.nodes.len() < tree.nodes().len() {
            let [brightness, contrast, level] = self.nodes[parent as usize];
            self.nodes.resize(tree.nodes().len(), [brightness, 0.5 * contrast, level]);
            if let Some(weights) = &mut self.weights {
                weights.resize(tree.nodes().len(), weights[parent as usize]);
            }
        }
    }
}

/// Share of the reflected ambient light by which it may vary over an input element.
const AMBIENT_VARIATION: f64 = 0.3;

/// The ambient irradiance of each band, W/m².
pub(crate) fn ambient(tree: &Tree, surfaces: &Surfaces) -> Vec<f64> {
    let bands = surfaces.exitance.rhs_count();
    let (mut emitted, mut absorbing) = (vec![0.0; bands], vec![0.0; bands]);
    for (root, &node) in tree.roots().iter().enumerate() {
        let area = tree.nodes()[node as usize].area();
        for band in 0..bands {
            emitted[band] += area * surfaces.exitance.row(root)[band];
            absorbing[band] += area * (1.0 - surfaces.reflectance.row(root)[band]);
        }
    }
    emitted.iter().zip(absorbing).map(|(m, a)| m / a).collect()
}

/// Root-mean-square irradiance of the input elements in each band, W/m².
fn unit(tree: &Tree, irradiance: &MultiVector<f64>) -> Vec<f64> {
    let (mut squares, mut area) = (vec![0.0; irradiance.rhs_count()], 0.0);
    for &root in tree.roots() {
        let size = tree.nodes()[root as usize].area();
        area += size;
        let row = irradiance.row(root as usize);
        squares.iter_mut().zip(row).for_each(|(square, e)| *square += size * e * e);
    }
    squares.into_iter().map(|square| (square / area).sqrt()).collect()
}
