//! Row sums that hold: no leaf sends more than it exposes, and in a closed scene no less.
//!
//! The sum of the exchanges of a leaf with all others is its exposed area times the share of its
//! rays that meet a lit side: at most the exposed area, and all of it in a closed scene. Estimates
//! of partly visible links, and links that follow a form factor to first order only, miss that.
//! Multiple reflection multiplies what they miss by 1/(1 − ρ). So the operator is scaled on both
//! sides, S G S with a diagonal S > 0: it stays symmetric, and with reflectances below 1 the system
//! is positive definite. The scaling that makes the row sums given numbers is found by the fixed
//! point of s_i ← s_i (t_i/(s_i (G s)_i))^α (P. A. Knight, D. Ruiz, B. Uçar, SIAM J. Matrix Anal.
//! Appl. 35 (2014) 931–955, doi:10.1137/110825753, with α = 1/2 for symmetric scaling). A step
//! leaves 1 − α (1 + μ) of an error that is an eigenvector of the operator with the eigenvalue μ.
//! Between 0 and 1, where nearly all of them lie, α = 2/3 makes the largest of these factors 1/3.
//! What is left of each row sum is reported.

use crate::HierarchicalOperator;

/// Steps at most.
const STEPS: usize = 40;
/// α of a step.
const STEP_EXPONENT: f64 = 2.0 / 3.0;
/// Mean change of the factors that is small enough: least and most. Single leaves that move on do
/// not matter.
const SETTLED_CHANGE: [f64; 2] = [1e-7, 1e-4];
/// Times that what is above is cut, at most, and the relative excess that one cut takes for good.
const MOST_CUTS: usize = 4;
const SMALL_EXCESS: f64 = 5e-3;
/// A leaf whose links bring much too little lacks some of them: scaling does not stand in for
/// those.
const LARGEST_FACTOR: f64 = 1.25;

/// What a row sum may be, m².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    pub least: f64,
    pub most: f64,
}

impl Aim {
    /// The sum that a row sum should move to: a factor other than 1 stays only as long as a bound
    /// asks for it.
    fn wanted(self, scale: f64, row: f64) -> f64 {
        let held = if scale < 1.0 {
            self.most
        } else if scale > 1.0 {
            self.least
        } else {
            row
        };
        if row > self.most || row < self.least { row.clamp(self.least, self.most) } else { held }
    }

    /// The factor that brings a row sum nearer.
    fn next(self, scale: f64, row: f64) -> f64 {
        if row <= 0.0 {
            return scale;
        }
        let next = (scale * (self.wanted(scale, row) / row).powf(STEP_EXPONENT)).min(LARGEST_FACTOR);
        // On the way back a factor stops at 1.
        match (scale < 1.0 && row < self.most, scale > 1.0 && row > self.least) {
            (true, _) => next.min(1.0),
            (_, true) => next.max(1.0),
            _ => next,
        }
    }
}

/// The leaves of the input elements, and what their row sums may be together.
pub(crate) struct Wholes<'a> {
    /// The input element of each leaf.
    pub of_leaf: &'a [u32],
    /// What is known of each input element, m²; none where only its leaves are.
    pub aims: Vec<Option<Aim>>,
}

impl Wholes<'_> {
    /// The factors that bring the sums over input elements nearer.
    fn next(&self, factors: &[f64], rows: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.aims.len()];
        self.of_leaf.iter().zip(rows).for_each(|(&whole, row)| sums[whole as usize] += row);
        let next = |((&factor, &sum), aim): ((&f64, &f64), &Option<Aim>)| match aim {
            Some(aim) if sum > 0.0 => (factor * (sum.clamp(aim.least, aim.most) / sum).powf(STEP_EXPONENT))
                .clamp(LARGEST_FACTOR.recip(), LARGEST_FACTOR),
            _ => factor,
        };
        factors.iter().zip(&sums).zip(&self.aims).map(next).collect()
    }
}

