//! How much of what an element sends meets no lit side: it leaves the scene, or ends on the back of a surface.
//!
//! The sum of the form factors of an element over all others is 1 less that share, which rays tell without any form factor: so they tell how far the row sums of the links can be right. Rays start
//! at points of the element and go in directions of cosine density, both from the low-discrepancy sequence R_d of M. Roberts 2018 (powers of the root of x^{d+1} = x + 1), moved by the golden ratio from element to element. Points from which all rays meet backs
//! are buried and do not count.

use fredholm_coupling::polygon::folded;
use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Rays of the whole scene, about: by default, and where much reflection amplifies what they do not know.
const RAYS: [usize; 2] = [1 << 16, 1 << 20];
/// Reflectance from which on that is so.
const BRIGHT: f64 = 0.85;
/// Rays of an element, one a point, that tell its row sum where the scene loses something: at least, and at most where
/// there are few elements and much reflection.
const SINGLE: [usize; 2] = [128, 16384];
/// Rays from one point.
const DIRECTIONS: usize = 8;
/// Points of an element, at least and at most.
const POINTS: [usize; 2] = [1, 4096];
/// Share of all rays that may meet nothing lit where a scene still counts as closed: seams of rounded coordinates let some through.
const SEAMS: f64 = 1e-3;
/// Powers of the inverse root of x⁵ = x + 1.
const R4: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_808_6, 0.538_597_257_223_61];
/// Golden ratio less one.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Rays of one element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rays {
    /// Those from points that are not buried.
    pub all: u32,
    /// Those of them that met no lit side.
    pub lost: u32,
}

/// What rays tell of the input elements.
#[derive(Clone, Debug)]
pub(crate) struct Opening {
    rays: Vec<Rays>,
    closed: bool,
    /// Rays from as many points of each element, buried ones included.
    single: usize,
    /// Those of them that met a lit side; empty where the scene is closed.
    met: Vec<u32>,
}

impl Opening {
    /// Sends the rays; `lit` holds the elements in order, `reflectance` is the largest one.
    pub fn new(patches: &[&Patch], lit: &Occluders, reflectance: f64) -> Self {
        let first = Self::sent(patches, lit, RAYS[0]);
        if first.closed {
            return first;
        }
        let bright = reflectance >= BRIGHT;
        let all = if bright { Self::sent(patches, lit, RAYS[1]) } else { first };
        let single =
            if bright { (RAYS[1] / patches.len().max(1)).clamp(SINGLE[0], SINGLE[1]) } else { SINGLE[0] };
        let met = (0..patches.len()).into_par_iter().map(|k| met(k, single, patches, lit)).collect();
        Self { single, met, ..all }
    }

    fn sent(patches: &[&Patch], lit: &Occluders, rays: usize) -> Self {
        let points = (rays / DIRECTIONS / patches.len().max(1)).clamp(POINTS[0], POINTS[1]);
        let rays: Vec<Rays> =
            (0..patches.len()).into_par_iter().map(|k| send(k, points, patches, lit)).collect();
        // What loses all it sends looks at the outside, as the backs of walls do, or lies on another surface: it is no part of what may be closed.
        let inside = || rays.iter().filter(|rays| rays.lost < rays.all);
        let sum = |of: fn(&Rays) -> u32| inside().map(|rays| u64::from(of(rays))).sum::<u64>() as f64;
        let closed = sum(|rays| rays.lost) <= SEAMS * sum(|rays| rays.all);
        Self { rays, closed, single: 0, met: Vec::new() }
    }

    /// Whether the scene loses nothing.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Whether all that an element sends is known to arrive: in a scene that loses nothing, and by its own rays.
    pub fn loses_nothing(&self, element: usize) -> bool {
        self.closed && self.rays[element].lost == 0
    }

    /// What the row sums over an element come to, over its area, and the standard error of that; none in a closed scene.
    pub fn row(&self, element: usize) -> Option<[f64; 2]> {
        let met = f64::from(*self.met.get(element)?);
        let count = self.single as f64;
        let likely = (met + 1.0) / (count + 2.0);
        Some([met / count, (likely * (1.0 - likely) / count).sqrt()])
    }

    /// The share that is lost and the variance of that estimate.
    pub fn lost(&self, element: usize) -> [f64; 2] {
        let Rays { all, lost } = self.rays[element];
        if all == 0 || self.loses_nothing(element) {
            return [0.0; 2];
        }
        let (all, lost) = (f64::from(all), f64::from(lost));
        // One ray more of either kind: a few that agree do not make sure.
        let likely = (lost + 1.0) / (all + 2.0);
        [lost / all, likely * (1.0 - likely) / all]
    }
}

/// Where the rays of an element begin and where they go.
struct Directions<'a> {
    element: usize,
    patch: &'a Patch,
    across: Vec3,
    other: Vec3,
}

impl<'a> Directions<'a> {
    fn of(element: usize, patches: &[&'a Patch]) -> Self {
        let patch = patches[element];
        let across = patch.normal().any_orthonormal_vector();
        Self { element, patch, across, other: patch.normal().cross(across) }
    }

    fn coordinate(&self, number: usize, k: usize) -> f64 {
        ((number + 1) as f64 * R4[k] + (self.element as f64 * GOLDEN * (k + 1) as f64)).fract()
    }

    fn point(&self, number: usize) -> Vec3 {
        let (u, v) = folded(self.patch, self.coordinate(number, 0), self.coordinate(number, 1));
        self.patch.point(u, v)
    }

    fn direction(&self, number: usize) -> Vec3 {
        let (sine, angle) = (self.coordinate(number, 2).sqrt(), TAU * self.coordinate(number, 3));
        let flat = self.across * (sine * angle.cos()) + self.other * (sine * angle.sin());
        flat + self.patch.normal() * (1.0 - sine * sine).max(0.0).sqrt()
    }
}

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meets {
    Lit,
    Back,
    Nothing,
}

fn meets(from: Vec3, along: Vec3, patches: &[&Patch], lit: &Occluders) -> Meets {
    match lit.closest(from, along, f64::INFINITY) {
        Some(hit) if patches[hit.patch].normal().dot(along) < 0.0 => Meets::Lit,
        Some(_) => Meets::Back,
        None => Meets::Nothing,
    }
}

fn met(element: usize, rays: usize, patches: &[&Patch], lit: &Occluders) -> u32 {
    let directions = Directions::of(element, patches);
    let lit = |&k: &usize| meets(directions.point(k), directions.direction(k), patches, lit) == Meets::Lit;
    (0..rays).filter(lit).count() as u32
}

fn send(element: usize, points: usize, patches: &[&Patch], lit: &Occluders) -> Rays {
    let directions = Directions::of(element, patches);
    let mut rays = Rays::default();
    for point in 0..points {
        let from = directions.point(point);
        let (mut lost, mut backs) = (0, 0);
        for k in 0..DIRECTIONS {
            let met = meets(from, directions.direction(point * DIRECTIONS + k), patches, lit);
            lost += u32::from(met != Meets::Lit);
            backs += u32::from(met == Meets::Back);
        }
        if backs < DIRECTIONS as u32 {
            rays.all += DIRECTIONS as u32;
            rays.lost += lost;
        }
    }
    rays
}
