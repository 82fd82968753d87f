//! Light gathered at some of the pixels, and between them what these tell: E(x) = ∫ B cosθ/π dω
//! over the directions from x, of which a few hundred are looked along.
//!
//! Only what changes slowly is gathered, so some ten thousand places are enough for a picture: a cache
//! of irradiance (G. J. Ward, F. M. Rubinstein, R. D. Clear, SIGGRAPH 1988,
//! doi:10.1145/54852.378490). The harmonic mean of the lengths of the rays of a place tells how far
//! it reaches. A point has the value at it of the plane that fits the places around it best
//! (weighted least squares), on the same surface and where normals are alike. What these are off
//! that plane, and what the groups of directions of a place differ by, is the stated error.
//! No place reaches farther than others nearby allow that are close to something. Places are added
//! on grids of pixels, each twice as fine, where too few others reach or where that error is too
//! large.
//!
//! What a direction meets has the radiosity of the solution, but for surfaces nearby, whose
//! elements are too large to tell it: narrow gaps and corners would be too bright. There the light
//! of the lamps is taken where it is met, and the rest from what one more direction meets. W/m².

use std::ops::{Range, RangeInclusive};

use rayon::prelude::*;

use fredholm_mesh::{Mesh, Vec3};

use super::lit::{LampFactors, LampLight, Lighter, Lit, Points, Seen};
use crate::colour::{Rgb, sum};
use crate::shading::Shading;
use crate::tone::luminance;
use crate::{Eye, Field};

/// Groups of directions of a place, each evenly distributed: their scatter tells the error.
pub const DIRECTION_GROUPS: usize = 4;
/// Pixels from place to place on each of the grids.
const STRIDES: [usize; 4] = [16, 8, 4, 2];
/// Places that have to reach a pixel of these grids, else it becomes one.
const FEWEST: [usize; 4] = [6, 6, 4, 1];
/// Pixels to which a place reaches at least: so few are not seen.
const LEAST_REACH_PIXELS: f64 = 3.0;
/// Places that tell a point, at most: the nearest.
const MOST_PLACES: usize = 16;
/// Places from which on a plane is laid through them, and not their mean taken.
const PLACES_OF_A_PLANE: usize = 6;
/// Determinant, over the product of the diagonal, below which places lie on a line.
const SINGULAR: f64 = 1e-4;
/// Sum of the squares of the weights of the places from which on a plane is not trusted: the point
/// lies outside of them.
const MOST_SPREAD: f64 = 1.0;
/// Darker pixels may have the error of this share of the mean.
const DARK_SHARE: f64 = 0.3;
/// Normals of one surface are alike up to this cosine, and points of it lie in one plane up to this
/// part of their distance.
const ALIKE_COSINE: f64 = 0.9;
const FLAT_SHARE: f64 = 0.25;
/// Pixels along the side of a bin of places, and bins that are looked through on either side.
const BIN_SIDE: usize = 8;
const MOST_RINGS: usize = 8;
/// The same where places limit each other.
const CLAMPING_RINGS: usize = 3;

/// How exact what is gathered has to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quality {
    /// Standard error, over the colour of the pixel, that a pixel of a grid may have.
    pub error: f64,
    /// Distance, over the harmonic mean of the lengths of its rays, to which a place reaches.
    pub reach: f64,
}

/// Looks along directions.
pub trait Gathering: Sync {
    /// What rays from a point of a leaf meet, of which the directions have the density cosθ/π: leaf
    /// and point (m), or none for a back or for nothing. [`DIRECTION_GROUPS`] groups of equally
    /// many, independent of each other, one behind the other. Numbers below 2³¹ tell places apart,
    /// and the directions of different ones are independent.
    fn meet(&self, number: u32, leaf: usize, point: Vec3, met: &mut Vec<Seen>);

    /// What one more ray meets from each of some points of leaves, with the same density of
    /// directions and independent of the others: `step` counts the rays on the way there.
    fn onward(&self, number: u32, step: u32, from: &[(usize, Vec3)], met: &mut Vec<Seen>);
}

