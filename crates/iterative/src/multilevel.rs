//! Progressive radiosity from patches of all sizes: the element or group of elements with the most unshot power sends it to all elements.
//!
//! Southwell's relaxation along the directions 1_S, one for each group S of elements that lie in one plane and reflect alike: with r the unshot radiosity and
//! A the areas, s = Σ_S A_i r_i/Σ_S A_i, x_j += s for j in S, and the unshot radiosity is r = b + D G x − x with D = ρ/A. Nothing of it is approximate: what a group cannot send
//! as one, because its elements differ, stays unshot until smaller groups send it. Within S nothing is exchanged, so that s is the step that minimises the error
//! in the norm of Ψ = D⁻¹ − G along 1_S. The group with the largest |Σ_S A_i r_i| for what its shot costs shoots next.
//!
//! Sources: M. F. Cohen, S. E. Chen, J. R. Wallace, D. P. Greenberg, SIGGRAPH 1988, DOI 10.1145/54852.378487, for the shooting; M. F. Cohen, D. P. Greenberg,
//! D. S. Immel, P. J. Brock, IEEE Computer Graphics and Applications 6 (3), 1986, DOI 10.1109/MCG.1986.276629, for patches that shoot to smaller elements.
//!
//! Cost of a shot: one column of G 1_S, and a pass over elements and groups. Radiosity in W/m², areas in m².
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
//! let mut shooting = MultilevelShooting::new(&columns, frame, scaling, MultiVector::from_vec(3, 1, vec![0.0, 0.0, 1.0])?)?;
//! while shooting.distributed() < 1.0 - 1e-12 && shooting.shoot().is_some() {}
//! assert!((shooting.radiosity().row(2)[0] - 4.0 / 3.0).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::progressive::ambient;
use fredholm_linop::{Lazy, LinearOperator, MultiVector, SolveError};
use std::ops::Range;

/// What a column that is to be computed costs, over a shot whose column was there before.
const FRESH: f64 = 3.0;

/// What shoots: groups of elements, as ranges in an order of the elements, and the areas of the elements in m².
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
    scaling: MultiVector<f64>,
    /// Shot radiosity x.
    shot: MultiVector<f64>,
    /// G x, W.
    received: MultiVector<f64>,
    /// r, W/m².
    unshot: MultiVector<f64>,
    /// Σ A r over the places before each, by lane, W.
    sums: Vec<f64>,
    /// Σ A |r| and Σ A x by lane, W.
    left: Vec<f64>,
    sent: Vec<f64>,
    scales: Vec<f64>,
    /// 1 − ρ̄, by lane.
    losses: Vec<f64>,
    column: Vec<f64>,
    /// Groups that have shot.
    known: Vec<bool>,
}

impl<'a> MultilevelShooting<'a> {
    /// Starts with nothing shot: `scaling` is D = ρ/A (1/m²), `exitance` is b (W/m²), both elements × bands. Column g of `columns` is G 1_S for group g.
    ///
    /// # Errors
    /// [`SolveError::Shape`] where sizes do not fit.
    pub fn new(
        columns: &'a Lazy<'a, f64>,
        frame: Frame<'a>,
        scaling: MultiVector<f64>,
        exitance: MultiVector<f64>,
    ) -> Result<Self, SolveError> {
        let (dim, lanes) = (columns.dim(), scaling.lanes());
        let sizes = [
            ("scaling", scaling.dim(), lanes),
            ("exitance", exitance.dim(), exitance.lanes()),
            ("areas", frame.areas.len(), lanes),
            ("order of elements", frame.order.len(), lanes),
        ];
        if let Some(&(vector, found, found_lanes)) =
            sizes.iter().find(|&&(_, found, found_lanes)| (found, found_lanes) != (dim, lanes))
        {
            return Err(SolveError::Shape {
                vector,
                found,
                found_lanes,
                expected: dim,
                expected_lanes: lanes,
            });
        }
        let zeros = MultiVector::zeros(dim, lanes);
        let scale = |norm: f64| if norm > 0.0 { norm.recip() } else { 0.0 };
        let mut shooting = Self {
            columns,
            frame,
            losses: losses(frame.areas, &scaling),
            scaling,
            shot: zeros.clone(),
            received: zeros,
            scales: exitance.norms().into_iter().map(scale).collect(),
            unshot: exitance,
            sums: vec![0.0; (dim + 1) * lanes],
            left: vec![0.0; lanes],
            sent: vec![0.0; lanes],
            column: vec![0.0; dim],
            known: vec![false; frame.groups.len()],
        };
        shooting.sum_up();
        Ok(shooting)
    }

