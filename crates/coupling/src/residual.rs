//! How far constants on elements are from the light of the continuous equation: an estimate of the
//! error of the irradiance of faces.
//!
//! The solution B_h is constant on every element, and what is stated of an element is the mean of E
//! = K B_h over it. At a point q the continuous equation asks for M + ρ E(q) where B_h has the
//! mean, so that a residual r = ρ (E(q) − Ē_j) is left. It has no mean over an element; what it
//! does to element i is
//!
//! ```text
//! p_i = ∫ r(q) F_q,i dA = Σ_j ρ_j A_j cov_j(F_·,i , E)    W,
//! ```
//!
//! F_q,i the exact form factor from the point q to element i. Both factors follow from one row of
//! form factors, Σ_i F_q,i B_i = E(q), so that a few exact rows a element say what its residual
//! does to all others. From there on it is reflected as light is: (I − D G) δB = D p. To first
//! order in the residual that is the error of the solution.
//!
//! The covariance is taken over a k × k grid of each element, times k²/(k² − 1), which is exact
//! where both factors are linear. Where so many rows cost too much, elements are drawn in
//! proportion to what they reflect, in [`DRAWN_SEQUENCES`] interleaved sequences whose differences
//! tell the noise, and each has the ends of one of two diagonals of its 2 × 2 grid in turn. Power
//! in W, irradiance in W/m².

use crate::CouplingError;
use crate::pair_sample::scattered;
use crate::radiosity::Extent;
use crate::receiver::{Receiver, Targets};
use fredholm_linop::{MultiVector, Watch};
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::Bodies;
use rayon::prelude::*;

/// Interleaved sequences of elements that are drawn.
pub const DRAWN_SEQUENCES: usize = 4;
/// Form factors from points that may always be computed: what a tenth of a second is for.
const POINT_FACTORS_ALWAYS_COMPUTED: usize = 1 << 17;
/// Points per element where nothing stands between, so that a form factor costs as much as an
/// exchange, and where it costs a small part of one.
const POINTS_IN_THE_OPEN: f64 = 0.25;
const POINTS_AMONG_BODIES: f64 = 0.5;
/// Bodies from which on looking through all of them costs more than everything else of a form
/// factor.
const MANY_BODIES: f64 = 256.0;
/// Fewest elements that are drawn.
const FEWEST_ELEMENTS: usize = 32;
/// Most points along a side of an element.
const MOST_POINTS_A_SIDE: usize = 8;
/// Share of the mean irradiance by which elements count at least when they are drawn.
const DARK_SHARE: f64 = 0.1;
/// Elements whose rows are in memory at once, of up to so many bands; of more bands fewer, but
/// some for each thread.
const CHUNK: usize = 64;
const BANDS_OF_A_CHUNK: usize = 4;
const OF_A_THREAD: usize = 2;

/// Estimated error of the irradiance of faces, per band.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshError {
    /// √(Σ A δ² / Σ A E²), per band.
    pub relative_l2: Vec<f64>,
    /// Largest δ, W/m², per band.
    pub largest: Vec<f64>,
    /// δ of every face, faces × bands, W/m².
    pub per_face: Vec<f64>,
}

impl MeshError {
    /// From δ of every face and band (W/m²), the irradiances and the areas (m²).
    #[must_use]
    pub fn new(per_face: Vec<f64>, irradiance: &MultiVector<f64>, areas: &[f64]) -> Self {
        let bands = irradiance.rhs_count();
        let (mut errors, mut squares, mut largest) = (vec![0.0; bands], vec![0.0; bands], vec![0.0; bands]);
        for (i, area) in areas.iter().enumerate() {
            for l in 0..bands {
                let (delta, value): (f64, f64) = (per_face[i * bands + l], irradiance.row(i)[l]);
                errors[l] += area * delta * delta;
                squares[l] += area * value * value;
                largest[l] = delta.max(largest[l]);
            }
        }
        let relative = |(e, s): (&f64, &f64)| if *s > 0.0 { (e / s).sqrt() } else { 0.0 };
        let relative_l2 = errors.iter().zip(&squares).map(relative).collect();
        Self { relative_l2, largest, per_face }
    }
}

