//! Lagrange polynomials: φ_a of degree k with φ_a(x_b) = δ_ab. P_k on the triangle, Q_k (degree k
//! in each direction) on the square.
//!
//! G. Peyré's article on integral equations, section 3.2; P. G. Ciarlet, *The Finite Element Method
//! for Elliptic Problems*, North-Holland 1978, section 2.2. Two sets of nodes:
//!
//! - [`Nodes::Interior`]: the (k + 1)² Gauss points of the square; on the triangle the 1, 3 and 6
//!   points of the symmetric rules of degree 1, 2 and 4. They are the points of collocation and of
//!   Nyström's rule, and lie off the edges, where normals jump.
//! - [`Nodes::Border`]: equally spaced from corner to corner, for continuity across edges. Of
//!   degree 1 and 2.
//!
//! Dimensionless.

use crate::DiscretisationError;
use crate::cholesky::Cholesky;
use fredholm_quadrature::{PlanePoint, gauss_legendre, symmetric_triangle, tensor_quad};

/// Most nodes of an element: those of Q2.
pub const MOST_NODES: usize = 9;
/// Highest degree.
pub const HIGHEST_DEGREE: usize = 2;

/// Where the nodes of a basis lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodes {
    /// At the points of a quadrature rule inside.
    Interior,
    /// Equally spaced, at the corners and along the edges too.
    Border,
}

/// The Lagrange basis of one degree on one domain.
#[derive(Clone, Debug)]
pub struct Lagrange {
    nodes: Vec<PlanePoint>,
    form: Form,
}

#[derive(Clone, Debug)]
enum Form {
    /// Products of one-dimensional polynomials with these nodes.
    Product(Vec<f64>),
    /// Σ_b c_ab ψ_b with ψ the basis of equally spaced nodes of this degree; no matrix where it is
    /// that basis.
    Triangle(usize, Option<Vec<f64>>),
}

impl Lagrange {
    /// The basis of `degree`, at most 2, on the domain with 3 or 4 `sides`.
    ///
    /// # Errors
    /// A rule that is not in the table; not for the degrees 0, 1 and 2.
    pub fn new(sides: usize, degree: usize, nodes: Nodes) -> Result<Self, DiscretisationError> {
        // A constant has no nodes on the border.
        match (sides, nodes) {
            (3, Nodes::Border) if degree > 0 => {
                Ok(Self { nodes: even_triangle(degree), form: Form::Triangle(degree, None) })
            }
            (3, _) => Self::inner_triangle(degree),
            (_, Nodes::Border) if degree > 0 => Ok(Self::product(&even(degree), even_square(degree))),
            _ => Ok(Self::product(&gauss_legendre(degree + 1).points, tensor_quad(degree + 1))),
        }
    }

    fn product(line: &[f64], nodes: Vec<PlanePoint>) -> Self {
        Self { nodes, form: Form::Product(line.to_vec()) }
    }

    fn inner_triangle(degree: usize) -> Result<Self, DiscretisationError> {
        let nodes = symmetric_triangle((2 * degree).max(1))?;
        // Never refused for these nodes; the type of the error is the nearest there is.
        let change =
            inverse_transpose(&nodes, degree).ok_or(DiscretisationError::Degenerate { element: 0 })?;
        Ok(Self { nodes, form: Form::Triangle(degree, Some(change)) })
    }

    /// Number of functions, and of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none; there always are.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The nodes. For [`Nodes::Interior`] the weights are those of the rule; else they are 0.
    #[must_use]
    pub fn nodes(&self) -> &[PlanePoint] {
        &self.nodes
    }

    /// φ_a(u, v) for all a; entries beyond [`len`](Self::len) are 0.
    #[must_use]
    pub fn values(&self, u: f64, v: f64) -> [f64; MOST_NODES] {
        match &self.form {
            Form::Product(line) => product_values(line, u, v),
            Form::Triangle(degree, None) => even_values(*degree, u, v),
            Form::Triangle(degree, Some(change)) => turned(change, self.len(), even_values(*degree, u, v)),
        }
    }
}

fn turned(change: &[f64], count: usize, even: [f64; MOST_NODES]) -> [f64; MOST_NODES] {
    let mut values = [0.0; MOST_NODES];
    for (value, row) in values.iter_mut().zip(change.chunks_exact(count)) {
        *value = row.iter().zip(even).map(|(c, psi)| c * psi).sum();
    }
    values
}