/// Distance of what a direction meets, over the root of the area of its leaf, up to which the mean
/// over the leaf is not enough: the lamps are looked at where it is met, and what else comes to it
/// is taken from where one more direction ends.
const NEAR: f64 = 0.5;
/// More directions of this kind, one behind the other, at most.
const MOST_STEPS: u32 = 4;

/// What surfaces send on, W/m².
pub(super) struct Sent<'a> {
    /// What is interpolated between the corners of leaves, and what each has as a whole, leaves ×
    /// bands.
    smooth: Shading<'a>,
    constant: Vec<f64>,
    /// The lamps that are looked at where leaves are near, with the exitance of each, lamps ×
    /// bands, and the reflectance of the leaves, leaves × bands.
    lamps: Option<(&'a dyn LampLight, &'a [f64], &'a [f64])>,
}

impl<'a> Sent<'a> {
    /// The radiosity; without its exitance, and with the part of its irradiance that is the lamps'
    /// not interpolated, where that is told apart; nearby that part is looked at where it is exact.
    pub fn new(field: Field<'a>, lit: &Lit<'a>, (passes, is_exact): (usize, bool)) -> Self {
        let Lit { light, exitance, reflectance, direct, .. } = *lit;
        let lamps = (is_exact && direct.is_some()).then_some((light, exitance, reflectance));
        let bands = field.bands().len();
        let mut smooth: Vec<f64> =
            (0..field.mesh().len()).flat_map(|leaf| field.exposed_radiosity(leaf)).collect();
        let mut constant = Vec::new();
        if let Some(direct) = direct {
            for (leaf, smooth) in smooth.chunks_exact_mut(bands).enumerate() {
                let reflected_by = field.over_exposed(leaf);
                let exitance = field.exitance().map(|m| field.row(m, leaf));
                for (band, smooth) in smooth.iter_mut().enumerate() {
                    let at = leaf * bands + band;
                    let part = reflectance[at] * direct[at] * reflected_by;
                    *smooth -= exitance.map_or(0.0, |m| m[band]) + part;
                    constant.push(part);
                }
            }
        }
        Self { smooth: Shading::of_values(field, passes, (bands, smooth)), constant, lamps }
    }

    /// Adds a share of what a point of a leaf sends on, without the light that comes to it straight
    /// from lamps that are told apart.
    fn add_smooth(&self, (leaf, point): (usize, Vec3), share: &[f64], sum: &mut [f64]) {
        let mut sent = vec![0.0; share.len()];
        self.smooth.add(leaf, point, &mut sent);
        sum.iter_mut().zip(share.iter().zip(sent)).for_each(|(sum, (share, sent))| *sum += share * sent);
    }

    /// Adds a share of what a leaf sends on of the light of lamps, as a whole.
    fn add_whole(&self, leaf: usize, share: &[f64], sum: &mut [f64]) {
        if !self.constant.is_empty() {
            let bands = sum.len();
            let sent = &self.constant[leaf * bands..(leaf + 1) * bands];
            sum.iter_mut().zip(share.iter().zip(sent)).for_each(|(sum, (share, sent))| *sum += share * sent);
        }
    }

    fn looker<'s>(&'s self, gathering: &'s dyn Gathering) -> Looker<'s> {
        Looker {
            sent: self,
            gathering,
            look: self.lamps.map(|(light, ..)| light.lighter(Points::Several)),
            near: Vec::new(),
            shares: Vec::new(),
            onward: Vec::new(),
            points: Vec::new(),
            factors: LampFactors::default(),
        }
    }
}

/// What a direction met nearby: of a place, or of what was itself met nearby.
#[derive(Clone, Copy, Debug)]
struct Near {
    leaf: usize,
    point: Vec3,
    /// Group of directions of the place.
    group: usize,
}

/// Sums what the directions of one place meet, for one thread.
struct Looker<'s> {
    sent: &'s Sent<'s>,
    gathering: &'s dyn Gathering,
    look: Option<Lighter<'s>>,
    near: Vec<Near>,
    /// The shares of what they send on that the place gets, near × bands.
    shares: Vec<f64>,
    onward: Vec<Seen>,
    points: Vec<Vec3>,
    factors: LampFactors,
}

