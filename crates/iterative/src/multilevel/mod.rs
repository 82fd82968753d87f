//! Progressive radiosity from patches of all sizes: the element or group of elements with the most
//! unshot power sends it to all elements.
//!
//! Southwell's relaxation along the directions 1_S, one for each group S of elements that lie in
//! one plane and reflect alike: with r the unshot radiosity and A the areas, s = Σ_S A_i r_i/Σ_S
//! A_i, x_j += s for j in S, and the unshot radiosity is r = b + D G x − x with D = ρ/A. Nothing of
//! it is approximate: what a group cannot send as one, because its elements differ, stays unshot
//! until smaller groups send it. Within S nothing is exchanged, so that s is the step that
//! minimises the error in the norm of Ψ = D⁻¹ − G along 1_S. The group with the largest |Σ_S A_i
//! r_i| for what its shot costs shoots next.
//!
//! Sources: M. F. Cohen, S. E. Chen, J. R. Wallace, D. P. Greenberg, SIGGRAPH 1988, DOI
//! 10.1145/54852.378487, for the shooting; M. F. Cohen, D. P. Greenberg, D. S. Immel, P. J. Brock,
//! IEEE Computer Graphics and Applications 6 (3), 1986, DOI 10.1109/MCG.1986.276629, for patches
//! that shoot to smaller elements.
//!
//! Cost of a shot: one column of G 1_S, and a pass over elements and groups. Radiosity in W/m²,
//! areas in m².
//!
//! ```
//! use fredholm_iterative::{Frame, MultilevelShooting};
//! use fredholm_linop::{Columns, Lazy, MultiVector, Symmetry};
//!
//! /// Two halves of a floor, which shoot as one too, and a ceiling: columns 0, 1, 2, and 0 with 1.
//! struct Room;
//!
//! impl Columns<f64> for Room {
//!     fn dim(&self) -> usize {
//!         3
//!     }
//!     fn count(&self) -> usize {
//!         4
//!     }
//!     fn symmetry(&self) -> Symmetry {
//!         Symmetry::General
//!     }
//!     fn diagonal(&self, _: usize) -> f64 {
//!         0.0
//!     }
//!     fn column(&self, j: usize, out: &mut [f64]) {
//!         out.copy_from_slice(&[[0.0, 0.0, 0.5], [0.0, 0.0, 0.5], [0.5, 0.5, 0.0], [0.0, 0.0, 1.0]][j]);
//!     }
//! }
//!
//! let columns = Lazy::new(&Room, 1024);
//! let frame = Frame { order: &[0, 1, 2], groups: &[0..1, 1..2, 2..3, 0..2], areas: &[0.5, 0.5, 1.0] };
//! // Both sides reflect half, the ceiling shines: B = 1 + B'/2 above, B' = B/2 below.
//! let scaling = MultiVector::from_vec(3, 1, vec![1.0, 1.0, 0.5])?;
//! let mut shooting = MultilevelShooting::new(&columns, frame, scaling, &MultiVector::from_vec(3, 1, vec![0.0, 0.0, 1.0])?)?;
//! while shooting.distributed() < 1.0 - 1e-12 && shooting.shoot().is_some() {}
//! assert!((shooting.radiosity().row(2)[0] - 4.0 / 3.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod rhs;

use crate::progressive::ambient;
use fredholm_linop::{Lazy, LinearOperator, MultiVector, SolveError};
use rhs::Rhs;
use std::ops::Range;

/// How much more unshot power a column that is to be computed must promise than one that is there.
const FRESH_COLUMN_RATIO: f64 = 2.0;

/// What shoots: groups of elements, as ranges in an order of the elements, and the areas of the
/// elements in m².
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The elements, every one once.
    pub order: &'a [u32],
    /// Places of the members of each group in `order`.
    pub groups: &'a [Range<usize>],
    /// A_i, m², by element.
    pub areas: &'a [f64],
}

/// Progressive radiosity over columns that are computed when they are needed.
pub struct MultilevelShooting<'a> {
    columns: &'a Lazy<'a, f64>,
    frame: Frame<'a>,
    /// A_i by place, m².
    areas: Vec<f64>,
    all: Vec<Rhs>,
    scaling: MultiVector<f64>,
    /// The column of a shot, by element and by place.
    column: Vec<f64>,
    exchanges: Vec<f64>,
    /// Per group 1, or 1/[`FRESH_COLUMN_RATIO`] as long as its column is to be computed.
    worth: Vec<f64>,
    /// Per group the unshot power in the band where it is largest, over ‖b‖₂.
    sizes: Vec<f64>,
}

