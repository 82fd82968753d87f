//! How much of what an element sends meets no lit side: it leaves the scene, or ends on the back of a surface.
//!
//! The sum of the form factors of an element over all others is 1 less that share, which rays tell without any form factor: so they tell how far the row sums of the links can be right. Rays start
//! at points of the element and go in directions of cosine density, both from the low-discrepancy sequence R_d of M. Roberts 2018 (powers of the root of x^{d+1} = x + 1), moved by the golden ratio from element to element. Points from which all rays meet backs
//! are buried and do not count.

use fredholm_coupling::polygon::folded;
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;
use rayon::prelude::*;

/// Rays of the whole scene, about: by default, and where much reflection amplifies what they do not know.
const RAYS: [usize; 2] = [1 << 16, 1 << 20];
/// Reflectance from which on that is so.
const BRIGHT: f64 = 0.85;
/// Rays from one point.
const DIRECTIONS: usize = 8;
/// Points of an element, at least and at most.
const POINTS: [usize; 2] = [1, 128];
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
}

impl Opening {
    /// Sends the rays; `lit` holds the elements in order, `reflectance` is the largest one.
    pub fn new(patches: &[&Patch], lit: &Occluders, reflectance: f64) -> Self {
        let first = Self::sent(patches, lit, RAYS[0]);
        if first.closed || reflectance < BRIGHT { first } else { Self::sent(patches, lit, RAYS[1]) }
    }

    fn sent(patches: &[&Patch], lit: &Occluders, rays: usize) -> Self {
        let points = (rays / DIRECTIONS / patches.len().max(1)).clamp(POINTS[0], POINTS[1]);
        let rays: Vec<Rays> =
            (0..patches.len()).into_par_iter().map(|k| send(k, points, patches, lit)).collect();
        // What loses all it sends looks at the outside, as the backs of walls do, or lies on another surface: it is no part of what may be closed.
        let inside = || rays.iter().filter(|rays| rays.lost < rays.all);
        let sum = |of: fn(&Rays) -> u32| inside().map(|rays| u64::from(of(rays))).sum::<u64>() as f64;
        let closed = sum(|rays| rays.lost) <= SEAMS * sum(|rays| rays.all);
        Self { rays, closed }
    }

    /// Whether all that an element sends is known to arrive: in a scene that loses nothing, and by its own rays.
    pub fn loses_nothing(&self, element: usize) -> bool {
        self.closed && self.rays[element].lost == 0
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

fn send(element: usize, points: usize, patches: &[&Patch], lit: &Occluders) -> Rays {
    let patch = patches[element];
    let n = patch.normal();
    let across = n.any_orthonormal_vector();
    let other = n.cross(across);
    let place = |number: usize, k: usize| {
        ((number + 1) as f64 * R4[k] + (element as f64 * GOLDEN * (k + 1) as f64)).fract()
    };
    let mut rays = Rays::default();
    for point in 0..points {
        let (u, v) = folded(patch, place(point, 0), place(point, 1));
        let from = patch.point(u, v);
        let (mut lost, mut backs) = (0, 0);
        for direction in 0..DIRECTIONS {
            let number = point * DIRECTIONS + direction;
            let (sine, angle) = (place(number, 2).sqrt(), std::f64::consts::TAU * place(number, 3));
            let flat = across * (sine * angle.cos()) + other * (sine * angle.sin());
            let along = flat + n * (1.0 - sine * sine).max(0.0).sqrt();
            match lit.closest(from, along, f64::INFINITY) {
                Some(hit) if patches[hit.patch].normal().dot(along) < 0.0 => {}
                Some(_) => (lost, backs) = (lost + 1, backs + 1),
                None => lost += 1,
            }
        }
        if backs < DIRECTIONS as u32 {
            rays.all += DIRECTIONS as u32;
            rays.lost += lost;
        }
    }
    rays
}
