//! The space of trial functions x_h = Σ_j x_j φ_j on a surface, discontinuous or continuous.
//!
//! Discontinuous, each element has the unknowns of its own Lagrange basis. Conforming, nodes that
//! coincide are one unknown where the elements belong to one face and their normals differ by at
//! most an angle; a node that lies on the middle of a neighbour's edge (a hanging node) is not
//! joined. P. G. Ciarlet, *The Finite Element Method for Elliptic Problems*, North-Holland 1978,
//! section 2.3.

use crate::lagrange::{Lagrange, MOST_NODES, Nodes};
use crate::{DiscretisationError, Site, Surface};
use fredholm_linop::MultiVector;
use fredholm_mesh::Vec3;
use std::collections::BTreeMap;

/// Distance, relative to the extent of the surface, up to which nodes are one.
const TOLERANCE: f64 = 1e-9;
/// Width of the cubes that nodes are sorted into, over the tolerance.
const CUBE_WIDTH: f64 = 4.0;

/// Piecewise polynomials of one degree.
#[derive(Debug)]
pub struct Space<'a> {
    surface: &'a Surface,
    degree: usize,
    triangle: Lagrange,
    quad: Lagrange,
    dofs: Vec<usize>,
    starts: Vec<usize>,
    dim: usize,
}

impl<'a> Space<'a> {
    /// Every element on its own, with nodes inside it.
    ///
    /// # Errors
    /// Not for the degrees 0, 1 and 2.
    pub fn discontinuous(surface: &'a Surface, degree: usize) -> Result<Self, DiscretisationError> {
        let mut space = Self::new(surface, degree, Nodes::Interior)?;
        space.dim = *space.starts.last().unwrap_or(&0);
        space.dofs = (0..space.dim).collect();
        Ok(space)
    }

    /// Continuous within every face, across edges where the normals differ by at most `degrees`. Of
    /// degree 1 or 2; with 0 this is [`discontinuous`](Self::discontinuous).
    ///
    /// # Errors
    /// Not for the degrees 0, 1 and 2.
    pub fn conforming(
        surface: &'a Surface,
        degree: usize,
        degrees: f64,
    ) -> Result<Self, DiscretisationError> {
        if degree == 0 {
            return Self::discontinuous(surface, degree);
        }
        let mut space = Self::new(surface, degree, Nodes::Border)?;
        let mut joints = Joints::new(&space, degrees.to_radians().cos());
        let sites = space.node_sites();
        space.dofs = sites.iter().map(|site| joints.dof(site, surface.face(site.element))).collect();
        space.dim = joints.sites.len();
        Ok(space)
    }

    fn new(surface: &'a Surface, degree: usize, nodes: Nodes) -> Result<Self, DiscretisationError> {
        let (triangle, quad) = (Lagrange::new(3, degree, nodes)?, Lagrange::new(4, degree, nodes)?);
        let mut starts = vec![0];
        for i in 0..surface.len() {
            let count = if surface.chart(i).sides() == 3 { triangle.len() } else { quad.len() };
            starts.push(starts[i] + count);
        }
        Ok(Self { surface, degree, triangle, quad, dofs: Vec::new(), starts, dim: 0 })
    }

    /// The surface.
    #[must_use]
    pub fn surface(&self) -> &'a Surface {
        self.surface
    }

    /// Degree of the polynomials.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of unknowns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The basis of element `i`.
    ///
    /// # Panics
    /// Like a slice, where there is no such element.
    #[must_use]
    pub fn basis(&self, i: usize) -> &Lagrange {
        if self.surface.chart(i).sides() == 3 { &self.triangle } else { &self.quad }
    }

    /// The unknowns of element `i`, in the order of its basis.
    ///
    /// # Panics
    /// Like a slice, where there is no such element.
    #[must_use]
    pub fn dofs(&self, i: usize) -> &[usize] {
        &self.dofs[self.starts[i]..self.starts[i + 1]]
    }

    /// The nodes of all elements, element after element; those that elements share are repeated.
    #[must_use]
    pub fn node_sites(&self) -> Vec<Site> {
        (0..self.surface.len()).flat_map(|i| self.nodes_of(i)).collect()
    }

    /// The nodes of element `i`.
    ///
    /// # Panics
    /// Like a slice, where there is no such element.
    #[must_use]
    pub fn nodes_of(&self, i: usize) -> Vec<Site> {
        self.basis(i).nodes().iter().map(|p| self.surface.site(i, p.u, p.v)).collect()
    }

    /// x_h(u, v) on element `i` in one right-hand side of the coefficients `x` (unknowns ×
    /// right-hand sides).
    ///
    /// # Panics
    /// Where there is no such element or right-hand side.
    #[must_use]
    pub fn value(&self, x: &MultiVector<f64>, rhs: usize, i: usize, u: f64, v: f64) -> f64 {
        let values = self.basis(i).values(u, v);
        self.dofs(i).iter().zip(values).map(|(&dof, phi)| phi * x.row(dof)[rhs]).sum()
    }

    /// Σ over points (u, v, w) of element `i` of w φ_a(u, v), for all a.
    pub(crate) fn moments(&self, i: usize, points: &[fredholm_quadrature::PlanePoint]) -> [f64; MOST_NODES] {
        let basis = self.basis(i);
        let mut sums = [0.0; MOST_NODES];
        for p in points {
            let values = basis.values(p.u, p.v);
            sums.iter_mut().zip(values).for_each(|(sum, phi)| *sum += p.weight * phi);
        }
        sums
    }
}

