//! What a bent cluster exchanges with a polygon or with another one, and how that varies over both.
//!
//! A part with the area vector a = |a| n and the area A receives (|a|/A) F from afar, F the form factor of a point with its normal: the polygon as it is, or the parts of the other cluster as discs. Over the
//! cluster that is taken to be linear in space, which on a smooth surface is linear in the normal too; what real members receive otherwise is the rest. Rays between members tell what gets through,
//! those that the cluster itself stops included. Lengths in metres, exchanges in m².

use super::side::{POINTS, Points, Side};
use super::sight::{Viewer, weigh};
use super::spread::{STEEP, disc, open_factor};
use crate::tree::{Node, Tree};
use fredholm_mesh::{Patch, Vec3};

/// Uncertainty of a share of which all rays say the same, and of any other.
const UNANIMOUS: f64 = 0.05;
const MIXED: f64 = 0.2;
/// Part of the variance of places that is added in all directions before a linear function is fitted.
const RIDGE: f64 = 1e-3;

/// Radius of a flat part, over that of the cluster, from which on its quarters stand for it.
const LARGE: f64 = 0.5;
/// Least samples of a bent cluster.
const SAMPLES: usize = 8;
/// Numbers that are fitted to the samples.
const FITTED: usize = 4;
/// Most rays of a pair.
const MOST: usize = 40;

/// A part of a bent cluster.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Centre of area.
    centre: Vec3,
    /// Σ A n, m².
    vector: Vec3,
    /// Σ A, m².
    area: f64,
    /// Place and normal of one of its elements near the centre.
    member: [Vec3; 2],
}

/// The parts of a bent node; quarters of flat ones that are few or large.
fn samples(tree: &Tree, index: u32) -> Vec<Sample> {
    let parts = tree.parts(index);
    let large = LARGE * tree.nodes()[index as usize].cone().radius;
    let mut samples = Vec::with_capacity(SAMPLES);
    for &part in &parts {
        let node = &tree.nodes()[part as usize];
        match node.patch() {
            Some(patch) if parts.len() < SAMPLES || node.cone().radius > large => {
                quarters(patch, &mut samples);
            }
            Some(patch) => samples.push(Sample::of(node, node.centre(), patch.normal())),
            None => {
                let middle = &tree.nodes()[node.middle() as usize];
                let normal = middle.area_vector().normalize_or_zero();
                samples.push(Sample::of(node, middle.centre(), normal));
            }
        }
    }
    samples
}

fn quarters(patch: &Patch, samples: &mut Vec<Sample>) {
    let area = patch.area() / (POINTS - 1) as f64;
    let quarter =
        |&x: &Vec3| Sample { centre: x, vector: patch.normal() * area, area, member: [x, patch.normal()] };
    samples.extend(Points::of(patch).at[..POINTS - 1].iter().map(quarter));
}

impl Sample {
    fn of(node: &Node, place: Vec3, normal: Vec3) -> Self {
        Self { centre: node.centre(), vector: node.area_vector(), area: node.area(), member: [place, normal] }
    }
}

/// A side of a pair: a polygon or a bent cluster.
pub(crate) enum End<'a> {
    Flat(&'a Patch, Points<'a>),
    Bent(Vec<Sample>),
}

/// A place that stands for a part of a side.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Vec3,
    normal: Vec3,
    /// Where rays start.
    on: Vec3,
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

