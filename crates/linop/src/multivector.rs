//! Several vectors side by side: one unknown a row, one for each right-hand
//! side: a band of light, an incident wave.
//!
//! Entry (i, l) is stored at i · count + l, so that one entry of a matrix, once read, serves all
//! right-hand sides.

use crate::{LinopError, Scalar};

/// A dim × count array, the values of one unknown being neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct MultiVector<T> {
    dim: usize,
    rhs_count: usize,
    data: Vec<T>,
}

impl<T: Scalar> MultiVector<T> {
    /// All zeros.
    #[must_use]
    pub fn zeros(dim: usize, rhs_count: usize) -> Self {
        Self { dim, rhs_count, data: vec![T::zero(); dim * rhs_count] }
    }

    /// Entry (i, l) is `value(i, l)`.
    #[must_use]
    pub fn from_fn(dim: usize, rhs_count: usize, mut value: impl FnMut(usize, usize) -> T) -> Self {
        let mut vector = Self::zeros(dim, rhs_count);
        for i in 0..dim {
            for l in 0..rhs_count {
                vector.data[i * rhs_count + l] = value(i, l);
            }
        }
        vector
    }

    /// Takes `data` as it is stored: entry (i, l) at i · count + l.
    ///
    /// # Errors
    /// [`LinopError::Length`] unless `data` has dim · count entries.
    pub fn from_vec(dim: usize, rhs_count: usize, data: Vec<T>) -> Result<Self, LinopError> {
        let expected = dim as u128 * rhs_count as u128;
        if data.len() as u128 != expected {
            return Err(LinopError::Length { what: "the multivector", expected, found: data.len() });
        }
        Ok(Self { dim, rhs_count, data })
    }

    /// Number of unknowns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of right-hand sides.
    #[must_use]
    pub fn rhs_count(&self) -> usize {
        self.rhs_count
    }

    /// The values of unknown `i`, one for each right-hand side.
    ///
    /// # Panics
    /// There is no unknown `i`.
    #[must_use]
    pub fn row(&self, i: usize) -> &[T] {
        &self.data[i * self.rhs_count..(i + 1) * self.rhs_count]
    }

    /// The values of unknown `i`, one for each right-hand side.
    ///
    /// # Panics
    /// There is no unknown `i`.
    pub fn row_mut(&mut self, i: usize) -> &mut [T] {
        &mut self.data[i * self.rhs_count..(i + 1) * self.rhs_count]
    }

    /// Vector `l`: the values of all unknowns for right-hand side `l`, copied.
    ///
    /// # Panics
    /// There is no right-hand side `l`.
    #[must_use]
    pub fn vector(&self, l: usize) -> Vec<T> {
        (0..self.dim).map(|i| self.row(i)[l]).collect()
    }

    /// Sets vector `l`, the values of all unknowns for right-hand side `l`.
    ///
    /// # Panics
    /// There is no right-hand side `l`, or `values` has not dim entries.
    pub fn set_vector(&mut self, l: usize, values: &[T]) {
        assert_eq!(values.len(), self.dim, "a vector has one value for each unknown");
        for (i, &value) in values.iter().enumerate() {
            self.row_mut(i)[l] = value;
        }
    }

    /// Sets every entry.
    pub fn fill(&mut self, value: T) {
        self.data.fill(value);
    }

    /// Entries as they are stored.
    #[must_use]
    pub fn as_slice(&self) -> &[T] {
        &self.data
    }

    /// Entries as they are stored.
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// ‖·‖₂ of each vector.
    #[must_use]
    pub fn norms(&self) -> Vec<f64> {
        norms(self.rhs_count, self.data.iter().copied())
    }

    /// Σ_i conj(u_i) v_i for each right-hand side, u being this vector.
    ///
    /// # Panics
    /// The vectors do not have the same shape.
    #[must_use]
    pub fn dots(&self, v: &Self) -> Vec<T> {
        self.check_shape(v);
        let mut sums = vec![T::zero(); self.rhs_count];
        for (u, v) in self.rows().zip(v.rows()) {
            sums.iter_mut().zip(u.iter().zip(v)).for_each(|(sum, (&u, &v))| *sum += u.conj() * v);
        }
        sums
    }