/// A solution that is constant on elements.
#[derive(Clone, Copy, Debug)]
pub struct Constants<'a> {
    /// The elements.
    pub patches: &'a [&'a Patch],
    /// What blocks the view.
    pub occluders: &'a Occluders,
    /// Their sizes.
    pub elements: &'a [Extent],
    /// ρ, elements × bands.
    pub reflectance: &'a MultiVector<f64>,
    /// Radiosity of the exposed parts, W/m², elements × bands.
    pub radiosity: &'a MultiVector<f64>,
    /// Mean irradiance of whole elements, W/m², elements × bands.
    pub irradiance: &'a MultiVector<f64>,
}

/// What the residual of constants does to the elements.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// p of every draw, W: elements × (draws × bands), the bands of a draw side by side. The mean
    /// over the draws is the estimate.
    pub power: MultiVector<f64>,
    /// 1 where every element was looked at, else [`DRAWN_SEQUENCES`].
    pub draws: usize,
}

/// An element that is looked at, how many it stands for, and its draw.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chosen {
    element: usize,
    times: f64,
    draw: usize,
    /// Its number in the draw.
    turn: usize,
}

impl Constants<'_> {
    /// Bytes that [`residual`](Self::residual) takes for so many elements and bands.
    #[must_use]
    pub fn bytes(elements: usize, bands: usize) -> u64 {
        (at_once(bands) * bands) as u64 * 8 * elements as u64
    }

    /// Samples the residual. `watch` is asked before every element whether to go on.
    ///
    /// # Errors
    /// [`CouplingError::Interrupted`] where the watch stops it.
    pub fn residual(&self, watch: &dyn Watch) -> Result<Residual, CouplingError> {
        let (n, bands) = (self.patches.len(), self.irradiance.rhs_count());
        let bodies = Bodies::new(self.occluders, self.patches, &[]);
        let (chosen, grid) = self.choose(points(n, bodies.as_slice().len()));
        let draws = chosen.iter().map(|one| one.draw + 1).max().unwrap_or(1);
        let rows: Vec<usize> = (0..n).collect();
        let targets = Targets { patches: self.patches, row_of: &rows, rows: n, occluders: self.occluders };
        let one = |chosen: &Chosen| {
            let places = chosen.places(grid);
            watch.go_on().is_continue().then(|| self.spread(chosen.element, &places, &targets, &bodies))
        };
        let mut power = MultiVector::zeros(n, draws * bands);
        // The sums are in the order of the elements, however many there are at a time.
        let size = at_once(bands);
        for (number, chunk) in chosen.chunks(size).enumerate() {
            let found: Vec<Option<Vec<f64>>> = chunk.par_iter().map(one).collect();
            let (done, total) = ((number * size) as u64, chosen.len() as u64);
            let found: Option<Vec<Vec<f64>>> = found.into_iter().collect();
            let found = found.ok_or(CouplingError::Interrupted { done, total })?;
            for (chosen, spread) in chunk.iter().zip(found) {
                let factor = draws as f64 * chosen.times;
                for (i, values) in spread.chunks(bands).enumerate() {
                    let sums = power.row_mut(i)[chosen.draw * bands..].iter_mut();
                    sums.zip(values).for_each(|(sum, value)| *sum += factor * value);
                }
            }
        }
        Ok(Residual { power, draws })
    }

    /// Seconds that [`residual`](Self::residual) takes one thread, from elements in all parts of
    /// the mesh. `spent` tells the seconds that the calling thread has worked; elements are looked
    /// at until `budget` (s) is spent, one at least.
    #[must_use]
    pub fn seconds(&self, budget: f64, spent: &dyn Fn() -> f64) -> f64 {
        let n = self.patches.len();
        let started = spent();
        let bodies = Bodies::new(self.occluders, self.patches, &[]);
        let (chosen, grid) = self.choose(points(n, bodies.as_slice().len()));
        let rows: Vec<usize> = (0..n).collect();
        let targets = Targets { patches: self.patches, row_of: &rows, rows: n, occluders: self.occluders };
        let prepared = spent();
        let mut done = 0;
        for one in scattered(chosen.len()).map(|at| &chosen[at]) {
            std::hint::black_box(self.spread(one.element, &one.places(grid), &targets, &bodies));
            done += 1;
            if spent() - started > budget {
                break;
            }
        }
        let of_all = if done == 0 { 0.0 } else { chosen.len() as f64 / f64::from(done) };
        prepared - started + (spent() - prepared) * of_all
    }

    /// What the residual of one element does to all, W, element-major, from some places on it.
    fn spread(
        &self,
        element: usize,
        places: &[[f64; 2]],
        targets: &Targets<'_>,
        bodies: &Bodies,
    ) -> Vec<f64> {
        let (patch, bands) = (self.patches[element], self.irradiance.rhs_count());
        let size = self.elements[element];
        let whole = size.exposed >= size.area;
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(places.len());
        for &place in places {
            let at = Receiver { point: even_point(patch, place), normal: patch.normal() };
            let row = targets.row(&at, bodies);
            // What is buried sees nothing, and has no part in what is exposed.
            if whole || row.iter().any(|factor| *factor > 0.0) {
                rows.push(row);
            }
        }
        let mut spread = vec![0.0; self.patches.len() * bands];
        if rows.len() < 2 {
            return spread;
        }
        let seen = |row: &Vec<f64>| self.seen(row);
        let seen: Vec<Vec<f64>> = rows.iter().map(seen).collect();
        let count = rows.len() as f64;
        // The variance of a linear function over an element is that over a k × k grid times k²/(k²
        // − 1), of two ends of a diagonal as of all four cells.
        let cells = (places.len() as f64).max(4.0);
        let weight = size.exposed / count * cells / (cells - 1.0);
        for band in 0..bands {
            let mean = seen.iter().map(|e| e[band]).sum::<f64>() / count;
            let scale = weight * self.reflectance.row(element)[band];
            for (row, e) in rows.iter().zip(&seen) {
                let residual = scale * (e[band] - mean);
                let to = spread.iter_mut().skip(band).step_by(bands);
                to.zip(row).for_each(|(to, factor)| *to += residual * factor);
            }
        }
        spread
    }

    /// E of every band at a point with these form factors.
    fn seen(&self, row: &[f64]) -> Vec<f64> {
        let mut seen = vec![0.0; self.irradiance.rhs_count()];
        for (factor, light) in row.iter().zip(self.radiosity.rows()).filter(|(factor, _)| **factor > 0.0) {
            seen.iter_mut().zip(light).for_each(|(seen, light)| *seen += factor * light);
        }
        seen
    }

    /// All elements and the side of their grids, or else some elements, for which the side is 1:
    /// two ends of a diagonal.
    fn choose(&self, points: usize) -> (Vec<Chosen>, usize) {
        let n = self.patches.len();
        let side = ((points as f64 / n as f64).sqrt() as usize).min(MOST_POINTS_A_SIDE);
        if side >= 2 {
            let all = (0..n).map(|element| Chosen { element, times: 1.0, draw: 0, turn: 0 });
            return (all.collect(), side);
        }
        (self.draw((points / 2).max(FEWEST_ELEMENTS)), 1)
    }

    /// About so many elements, drawn in proportion to the light that they reflect.
    fn draw(&self, count: usize) -> Vec<Chosen> {
        let weights = self.weights();
        let total: f64 = weights.iter().sum();
        let (mut chosen, mut sum, mut next) = (Vec::new(), 0.0, 0.5);
        for (element, weight) in weights.iter().enumerate() {
            let expected = weight * count as f64 / total;
            sum += expected;
            while sum > next {
                let turn = chosen.len();
                let times = expected.recip();
                chosen.push(Chosen {
                    element,
                    times,
                    draw: turn % DRAWN_SEQUENCES,
                    turn: turn / DRAWN_SEQUENCES,
                });
                next += 1.0;
            }
        }
        chosen
    }

    /// Reflected power of the elements, in the band where it is the largest share of the whole; no
    /// less than that of an element in some light.
    fn weights(&self) -> Vec<f64> {
        let (n, bands) = (self.patches.len(), self.irradiance.rhs_count());
        let mut weights = vec![0.0; n];
        let area: f64 = self.elements.iter().map(|size| size.area).sum();
        for band in 0..bands {
            let power: f64 =
                (0..n).map(|i| self.elements[i].area * self.irradiance.row(i)[band]).sum::<f64>();
            if power > 0.0 {
                let mean = power / area;
                for (i, weight) in weights.iter_mut().enumerate() {
                    let light = self.irradiance.row(i)[band] + DARK_SHARE * mean;
                    let own = self.elements[i].exposed * self.reflectance.row(i)[band] * light / power;
                    *weight = own.max(*weight);
                }
            }
        }
        weights
    }
}