/// What two sides exchange: relative to the open exchange the share that gets through, the variation over either side, and the uncertainty of the share.
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
            None => Self::Bent(samples(tree, index)),
        }
    }

    fn places(&self) -> Vec<Place> {
        match self {
            Self::Flat(patch, points) => {
                let (normal, facing) = (patch.normal(), patch.area() / (POINTS - 1) as f64);
                points.at.iter().map(|&at| Place { at, normal, on: at, facing }).collect()
            }
            Self::Bent(samples) => {
                let place = |s: &Sample| {
                    let facing = s.vector.length();
                    Place { at: s.centre, normal: s.vector / facing, on: s.member[0], facing }
                };
                samples.iter().map(place).collect()
            }
        }
    }

    /// Open form factor from a point with its normal to this side.
    fn factor(&self, [x, n]: [Vec3; 2], front: &mut Vec<Vec3>) -> f64 {
        match self {
            Self::Flat(patch, _) => open_factor(x, n, patch, front),
            Self::Bent(samples) => {
                let part = |s: &Sample| {
                    let facing = s.vector.length();
                    facing * disc([x, n], [s.centre, s.vector / facing], facing)
                };
                samples.iter().map(part).sum()
            }
        }
    }

    /// Open form factors from the parts of this side to another one.
    fn open(&self, to: &Self, front: &mut Vec<Vec3>) -> Vec<f64> {
        let filled = |k: usize, place: &Place| match self {
            Self::Flat(..) => 1.0,
            Self::Bent(samples) => place.facing / samples[k].area,
        };
        let factor =
            |(k, place): (usize, &Place)| filled(k, place) * to.factor([place.at, place.normal], front);
        self.places().iter().enumerate().map(factor).collect()
    }

    /// Open form factors from members of a bent cluster.
    fn probes(&self, to: &Self, front: &mut Vec<Vec3>) -> Vec<f64> {
        match self {
            Self::Flat(..) => Vec::new(),
            Self::Bent(samples) => samples.iter().map(|s| to.factor(s.member, front)).collect(),
        }
    }

    /// What form factors from the parts, and from members with `share` of them, tell of the function.
    fn side(&self, values: &[f64], probes: &[f64]) -> Side {
        match self {
            Self::Flat(_, points) => {
                points.side(&std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0)))
            }
            Self::Bent(samples) => fit(samples, values, probes),
        }
    }

    fn area(&self) -> f64 {
        match self {
            Self::Flat(patch, _) => patch.area(),
            Self::Bent(samples) => samples.iter().map(|s| s.area).sum(),
        }
    }
}

/// The linear function in space through the values of parts, and what is left of it at members.
fn fit(samples: &[Sample], values: &[f64], probes: &[f64]) -> Side {
    let area: f64 = samples.iter().map(|s| s.area).sum();
    let over =
        |f: &dyn Fn(usize) -> f64| (0..samples.len()).map(|k| samples[k].area * f(k)).sum::<f64>() / area;
    let mean = over(&|k| values[k]);
    if mean <= 0.0 {
        return Side::default();
    }
    let centre = samples.iter().map(|s| s.centre * s.area).sum::<Vec3>() / area;
    let offsets: Vec<Vec3> = samples.iter().map(|s| s.centre - centre).collect();
    let gradient = limited(slope(samples, &offsets, |k| values[k] / mean - 1.0), &offsets);
    let linear = |x: Vec3| 1.0 + gradient.dot(x - centre);
    let parts = over(&|k| (values[k] / mean - linear(samples[k].centre)).powi(2));
    let members = over(&|k| (probes[k] / mean - linear(samples[k].member[0])).powi(2));
    let freedom = samples.len() as f64 / (samples.len() - FITTED) as f64;
    let rest = (parts * freedom).max(members).sqrt();
    let explained = over(&|k| gradient.dot(offsets[k]).powi(2));
    Side { mean, gradient, deviation: rest.hypot(explained.sqrt()), rest }
}

/// The gradient that fits values best; directions in which the parts hardly extend count little.
fn slope(samples: &[Sample], offsets: &[Vec3], value: impl Fn(usize) -> f64) -> Vec3 {
    let (mut square, mut moment) = (glam::DMat3::ZERO, Vec3::ZERO);
    for (k, &x) in offsets.iter().enumerate() {
        let weighted = x * samples[k].area;
        square += glam::DMat3::from_cols(weighted * x.x, weighted * x.y, weighted * x.z);
        moment += weighted * value(k);
    }
    let trace = square.x_axis.x + square.y_axis.y + square.z_axis.z;
    let ridged = square + glam::DMat3::from_diagonal(Vec3::splat(RIDGE * trace));
    if trace > 0.0 { ridged.inverse() * moment } else { Vec3::ZERO }
}

/// How far members lie beyond the centres of the parts.
const BEYOND: f64 = 1.6;

/// The gradient, shortened where the linear function would be negative.
fn limited(gradient: Vec3, offsets: &[Vec3]) -> Vec3 {
    let least = offsets.iter().map(|x| BEYOND * gradient.dot(*x)).fold(0.0, f64::min);
    if least < -1.0 { gradient / -least } else { gradient }
}

