//! Directions on the sphere: Gauss points in cos θ, even steps in φ.
//!
//! With n rows and 2n columns the rule integrates spherical harmonics up to degree 2n − 1 exactly.
//! There is an even number of rows, so that the opposite of every direction of the northern half is
//! one of the southern half.

use fredholm_mesh::Vec3;
use fredholm_quadrature::gauss_legendre;
use std::f64::consts::PI;

/// A direction and the two unit vectors across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// The direction, a unit vector.
    pub along: Vec3,
    /// The unit vector in which θ grows.
    pub theta: Vec3,
    /// The unit vector in which φ grows.
    pub phi: Vec3,
}

/// Directions in rows of one θ each, row by row from the north on.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// θ of the rows, increasing.
    pub(crate) angles: Vec<f64>,
    /// Weights of the directions of each row; all of them sum to 4π.
    weights: Vec<f64>,
}

impl Grid {
    /// Directions enough for products of degree 2 · `degree` + 1.
    pub(crate) fn new(degree: usize) -> Self {
        let rows = (degree + 1).next_multiple_of(2);
        let columns = 2 * rows;
        let rule = gauss_legendre(rows);
        Self {
            rows,
            columns,
            angles: rule.points.iter().map(|x| (1.0 - 2.0 * x).acos()).collect(),
            weights: rule.weights.iter().map(|weight| 4.0 * PI * weight / columns as f64).collect(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.rows * self.columns
    }

    /// Directions of the northern half, which come first.
    pub(crate) fn half(&self) -> usize {
        self.len() / 2
    }

    pub(crate) fn weight(&self, at: usize) -> f64 {
        self.weights[at / self.columns]
    }

    /// The place of the opposite direction.
    pub(crate) fn opposite(&self, at: usize) -> usize {
        let (row, column) = (at / self.columns, at % self.columns);
        (self.rows - 1 - row) * self.columns + (column + self.rows) % self.columns
    }

    pub(crate) fn direction(&self, at: usize) -> Direction {
        let (row, column) = (at / self.columns, at % self.columns);
        let (sin, cos) = self.angles[row].sin_cos();
        let (up, across) = (2.0 * PI * column as f64 / self.columns as f64).sin_cos();
        Direction {
            along: Vec3::new(sin * across, sin * up, cos),
            theta: Vec3::new(cos * across, cos * up, -sin),
            phi: Vec3::new(-up, across, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposites_are_opposite_and_the_rule_is_exact() {
        let grid = Grid::new(6);
        assert_eq!((grid.rows, grid.columns), (8, 16));
        let mut sums = [0.0; 3];
        for at in 0..grid.len() {
            let [one, other] = [at, grid.opposite(at)].map(|at| grid.direction(at));
            assert!((one.along + other.along).length() < 1e-14);
            assert!((one.theta - other.theta).length() < 1e-14 && (one.phi + other.phi).length() < 1e-14);
            assert!((one.theta.cross(one.phi) - one.along).length() < 1e-14);
            let Vec3 { x, y, z } = one.along;
            let values = [1.0, x * x * y * y * z * z, z.powi(14)];
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += grid.weight(at) * value);
        }
        let exact = [4.0 * PI, 4.0 * PI / 105.0, 4.0 * PI / 15.0];
        assert!(sums.iter().zip(exact).all(|(sum, exact)| (sum - exact).abs() < 1e-12), "{sums:?}");
    }
}