impl Chosen {
    /// Where it is looked at, in [0, 1]².
    fn places(&self, side: usize) -> Vec<[f64; 2]> {
        if side < 2 {
            let (low, high) = (0.25, 0.75);
            return if self.turn.is_multiple_of(2) {
                vec![[low, low], [high, high]]
            } else {
                vec![[low, high], [high, low]]
            };
        }
        let middle = |k: usize| (k as f64 + 0.5) / side as f64;
        (0..side * side).map(|k| [middle(k / side), middle(k % side)]).collect()
    }
}

/// Points that are looked from, among so many elements and bodies.
fn points(elements: usize, bodies: usize) -> usize {
    let n = elements.max(1) as f64;
    let share = if bodies == 0 {
        POINTS_IN_THE_OPEN
    } else {
        POINTS_AMONG_BODIES / (1.0 + bodies as f64 / MANY_BODIES)
    };
    (POINT_FACTORS_ALWAYS_COMPUTED / elements.max(1)).max((share * n) as usize)
}

/// Elements whose rows are in memory at once.
fn at_once(bands: usize) -> usize {
    let some = OF_A_THREAD * rayon::current_num_threads();
    (CHUNK * BANDS_OF_A_CHUNK / bands.max(1)).clamp(some.min(CHUNK), CHUNK)
}

