//! Closure enforced: the symmetric, non-negative matrix nearest to G = A F whose row sums are the
//! areas.
//!
//! Least squares with the exchange itself as the weight,
//!
//! ```text
//! min ½ Σ_ij (G'_ij − G_ij)² / G_ij   subject to   Σ_j G'_ij = A_i,   G' symmetric,   G' ≥ 0,
//! ```
//!
//! so that a pair changes in proportion to what it exchanges, and a pair that sees nothing stays
//! so. Weighted least squares for view factors: H. A. J. Vercammen & G. F. Froment, Int. J. Heat
//! Mass Transfer 23 (1980) 329; R. P. Taylor & R. Luck, *A case study of view-factor rectification
//! procedures for diffuse-gray radiation enclosure computations*, NASA N95-27353, 1995. The
//! conditions of the minimum give
//!
//! ```text
//! G'_ij = G_ij max(0, 1 + λ_i + λ_j),
//! ```
//!
//! with one multiplier λ a row. They maximise the concave dual Σ A_i λ_i − ¼ Σ_ij G_ij max(0, 1 +
//! λ_i + λ_j)²: Newton's method, the linear systems by conjugate gradients with the diagonal as the
//! preconditioner. Areas and exchanges in m², λ dimensionless.

use fredholm_linop::{LinopError, PackedSymmetric};
use thiserror::Error;

/// Row sums of F that differ more from 1 are those of an open scene, unless their stated error is
/// larger still.
const OPEN_SCENE_DEFECT: f64 = 0.01;
/// Stated errors of a row by which a closed row may differ from 1.
const STATED_ERRORS_OFF_ONE: f64 = 3.0;
/// Largest |Σ_j F_ij − 1| that is left.
const LARGEST_DEFECT_LEFT: f64 = 1e-13;
/// Steps of Newton's method; a few suffice where there is a solution.
const MOST_NEWTON_STEPS: usize = 60;
/// Iterations of the conjugate gradients a step.
const MOST_CG_ITERATIONS: usize = 2000;
/// Relative residual of the conjugate gradients.
const CG_RESIDUAL: f64 = 1e-15;
/// Halvings of a step.
const MOST_STEP_HALVINGS: usize = 40;
/// Share of the predicted gain that a step must bring (Armijo).
const ARMIJO_SHARE: f64 = 1e-4;

/// Why closure cannot be enforced.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ClosureError {
    /// A row that is open rather than inexact.
    #[error(
        "row {row} sums to {sum:.6}, stated error {error:.1e}: the scene is open there, and closing it would invent exchange; \
         close the scene, or let the sky close it"
    )]
    Open {
        /// Row, from 0.
        row: usize,
        /// Σ_j F_ij.
        sum: f64,
        /// Stated error of the sum.
        error: f64,
    },
    /// No matrix has these row sums and these zeros.
    #[error(
        "no symmetric non-negative matrix with the same pairs in view has closed row sums (row {row} is left with {defect:.1e}); \
         compute with a smaller tolerance, or keep the matrix as it is"
    )]
    Infeasible {
        /// Row with the largest defect, from 0.
        row: usize,
        /// Its |Σ_j F_ij − 1|.
        defect: f64,
    },
    /// Arrays that do not fit each other.
    #[error("{rows} rows have data for {found}")]
    Dimension {
        /// Number of rows.
        rows: usize,
        /// Length found.
        found: usize,
    },
    /// A matrix that cannot be built.
    #[error(transparent)]
    Linop(#[from] LinopError),
}

/// A matrix with closed rows, and how far it is from the one computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Closed {
    /// G', m².
    pub matrix: PackedSymmetric<f64>,
    /// Σ_j |F'_ij − F_ij| of every row.
    pub change: Vec<f64>,
    /// Largest |F'_ij − F_ij|.
    pub largest: f64,
    /// Steps of Newton's method.
    pub steps: usize,
}

/// Enforces Σ_j G_ij = A_i (`areas`, m²) for the first `closing` rows; the others, as that of the
/// sky, take what comes. `error` is the stated error of every row sum of F: it tells an inexact row
/// from an open one.
///
/// # Errors
/// [`ClosureError::Open`] for a row whose sum is not near 1, [`ClosureError::Infeasible`] where
/// there is no such matrix.
pub fn enforce_closure(
    matrix: &PackedSymmetric<f64>,
    areas: &[f64],
    error: &[f64],
    closing: usize,
) -> Result<Closed, ClosureError> {
    for found in [areas.len(), error.len()] {
        if found != matrix.dim() {
            return Err(ClosureError::Dimension { rows: matrix.dim(), found });
        }
    }
    let closing = closing.min(areas.len());
    refuse_open(matrix, &areas[..closing], error)?;
    let dual = Dual { matrix, areas, closing };
    let (multipliers, steps) = dual.maximise()?;
    dual.closed(&multipliers, steps)
}