impl Looker<'_> {
    /// Sums of what the groups of directions of a place meet, groups × bands, W/m². What is met
    /// nearby sends on the light of the lamps that comes to it and what one more direction meets.
    fn sums(&mut self, number: u32, place: Vec3, met: &[Seen], mesh: &Mesh, bands: usize) -> Vec<f64> {
        let of_group = (met.len() / DIRECTION_GROUPS).max(1);
        let mut sums = vec![0.0; DIRECTION_GROUPS * bands];
        self.near.clear();
        self.shares.clear();
        let whole = vec![1.0; bands];
        for (k, (leaf, point)) in met.iter().enumerate().filter_map(|(k, met)| met.map(|met| (k, met))) {
            let group = (k / of_group).min(DIRECTION_GROUPS - 1);
            self.add(place, Near { leaf, point, group }, &whole, (mesh, &mut sums));
        }
        let mut new = 0..self.near.len();
        for step in 0..MOST_STEPS {
            if new.is_empty() {
                break;
            }
            let sites: Vec<(usize, Vec3)> =
                self.near[new.clone()].iter().map(|near| (near.leaf, near.point)).collect();
            let mut onward = std::mem::take(&mut self.onward);
            self.gathering.onward(number, step, &sites, &mut onward);
            for (k, met) in new.clone().zip(&onward) {
                let Some((leaf, point)) = *met else { continue };
                let Near { point: from, group, .. } = self.near[k];
                let share = self.reflected(k, bands);
                self.add(from, Near { leaf, point, group }, &share, (mesh, &mut sums));
            }
            self.onward = onward;
            new = new.end..self.near.len();
        }
        // What is left is taken from the solution, without the light of lamps.
        for k in new {
            let Near { leaf, point, group } = self.near[k];
            self.sent.add_smooth(
                (leaf, point),
                &self.shares[k * bands..(k + 1) * bands],
                &mut sums[group * bands..(group + 1) * bands],
            );
        }
        self.add_lamps(bands, &mut sums);
        sums
    }

    /// The share of its irradiance that the place gets of what is nearby.
    fn reflected(&self, k: usize, bands: usize) -> Vec<f64> {
        let share = &self.shares[k * bands..(k + 1) * bands];
        let leaf = self.near[k].leaf;
        let rho = self.sent.lamps.map_or(&[][..], |(.., rho)| &rho[leaf * bands..(leaf + 1) * bands]);
        share.iter().zip(rho).map(|(share, rho)| share * rho).collect()
    }

    /// Adds a share of what is met, as it is seen from a point, or puts it with what is near.
    fn add(&mut self, from: Vec3, met: Near, share: &[f64], (mesh, sums): (&Mesh, &mut [f64])) {
        let Near { leaf, point, group } = met;
        let reach = NEAR * NEAR * mesh.patch(leaf).area();
        if self.look.is_some() && point.distance_squared(from) < reach {
            self.near.push(met);
            self.shares.extend_from_slice(share);
            return;
        }
        let sum = &mut sums[group * share.len()..(group + 1) * share.len()];
        self.sent.add_smooth((leaf, point), share, sum);
        self.sent.add_whole(leaf, share, sum);
    }

    /// Adds the light of lamps that what is near sends on.
    fn add_lamps(&mut self, bands: usize, sums: &mut [f64]) {
        let (Some(mut look), Some((light, exitance, _))) = (self.look.take(), self.sent.lamps) else {
            return;
        };
        let lamps = light.lamps();
        // In the order of directions, those of one leaf together.
        let mut order: Vec<usize> = (0..self.near.len()).collect();
        order.sort_by_key(|&k| self.near[k].leaf);
        for together in order.chunk_by(|&a, &b| self.near[a].leaf == self.near[b].leaf) {
            self.points.clear();
            self.points.extend(together.iter().map(|&k| self.near[k].point));
            self.factors.reset(lamps * together.len());
            look(self.near[together[0]].leaf, &self.points, &mut self.factors);
            for (&k, factors) in together.iter().zip(self.factors.values.chunks_exact(lamps)) {
                let (group, share) = (self.near[k].group, self.reflected(k, bands));
                let sum = &mut sums[group * bands..(group + 1) * bands];
                for (factor, m) in factors.iter().zip(exitance.chunks_exact(bands)) {
                    let add = |(sum, (share, m)): (&mut f64, (&f64, &f64))| *sum += share * m * factor;
                    sum.iter_mut().zip(share.iter().zip(m)).for_each(add);
                }
            }
        }
        self.look = Some(look);
    }
}