/// Open form factors from the parts of a side, those from members, and what they tell of the function.
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

    /// The share that is left where each part sees a share of what it would, and how that varies; none where nothing is in front.
    fn seen(&self, from: &End, shares: &[f64]) -> Option<(f64, Side)> {
        let through = |values: &[f64]| values.iter().zip(shares).map(|(v, s)| v * s).collect::<Vec<_>>();
        let side = from.side(&through(&self.open), &through(&self.probes));
        let share = if self.side.mean > 0.0 { (side.mean / self.side.mean).min(1.0) } else { 0.0 };
        (self.side.mean > 0.0).then(|| (share, side.scaled(share)))
    }
}

/// The exchange of two sides that lie apart, at least one of them bent; the larger one of two near ones varies by as much as itself. The open exchange is 0 where no part sees another.
pub(crate) fn meet(viewer: &mut Viewer, ends: [&End; 2], near: bool) -> Meeting {
    let [a, b] = ends;
    let looks = [Outlook::of(a, b, &mut viewer.front), Outlook::of(b, a, &mut viewer.front)];
    let exact = exact(ends);
    let open = looks[exact].side.mean * ends[exact].area();
    let larger = usize::from(a.area() <= b.area());
    let least = |k: usize| if near && k == larger { STEEP } else { 0.0 };
    let whole = [0, 1].map(|k| looks[k].side.at_least(least(k)));
    let (seen, [all, clear]) = rays(viewer, ends);
    if clear == all {
        return Meeting { open, share: 1.0, sides: whole, doubt: UNANIMOUS };
    }
    let views = [0, 1].map(|k| looks[k].seen(ends[k], &seen[k]));
    let (share, partly, doubt) = weigh(views[0], views[1]);
    let sides = [0, 1].map(|k| partly[k].at_least_of(&whole[k], share));
    let unsure = if clear == 0 { UNANIMOUS } else { MIXED };
    Meeting { open, share, sides, doubt: doubt.max(unsure) }
}

/// Which side knows the exchange better: the parts of a bent cluster see a polygon as it is.
fn exact(ends: [&End; 2]) -> usize {
    usize::from(matches!(ends[0], End::Flat(..)))
}