    /// u += f v, with a factor f for each right-hand side, u being this vector.
    ///
    /// # Panics
    /// The vectors do not have the same shape.
    pub fn add_scaled(&mut self, factors: &[T], v: &Self) {
        self.check_shape(v);
        let rhs_count = self.rhs_count.max(1);
        for (u, v) in self.data.chunks_exact_mut(rhs_count).zip(v.rows()) {
            u.iter_mut().zip(factors.iter().zip(v)).for_each(|(u, (&f, &v))| *u += f * v);
        }
    }

    /// u = f u + v, with a factor f for each right-hand side, u being this vector.
    ///
    /// # Panics
    /// The vectors do not have the same shape.
    pub fn scale_and_add(&mut self, factors: &[T], v: &Self) {
        self.check_shape(v);
        let rhs_count = self.rhs_count.max(1);
        for (u, v) in self.data.chunks_exact_mut(rhs_count).zip(v.rows()) {
            u.iter_mut().zip(factors.iter().zip(v)).for_each(|(u, (&f, &v))| *u = f * *u + v);
        }
    }

    /// u = v − w, u being this vector.
    ///
    /// # Panics
    /// The vectors do not have the same shape.
    pub fn set_difference(&mut self, v: &Self, w: &Self) {
        self.check_shape(v);
        self.check_shape(w);
        let terms = v.data.iter().zip(&w.data);
        self.data.iter_mut().zip(terms).for_each(|(u, (&v, &w))| *u = v - w);
    }

    /// u_i = w_i v_i for every entry, u being this vector.
    ///
    /// # Panics
    /// The vectors do not have the same shape.
    pub fn set_products(&mut self, w: &Self, v: &Self) {
        self.check_shape(w);
        self.check_shape(v);
        let terms = w.data.iter().zip(&v.data);
        self.data.iter_mut().zip(terms).for_each(|(u, (&w, &v))| *u = w * v);
    }

    /// u = v, without a new allocation, u being this vector.
    ///
    /// # Panics
    /// The vectors do not have the same shape.
    pub fn copy_from(&mut self, v: &Self) {
        self.check_shape(v);
        self.data.copy_from_slice(&v.data);
    }

    /// Whether every entry is 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.data.iter().all(|&value| value == T::zero())
    }

    /// The unknowns in order, the values of each for all right-hand sides.
    pub fn rows(&self) -> impl Iterator<Item = &[T]> {
        self.data.chunks_exact(self.rhs_count.max(1))
    }

    fn check_shape(&self, other: &Self) {
        assert_eq!((self.dim, self.rhs_count), (other.dim, other.rhs_count), "the shapes must be the same");
    }

    /// First entry that is NaN or infinite, as (unknown, right-hand side).
    #[must_use]
    pub fn not_finite(&self) -> Option<(usize, usize)> {
        let at = self.data.iter().position(|value| !value.is_finite())?;
        Some((at / self.rhs_count, at % self.rhs_count))
    }
}

/// ‖·‖₂ of each vector of values in storage order, scaled by the largest one so that squares
/// neither overflow nor vanish. A NaN or an infinity among the values makes the norm of its vector
/// not finite.
pub(crate) fn norms<T: Scalar>(rhs_count: usize, values: impl Iterator<Item = T> + Clone) -> Vec<f64> {
    let scales = largest(rhs_count, values.clone());
    let mut sums = vec![0.0; rhs_count];
    for (at, value) in values.enumerate() {
        let scaled = value.abs() / scales[at % rhs_count];
        sums[at % rhs_count] += scaled * scaled;
    }
    sums.iter().zip(&scales).map(|(sum, scale)| scale * sum.sqrt()).collect()
}

