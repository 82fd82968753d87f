//! The matrix F_ij = G_ij / A_i with what is known of its rows. Areas in m², the rest
//! dimensionless.

/// View factors between surfaces, and from points to surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewFactors {
    /// The surfaces, one a row and a column.
    pub surfaces: SurfaceData,
    /// F_ij.
    pub factors: Factors,
    /// Stated error of every stored factor, in their order.
    pub errors: Vec<f32>,
    /// Σ_j F_ij over all entries, those that were dropped included.
    pub row_sums: Vec<f64>,
    /// Σ_j F_ij over the entries that were dropped.
    pub row_dropped: Vec<f64>,
    /// What points see.
    pub points: Option<ViewPoints>,
}

/// Surfaces of a matrix. All vectors have an entry a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceData {
    /// Names.
    pub names: Vec<String>,
    /// Areas, m².
    pub area: Vec<f64>,
    /// Emissivities, where they are known.
    pub emissivity: Option<Vec<f64>>,
    /// Stated error of Σ_j F_ij.
    pub row_error: Vec<f64>,
}

/// Stored factors.
#[derive(Clone, Debug, PartialEq)]
pub enum Factors {
    /// All of them, row by row.
    Dense(Vec<f64>),
    /// Those of at least a threshold.
    Sparse(Sparse),
}

/// Compressed sparse rows: row i has the entries `starts[i]..starts[i + 1]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparse {
    /// Least factor that is kept.
    pub threshold: f64,
    /// Where rows start, and the number of entries.
    pub starts: Vec<u64>,
    /// Columns, rising within a row.
    pub columns: Vec<u32>,
    /// Factors.
    pub values: Vec<f64>,
}

/// What points with a normal see.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewPoints {
    /// Places, m.
    pub points: Vec<[f64; 3]>,
    /// Unit normals.
    pub normals: Vec<[f64; 3]>,
    /// Factors, points × surfaces.
    pub factors: Vec<f64>,
}

impl ViewFactors {
    /// Divides exchanges by areas. `exchange(i, row, errors)` writes row i of G and the errors
    /// stated for it (m²); `threshold` asks for sparse storage.
    ///
    /// ```
    /// use fredholm_report::{SurfaceData, ViewFactors};
    /// let surfaces = SurfaceData {
    ///     names: vec!["plate".into(), "hall".into()],
    ///     area: vec![1.0, 4.0],
    ///     emissivity: None,
    ///     row_error: vec![0.0; 2],
    /// };
    /// let exchange = [[0.0, 1.0], [1.0, 3.0]];
    /// let factors = ViewFactors::new(surfaces, Some(0.5), |i, row, errors| {
    ///     row.copy_from_slice(&exchange[i]);
    ///     errors.fill(1e-9);
    /// });
    /// assert_eq!((factors.row_sums, factors.row_dropped), (vec![1.0, 1.0], vec![0.0, 0.25]));
    /// ```
    pub fn new(
        surfaces: SurfaceData,
        threshold: Option<f64>,
        exchange: impl Fn(usize, &mut [f64], &mut [f64]),
    ) -> Self {
        let n = surfaces.area.len();
        let mut rows = Rows::new(n, threshold);
        let (mut row, mut errors, mut row_sums) = (vec![0.0; n], vec![0.0; n], Vec::with_capacity(n));
        for (i, area) in surfaces.area.iter().enumerate() {
            exchange(i, &mut row, &mut errors);
            row.iter_mut().chain(&mut errors).for_each(|entry| *entry /= area);
            row_sums.push(row.iter().sum());
            rows.push(&row, &errors);
        }
        let Rows { factors, errors, dropped } = rows;
        Self { surfaces, factors, errors, row_sums, row_dropped: dropped, points: None }
    }

    /// Number of surfaces.
    #[must_use]
    pub fn len(&self) -> usize {
        self.surfaces.area.len()
    }

    /// Whether there are no surfaces.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes row i into `row`, which has an entry a surface; what was dropped is 0.
    ///
    /// # Panics
    /// There is no such row, or `row` is of another length.
    pub fn copy_row(&self, i: usize, row: &mut [f64]) {
        match &self.factors {
            Factors::Dense(values) => row.copy_from_slice(&values[i * row.len()..(i + 1) * row.len()]),
            Factors::Sparse(sparse) => {
                row.fill(0.0);
                let entries = sparse.starts[i] as usize..sparse.starts[i + 1] as usize;
                for (&column, &value) in sparse.columns[entries.clone()].iter().zip(&sparse.values[entries]) {
                    row[column as usize] = value;
                }
            }
        }
    }

    /// Number of factors stored.
    #[must_use]
    pub fn stored(&self) -> usize {
        match &self.factors {
            Factors::Dense(values) => values.len(),
            Factors::Sparse(sparse) => sparse.values.len(),
        }
    }

    /// |Σ_j F_ij − 1| of every row.
    #[must_use]
    pub fn defects(&self) -> Vec<f64> {
        self.row_sums.iter().map(|sum| (sum - 1.0).abs()).collect()
    }
}