/// Scales an operator until its row sums are within their bounds, as far as that goes; none stays
/// above. Every leaf has a factor of its own and shares another with the leaves of its input
/// element; they take turns. They stop at mean relative changes of `tolerance`, weighted by what
/// the leaves receive, or where row sums must be 1 at smaller ones: what is left above is cut,
/// which loses power.
pub(crate) fn balance(operator: &mut HierarchicalOperator, aims: &[Aim], wholes: &Wholes, tolerance: f64) {
    let (mut own, mut shared) = (vec![1.0; aims.len()], vec![1.0; wholes.aims.len()]);
    let products = |own: &[f64], shared: &[f64]| -> Vec<f64> {
        own.iter().zip(wholes.of_leaf).map(|(own, &whole)| own * shared[whole as usize]).collect()
    };
    operator.set_scale(own.clone());
    let exact = aims.iter().any(|aim| aim.least > 0.0);
    let tolerance =
        if exact { SETTLED_CHANGE[0] } else { tolerance.clamp(SETTLED_CHANGE[0], SETTLED_CHANGE[1]) };
    let together = wholes.aims.iter().any(Option::is_some);
    for _ in 0..STEPS {
        let mut done = true;
        if together {
            let rows = operator.row_sums();
            let next = wholes.next(&shared, &rows);
            let of_leaf = |&whole: &u32| [shared[whole as usize], next[whole as usize]];
            done = near(&rows, wholes.of_leaf.iter().map(of_leaf), tolerance);
            shared = next;
            operator.set_scale(products(&own, &shared));
        }
        let rows = operator.row_sums();
        let leaves = own.iter().zip(&rows).zip(aims);
        let next: Vec<f64> = leaves.map(|((&own, &row), aim)| aim.next(own, row)).collect();
        done &= near(&rows, own.iter().zip(&next).map(|(&own, &next)| [own, next]), tolerance);
        own = next;
        operator.set_scale(products(&own, &shared));
        if done {
            break;
        }
    }
    // What is above in the end is cut off. Smaller factors make other row sums smaller, but for the
    // few that links with a steep gradient bring less than nothing: they may rise, and are cut
    // again.
    for _ in 0..MOST_CUTS {
        let rows = operator.row_sums();
        let above = |(&row, aim): (&f64, &Aim)| if row > aim.most { row / aim.most - 1.0 } else { 0.0 };
        let most = rows.iter().zip(aims).map(above).fold(0.0, f64::max);
        let leaves = operator.scale().iter().zip(&rows).zip(aims);
        // Linear functions may leave a nearly buried leaf less than nothing.
        let cut = leaves.map(|((&scale, &row), aim)| match row {
            _ if row > aim.most => scale * aim.most / row,
            _ if row < 0.0 => 0.0,
            _ => scale,
        });
        let scale = cut.collect();
        operator.set_scale(scale);
        if most <= SMALL_EXCESS {
            break;
        }
    }
}

/// Whether the factors of the leaves, each with the one of the next step, move by no more than
/// `tolerance` in the mean, weighted by the row sums, m².
fn near(rows: &[f64], factors: impl Iterator<Item = [f64; 2]>, tolerance: f64) -> bool {
    let (mut moved, mut all) = (0.0, 0.0);
    for (row, [now, next]) in rows.iter().zip(factors) {
        // A buried leaf has the factor 0, for good.
        let change = if now > 0.0 { (next - now).abs() / now } else { 0.0 };
        moved += row.abs() * change;
        all += row.abs();
    }
    moved <= tolerance * all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_stay_finite_whatever_the_sums_are() {
        let aims = [0.0, 1.0].map(|row| Some(Aim { least: row, most: row }));
        let wholes = Wholes { of_leaf: &[0, 1], aims: aims.to_vec() };
        for rows in [[0.5, 0.5], [-0.1, 0.0], [1e-300, 1e300]] {
            let next = wholes.next(&[1.0, 1.0], &rows);
            let within = |factor: &f64| (LARGEST_FACTOR.recip()..=LARGEST_FACTOR).contains(factor);
            assert!(next.iter().all(within), "{rows:?}: {next:?}");
        }
    }
}