/// The point of a patch for two numbers in [0, 1], as many on equal areas; of a quad that is no
/// parallelogram nearly so.
fn even_point(patch: &Patch, [u, v]: [f64; 2]) -> Vec3 {
    if patch.sides() == 4 {
        return patch.point(u, v);
    }
    // √u is the share of the way from the first corner to the side opposite (G. Turk, Graphics
    // Gems, 1990).
    let way = u.sqrt();
    patch.point(way * (1.0 - v), way * v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::assemble;
    use crate::form_factor::PairIntegrator;
    use fredholm_linop::Quiet;
    use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Shape};
    use std::ops::ControlFlow;

    /// Whoever wants nothing.
    struct Cancelled;

    impl Watch for Cancelled {
        fn go_on(&self) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }

    fn room(n: usize) -> Mesh {
        let mut builder = MeshBuilder::default();
        builder.surface("room", 0);
        let cut = Cutting { lines: Lines::Counts { u: n, v: n }, ..Cutting::default() };
        let shape = Shape::Box { min: Vec3::ZERO, max: Vec3::new(1.0, 1.5, 0.8), inward: true };
        builder.add(&shape, &cut).unwrap();
        builder.build()
    }

    struct Solved {
        mesh: Mesh,
        sizes: Vec<Extent>,
        reflectance: MultiVector<f64>,
        radiosity: MultiVector<f64>,
        irradiance: MultiVector<f64>,
    }

    impl Solved {
        /// One reflection of a light that comes from the first wall alone.
        fn new(n: usize, exitance: impl Fn(usize) -> f64) -> Self {
            let mesh = room(n);
            let occluders = Occluders::new(mesh.occluders()).unwrap();
            let pairs = PairIntegrator::new(mesh.patches(), &occluders, 1e-7);
            let matrix = assemble::<f64>(&pairs, &Quiet).unwrap().matrix;
            let sizes: Vec<Extent> =
                mesh.patches().map(|p| Extent { area: p.area(), exposed: p.area() }).collect();
            let (count, rho) = (mesh.len(), 0.9);
            let irradiance = |b: &[f64]| -> Vec<f64> {
                (0..count)
                    .map(|i| (0..count).map(|j| matrix.get(i, j) * b[j]).sum::<f64>() / sizes[i].area)
                    .collect()
            };
            let m: Vec<f64> = (0..count).map(&exitance).collect();
            let mut b = m.clone();
            for _ in 0..400 {
                b = irradiance(&b).iter().zip(&m).map(|(e, m)| m + rho * e).collect();
            }
            let rhs = |values| MultiVector::from_vec(count, 1, values).unwrap();
            let irradiance = rhs(irradiance(&b));
            Self { sizes, reflectance: rhs(vec![rho; count]), radiosity: rhs(b), irradiance, mesh }
        }

        fn residual(&self) -> Residual {
            let patches: Vec<&Patch> = self.mesh.patches().collect();
            let occluders = Occluders::new(self.mesh.occluders()).unwrap();
            let constants = Constants {
                patches: &patches,
                occluders: &occluders,
                elements: &self.sizes,
                reflectance: &self.reflectance,
                radiosity: &self.radiosity,
                irradiance: &self.irradiance,
            };
            constants.residual(&Quiet).unwrap()
        }
    }

    #[test]
    fn a_furnace_has_no_residual() {
        let found = Solved::new(1, |_| 1.0).residual();
        assert_eq!(found.draws, 1);
        assert!(found.power.as_slice().iter().all(|p| p.abs() < 1e-5), "{found:?}");
    }

    #[test]
    fn a_residual_moves_light_and_makes_none() {
        let found = Solved::new(1, |leaf| f64::from(u8::from(leaf == 0))).residual();
        let (sum, size): (f64, f64) =
            found.power.as_slice().iter().fold((0.0, 0.0), |(sum, size), p| (sum + p, size + p.abs()));
        assert!(size > 0.01 && sum.abs() < 1e-12 * size, "{sum:e} {size}");
    }

    #[test]
    fn elements_that_are_drawn_stand_for_all() {
        // 600 elements: a quarter of them is looked at, and each draw estimates the same powers.
        let solved = Solved::new(10, |leaf| f64::from(u8::from(leaf < 30)));
        let (patches, occluders) =
            (solved.mesh.patches().collect::<Vec<_>>(), Occluders::new(solved.mesh.occluders()).unwrap());
        let constants = Constants {
            patches: &patches,
            occluders: &occluders,
            elements: &solved.sizes,
            reflectance: &solved.reflectance,
            radiosity: &solved.radiosity,
            irradiance: &solved.irradiance,
        };
        let chosen = constants.draw(150);
        let stood_for: f64 = chosen.iter().map(|one| one.times * solved.sizes[one.element].area).sum();
        let area: f64 = solved.sizes.iter().map(|size| size.area).sum();
        assert!((stood_for / area - 1.0).abs() < 0.05, "{stood_for} {area}");
        assert_eq!(constants.residual(&Quiet).unwrap().draws, DRAWN_SEQUENCES);
        let stopped = constants.residual(&Cancelled);
        assert!(matches!(stopped, Err(CouplingError::Interrupted { done: 0, .. })));
    }

    #[test]
    fn errors_are_weighed_by_area() {
        let irradiance = MultiVector::from_vec(2, 1, vec![1.0, 2.0]).unwrap();
        let found = MeshError::new(vec![0.1, 0.2], &irradiance, &[4.0, 1.0]);
        assert!((found.relative_l2[0] - 0.1).abs() < 1e-15 && found.largest == [0.2]);
    }
}
