//! What a bent cluster exchanges with a polygon or with another one, and how that varies over both.
//!
//! A part with the area vector a = |a| n and the area A receives (|a|/A) F from afar, F the form
//! factor of a point with its normal: the polygon as it is, or the parts of the other cluster as
//! discs. Over the cluster that is taken to be linear in space, which on a smooth surface is linear
//! in the normal too; what real members receive otherwise is the rest. Rays between members, which
//! every pair draws for itself, tell what gets through, those that the cluster itself stops
//! included. Lengths in metres, exchanges in m².

use super::draw::Places;
use super::sample::{Sample, fit, samples};
use super::side::{POINTS, Points, Side};
use super::sight::{Viewer, weigh};
use super::spread::{CLOSE_DEVIATION, disc, open_factor};
use crate::tree::Tree;
use fredholm_mesh::{Patch, Vec3};

/// Uncertainty of a share of which all rays say the same, and of any other.
const UNANIMOUS_UNCERTAINTY: f64 = 0.05;
const MIXED_UNCERTAINTY: f64 = 0.2;
/// Most rays of a pair.
const MOST_RAYS: usize = 40;

/// A side of a pair: a polygon or a bent cluster.
pub(super) enum End<'a> {
    Flat(&'a Patch, Points<'a>),
    Bent(&'a Tree, Vec<Sample>),
}

/// A place that stands for a part of a side.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Vec3,
    normal: Vec3,
    /// |a|, m².
    facing: f64,
}

impl Place {
    /// What two places exchange, m².
    fn weight(&self, other: &Self) -> f64 {
        let larger = self.facing.max(other.facing);
        disc([self.at, self.normal], [other.at, other.normal], larger) * self.facing * other.facing
    }
}

/// What two sides exchange: relative to the open exchange the share that gets through, the
/// variation over either side, and the uncertainty of the share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    pub open: f64,
    pub share: f64,
    pub sides: [Side; 2],
    pub doubt: f64,
}

impl<'a> End<'a> {
    /// A linkable node as a side.
    pub fn of(tree: &'a Tree, index: u32) -> Self {
        match tree.nodes()[index as usize].patch() {
            Some(patch) => Self::Flat(patch, Points::of(patch)),
            None => Self::Bent(tree, samples(tree, index)),
        }
    }

    fn places(&self) -> Vec<Place> {
        match self {
            Self::Flat(patch, points) => {
                let (normal, facing) = (patch.normal(), patch.area() / (POINTS - 1) as f64);
                points.at.iter().map(|&at| Place { at, normal, facing }).collect()
            }
            Self::Bent(_, samples) => {
                let place = |s: &Sample| {
                    let facing = s.vector.length();
                    Place { at: s.centre, normal: s.vector / facing, facing }
                };
                samples.iter().map(place).collect()
            }
        }
    }

    /// Where a ray starts on the part of a place.
    fn start(&self, k: usize, drawn: (f64, [f64; 2])) -> Vec3 {
        match self {
            Self::Flat(_, points) => points.within(k, drawn.1),
            Self::Bent(tree, samples) => samples[k].place(tree, drawn),
        }
    }

    /// Open form factor from a point with its normal to this side.
    fn factor(&self, [x, n]: [Vec3; 2], front: &mut Vec<Vec3>) -> f64 {
        match self {
            Self::Flat(patch, _) => open_factor(x, n, patch, front),
            Self::Bent(_, samples) => {
                let part = |s: &Sample| {
                    let facing = s.vector.length();
                    facing * disc([x, n], [s.centre, s.vector / facing], facing)
                };
                samples.iter().map(part).sum()
            }
        }
    }

    /// Open form factors from the parts of this side to another one.
    pub(super) fn open(&self, to: &Self, front: &mut Vec<Vec3>) -> Vec<f64> {
        let filled = |k: usize, place: &Place| match self {
            Self::Flat(..) => 1.0,
            Self::Bent(_, samples) => place.facing / samples[k].area,
        };
        let factor =
            |(k, place): (usize, &Place)| filled(k, place) * to.factor([place.at, place.normal], front);
        self.places().iter().enumerate().map(factor).collect()
    }

    /// Open form factors from members of a bent cluster.
    fn probes(&self, to: &Self, front: &mut Vec<Vec3>) -> Vec<f64> {
        match self {
            Self::Flat(..) => Vec::new(),
            Self::Bent(_, samples) => samples.iter().map(|s| to.factor(s.member, front)).collect(),
        }
    }

