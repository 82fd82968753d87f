//! The surface S = ⋃ X_i(domain) as a list of charts. Metres.

use crate::{Chart, DiscretisationError, FlatChart, Site};
use fredholm_mesh::Mesh;
use fredholm_quadrature::{PlanePoint, collapsed_triangle, tensor_quad};
use std::borrow::Borrow;

/// Elements with their geometry. Elements of one *face* may share unknowns where they meet
/// smoothly.
#[derive(Debug)]
pub struct Surface {
    charts: Vec<Box<dyn Chart>>,
    faces: Vec<usize>,
}

impl Surface {
    /// Takes the charts, and for each the number of its face.
    ///
    /// # Errors
    /// [`DiscretisationError::Dimension`] where the two lists differ in length.
    pub fn new(charts: Vec<Box<dyn Chart>>, faces: Vec<usize>) -> Result<Self, DiscretisationError> {
        if charts.len() != faces.len() {
            let (found, elements) = (faces.len(), charts.len());
            return Err(DiscretisationError::Dimension { what: "the list of faces", found, elements });
        }
        Ok(Self { charts, faces })
    }

    /// The leaves of a mesh; those of one surface of the scene are one face.
    #[must_use]
    pub fn from_mesh(mesh: &Mesh) -> Self {
        let chart = |patch| Box::new(FlatChart(patch)) as Box<dyn Chart>;
        let charts = mesh.patches().copied().map(chart).collect();
        Self { charts, faces: (0..mesh.len()).map(|leaf| mesh.surface_of(leaf)).collect() }
    }

    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.charts.len()
    }

    /// Whether there is no element.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.charts.is_empty()
    }

    /// Geometry of element `i`.
    ///
    /// # Panics
    /// Like a slice, where there is no such element.
    #[must_use]
    pub fn chart(&self, i: usize) -> &dyn Chart {
        self.charts[i].borrow()
    }

    /// Face of element `i`.
    ///
    /// # Panics
    /// Like a slice, where there is no such element.
    #[must_use]
    pub fn face(&self, i: usize) -> usize {
        self.faces[i]
    }

    /// The point (u, v) of element `i`.
    ///
    /// # Panics
    /// Like a slice, where there is no such element.
    #[must_use]
    pub fn site(&self, i: usize, u: f64, v: f64) -> Site {
        let chart = self.chart(i);
        Site { element: i, u, v, position: chart.position(u, v), normal: chart.normal(u, v) }
    }

    /// The points of a rule on element `i` with their weights times dA/(du dv), m².
    ///
    /// # Panics
    /// Like a slice, where there is no such element.
    #[must_use]
    pub fn place(&self, i: usize, rule: &[PlanePoint]) -> Vec<(Site, f64)> {
        let chart = self.chart(i);
        let put = |p: &PlanePoint| (self.site(i, p.u, p.v), p.weight * chart.jacobian(p.u, p.v));
        rule.iter().map(put).collect()
    }
}

/// A rule for each of the two domains.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    triangle: Vec<PlanePoint>,
    quad: Vec<PlanePoint>,
}

impl Rules {
    /// n × n Gauss points, of degree 2n − 1 on both domains.
    #[must_use]
    pub fn gauss(n: usize) -> Self {
        Self { triangle: collapsed_triangle(n), quad: tensor_quad(n) }
    }

    /// The rule for a domain of three or four sides.
    #[must_use]
    pub fn of(&self, sides: usize) -> &[PlanePoint] {
        if sides == 3 { &self.triangle } else { &self.quad }
    }
}