/// Rows on their way into storage.
struct Rows {
    factors: Factors,
    errors: Vec<f32>,
    dropped: Vec<f64>,
}

impl Rows {
    fn new(n: usize, threshold: Option<f64>) -> Self {
        let sparse = |threshold| Sparse { threshold, starts: vec![0], columns: vec![], values: vec![] };
        let dense = || Factors::Dense(Vec::with_capacity(n * n));
        let factors = threshold.map_or_else(dense, |threshold| Factors::Sparse(sparse(threshold)));
        let errors = Vec::with_capacity(if threshold.is_some() { 0 } else { n * n });
        Self { factors, errors, dropped: Vec::with_capacity(n) }
    }

    fn push(&mut self, row: &[f64], errors: &[f64]) {
        match &mut self.factors {
            Factors::Dense(values) => {
                values.extend_from_slice(row);
                self.errors.extend(errors.iter().map(|&error| rounded_up(error)));
                self.dropped.push(0.0);
            }
            Factors::Sparse(sparse) => {
                let kept = errors.iter().zip(row).filter(|(_, factor)| sparse.keeps(**factor));
                self.errors.extend(kept.map(|(&error, _)| rounded_up(error)));
                self.dropped.push(sparse.push(row));
            }
        }
    }
}

/// A stated error must not shrink where it loses digits.
fn rounded_up(error: f64) -> f32 {
    let nearest = error as f32;
    if f64::from(nearest) < error { nearest.next_up() } else { nearest }
}

impl Sparse {
    fn keeps(&self, factor: f64) -> bool {
        factor > 0.0 && factor >= self.threshold
    }

    /// Appends a row and returns the sum of what it drops.
    fn push(&mut self, row: &[f64]) -> f64 {
        let mut dropped = 0.0;
        for (column, &value) in (0..).zip(row) {
            if self.keeps(value) {
                self.columns.push(column);
                self.values.push(value);
            } else {
                dropped += value;
            }
        }
        self.starts.push(self.values.len() as u64);
        dropped
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Three surfaces with awkward names, a point and numbers that decimal fractions do not hold.
    pub(in crate::viewfactors) fn sample(threshold: Option<f64>) -> ViewFactors {
        let exchange = [[0.0, 1.0 / 3.0, 1e-12], [1.0 / 3.0, 0.1, 0.7], [1e-12, 0.7, 0.0]];
        let surfaces = SurfaceData {
            names: ["Wände, \"alle\"", "b", "модель"].map(String::from).to_vec(),
            area: vec![0.3, 1.1, 0.7],
            emissivity: Some(vec![0.9, 0.05, 1.0]),
            row_error: vec![1e-4, 2e-17, 0.0],
        };
        let mut factors = ViewFactors::new(surfaces, threshold, |i, row, errors| {
            row.copy_from_slice(&exchange[i]);
            errors.copy_from_slice(&exchange[i].map(|g| 1e-7 * g));
        });
        factors.points = Some(ViewPoints {
            points: vec![[0.1, 0.2, 0.3], [1e-300, -0.5, 7.0]],
            normals: vec![[0.0, 0.0, 1.0], [0.6, 0.8, 0.0]],
            factors: vec![0.1, 0.2, 0.3, 1.0 / 7.0, 0.0, 1e-20],
        });
        factors
    }

    #[test]
    fn sparse_rows_hold_what_is_large_enough_and_state_the_rest() {
        let (dense, sparse) = (sample(None), sample(Some(0.1)));
        assert_eq!((dense.stored(), sparse.stored()), (9, 4), "F_11 = 0.1/1.1 and what is 1e-12 m² go");
        assert_eq!(dense.row_sums, sparse.row_sums);
        let (mut full, mut kept) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            dense.copy_row(i, &mut full);
            sparse.copy_row(i, &mut kept);
            let dropped: f64 = full.iter().zip(&kept).map(|(f, k)| f - k).sum();
            assert!((dropped - sparse.row_dropped[i]).abs() < 1e-16, "{i}");
            assert!(full.iter().zip(&kept).all(|(&f, &k)| if f < 0.1 {
                k == 0.0
            } else {
                k.to_bits() == f.to_bits()
            }));
        }
        assert_eq!(dense.row_dropped, [0.0; 3]);
    }

    #[test]
    fn every_stored_factor_has_its_error_and_none_shrinks() {
        for factors in [sample(None), sample(Some(0.1))] {
            let stored = match &factors.factors {
                Factors::Dense(values) => values,
                Factors::Sparse(sparse) => &sparse.values,
            };
            assert_eq!(stored.len(), factors.errors.len());
            for (&factor, &error) in stored.iter().zip(&factors.errors) {
                let (error, stated) = (f64::from(error), 1e-7 * factor);
                assert!(
                    error >= stated * (1.0 - 1e-15) && error <= stated * (1.0 + 1e-6),
                    "{error:e} {stated:e}"
                );
            }
        }
        assert!(rounded_up(1e-60) > 0.0);
    }
}
