//! How much of what an element sends meets no lit side: it leaves the scene, or ends on the back of
//! a surface.
//!
//! The sum of the form factors of an element over all others is 1 less that share, which rays tell
//! without any form factor: so they tell how far the row sums of the links can be right. Of each
//! element they are those of [`rays`](fredholm_coupling::rays), one a point, their numbers moved by
//! the golden ratio from element to element. Points from which all rays meet backs are buried:
//! nothing is sent from there.

use fredholm_coupling::rays::{Bundle, Meets, cosine_ray, meets, recurrence};
use fredholm_mesh::Patch;
use fredholm_visibility::Occluders;
use rayon::prelude::*;
use std::ops::Range;

/// Rays of the whole scene, about: at first, and where something is lost and much reflection
/// amplifies what they do not know.
const RAYS: [usize; 2] = [1 << 16, 1 << 20];
/// Reflectance from which on that is so.
const BRIGHT_REFLECTANCE: f64 = 0.85;
/// Rays of an element at first, at least.
const FIRST_RAYS: usize = 36;
/// Rays of an element that tell its row sum where the scene loses something, at least; and of any,
/// at most.
const RAYS_OF_A_ROW: [usize; 2] = [128, 16384];
/// Share of all rays that may meet nothing lit where a scene still counts as closed: seams of
/// rounded coordinates let some through.
const MOST_SEAM_SHARE: f64 = 1e-3;
/// Golden ratio less one.
const GOLDEN_SECTION: f64 = 0.618_033_988_749_894_9;

/// Rays of one element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Rays {
    all: u32,
    /// Those from buried points.
    buried: u32,
    /// Those that met a lit side.
    met: u32,
}

impl Rays {
    fn lost(self) -> u32 {
        self.all - self.buried - self.met
    }
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
        let each = |rays: usize, least: usize| (rays / patches.len().max(1)).clamp(least, RAYS_OF_A_ROW[1]);
        let first = each(RAYS[0], FIRST_RAYS);
        let mut rays = vec![Rays::default(); patches.len()];
        let send_all = |rays: &mut Vec<Rays>, numbers: Range<usize>| {
            rays.par_iter_mut().enumerate().for_each(|(k, of)| send(k, of, numbers.clone(), patches, lit));
        };
        send_all(&mut rays, 0..first);
        // What loses all it sends looks at the outside, as the backs of walls do, or lies on
        // another surface: it is no part of what may be closed.
        let inside = || rays.iter().filter(|rays| rays.met > 0);
        let sum = |of: fn(&Rays) -> u32| inside().map(|rays| u64::from(of(rays))).sum::<u64>() as f64;
        let closed = sum(|rays| rays.lost()) <= MOST_SEAM_SHARE * sum(|rays| rays.all - rays.buried);
        if !closed {
            let rows = each(RAYS[usize::from(reflectance >= BRIGHT_REFLECTANCE)], RAYS_OF_A_ROW[0]);
            send_all(&mut rays, first..rows);
        }
        Self { rays, closed }
    }

    /// Whether the scene loses nothing.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Whether all that an element sends is known to arrive: in a scene that loses nothing, and by
    /// its own rays.
    pub fn loses_nothing(&self, element: usize) -> bool {
        self.closed && self.rays[element].lost() == 0
    }

    /// The share of the points of an element that are not buried.
    pub fn exposed(&self, element: usize) -> f64 {
        let Rays { all, buried, .. } = self.rays[element];
        f64::from(all - buried) / f64::from(all)
    }

    /// What the row sums over an element come to, over its area, and the standard error of that;
    /// none in a closed scene.
    pub fn row(&self, element: usize) -> Option<[f64; 2]> {
        let Rays { all, met, .. } = self.rays[element];
        (!self.closed).then(|| share(met, all))
    }

    /// The share of what an element sends that is lost, and the standard error of that.
    pub fn lost(&self, element: usize) -> [f64; 2] {
        let rays = self.rays[element];
        let sent = rays.all - rays.buried;
        if sent == 0 || self.loses_nothing(element) { [0.0; 2] } else { share(rays.lost(), sent) }
    }
}

/// The share that some rays are of all, and its standard error as if there were one ray more of
/// either kind: a few that agree do not make sure.
fn share(some: u32, all: u32) -> [f64; 2] {
    let (some, all) = (f64::from(some), f64::from(all));
    let likely = (some + 1.0) / (all + 2.0);
    [some / all, (likely * (1.0 - likely) / all).sqrt()]
}

/// Sends the rays of some numbers from an element.
fn send(element: usize, rays: &mut Rays, numbers: Range<usize>, patches: &[&Patch], lit: &Occluders) {
    let patch = patches[element];
    let start = [1.0, 2.0, 3.0, 4.0].map(|times| (element as f64 * GOLDEN_SECTION * times).fract());
    for number in numbers {
        let (from, along) = cosine_ray(patch, recurrence(number + 1, start));
        let met = meets(from, along, patches, lit);
        rays.all += 1;
        rays.met += u32::from(met == Meets::Lit);
        rays.buried += u32::from(met == Meets::Back && Bundle::of(patch).buried(from, patches, lit));
    }
}