    /// What form factors from the parts, and from members with `share` of them, tell of the
    /// function.
    pub(super) fn side(&self, values: &[f64], probes: &[f64]) -> Side {
        match self {
            Self::Flat(_, points) => {
                points.side(&std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0)))
            }
            Self::Bent(_, samples) => fit(samples, values, probes),
        }
    }

    pub(super) fn area(&self) -> f64 {
        match self {
            Self::Flat(patch, _) => patch.area(),
            Self::Bent(_, samples) => samples.iter().map(|s| s.area).sum(),
        }
    }
}

/// Open form factors from the parts of a side, those from members, and what they tell of the
/// function.
struct Outlook {
    open: Vec<f64>,
    probes: Vec<f64>,
    side: Side,
}

impl Outlook {
    fn of(from: &End, to: &End, front: &mut Vec<Vec3>) -> Self {
        let (open, probes) = (from.open(to, front), from.probes(to, front));
        let side = from.side(&open, &probes);
        Self { open, probes, side }
    }

    /// The share that is left where each part sees a share of what it would, and how that varies;
    /// none where nothing is in front.
    fn seen(&self, from: &End, shares: &[f64]) -> Option<(f64, Side)> {
        let through = |values: &[f64]| values.iter().zip(shares).map(|(v, s)| v * s).collect::<Vec<_>>();
        let side = from.side(&through(&self.open), &through(&self.probes));
        let share = if self.side.mean > 0.0 { (side.mean / self.side.mean).min(1.0) } else { 0.0 };
        (self.side.mean > 0.0).then(|| (share, side.scaled(share)))
    }
}

/// The exchange of two sides that lie apart, at least one of them bent; the larger one of two near
/// ones varies by as much as itself. The open exchange is 0 where no part sees another.
pub(super) fn meet(viewer: &mut Viewer, ends: [&End; 2], near: bool) -> Meeting {
    let [a, b] = ends;
    let looks = [Outlook::of(a, b, &mut viewer.front), Outlook::of(b, a, &mut viewer.front)];
    let exact = exact(ends);
    let open = looks[exact].side.mean * ends[exact].area();
    let larger = usize::from(a.area() <= b.area());
    let least = |k: usize| if near && k == larger { CLOSE_DEVIATION } else { 0.0 };
    let whole = [0, 1].map(|k| looks[k].side.at_least(least(k)));
    let (seen, [all, clear]) = rays(viewer, ends);
    if clear == all {
        return Meeting { open, share: 1.0, sides: whole, doubt: UNANIMOUS_UNCERTAINTY };
    }
    let views = [0, 1].map(|k| looks[k].seen(ends[k], &seen[k]));
    let (share, partly, doubt) = weigh(views[0], views[1]);
    let sides = [0, 1].map(|k| partly[k].at_least_of(&whole[k], share));
    let unsure = if clear == 0 { UNANIMOUS_UNCERTAINTY } else { MIXED_UNCERTAINTY };
    Meeting { open, share, sides, doubt: doubt.max(unsure) }
}

/// Which side knows the exchange better: the parts of a bent cluster see a polygon as it is.
pub(super) fn exact(ends: [&End; 2]) -> usize {
    usize::from(matches!(ends[0], End::Flat(..)))
}

/// Shares that the places of both sides see of each other, weighted by what they exchange, and the
/// numbers of rays and of clear ones.
fn rays(viewer: &mut Viewer, [a, b]: [&End; 2]) -> ([Vec<f64>; 2], [usize; 2]) {
    let (xs, ys) = (a.places(), b.places());
    let mut sums = [vec![[0.0; 2]; xs.len()], vec![[0.0; 2]; ys.len()]];
    let mut counts = [0, 0];
    let mut drawn = Places::at(xs[0].at, ys[0].at);
    let stride = (xs.len() * ys.len()).div_ceil(MOST_RAYS);
    for (i, x) in xs.iter().enumerate() {
        for (j, y) in ys.iter().enumerate().filter(|(j, _)| (i + j) % stride == 0) {
            let weight = x.weight(y);
            if weight > 0.0 {
                let [on_a, on_b] = drawn.next();
                let seen = viewer.sees(a.start(i, on_a), b.start(j, on_b));
                counts = [counts[0] + 1, counts[1] + usize::from(seen)];
                for (side, k) in [(0, i), (1, j)] {
                    let sum = &mut sums[side][k];
                    *sum = [sum[0] + weight, sum[1] + if seen { weight } else { 0.0 }];
                }
            }
        }
    }
    let mean = counts[1] as f64 / counts[0].max(1) as f64;
    let share = |[all, seen]: &[f64; 2]| if *all > 0.0 { seen / all } else { mean };
    (sums.map(|side| side.iter().map(share).collect()), counts)
}