/// A place at which light was gathered.
#[derive(Clone, Copy, Debug)]
struct Place {
    point: Vec3,
    normal: Vec3,
    surface: u32,
    /// Where it is in the picture, pixels.
    at: (f64, f64),
    /// To where it reaches, m.
    reach: f64,
    /// What is reflected of the light, as linear sRGB, and the square of its standard error.
    colour: Rgb,
    variance: Rgb,
}

/// What places tell of a point: what it reflects, as linear sRGB, and the standard error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    pub colour: Rgb,
    pub error: Rgb,
    /// How many told it.
    places: usize,
    /// Sum of the squares of their weights.
    spread: f64,
}

/// The places of a picture.
pub(super) struct Gathered<'a> {
    field: Field<'a>,
    eye: &'a Eye,
    /// As of [`Quality`].
    reach: f64,
    places: Vec<Place>,
    /// Where the places of each bin begin, a square of pixels, row by row; and where the last end.
    bins: Vec<usize>,
    /// Bins in a row, and rows.
    sides: [usize; 2],
}

/// A pixel that may become a place.
pub(super) struct Candidate {
    pub leaf: usize,
    pub point: Vec3,
    /// Its colour without what is gathered.
    pub colour: Rgb,
}

impl<'a> Gathered<'a> {
    /// Gathers for a picture. `pixel` is what is seen through the middle of a pixel, `reflected`
    /// the colour that a leaf reflects of an irradiance, leaf by leaf; `go_on` is told the share of
    /// the way and says whether to go on.
    pub fn new(
        (field, eye): (Field<'a>, &'a Eye),
        (gathering, sent): (&dyn Gathering, &Sent<'_>),
        (pixel, quality): (&(dyn Fn(usize, usize) -> Option<Candidate> + Sync), Quality),
        reflected: &(dyn Fn(usize, &[f64]) -> Rgb + Sync),
        go_on: &(dyn Fn(f64) -> bool + Sync),
    ) -> Self {
        let camera = eye.camera();
        let (w, h) = (camera.width as usize, camera.height as usize);
        let sides = [w.div_ceil(BIN_SIDE), h.div_ceil(BIN_SIDE)];
        let bins = vec![0; sides[0] * sides[1] + 1];
        let mut gathered = Self { field, eye, reach: quality.reach, places: Vec::new(), bins, sides };
        for (pass, stride) in STRIDES.into_iter().enumerate() {
            let coarser = if pass == 0 { 0 } else { 2 * stride };
            let is_new = |x: usize, y: usize| {
                coarser == 0 || !(x.is_multiple_of(coarser) && y.is_multiple_of(coarser))
            };
            let grid = (0..h).step_by(stride).flat_map(|y| (0..w).step_by(stride).map(move |x| (x, y)));
            let pixels: Vec<(usize, usize)> = grid.filter(|&(x, y)| is_new(x, y)).collect();
            let look = |&(x, y): &(usize, usize)| {
                let candidate = pixel(x, y)?;
                let told = gathered.told(candidate.leaf, candidate.point);
                Some((x, y, candidate, told))
            };
            let seen: Vec<(usize, usize, Candidate, Option<Told>)> =
                pixels.par_iter().filter_map(look).collect();
            let mean =
                mean(seen.iter().filter_map(|(_, _, candidate, told)| Some((candidate, told.as_ref()?))));
            let enough = |told: &Told, candidate: &Candidate| {
                is_enough(told, candidate, (FEWEST[pass], mean, quality.error))
            };
            let wanted = seen.into_iter().filter_map(|(x, y, candidate, told)| {
                (!told.is_some_and(|told| enough(&told, &candidate))).then_some((x, y, candidate))
            });
            let wanted: Vec<(usize, usize, Candidate)> = wanted.collect();
            let begun = pass as f64 / STRIDES.len() as f64;
            let begin = || (Vec::new(), sent.looker(gathering));
            let look = |(met, looker): &mut (Vec<Seen>, Looker<'_>),
                        (k, (x, y, candidate)): (usize, &(usize, usize, Candidate))| {
                let share = begun + k as f64 / (wanted.len() * STRIDES.len()) as f64;
                if !go_on(share) {
                    return None;
                }
                let number = (y * w + x) as u32;
                gathering.meet(number, candidate.leaf, candidate.point, met);
                let at = (*x as f64 + 0.5, *y as f64 + 0.5);
                let sums = looker.sums(number, candidate.point, met, field.mesh(), field.bands().len());
                Some(gathered.place((candidate, at), (met, sums), reflected))
            };
            let places = wanted.par_iter().enumerate().map_init(begin, look);
            let places: Vec<Option<Place>> = places.collect();
            let stopped = places.iter().any(Option::is_none);
            gathered.insert(places.into_iter().flatten());
            if stopped {
                break;
            }
        }
        gathered
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    fn insert(&mut self, places: impl Iterator<Item = Place>) {
        self.places.extend(places);
        let of_row = self.sides[0];
        let sides = self.sides;
        let bin = |place: &Place| {
            let [column, row] = bin_of(place.at, sides);
            row * of_row + column
        };
        self.places.sort_by_key(bin);
        self.bins.fill(0);
        self.places.iter().for_each(|place| self.bins[bin(place) + 1] += 1);
        for k in 1..self.bins.len() {
            self.bins[k] += self.bins[k - 1];
        }
        self.clamp();
    }

    /// The columns and rows of bins up to so many from one.
    fn around(&self, own: [usize; 2], rings: usize) -> [RangeInclusive<usize>; 2] {
        [0, 1].map(|i| own[i].saturating_sub(rings)..=(own[i] + rings).min(self.sides[i] - 1))
    }

    /// The numbers of the places of some columns of a row of bins.
    fn of_bins(&self, row: usize, columns: RangeInclusive<usize>) -> Range<usize> {
        let first = row * self.sides[0];
        self.bins[first + columns.start()]..self.bins[first + columns.end() + 1]
    }

    /// Lets no place reach farther than what others nearby are close to allows: the distance from a
    /// point to what is around it changes by no more than the point moves (neighbour clamping, J.
    /// Křivánek, K. Bouatouch, S. Pattanaik, J. Žára, Rendering Techniques 2006).
    fn clamp(&mut self) {
        let clamped = |place: &Place| {
            let [columns, rows] = self.around(bin_of(place.at, self.sides), CLAMPING_RINGS);
            let others = rows.flat_map(|row| &self.places[self.of_bins(row, columns.clone())]);
            let alike = others.filter(|other| {
                other.surface == place.surface && other.normal.dot(place.normal) >= ALIKE_COSINE
            });
            alike.fold(place.reach, |reach, other| {
                reach.min(other.reach + self.reach * other.point.distance(place.point))
            })
        };
        let reaches: Vec<f64> = self.places.par_iter().map(clamped).collect();
        self.places.iter_mut().zip(reaches).for_each(|(place, reach)| place.reach = reach);
    }

    /// A place, from what its directions meet.
    fn place(
        &self,
        (candidate, at): (&Candidate, (f64, f64)),
        (met, mut sums): (&[Seen], Vec<f64>),
        reflected: &dyn Fn(usize, &[f64]) -> Rgb,
    ) -> Place {
        let Candidate { leaf, point, .. } = *candidate;
        let bands = self.field.bands().len();
        let of_group = met.len() / DIRECTION_GROUPS;
        let inverse: f64 =
            met.iter().flatten().map(|(_, at)| 1.0 / at.distance(point).max(f64::MIN_POSITIVE)).sum();
        for sum in &mut sums {
            *sum /= of_group as f64;
        }
        let mut colours = [[0.0; 3]; DIRECTION_GROUPS];
        for (colour, irradiance) in colours.iter_mut().zip(sums.chunks_exact(bands)) {
            *colour = reflected(leaf, irradiance);
        }
        let groups = DIRECTION_GROUPS as f64;
        let colour = [0, 1, 2].map(|i| colours.iter().map(|group| group[i]).sum::<f64>() / groups);
        let variance = [0, 1, 2].map(|i| {
            let squares = colours.iter().map(|group| (group[i] - colour[i]).powi(2));
            squares.sum::<f64>() / (groups * (groups - 1.0))
        });
        let mesh = self.field.mesh();
        let reach = self.reach * met.len() as f64 / inverse;
        let (normal, surface) = (mesh.patch(leaf).normal(), mesh.surface_of(leaf) as u32);
        Place { point, normal, surface, at, reach, colour, variance }
    }

    /// What the places around a point of a leaf tell; none where none reaches it.
    pub fn told(&self, leaf: usize, point: Vec3) -> Option<Told> {
        let near = self.near(leaf, point)?;
        if near.is_empty() {
            return None;
        }
        let plane = if near.len() >= PLACES_OF_A_PLANE { self.plane(leaf, point, &near) } else { None };
        Some(plane.filter(|told| told.spread <= MOST_SPREAD).unwrap_or_else(|| self.middle(&near)))
    }

    /// The places that reach a point, each with its weight, the heaviest first.
    fn near(&self, leaf: usize, point: Vec3) -> Option<Vec<(f64, u32)>> {
        let at = self.eye.place(point)?;
        let mesh = self.field.mesh();
        let (normal, surface) = (mesh.patch(leaf).normal(), mesh.surface_of(leaf) as u32);
        let own = bin_of(at, self.sides);
        let mut near: Vec<(f64, u32)> = Vec::with_capacity(2 * MOST_PLACES);
        for ring in 0..=MOST_RINGS {
            if ring > 1 && near.len() >= MOST_PLACES {
                break;
            }
            let [columns, rows] = self.around(own, ring);
            let mut look = |places: Range<usize>| {
                for k in places {
                    let weight = weight(&self.places[k], (point, normal, surface), at);
                    near.extend(weight.map(|weight| (weight, k as u32)));
                }
            };
            for row in rows {
                if row.abs_diff(own[1]) == ring {
                    look(self.of_bins(row, columns.clone()));
                    continue;
                }
                for column in [*columns.start(), *columns.end()] {
                    if column.abs_diff(own[0]) == ring {
                        look(self.of_bins(row, column..=column));
                    }
                }
            }
        }
        near.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        near.truncate(MOST_PLACES);
        Some(near)
    }

    /// The weighted mean of places.
    fn middle(&self, near: &[(f64, u32)]) -> Told {
        let all: f64 = near.iter().map(|(weight, _)| weight).sum();
        let shares: Vec<f64> = near.iter().map(|(weight, _)| weight / all).collect();
        let places = || near.iter().map(|&(_, k)| &self.places[k as usize]).zip(&shares);
        let colour = places()
            .fold([0.0; 3], |sum, (place, share)| [0, 1, 2].map(|i| sum[i] + share * place.colour[i]));
        self.stated(near, &shares, colour, |_| colour, 1)
    }

    /// The value at a point of the plane through places.
    fn plane(&self, leaf: usize, point: Vec3, near: &[(f64, u32)]) -> Option<Told> {
        let normal = self.field.mesh().patch(leaf).normal();
        let x = normal.any_orthonormal_vector();
        let y = normal.cross(x);
        let size =
            near.iter().map(|&(_, k)| self.places[k as usize].point.distance(point)).fold(0.0, f64::max);
        let coordinates: Vec<[f64; 3]> = near
            .iter()
            .map(|&(_, k)| {
                let off = (self.places[k as usize].point - point) / size;
                [1.0, off.dot(x), off.dot(y)]
            })
            .collect();
        let mut matrix = [[0.0; 3]; 3];
        for ((weight, _), c) in near.iter().zip(&coordinates) {
            for i in 0..3 {
                for j in 0..3 {
                    matrix[i][j] += weight * c[i] * c[j];
                }
            }
        }
        let inverse = inverse(matrix)?;
        // Row i of the inverse tells the weights of the places in coefficient i.
        let parts: Vec<[f64; 3]> = near
            .iter()
            .zip(&coordinates)
            .map(|((weight, _), c)| {
                [0, 1, 2].map(|i| weight * (0..3).map(|j| inverse[i][j] * c[j]).sum::<f64>())
            })
            .collect();
        let mut coefficients = [[0.0; 3]; 3];
        for (&(_, k), part) in near.iter().zip(&parts) {
            let colour = self.places[k as usize].colour;
            for (coefficient, part) in coefficients.iter_mut().zip(part) {
                *coefficient = [0, 1, 2].map(|i| coefficient[i] + part * colour[i]);
            }
        }
        let shares: Vec<f64> = parts.iter().map(|part| part[0]).collect();
        let fitted =
            |k: usize| [0, 1, 2].map(|i| (0..3).map(|j| coefficients[j][i] * coordinates[k][j]).sum::<f64>());
        let colour = coefficients[0].map(|c| c.max(0.0));
        Some(self.stated(near, &shares, colour, fitted, 3))
    }

    /// A colour with its error, from what places are off what was fitted with some free numbers.
    fn stated(
        &self,
        near: &[(f64, u32)],
        shares: &[f64],
        colour: Rgb,
        fitted: impl Fn(usize) -> Rgb,
        free: usize,
    ) -> Told {
        let (mut all, mut off, mut noise) = (0.0, [0.0; 3], [0.0; 3]);
        for (k, &(weight, number)) in near.iter().enumerate() {
            let (place, fitted) = (&self.places[number as usize], fitted(k));
            all += weight;
            off = [0, 1, 2].map(|i| off[i] + weight * (place.colour[i] - fitted[i]).powi(2));
            noise = [0, 1, 2].map(|i| noise[i] + weight * place.variance[i]);
        }
        let n = near.len() as f64;
        let freedom = n / (n - free as f64);
        let spread: f64 = shares.iter().map(|share| share * share).sum();
        let error = [0, 1, 2].map(|i| {
            let off = if near.len() > free { off[i] / all * freedom } else { 0.0 };
            (off.max(noise[i] / all) * spread).sqrt()
        });
        Told { colour, error, places: near.len(), spread }
    }
}

/// The bin of a place of the picture, column and row, of so many columns and rows.
fn bin_of(at: (f64, f64), sides: [usize; 2]) -> [usize; 2] {
    let bin = |at: f64, i: usize| (at.max(0.0) as usize / BIN_SIDE).min(sides[i] - 1);
    [bin(at.0, 0), bin(at.1, 1)]
}

/// Mean luminance of pixels that places tell.
fn mean<'c>(told: impl Iterator<Item = (&'c Candidate, &'c Told)>) -> f64 {
    let add = |(all, count): (f64, f64), (candidate, told): (&Candidate, &Told)| {
        (all + luminance(sum(candidate.colour, told.colour)), count + 1.0)
    };
    let (all, count) = told.fold((0.0, 0.0), add);
    all / count.max(1.0)
}

/// Whether a pixel need not become a place.
fn is_enough(told: &Told, candidate: &Candidate, (fewest, mean, error): (usize, f64, f64)) -> bool {
    let bright = luminance(sum(candidate.colour, told.colour)).max(DARK_SHARE * mean);
    told.places >= fewest && luminance(told.error) <= error * bright
}

/// The weight of a place for a point with its normal and surface, that is seen at a place of the
/// picture; none where it does not reach it.
fn weight(place: &Place, (point, normal, surface): (Vec3, Vec3, u32), at: (f64, f64)) -> Option<f64> {
    if place.surface != surface || place.normal.dot(normal) < ALIKE_COSINE {
        return None;
    }
    let off = point - place.point;
    let (squared, pixels) = (off.length_squared(), (at.0 - place.at.0).powi(2) + (at.1 - place.at.1).powi(2));
    let reach = place.reach;
    if squared >= reach * reach && pixels >= LEAST_REACH_PIXELS * LEAST_REACH_PIXELS {
        return None;
    }
    let distance = squared.sqrt();
    let share = (distance / reach).min(pixels.sqrt() / LEAST_REACH_PIXELS);
    if off.dot(place.normal + normal).abs() > 2.0 * FLAT_SHARE * distance {
        return None;
    }
    Some((1.0 - share).powi(2))
}

/// The inverse of a symmetric matrix; none where it has hardly one.
fn inverse(m: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let minor = |i: usize, j: usize| {
        let [a, b] = [(i + 1) % 3, (i + 2) % 3];
        let [c, d] = [(j + 1) % 3, (j + 2) % 3];
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    let scale = m[0][0] * m[1][1] * m[2][2];
    (determinant > SINGULAR * scale)
        .then(|| std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Camera;
    use crate::field::tests::{grid, names};
    use fredholm_mesh::{Mesh, MeshBuilder};

    fn square() -> Mesh {
        let mut builder = MeshBuilder::default();
        builder.surface("square", 0);
        grid(&mut builder, &[0.0, 1.0], &[0.0, 1.0]);
        builder.build()
    }

    /// Looks down on the unit square, which fills columns and rows 30 to 50 of 80.
    fn above() -> Camera {
        Camera {
            eye: Vec3::new(0.5, 0.5, 2.0),
            target: Vec3::new(0.5, 0.5, 0.0),
            up: Vec3::Y,
            vertical_fov_degrees: 90.0,
            width: 80,
            height: 80,
        }
    }

    #[test]
    fn places_of_a_plane_tell_it_between_them_and_beyond() {
        let (mesh, bands) = (square(), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[1.0], &[1.0]).unwrap();
        let eye = Eye::new(&mesh, &above()).unwrap();
        let mut gathered = Gathered {
            field,
            eye: &eye,
            reach: 0.35,
            places: Vec::new(),
            bins: vec![0; 101],
            sides: [10, 10],
        };
        let colour = |p: Vec3| [2.0 + p.x, 3.0 - p.y, 1.0 + 0.5 * p.x + 0.25 * p.y];
        let place = |k: usize| {
            let point = Vec3::new(0.2 + 0.15 * (k % 4) as f64, 0.25 + 0.2 * (k / 4) as f64, 0.0);
            let (at, colour) = (eye.place(point).unwrap(), colour(point));
            Place { point, normal: Vec3::Z, surface: 0, at, reach: 1.0, colour, variance: [0.0; 3] }
        };
        let told = |gathered: &Gathered, x: f64, y: f64| gathered.told(0, Vec3::new(x, y, 0.0));
        assert!(told(&gathered, 0.5, 0.5).is_none());
        gathered.insert((0..12).map(place));
        for (x, y) in [(0.3, 0.3), (0.5, 0.5), (0.62, 0.4), (0.7, 0.7)] {
            let told = told(&gathered, x, y).unwrap();
            let exact = colour(Vec3::new(x, y, 0.0));
            assert!((0..3).all(|i| (told.colour[i] - exact[i]).abs() < 1e-12 && told.error[i] < 1e-12));
            assert!(told.places == 12 && told.spread < MOST_SPREAD);
        }
        // Another surface, a wall on this one, and what is out of reach.
        let [mut other, mut wall, mut far] = [place(0); 3];
        (other.surface, wall.normal, far.reach) = (1, Vec3::X, 1e-3);
        let at = (40.0, 40.0);
        let point = Vec3::new(0.5, 0.5, 0.0);
        assert!([other, wall, far].iter().all(|place| weight(place, (point, Vec3::Z, 0), at).is_none()));
        assert!(weight(&place(0), (point, Vec3::Z, 0), at).is_some());
    }

    #[test]
    fn an_inverse_is_one() {
        let m = [[4.0, 1.0, 0.5], [1.0, 3.0, -0.25], [0.5, -0.25, 2.0]];
        let found = inverse(m).unwrap();
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let product: f64 = (0..3).map(|k| m[i][k] * found[k][j]).sum();
            assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14);
        }
        assert!(inverse([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).is_none());
    }
}
