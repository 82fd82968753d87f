//! Rows of the light equation from rays: E = D + C R E, with every row of C and D estimated.
//!
//! ```text
//! E_i = D_i + Σ_j C_ij B_j,   C_ij = (rays of i that end on j) / (rays of i),
//! D_i = mean of M(q) κ(p, q) V(p, q) / p_L(q)
//! ```
//!
//! Rays leave element i from points p even over it with density cosθ/π, so that C_ij → F_ij, and
//! each row of a closed scene sums to 1 (T. J. V. Malley, 1988; J. R. Wallace et al., SIGGRAPH 1989,
//! doi:10.1145/74333.74366). For every ray, one point q of a lamp is looked at from p; a ray that
//! meets a lamp counts too, and the balance heuristic weighs both (E. Veach, L. J. Guibas, SIGGRAPH
//! 1995, doi:10.1145/218380.218498). Each row is unbiased, and errors of rows average out over what
//! is seen, so that rows with a few hundred rays give a solution to one per cent, whatever stands
//! between the surfaces; no pair of elements is looked at.
//!
//! *Points.* The rays of an element are points of an Owen-scrambled Sobol sequence, in
//! [`REPLICATES`] independent replicates, from whose differences standard errors follow. The four
//! parts of an element share a sequence, each part a quarter, so that the mean over them has the
//! order of the whole. A row is prolonged by taking more points of its sequences.
//!
//! Irradiance E, radiosity B and exitance M in W/m²; κ = cosθ cosθ′/(π r²) in 1/m².

mod sampler;

pub use sampler::RowSampler;

use std::ops::Range;

use crate::Enclosure;
use crate::density::Look;
use fredholm_linop::{LinearOperator, MultiVector};
use fredholm_mesh::Patch;
use rayon::prelude::*;

/// Independent estimates of every row.
pub const REPLICATES: usize = 4;
/// What a ray met where it met no lit side.
const NOTHING: u32 = u32::MAX;
const BACK: u32 = u32::MAX - 1;
/// It went on from a patch that was too near to be seen as a whole.
const WALKED: u32 = u32::MAX - 2;
/// Share of the rays of a part that meet backs up to which all of it counts as exposed.
const LEAST_BURIED: f64 = 0.02;
/// Points along a side of the first grid that finds what is exposed, and of the one for parts that
/// are partly buried.
const POINTS_ALONG_GRIDS: [u32; 2] = [4, 6];
/// Rows of a product that one thread takes at a time.
const ROWS_OF_A_TASK: usize = 256;

/// The parts of an element, which share a sequence of points: four of equal kind, or one.
#[derive(Clone, Debug)]
pub struct Family {
    /// The element.
    pub whole: Patch,
    /// Its parts, as patches of the enclosure.
    pub parts: Range<usize>,
    /// A number of its own, which its points depend on.
    pub stream: u32,
}

/// From where rays look at lamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looks {
    /// From where they begin, and from patches that they go on from. What other patches reflect is
    /// that of their mean irradiance. One ray in so many looks from the patch that it meets too,
    /// only to find what that leaves out.
    Checked(usize),
    /// From every patch that they meet: what is reflected of the light of lamps is that of the
    /// point, at the price of more noise.
    Everywhere,
}

impl Looks {
    fn is_checked(self) -> bool {
        self != Self::Everywhere
    }

    /// Whether this ray of a batch looks only to check.
    fn checks(self, ray: usize) -> bool {
        matches!(self, Self::Checked(every) if ray.is_multiple_of(every))
    }
}

/// Rows as far as they are known; as an operator, C.
#[derive(Clone, Debug)]
pub struct Rows {
    bands: usize,
    looks: Looks,
    /// Number that the points depend on.
    stage: u32,
    /// Families whose rays go on further.
    dark: Vec<bool>,
    /// Rays of a replicate of each part.
    counts: Vec<u32>,
    /// Sums over the rays, for every part, replicate and band, of what comes from lamps directly and
    /// of what is reflected once or more on the way, W/m².
    direct: Vec<f64>,
    reflected: Vec<f64>,
    /// The same of the looks that only check.
    checked: Vec<f64>,
    batches: Vec<Batch>,
    /// Looks at lamps, as long as the sampler may learn from them.
    looked: Vec<Look>,
}