/// Largest absolute value of each vector, or 1 where that is no scale.
fn largest<T: Scalar>(rhs_count: usize, values: impl Iterator<Item = T>) -> Vec<f64> {
    let mut largest = vec![0.0; rhs_count];
    for (at, value) in values.enumerate() {
        largest[at % rhs_count] = value.abs().max(largest[at % rhs_count]);
    }
    largest.into_iter().map(|scale| if scale > 0.0 && scale.is_finite() { scale } else { 1.0 }).collect()
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "these results are exact")]
mod tests {
    use super::*;
    use num_complex::Complex64;

    #[test]
    fn right_hand_sides_of_one_unknown_are_neighbours() {
        let mut vector = MultiVector::from_fn(3, 2, |i, l| (10 * i + l) as f64);
        assert_eq!(vector.as_slice(), [0.0, 1.0, 10.0, 11.0, 20.0, 21.0]);
        assert_eq!(vector.row(1), [10.0, 11.0]);
        assert_eq!(vector.vector(1), [1.0, 11.0, 21.0]);
        vector.set_vector(0, &[7.0, 8.0, 9.0]);
        assert_eq!(vector.as_slice(), [7.0, 1.0, 8.0, 11.0, 9.0, 21.0]);
    }

    #[test]
    fn right_hand_sides_are_combined_each_by_itself() {
        let u = MultiVector::from_vec(2, 2, vec![1.0, 10.0, 2.0, 20.0]).unwrap();
        let v = MultiVector::from_vec(2, 2, vec![3.0, 5.0, 4.0, 6.0]).unwrap();
        assert_eq!(u.dots(&v), [11.0, 170.0]);
        let mut w = u.clone();
        w.add_scaled(&[2.0, 0.0], &v);
        assert_eq!(w.as_slice(), [7.0, 10.0, 10.0, 20.0]);
        w.scale_and_add(&[0.0, 1.0], &v);
        assert_eq!(w.as_slice(), [3.0, 15.0, 4.0, 26.0]);
        w.set_difference(&u, &v);
        assert_eq!(w.as_slice(), [-2.0, 5.0, -2.0, 14.0]);
        w.set_products(&u, &v);
        assert_eq!(w.as_slice(), [3.0, 50.0, 8.0, 120.0]);
        w.copy_from(&u);
        assert!(w == u && !w.is_zero() && MultiVector::<f64>::zeros(3, 1).is_zero());
        let z = MultiVector::from_vec(1, 1, vec![Complex64::new(0.0, 2.0)]).unwrap();
        assert_eq!(z.dots(&z), [Complex64::new(4.0, 0.0)]);
    }

    #[test]
    fn norms_are_euclidean_at_any_magnitude() {
        for scale in [1.0, 1e-300, 1e300, 5e-324] {
            let vector = MultiVector::from_vec(2, 2, vec![3.0 * scale, 0.0, 4.0 * scale, 0.0]).unwrap();
            assert!((vector.norms()[0] / scale - 5.0).abs() < 1e-12, "{scale}");
            assert_eq!(vector.norms()[1], 0.0);
        }
        let vector = MultiVector::from_vec(1, 1, vec![Complex64::new(3.0, 4.0)]).unwrap();
        assert_eq!(vector.norms(), [5.0]);
    }

    #[test]
    fn a_number_that_is_not_finite_spoils_the_norm_of_its_right_hand_side_only() {
        for bad in [f64::NAN, f64::INFINITY] {
            let vector = MultiVector::from_vec(2, 2, vec![bad, 1.0, 2.0, 0.0]).unwrap();
            assert!(!vector.norms()[0].is_finite());
            assert_eq!(vector.norms()[1], 1.0);
            assert_eq!(vector.not_finite(), Some((0, 0)));
        }
    }

    #[test]
    fn a_wrong_length_is_refused() {
        let wrong = LinopError::Length { what: "the multivector", expected: 6, found: 5 };
        assert_eq!(MultiVector::from_vec(2, 3, vec![0.0; 5]), Err(wrong));
    }
}