/// Shares that the places of both sides see of each other, weighted by what they exchange, and the numbers of rays and of clear ones.
fn rays(viewer: &mut Viewer, [a, b]: [&End; 2]) -> ([Vec<f64>; 2], [usize; 2]) {
    let (xs, ys) = (a.places(), b.places());
    let mut sums = [vec![[0.0; 2]; xs.len()], vec![[0.0; 2]; ys.len()]];
    let mut counts = [0, 0];
    let stride = (xs.len() * ys.len()).div_ceil(MOST);
    for (i, x) in xs.iter().enumerate() {
        for (j, y) in ys.iter().enumerate().filter(|(j, _)| (i + j) % stride == 0) {
            let weight = x.weight(y);
            if weight > 0.0 {
                let seen = viewer.sees(x.on, y.on);
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

/// The exchange of two sides that touch or are one, which no sampling resolves: at most `bound`, (A + A' − |a + a'|)/2. For every direction, what leaves one member along it and meets another is at most the smaller
/// one of the projected areas that face forward and backward; their difference is a·ω, their sum Σ A |n·ω|, and the integral of the smaller over all directions is that bound.
/// A link of a node with itself counts twice.
pub(crate) fn touch(viewer: &mut Viewer, ends: [&End; 2], bound: f64, same: bool) -> Meeting {
    let exact = exact(ends);
    let open = ends[exact].open(ends[1 - exact], &mut viewer.front);
    let half = if same { 0.5 } else { 1.0 };
    let guess = half * ends[exact].side(&open, &open).mean * ends[exact].area();
    let side = Side::default().at_least(STEEP);
    let share = if bound > 0.0 { (guess / bound).min(1.0) } else { 0.0 };
    Meeting { open: bound, share, sides: [side; 2], doubt: 1.0 }
}

/// Most that two nodes can exchange, or half of what one does with itself, m².
pub(crate) fn bound(a: &Node, b: &Node, same: bool) -> f64 {
    let areas = a.area() + b.area();
    let most = 0.5 * (areas - (a.area_vector() + b.area_vector()).length()).max(0.0);
    if same { 0.5 * most } else { most.min(a.area()).min(b.area()) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

    use super::*;
    use crate::transport::Sight;
    use fredholm_coupling::form_factor::contour_integral;
    use fredholm_mesh::MeshBuilder;
    use fredholm_visibility::Occluders;
    use fredholm_visibility::body::Bodies;

    /// A mesh of a hill of some height over the unit square, 0 at its border; a basin where the height is negative.
    fn hill(height: f64) -> Tree {
        let n = 12;
        let at = |i: usize, j: usize| {
            let (x, y) = (i as f64 / n as f64, j as f64 / n as f64);
            Vec3::new(x, y, 16.0 * height * x * (1.0 - x) * y * (1.0 - y))
        };
        let mut builder = MeshBuilder::default();
        builder.surface("hill", 0);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for corners in [[a, b, c], [a, c, d]] {
                builder.face(&[Patch::triangle(corners).unwrap()]).unwrap();
            }
        }
        Tree::new(&builder.build(), 1e-9).unwrap()
    }

    fn plate(z: f64) -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(x, y, z);
        Patch::quad([corner(-0.5, 0.), corner(-0.5, 1.), corner(1., 1.), corner(1., 0.)]).unwrap().unwrap()
    }

    fn with_viewer<T>(f: impl FnOnce(&mut Viewer) -> T) -> T {
        let (occluders, bodies) = (Occluders::new(&[]).unwrap(), Bodies::default());
        f(&mut Viewer::new(Sight { occluders: &occluders, bodies: &bodies, many: false }))
    }

    #[test]
    fn a_hill_receives_what_its_base_would() {
        // What the parts do not resolve of curvature times gradient falls with the distance.
        for (distance, tolerance) in [(3.0, 1.5e-2), (9.0, 5e-3)] {
            let (tree, plate, base) = (hill(0.15), plate(distance), plate_under());
            let exact = contour_integral(base.corners(), plate.corners(), 1e-10).value;
            let ends = [End::of(&tree, 0), End::Flat(&plate, Points::of(&plate))];
            for pair in [[&ends[0], &ends[1]], [&ends[1], &ends[0]]] {
                let found = with_viewer(|viewer| meet(viewer, pair, false));
                assert!((found.open / exact - 1.0).abs() < tolerance, "{} {exact}", found.open);
                assert!(found.share >= 1.0 && found.sides.iter().all(|side| side.rest < 0.1), "{found:?}");
            }
        }
    }

    /// The unit square, looking up.
    fn plate_under() -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        Patch::quad([corner(0., 0.), corner(1., 0.), corner(1., 1.), corner(0., 1.)]).unwrap().unwrap()
    }

    #[test]
    fn a_basin_sees_itself_as_its_opening_says_and_a_hill_does_not() {
        // Of a basin that sees nothing else, all that does not leave through the opening reaches the basin: A − 1.
        let basin = hill(-0.2);
        let node = &basin.nodes()[0];
        let most = bound(node, node, true);
        assert!((2.0 * most - (node.area() - 1.0)).abs() < 1e-12 && most > 0.01, "{most}");
        let own = |tree: &Tree, most: f64| {
            let ends = [End::of(tree, 0), End::of(tree, 0)];
            with_viewer(|viewer| touch(viewer, [&ends[0], &ends[1]], most, true)).share
        };
        assert!((own(&basin, most) - 1.0).abs() < 0.4, "{}", own(&basin, most));
        assert!(own(&hill(0.2), most) < 0.1, "{}", own(&hill(0.2), most));
    }

    #[test]
    fn no_two_squares_exchange_more_than_the_bound() {
        // Unit squares at right angles with a common edge: 0.20004, Howell's catalogue C-14.
        let wall = |corners: [[f64; 3]; 4]| Patch::quad(corners.map(Vec3::from)).unwrap().unwrap();
        let mut builder = MeshBuilder::default();
        builder.surface("squares", 0);
        for corners in [
            [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
            [[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]],
        ] {
            builder.face(&[wall(corners)]).unwrap();
        }
        let tree = Tree::new(&builder.build(), 1e-9).unwrap();
        let [a, b] = [0, 1].map(|root: usize| &tree.nodes()[tree.roots()[root] as usize]);
        let most = bound(a, b, false);
        assert!(most > 0.200_043 && (most - (1.0 - 0.5f64.sqrt())).abs() < 1e-12, "{most}");
    }
}