/// Rays cast at one time.
#[derive(Clone, Debug, Default)]
struct Batch {
    /// Where the rays of every part begin, and where those of the last end.
    starts: Vec<usize>,
    /// The patch that each has met, or [`NOTHING`], [`BACK`] or [`WALKED`]; of a part, one replicate
    /// after the other.
    met: Vec<u32>,
    /// Where the rays that went on begin, of every part and replicate, and where those of the last
    /// end.
    walk_starts: Vec<usize>,
    /// Where each has ended, and the reflectances on the way, multiplied, for every band.
    walked: Vec<u32>,
    weights: Vec<f64>,
}

impl Rows {
    /// Rays cast so far.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.batches.iter().map(|batch| batch.met.len() as u64).sum()
    }

    /// Rays of a replicate of a part.
    #[must_use]
    pub fn count(&self, part: usize) -> u32 {
        self.counts[part]
    }

    /// Exposed shares in [0, 1]: of parts of which some rays meet backs, that of a grid of points;
    /// of the others all is exposed. `known` are those of shorter rows, where there were any.
    #[must_use]
    pub fn exposed_shares(&self, scene: &Enclosure, known: Option<&[f64]>) -> Vec<f64> {
        let share = |part: usize| {
            let backs = self.batches.iter().map(|b| b.of(part).iter().filter(|&&met| met == BACK).count());
            let (backs, rays) = (backs.sum::<usize>() as f64, self.rays_of(part));
            if backs >= rays {
                // It receives nothing, and so sends nothing, whatever its share.
                return 0.0;
            }
            let known = known.map(|known| known[part]).filter(|&share| share > 0.0).unwrap_or(1.0);
            if known < 1.0 || backs <= LEAST_BURIED * rays {
                return known;
            }
            let few = scene.share_exposed(part, POINTS_ALONG_GRIDS[0]);
            if few > 0.0 && few < 1.0 { scene.share_exposed(part, POINTS_ALONG_GRIDS[1]) } else { few }
        };
        (0..self.counts.len()).into_par_iter().map(share).collect()
    }

    /// Share of the rays of each part that meet a lit side.
    #[must_use]
    pub fn closure(&self) -> Vec<f64> {
        let lit = |part: usize| {
            let met = self.batches.iter().flat_map(|batch| batch.of(part));
            met.filter(|&&met| met != BACK && met != NOTHING).count() as f64 / self.rays_of(part)
        };
        (0..self.counts.len()).map(lit).collect()
    }

    /// What comes from lamps directly, and what is reflected on the way of rays; parts × bands,
    /// W/m².
    #[must_use]
    pub fn lamplight(&self) -> [MultiVector<f64>; 2] {
        let bands = self.bands;
        [&self.direct, &self.reflected].map(|sums| {
            MultiVector::from_fn(self.counts.len(), bands, |part, band| {
                let of = |replicate| sums[(part * REPLICATES + replicate) * bands + band];
                (0..REPLICATES).map(of).sum::<f64>() / self.rays_of(part)
            })
        })
    }

    /// What comes from lamps directly by the rays of each replicate alone, W/m².
    #[must_use]
    pub fn direct_replicates(&self) -> [MultiVector<f64>; REPLICATES] {
        std::array::from_fn(|replicate| {
            MultiVector::from_fn(self.counts.len(), self.bands, |part, band| {
                let sum = self.direct[(part * REPLICATES + replicate) * self.bands + band];
                sum / f64::from(self.counts[part].max(1))
            })
        })
    }

    /// All light, with what is reflected C x, from the rays of each replicate alone, W/m².
    #[must_use]
    pub fn replicates(&self, x: &MultiVector<f64>) -> [MultiVector<f64>; REPLICATES] {
        std::array::from_fn(|replicate| {
            let mut y = MultiVector::zeros(self.counts.len(), self.bands);
            self.product(x, Some(replicate), &mut y);
            for (part, row) in y.as_mut_slice().chunks_mut(self.bands).enumerate() {
                let at = (part * REPLICATES + replicate) * self.bands;
                let count = f64::from(self.counts[part].max(1));
                let sums = self.direct[at..].iter().zip(&self.reflected[at..]);
                row.iter_mut()
                    .zip(sums)
                    .for_each(|(y, (direct, reflected))| *y += (direct + reflected) / count);
            }
            y
        })
    }

    /// C x from the rays of two replicates: the first two, or the last two.
    #[must_use]
    pub fn half(&self, second: bool, x: &MultiVector<f64>) -> MultiVector<f64> {
        let first = 2 * usize::from(second);
        let mut sum = MultiVector::zeros(x.dim(), x.rhs_count());
        let mut y = sum.clone();
        for replicate in [first, first + 1] {
            self.product(x, Some(replicate), &mut y);
            sum.as_mut_slice().iter_mut().zip(y.as_slice()).for_each(|(sum, y)| *sum += 0.5 * y);
        }
        sum
    }

    /// What means over patches leave out of the light of lamps that is reflected once: the mean
    /// over the rays of two replicates that check, W/m², of what points send less what the patches
    /// do, `x`.
    #[must_use]
    pub fn left_out(&self, second: bool, x: &MultiVector<f64>) -> MultiVector<f64> {
        let bands = self.bands;
        let first = 2 * usize::from(second);
        let mut out = MultiVector::zeros(self.counts.len(), bands);
        let Looks::Checked(every) = self.looks else { return out };
        let parts = self.counts.len() as u32;
        out.as_mut_slice().par_chunks_mut(bands.max(1)).enumerate().for_each(|(part, out)| {
            let mut checks = 0_usize;
            for replicate in first..first + 2 {
                let at = (part * REPLICATES + replicate) * bands;
                out.iter_mut().zip(&self.checked[at..]).for_each(|(out, sum)| *out += sum);
                for batch in &self.batches {
                    let met = batch.of(part);
                    let each = met.len() / REPLICATES;
                    for &patch in met[replicate * each..(replicate + 1) * each].iter().step_by(every) {
                        checks += 1;
                        if patch < parts {
                            out.iter_mut().zip(x.row(patch as usize)).for_each(|(out, x)| *out -= x);
                        }
                    }
                }
            }
            for out in out.iter_mut() {
                *out /= checks.max(1) as f64;
            }
        });
        out
    }

    fn rays_of(&self, part: usize) -> f64 {
        (REPLICATES as f64 * f64::from(self.counts[part])).max(1.0)
    }

    /// C x, from all rays or those of one replicate.
    fn product(&self, x: &MultiVector<f64>, replicate: Option<usize>, y: &mut MultiVector<f64>) {
        let count = self.bands;
        let parts = self.counts.len() as u32;
        let row = |part: usize, out: &mut [f64]| {
            out.fill(0.0);
            for batch in &self.batches {
                let met = batch.of(part);
                let each = met.len() / REPLICATES;
                let met = replicate.map_or(met, |k| &met[k * each..(k + 1) * each]);
                for &patch in met.iter().filter(|&&patch| patch < parts) {
                    out.iter_mut().zip(x.row(patch as usize)).for_each(|(out, x)| *out += x);
                }
                let replicates = replicate.map_or(0..REPLICATES, |k| k..k + 1);
                let walks = batch.walk_starts[part * REPLICATES + replicates.start]
                    ..batch.walk_starts[part * REPLICATES + replicates.end];
                for walk in walks {
                    let x = x.row(batch.walked[walk] as usize);
                    let weight = &batch.weights[walk * count..(walk + 1) * count];
                    out.iter_mut().zip(weight).zip(x).for_each(|((out, w), x)| *out += w * x);
                }
            }
            let rays =
                if replicate.is_some() { f64::from(self.counts[part].max(1)) } else { self.rays_of(part) };
            for out in out.iter_mut() {
                *out /= rays;
            }
        };
        y.as_mut_slice().par_chunks_mut(ROWS_OF_A_TASK * count).enumerate().for_each(|(task, out)| {
            for (k, out) in out.chunks_mut(count).enumerate() {
                row(task * ROWS_OF_A_TASK + k, out);
            }
        });
    }
}

impl Batch {
    fn of(&self, part: usize) -> &[u32] {
        &self.met[self.starts[part]..self.starts[part + 1]]
    }
}

impl LinearOperator<f64> for Rows {
    fn dim(&self) -> usize {
        self.counts.len()
    }

    fn apply(&self, x: &MultiVector<f64>, y: &mut MultiVector<f64>) {
        self.product(x, None, y);
    }

    fn rhs_count(&self) -> Option<usize> {
        Some(self.bands)
    }

    fn entries(&self) -> u64 {
        self.rays()
    }
}