/// C with φ = C ψ: C Pᵀ = I for P_ab = ψ_b(x_a), from the normal equations (P Pᵀ) C = P.
fn inverse_transpose(nodes: &[PlanePoint], degree: usize) -> Option<Vec<f64>> {
    let n = nodes.len();
    let rows: Vec<_> = nodes.iter().map(|p| even_values(degree, p.u, p.v)).collect();
    let dot = |a: &[f64; MOST_NODES], b: &[f64; MOST_NODES]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let gram = rows.iter().flat_map(|a| rows.iter().map(move |b| dot(a, b))).collect();
    let mut change: Vec<f64> = rows.iter().flat_map(|row| row[..n].to_vec()).collect();
    Cholesky::new(n, gram)?.solve(&mut change, n);
    Some(change)
}

fn even(degree: usize) -> Vec<f64> {
    (0..=degree).map(|i| i as f64 / degree as f64).collect()
}

fn even_square(degree: usize) -> Vec<PlanePoint> {
    let line = even(degree);
    line.iter().flat_map(|&u| line.iter().map(move |&v| PlanePoint { u, v, weight: 0.0 })).collect()
}

/// Corners, then the middles of the sides.
fn even_triangle(degree: usize) -> Vec<PlanePoint> {
    let all = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.0), (0.5, 0.5), (0.0, 0.5)];
    let count = if degree == 1 { 3 } else { 6 };
    all[..count].iter().map(|&(u, v)| PlanePoint { u, v, weight: 0.0 }).collect()
}

/// 1, λ_i, or λ_i (2 λ_i − 1) and 4 λ_i λ_j.
fn even_values(degree: usize, u: f64, v: f64) -> [f64; MOST_NODES] {
    let w = 1.0 - u - v;
    let mut values = [0.0; MOST_NODES];
    match degree {
        0 => values[0] = 1.0,
        1 => values[..3].copy_from_slice(&[w, u, v]),
        _ => {
            let corners = [w, u, v].map(|x| x * (2.0 * x - 1.0));
            values[..3].copy_from_slice(&corners);
            values[3..6].copy_from_slice(&[4.0 * w * u, 4.0 * u * v, 4.0 * v * w]);
        }
    }
    values
}

fn product_values(line: &[f64], u: f64, v: f64) -> [f64; MOST_NODES] {
    let n = line.len();
    let (along_u, along_v) = (line_values(line, u), line_values(line, v));
    let mut values = [0.0; MOST_NODES];
    for (at, value) in values[..n * n].iter_mut().enumerate() {
        *value = along_u[at / n] * along_v[at % n];
    }
    values
}

/// Π_{b≠a} (x − x_b)/(x_a − x_b) for all a.
fn line_values(line: &[f64], x: f64) -> [f64; HIGHEST_DEGREE + 1] {
    let mut values = [0.0; HIGHEST_DEGREE + 1];
    for (a, value) in values[..line.len()].iter_mut().enumerate() {
        let others = line.iter().enumerate().filter(|(b, _)| *b != a);
        *value = others.map(|(_, &xb)| (x - xb) / (line[a] - xb)).product();
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> impl Iterator<Item = (usize, usize, Lagrange)> {
        let kinds = [Nodes::Interior, Nodes::Border];
        let each = move |sides| {
            kinds.into_iter().flat_map(move |kind| {
                (0..=HIGHEST_DEGREE).map(move |k| (sides, k, Lagrange::new(sides, k, kind).unwrap()))
            })
        };
        [3, 4].into_iter().flat_map(each)
    }

    #[test]
    fn is_one_at_its_own_node_and_zero_at_the_others() {
        for (sides, k, basis) in all() {
            let expected = if sides == 3 { (k + 1) * (k + 2) / 2 } else { (k + 1) * (k + 1) };
            assert_eq!(basis.len(), expected);
            for (a, p) in basis.nodes().iter().enumerate() {
                for (b, value) in basis.values(p.u, p.v).iter().enumerate() {
                    let exact = f64::from(u8::from(a == b));
                    assert!((value - exact).abs() < 1e-13, "{sides} sides, degree {k}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn reproduces_every_polynomial_of_its_degree_and_not_the_next() {
        let (u, v) = (0.23, 0.31);
        for (sides, k, basis) in all() {
            let error = |i: usize, j: usize| {
                let f = |u: f64, v: f64| u.powi(i as i32) * v.powi(j as i32);
                let nodal = basis.nodes().iter().map(|p| f(p.u, p.v));
                (nodal.zip(basis.values(u, v)).map(|(x, phi)| x * phi).sum::<f64>() - f(u, v)).abs()
            };
            for i in 0..=k {
                for j in 0..=if sides == 3 { k - i } else { k } {
                    assert!(error(i, j) < 1e-13, "{sides} sides, degree {k}: u^{i} v^{j}");
                }
            }
            assert!(error(k + 1, 0) > 1e-4 && error(0, k + 1) > 1e-4);
        }
    }
}
