//! z = M⁻¹ r for an M that is easy to invert and near A.

use fredholm_linop::{Context, Halt, MultiVector, Scalar};

/// Applies M⁻¹.
pub(crate) trait Precondition<T: Scalar> {
    /// z = M⁻¹ r. The old values of z do not matter.
    fn apply(
        &mut self,
        r: &MultiVector<T>,
        z: &mut MultiVector<T>,
        context: &mut Context<'_>,
    ) -> Result<(), Halt>;
}

/// M = I.
pub(crate) struct Identity;

impl<T: Scalar> Precondition<T> for Identity {
    fn apply(&mut self, r: &MultiVector<T>, z: &mut MultiVector<T>, _: &mut Context<'_>) -> Result<(), Halt> {
        z.copy_from(r);
        Ok(())
    }
}

/// M⁻¹ = a diagonal.
pub(crate) struct Weights<T>(pub MultiVector<T>);

impl<T: Scalar> Precondition<T> for Weights<T> {
    fn apply(&mut self, r: &MultiVector<T>, z: &mut MultiVector<T>, _: &mut Context<'_>) -> Result<(), Halt> {
        z.set_products(&self.0, r);
        Ok(())
    }
}

/// M = a diagonal over ω.
pub(crate) struct Diagonal<T> {
    pub divisors: MultiVector<T>,
    pub omega: f64,
}

impl<T: Scalar> Precondition<T> for Diagonal<T> {
    fn apply(&mut self, r: &MultiVector<T>, z: &mut MultiVector<T>, _: &mut Context<'_>) -> Result<(), Halt> {
        let terms = r.as_slice().iter().zip(self.divisors.as_slice());
        let values = z.as_mut_slice().iter_mut();
        values.zip(terms).for_each(|(z, (&r, &divisor))| *z = (r / divisor).scale(self.omega));
        Ok(())
    }
}