/// Nodes that have become unknowns, found by position. The map is ordered, and only asked for
/// single cubes.
struct Joints {
    cosine: f64,
    tolerance: f64,
    cubes: BTreeMap<[i64; 3], Vec<usize>>,
    sites: Vec<(Site, usize)>,
}

impl Joints {
    fn new(space: &Space, cosine: f64) -> Self {
        let sites = space.node_sites();
        let low = sites.iter().map(|s| s.position).fold(Vec3::INFINITY, Vec3::min);
        let high = sites.iter().map(|s| s.position).fold(Vec3::NEG_INFINITY, Vec3::max);
        let extent = if sites.is_empty() { 1.0 } else { low.distance(high) };
        Self { cosine, tolerance: TOLERANCE * extent, cubes: BTreeMap::new(), sites: Vec::new() }
    }

    /// The unknown of a node of `face`.
    fn dof(&mut self, site: &Site, face: usize) -> usize {
        self.find(site, face).unwrap_or_else(|| {
            let dof = self.sites.len();
            self.cubes.entry(self.cube(site.position)).or_default().push(dof);
            self.sites.push((*site, face));
            dof
        })
    }

    fn find(&self, site: &Site, face: usize) -> Option<usize> {
        let [low, high] = [-1.0, 1.0].map(|sign| self.cube(site.position + sign * self.tolerance));
        let mut found: Option<usize> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let inside = self.cubes.get(&[x, y, z]).into_iter().flatten().copied();
                    found = inside.filter(|&dof| self.joins(dof, site, face)).chain(found).min();
                }
            }
        }
        found
    }

    fn joins(&self, dof: usize, site: &Site, face: usize) -> bool {
        let (other, its_face) = &self.sites[dof];
        *its_face == face
            && other.element != site.element
            && other.position.distance(site.position) <= self.tolerance
            && other.normal.dot(site.normal) >= self.cosine
    }

    fn cube(&self, point: Vec3) -> [i64; 3] {
        (point / (CUBE_WIDTH * self.tolerance)).floor().as_i64vec3().to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manufactured::{facing_squares, facing_triangles, inside_of_a_sphere};

    #[test]
    fn conforming_unknowns_are_the_nodes_of_the_grid() {
        // A square of n × n cells has (k n + 1)² nodes, of quads as of triangles; a sphere of six
        // faces 6 (k n)² + 2.
        for (n, k) in [(1, 1), (3, 1), (3, 2)] {
            let nodes = 2 * (k * n + 1) * (k * n + 1);
            for problem in [facing_squares(), facing_triangles()] {
                let surface = problem.surface(n).unwrap();
                assert_eq!(Space::conforming(&surface, k, 30.0).unwrap().dim(), nodes, "{}", problem.name);
            }
            let surface = inside_of_a_sphere().surface(n).unwrap();
            let expected = 6 * (k * n) * (k * n) + 2;
            assert_eq!(Space::conforming(&surface, k, 30.0).unwrap().dim(), expected);
        }
    }

    #[test]
    fn a_conforming_function_has_one_value_on_an_edge_and_a_discontinuous_one_two() {
        let surface = facing_squares().surface(2).unwrap();
        let jump = |space: &Space| {
            let x = MultiVector::from_fn(space.dim(), 1, |dof, _| ((7 * dof) % 5) as f64);
            // Cell 0 at its right end, cell 2 at its left one: cells run along y first.
            (space.value(&x, 0, 0, 1.0, 0.3) - space.value(&x, 0, 2, 0.0, 0.3)).abs()
        };
        for k in [1, 2] {
            assert!(jump(&Space::conforming(&surface, k, 30.0).unwrap()) < 1e-14);
            assert!(jump(&Space::discontinuous(&surface, k).unwrap()) > 1e-2);
        }
    }
}