impl<'a> MultilevelShooting<'a> {
    /// Starts with nothing shot: `scaling` is D = ρ/A (1/m²), `exitance` is b (W/m²), both elements
    /// × bands. Column g of `columns` is G 1_S for group g.
    ///
    /// # Errors
    /// [`SolveError::Shape`] where sizes do not fit.
    pub fn new(
        columns: &'a Lazy<'a, f64>,
        frame: Frame<'a>,
        scaling: MultiVector<f64>,
        exitance: &MultiVector<f64>,
    ) -> Result<Self, SolveError> {
        let dim = columns.dim();
        check(dim, &frame, &scaling, exitance)?;
        let by_place = |values: &[f64]| frame.order.iter().map(|&i| values[i as usize]).collect::<Vec<f64>>();
        let areas = by_place(frame.areas);
        let rhs = |(l, norm): (usize, f64)| {
            let scale = if norm > 0.0 { norm.recip() } else { 0.0 };
            Rhs::new(&areas, by_place(&scaling.vector(l)), by_place(&exitance.vector(l)), scale)
        };
        Ok(Self {
            all: exitance.norms().into_iter().enumerate().map(rhs).collect(),
            columns,
            frame,
            areas,
            scaling,
            column: vec![0.0; dim],
            exchanges: vec![0.0; dim],
            worth: vec![FRESH_COLUMN_RATIO.recip(); frame.groups.len()],
            sizes: vec![0.0; frame.groups.len()],
        })
    }

    /// Shoots from the group with the most unshot power and returns it; `None` where nothing is
    /// unshot.
    pub fn shoot(&mut self) -> Option<usize> {
        let group = self.brightest()?;
        let places = &self.frame.groups[group];
        let area: f64 = self.areas[places.clone()].iter().sum();
        self.columns.column(group, 0, &mut self.column);
        self.worth[group] = 1.0;
        let exchanges = self.exchanges.iter_mut().zip(self.frame.order);
        exchanges.for_each(|(exchange, &i)| *exchange = self.column[i as usize]);
        for rhs in &mut self.all {
            rhs.shoot(places, area, &self.exchanges, &self.areas);
        }
        Some(group)
    }

    /// x + r: radiosity as far as it is known, W/m².
    #[must_use]
    pub fn radiosity(&self) -> MultiVector<f64> {
        self.by_element(|rhs, place| rhs.shot[place] + rhs.unshot[place])
    }

    /// The radiosity with the ambient term: x + r + ρ Amb, where Amb = Σ A r/(Σ A (1 − ρ̄)) spreads
    /// what the unshot light will become evenly.
    #[must_use]
    pub fn with_ambient(&self) -> MultiVector<f64> {
        let ambient = ambient(&self.scaling, self.frame.areas, &self.unshot());
        let known = self.radiosity();
        MultiVector::from_fn(known.dim(), known.rhs_count(), |i, l| {
            known.row(i)[l] + self.scaling.row(i)[l] * self.frame.areas[i] * ambient[l]
        })
    }

    /// G x, the power that each element has received, W.
    #[must_use]
    pub fn received(&self) -> MultiVector<f64> {
        self.by_element(|rhs, place| rhs.received[place])
    }

    /// r, W/m².
    #[must_use]
    pub fn unshot(&self) -> MultiVector<f64> {
        self.by_element(|rhs, place| rhs.unshot[place])
    }

    /// The share of the power of the solution that has been shot, at least: 1 − U/(Σ A x + U) with
    /// U = Σ A |r|/(1 − ρ̄), what is unshot and what its reflections will come to; of the band with
    /// the smallest share.
    #[must_use]
    pub fn distributed(&self) -> f64 {
        let share = |rhs: &Rhs| {
            let unshot = rhs.left / rhs.loss;
            if unshot > 0.0 { 1.0 - unshot / (rhs.sent + unshot) } else { 1.0 }
        };
        self.all.iter().map(share).fold(1.0, f64::min)
    }

    fn by_element(&self, value: impl Fn(&Rhs, usize) -> f64) -> MultiVector<f64> {
        let mut values = MultiVector::zeros(self.areas.len(), self.all.len());
        for (place, &i) in self.frame.order.iter().enumerate() {
            let row = values.row_mut(i as usize).iter_mut().zip(&self.all);
            row.for_each(|(to, rhs)| *to = value(rhs, place));
        }
        values
    }

    /// The group with the most unshot power in any band, over ‖b‖₂ of the band, with its worth; the
    /// first of equals.
    fn brightest(&mut self) -> Option<usize> {
        self.sizes.fill(0.0);
        for rhs in &self.all {
            for (size, places) in self.sizes.iter_mut().zip(self.frame.groups) {
                *size = size.max((rhs.power(places) * rhs.scale).abs());
            }
        }
        let (mut found, mut most) = (None, 0.0);
        for (group, (size, worth)) in self.sizes.iter().zip(&self.worth).enumerate() {
            if size * worth > most {
                (found, most) = (Some(group), size * worth);
            }
        }
        found
    }
}

/// Whether everything has as many elements as the columns, and as many right-hand sides.
fn check(
    dim: usize,
    frame: &Frame<'_>,
    scaling: &MultiVector<f64>,
    exitance: &MultiVector<f64>,
) -> Result<(), SolveError> {
    let rhs_count = scaling.rhs_count();
    let sizes = [
        ("scaling", scaling.dim(), rhs_count),
        ("exitance", exitance.dim(), exitance.rhs_count()),
        ("areas", frame.areas.len(), rhs_count),
        ("order of elements", frame.order.len(), rhs_count),
    ];
    let wrong = sizes.iter().find(|&&(_, found, found_rhs)| (found, found_rhs) != (dim, rhs_count));
    wrong.map_or(Ok(()), |&(vector, found, found_rhs)| {
        Err(SolveError::Shape { vector, found, found_rhs, expected: dim, expected_rhs: rhs_count })
    })
}