    /// Shoots from the group with the most unshot power and returns it; `None` where nothing is unshot.
    pub fn shoot(&mut self) -> Option<usize> {
        let group = self.brightest()?;
        let places = self.frame.groups[group].clone();
        let members = &self.frame.order[places.clone()];
        let area: f64 = members.iter().map(|&i| self.frame.areas[i as usize]).sum();
        let step: Vec<f64> = self.powers(&places).map(|power| power / area).collect();
        for &i in members {
            add(self.shot.row_mut(i as usize), &step, 1.0);
            add(self.unshot.row_mut(i as usize), &step, -1.0);
        }
        self.known[group] = true;
        self.columns.column(group, 0, &mut self.column);
        for (i, &exchange) in self.column.iter().enumerate() {
            add(self.received.row_mut(i), &step, exchange);
            let reflected = self.unshot.row_mut(i).iter_mut().zip(self.scaling.row(i));
            reflected.zip(&step).for_each(|((unshot, scaling), step)| *unshot += scaling * exchange * step);
        }
        self.sent.iter_mut().zip(&step).for_each(|(sent, step)| *sent += area * step);
        self.sum_up();
        Some(group)
    }

    /// x + r: radiosity as far as it is known, W/m².
    #[must_use]
    pub fn radiosity(&self) -> MultiVector<f64> {
        MultiVector::from_fn(self.shot.dim(), self.shot.lanes(), |i, l| {
            self.shot.row(i)[l] + self.unshot.row(i)[l]
        })
    }

    /// The radiosity with the ambient term: x + r + ρ Amb, where Amb = Σ A r/(Σ A (1 − ρ̄)) spreads what the unshot light will become evenly.
    #[must_use]
    pub fn with_ambient(&self) -> MultiVector<f64> {
        let ambient = ambient(&self.scaling, self.frame.areas, &self.unshot);
        let known = self.radiosity();
        MultiVector::from_fn(known.dim(), known.lanes(), |i, l| {
            known.row(i)[l] + self.scaling.row(i)[l] * self.frame.areas[i] * ambient[l]
        })
    }

    /// G x, the power that each element has received, W.
    #[must_use]
    pub fn received(&self) -> &MultiVector<f64> {
        &self.received
    }

    /// r, W/m².
    #[must_use]
    pub fn unshot(&self) -> &MultiVector<f64> {
        &self.unshot
    }

    /// The share of the power of the solution that has been shot, at least: 1 − U/(Σ A x + U) with U = Σ A |r|/(1 − ρ̄), what is unshot and what its reflections will come to;
    /// of the band with the smallest share.
    #[must_use]
    pub fn distributed(&self) -> f64 {
        let share = |l: usize| {
            let unshot = self.left[l] / self.losses[l];
            if unshot > 0.0 { 1.0 - unshot / (self.sent[l] + unshot) } else { 1.0 }
        };
        (0..self.shot.lanes()).map(share).fold(1.0, f64::min)
    }

    fn sum_up(&mut self) {
        let lanes = self.shot.lanes();
        self.left.fill(0.0);
        for (place, &i) in self.frame.order.iter().enumerate() {
            for l in 0..lanes {
                let own = self.frame.areas[i as usize] * self.unshot.row(i as usize)[l];
                self.sums[(place + 1) * lanes + l] = self.sums[place * lanes + l] + own;
                self.left[l] += own.abs();
            }
        }
    }

    /// Σ_S A r of some places, by lane, W.
    fn powers(&self, places: &Range<usize>) -> impl Iterator<Item = f64> + '_ {
        let lanes = self.shot.lanes();
        let (start, end) = (places.start * lanes, places.end * lanes);
        (0..lanes).map(move |l| self.sums[end + l] - self.sums[start + l])
    }

    /// The group with the most unshot power in any band, over ‖b‖₂ of the band and over its cost; the first of equals.
    fn brightest(&self) -> Option<usize> {
        let (mut found, mut most) = (None, 0.0);
        for (group, places) in self.frame.groups.iter().enumerate() {
            let sizes = self.powers(places).zip(&self.scales).map(|(power, scale)| (power * scale).abs());
            let cost = if self.known[group] { 1.0 } else { FRESH };
            let size = sizes.fold(0.0, f64::max) / cost;
            if size > most {
                (found, most) = (Some(group), size);
            }
        }
        found
    }
}

/// 1 − ρ̄ by lane, with the mean over areas.
fn losses(areas: &[f64], scaling: &MultiVector<f64>) -> Vec<f64> {
    let total: f64 = areas.iter().sum();
    let reflected =
        |l: usize| -> f64 { areas.iter().enumerate().map(|(i, area)| area * area * scaling.row(i)[l]).sum() };
    (0..scaling.lanes()).map(|l| 1.0 - reflected(l) / total).collect()
}

fn add(to: &mut [f64], step: &[f64], factor: f64) {
    to.iter_mut().zip(step).for_each(|(to, step)| *to += factor * step);
}
