//! z = α x' + (1 − α) x'' with the α that minimises ‖b − A z‖₂: α = −(r'', r' − r'')/‖r' − r''‖².
//!
//! Source: C. Brezinski, M. Redivo Zaglia, Hybrid procedures for solving linear systems, Numerische
//! Mathematik 67, 1994, DOI 10.1007/s002110050015. The residual of z is at most the smaller one of
//! r' and r''. Per right-hand side.

use super::quotients;
use fredholm_linop::{MultiVector, Scalar};

/// An iterate and its A x.
pub(crate) struct Blend<'a, T> {
    pub x: &'a MultiVector<T>,
    pub product: &'a MultiVector<T>,
}

/// Blends x' into z, which is x'' before, and A x' into `product`, which is A x'' before. Returns
/// α.
pub(crate) fn blend<T: Scalar>(
    b: &MultiVector<T>,
    first: &Blend<'_, T>,
    z: &mut MultiVector<T>,
    product: &mut MultiVector<T>,
) -> Vec<T> {
    let alpha = best(b, first.product, product);
    mix(&alpha, first.x, z);
    mix(&alpha, first.product, product);
    alpha
}

/// α of every right-hand side: 1 where both residuals are the same. An iterate that is not finite
/// has no part in z.
fn best<T: Scalar>(b: &MultiVector<T>, first: &MultiVector<T>, second: &MultiVector<T>) -> Vec<T> {
    let (mut residual, mut difference) = (b.clone(), b.clone());
    residual.set_difference(b, second);
    // r' − r'' = A x'' − A x'.
    difference.set_difference(second, first);
    let (across, squares) = (difference.dots(&residual), difference.dots(&difference));
    let best = quotients(&across, &squares);
    let choose = |l: usize| match squares[l] {
        square if square == T::zero() => T::one(),
        square if square.is_finite() => -best[l],
        _ if (0..b.dim()).all(|i| first.row(i)[l].is_finite()) => T::one(),
        _ => T::zero(),
    };
    (0..b.rhs_count()).map(choose).collect()
}

/// z = α x + (1 − α) z; a part with the factor 0 is left out, whatever it is.
fn mix<T: Scalar>(alpha: &[T], x: &MultiVector<T>, z: &mut MultiVector<T>) {
    for i in 0..x.dim() {
        for ((z, &x), &alpha) in z.row_mut(i).iter_mut().zip(x.row(i)).zip(alpha) {
            let rest = T::one() - alpha;
            let part = |factor: T, value: T| if factor == T::zero() { factor } else { factor * value };
            *z = part(alpha, x) + part(rest, *z);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blend_of_a_line_is_its_point_nearest_to_the_right_hand_side() {
        // A = I: between (0, 0) and (2, 0) the nearest to b = (0.5, 1) is (0.5, 0).
        let vector = |x: f64, y: f64| MultiVector::from_vec(2, 1, vec![x, y]).unwrap();
        let (b, first) = (vector(0.5, 1.0), vector(2.0, 0.0));
        let (mut z, mut product) = (vector(0.0, 0.0), vector(0.0, 0.0));
        let alpha = blend(&b, &Blend { x: &first, product: &first }, &mut z, &mut product);
        assert_eq!((alpha, z, product), (vec![0.25], vector(0.5, 0.0), vector(0.5, 0.0)));
    }

    #[test]
    fn an_iterate_that_is_lost_has_no_part() {
        let vector = |x: f64| MultiVector::from_vec(1, 1, vec![x]).unwrap();
        let lost = vector(f64::INFINITY);
        let (mut z, mut product) = (vector(3.0), vector(3.0));
        blend(&vector(1.0), &Blend { x: &lost, product: &lost }, &mut z, &mut product);
        assert_eq!(z, vector(3.0));
        let (first, mut z, mut product) = (vector(3.0), lost.clone(), lost);
        blend(&vector(1.0), &Blend { x: &first, product: &first }, &mut z, &mut product);
        assert_eq!(z, vector(3.0));
    }
}