fn refuse_open(matrix: &PackedSymmetric<f64>, areas: &[f64], error: &[f64]) -> Result<(), ClosureError> {
    for (row, (exchange, (area, &error))) in matrix.row_sums().iter().zip(areas.iter().zip(error)).enumerate()
    {
        let sum = exchange / area;
        let allowed = OPEN_SCENE_DEFECT.max(STATED_ERRORS_OFF_ONE * error);
        // A sum that is no number is refused as well.
        let near = (sum - 1.0).abs() <= allowed && sum > 0.0;
        if !near {
            return Err(ClosureError::Open { row, sum, error });
        }
    }
    Ok(())
}

/// The dual problem.
#[derive(Clone, Copy)]
struct Dual<'a> {
    matrix: &'a PackedSymmetric<f64>,
    areas: &'a [f64],
    /// Rows from here on have the multiplier 0.
    closing: usize,
}

impl Dual<'_> {
    /// Calls `pair` with i, j ≤ i, G_ij and 1 + λ_i + λ_j.
    fn each(&self, multipliers: &[f64], mut pair: impl FnMut(usize, usize, f64, f64)) {
        for (i, &a) in multipliers.iter().enumerate() {
            for (j, (&entry, &b)) in self.matrix.packed_row(i).iter().zip(multipliers).enumerate() {
                if entry != 0.0 {
                    pair(i, j, entry, 1.0 + a + b);
                }
            }
        }
    }

    /// The dual function, and its gradient A_i − Σ_j G'_ij, m²; 0 where a row need not close.
    fn evaluate(&self, multipliers: &[f64]) -> (f64, Vec<f64>) {
        let mut gradient = self.areas.to_vec();
        let mut quadratic = 0.0;
        self.each(multipliers, |i, j, entry, factor| {
            let kept = entry * factor.max(0.0);
            gradient[i] -= kept;
            if i != j {
                gradient[j] -= kept;
            }
            quadratic += if i == j { 0.25 } else { 0.5 } * kept * factor;
        });
        gradient[self.closing..].fill(0.0);
        let linear: f64 = self.areas.iter().zip(multipliers).map(|(area, m)| area * m).sum();
        (linear - quadratic, gradient)
    }

    /// Minus the second derivative, applied to `v`: Σ_j G_ij (v_i + v_j) over the pairs that are
    /// above 0.
    fn curvature(&self, multipliers: &[f64], v: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; v.len()];
        self.each(multipliers, |i, j, entry, factor| {
            if factor > 0.0 {
                let term = entry * (v[i] + v[j]);
                product[i] += term;
                if i != j {
                    product[j] += term;
                }
            }
        });
        product[self.closing..].fill(0.0);
        product
    }

    /// Largest |Σ_j F'_ij − 1| and its row.
    fn worst(&self, gradient: &[f64]) -> (usize, f64) {
        let defects = gradient.iter().zip(self.areas).map(|(g, area)| (g / area).abs());
        defects.enumerate().fold((0, 0.0), |worst, (row, d)| if d > worst.1 { (row, d) } else { worst })
    }

    fn maximise(&self) -> Result<(Vec<f64>, usize), ClosureError> {
        let mut multipliers = vec![0.0; self.areas.len()];
        let (mut value, mut gradient) = self.evaluate(&multipliers);
        for step in 0..MOST_NEWTON_STEPS {
            if self.worst(&gradient).1 <= LARGEST_DEFECT_LEFT {
                return Ok((multipliers, step));
            }
            let direction = self.newton(&multipliers, &gradient);
            let Some(next) = self.search(&multipliers, value, &gradient, &direction) else { break };
            (multipliers, (value, gradient)) = next;
        }
        let (row, defect) = self.worst(&gradient);
        Err(ClosureError::Infeasible { row, defect })
    }

    /// The first of the halved steps that gains enough, or one that the dual function no longer
    /// resolves but that lessens the defect.
    #[allow(clippy::type_complexity, reason = "a point with its value and gradient")]
    fn search(
        &self,
        from: &[f64],
        value: f64,
        gradient: &[f64],
        direction: &[f64],
    ) -> Option<(Vec<f64>, (f64, Vec<f64>))> {
        let slope: f64 = dot(gradient, direction);
        let defect = self.worst(gradient).1;
        (0..MOST_STEP_HALVINGS).find_map(|halving| {
            let length = 0.5_f64.powi(halving as i32);
            let to: Vec<f64> = from.iter().zip(direction).map(|(m, d)| m + length * d).collect();
            let (reached, gradient) = self.evaluate(&to);
            let gains = reached >= value + ARMIJO_SHARE * length * slope && reached > value;
            (gains || self.worst(&gradient).1 < defect).then_some((to, (reached, gradient)))
        })
    }

    /// Solves curvature · d = gradient by preconditioned conjugate gradients.
    fn newton(&self, multipliers: &[f64], gradient: &[f64]) -> Vec<f64> {
        let diagonal = self.diagonal(multipliers);
        let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
        let mut x = vec![0.0; gradient.len()];
        let mut r = gradient.to_vec();
        let mut p = scaled(&r);
        let mut energy = dot(&r, &p);
        let stop = CG_RESIDUAL * CG_RESIDUAL * energy;
        for _ in 0..MOST_CG_ITERATIONS {
            let product = self.curvature(multipliers, &p);
            let steepness = dot(&p, &product);
            if energy <= stop || steepness <= 0.0 {
                break;
            }
            let length = energy / steepness;
            x.iter_mut().zip(&p).for_each(|(x, p)| *x += length * p);
            r.iter_mut().zip(&product).for_each(|(r, q)| *r -= length * q);
            let z = scaled(&r);
            let next = dot(&r, &z);
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + next / energy * *p);
            energy = next;
        }
        x
    }

    /// The diagonal of the curvature; a row of which nothing is left takes its area, so that it can
    /// move.
    fn diagonal(&self, multipliers: &[f64]) -> Vec<f64> {
        let mut diagonal = vec![0.0; multipliers.len()];
        self.each(multipliers, |i, j, entry, factor| {
            if factor > 0.0 {
                diagonal[i] += entry * if i == j { 2.0 } else { 1.0 };
                if i != j {
                    diagonal[j] += entry;
                }
            }
        });
        diagonal.iter().zip(self.areas).map(|(&d, &area)| if d > 0.0 { d } else { area }).collect()
    }

    fn closed(&self, multipliers: &[f64], steps: usize) -> Result<Closed, ClosureError> {
        let n = self.areas.len();
        let (mut packed, mut change, mut largest) = (vec![0.0; n * (n + 1) / 2], vec![0.0; n], 0.0_f64);
        self.each(multipliers, |i, j, entry, factor| {
            let kept = entry * factor.max(0.0);
            packed[i * (i + 1) / 2 + j] = kept;
            let moved = (kept - entry).abs();
            change[i] += moved / self.areas[i];
            if i != j {
                change[j] += moved / self.areas[j];
            }
            largest = largest.max(moved / self.areas[i].min(self.areas[j]));
        });
        Ok(Closed { matrix: PackedSymmetric::new(n, packed)?, change, largest, steps })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The six walls of a unit cube: opposite walls exchange `facing`, neighbours `beside`.
    fn cube(facing: f64, beside: f64) -> Vec<f64> {
        let exchange = |i: usize, j: usize| match (i == j, i / 2 == j / 2) {
            (true, _) => 0.0,
            (_, true) => facing,
            _ => beside,
        };
        (0..6).flat_map(|i| (0..=i).map(move |j| exchange(i, j))).collect()
    }

    fn packed(entries: Vec<f64>) -> PackedSymmetric<f64> {
        let n = ((2.0 * entries.len() as f64).sqrt()) as usize;
        PackedSymmetric::new(n, entries).unwrap()
    }

    #[test]
    fn equal_rows_are_scaled_alike() {
        // By symmetry all multipliers are equal: every entry is divided by the row sum.
        let matrix = packed(cube(0.2, 0.201));
        let closed = enforce_closure(&matrix, &[1.0; 6], &[0.01; 6], 6).unwrap();
        let sum = 0.2 + 4.0 * 0.201;
        assert!((closed.matrix.get(1, 0) - 0.2 / sum).abs() < 1e-15);
        assert!((closed.matrix.get(2, 0) - 0.201 / sum).abs() < 1e-15);
        assert!((closed.change[3] - (sum - 1.0)).abs() < 1e-14 && closed.largest < 1e-3);
    }

    #[test]
    fn a_closed_matrix_does_not_change() {
        let facing = 0.199_824_895_698_387_5;
        let matrix = packed(cube(facing, 0.25 * (1.0 - facing)));
        let closed = enforce_closure(&matrix, &[1.0; 6], &[0.0; 6], 6).unwrap();
        assert_eq!((closed.steps, closed.largest), (0, 0.0));
        assert_eq!(closed.matrix, matrix);
    }

    #[test]
    fn three_surfaces_have_one_solution() {
        // With three flat surfaces G_01 = ½ (A_0 + A_1 − A_2), and so on, whatever the weights.
        let areas = [3.0, 4.0, 5.0];
        let matrix = packed(vec![0.0, 1.0 + 2e-3, 0.0, 2.0 - 3e-3, 3.0 + 5e-3, 0.0]);
        let closed = enforce_closure(&matrix, &areas, &[0.01; 3], 3).unwrap();
        for (found, exact) in
            [(1, 0, 1.0), (2, 0, 2.0), (2, 1, 3.0)].map(|(i, j, g)| (closed.matrix.get(i, j), g))
        {
            assert!((found - exact).abs() < 1e-12, "{found} {exact}");
        }
    }

    #[test]
    fn no_entry_becomes_negative_and_none_appears() {
        // Row 0 is far too large with a large stated error: the least squares without the bound
        // would turn entries negative.
        let n = 12;
        let mut entries: Vec<f64> =
            (0..n).flat_map(|i| (0..=i).map(move |j| if i == j { 0.0 } else { 1.0 / 11.0 })).collect();
        (1..n).for_each(|i| entries[i * (i + 1) / 2] *= 4.0);
        entries[n * (n - 1) / 2 + 5] = 0.0;
        let matrix = packed(entries);
        let closed = enforce_closure(&matrix, &vec![1.0; n], &vec![10.0; n], n).unwrap();
        for (i, sum) in closed.matrix.row_sums().iter().enumerate() {
            assert!((sum - 1.0).abs() < 1e-12, "{i}: {sum}");
            assert!((0..n).all(|j| closed.matrix.get(i, j) >= 0.0));
        }
        assert!(closed.matrix.get(11, 5) == 0.0 && closed.largest > 0.1);
    }

    #[test]
    fn the_bound_is_met_where_it_binds() {
        // Rows 0 and 1 exchange too much with rows 2 to 5, and those too little with each other.
        // From 1 + λ₀ + λ₂ = ¼ and 1 + 2 λ₂ = 2 follows 1 + 2 λ₀ = −1.5: the pair (0, 1) is left
        // with nothing.
        let exchange = |i: usize, j: usize| match (i < 2, j < 2) {
            _ if i == j => 0.0,
            (true, true) => 0.3,
            (false, false) => 1.0 / 12.0,
            _ => 1.0,
        };
        let matrix = packed((0..6).flat_map(|i| (0..=i).map(move |j| exchange(i, j))).collect());
        let closed = enforce_closure(&matrix, &[1.0; 6], &[10.0; 6], 6).unwrap().matrix;
        assert!(closed.get(1, 0) == 0.0);
        assert!((closed.get(2, 0) - 0.25).abs() < 1e-12 && (closed.get(5, 1) - 0.25).abs() < 1e-12);
        assert!((closed.get(3, 2) - 1.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_free_row_takes_what_comes() {
        // Two plates under a sky: the plates close, the sky is as large as one likes.
        let matrix = packed(vec![0.0, 0.2, 0.0, 0.81, 0.79, 0.0]);
        let closed = enforce_closure(&matrix, &[1.0, 1.0, 50.0], &[0.01; 3], 2).unwrap().matrix;
        let sums = closed.row_sums();
        assert!((sums[0] - 1.0).abs() < 1e-14 && (sums[1] - 1.0).abs() < 1e-14);
        // λ from 0.2 (λ₀ + λ₁) + 0.81 λ₀ = −0.01 and 0.2 (λ₀ + λ₁) + 0.79 λ₁ = 0.01.
        let determinant = 1.01 * 0.99 - 0.04;
        let multipliers =
            [(-0.01 * 0.99 - 0.01 * 0.2) / determinant, (0.01 * 1.01 + 0.01 * 0.2) / determinant];
        assert!((closed.get(1, 0) - 0.2 * (1.0 + multipliers[0] + multipliers[1])).abs() < 1e-14);
        assert!((closed.get(2, 0) - 0.81 * (1.0 + multipliers[0])).abs() < 1e-14);
    }

    #[test]
    fn open_and_impossible_scenes_are_refused() {
        let plates = packed(vec![0.0, 0.2, 0.0]);
        let open = enforce_closure(&plates, &[1.0; 2], &[1e-3; 2], 2);
        assert!(matches!(open, Err(ClosureError::Open { row: 0, .. })), "{open:?}");
        let nothing = enforce_closure(&packed(vec![0.0; 3]), &[1.0; 2], &[10.0; 2], 2);
        assert!(matches!(nothing, Err(ClosureError::Open { .. })));
        // Two surfaces of different areas cannot close on each other.
        let unequal = enforce_closure(&packed(vec![0.0, 1.0, 0.0]), &[1.0, 1.005], &[0.0; 2], 2);
        assert!(matches!(unequal, Err(ClosureError::Infeasible { .. })), "{unequal:?}");
        let short = enforce_closure(&plates, &[1.0], &[0.0; 2], 2);
        assert_eq!(short, Err(ClosureError::Dimension { rows: 2, found: 1 }));
    }
}
