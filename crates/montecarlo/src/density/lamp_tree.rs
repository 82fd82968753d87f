//! Lamps as one receiver sees them: a tree of lamps, and a cut through it for every receiver.
//!
//! The density of a point q of a lamp is P(q)/A, with the probability P of its lamp in proportion to
//! a bound on what the lamp can bring to the receiver,
//!
//! ```text
//! A M max cosθ max cosθ′ / max(d², r²),
//! ```
//!
//! over the balls (radii r) round both, and 0 where one is wholly behind the other. Lamps that are
//! many are taken together where they are far away: from the root on, parts that may bring much,
//! were all of them where their nearest lamp may be, are opened until none does or there are
//! [`MOST_PARTS`]; within a part, lamps are taken by power (B. Walter et al., *Lightcuts*, SIGGRAPH
//! 2005, doi:10.1145/1186822.1073318). No lamp that may light the receiver has probability 0, so
//! means stay unbiased. M is the mean exitance over the bands, W/m².

use super::SurfaceDensity;
use fredholm_mesh::{Patch, Vec3};
use rayon::prelude::*;

/// Parts of a cut at most.
const MOST_PARTS: usize = 256;
/// Distance of the nearest lamp of a part over its radius, at least.
const NEAREST: f64 = 0.25;
/// What a part may bring, over the sum of all bounds, from which on it is opened.
const LEAST_OPENED: f64 = 0.03;
/// Height of a receiver's ball over its plane, relative to its radius, that counts as none.
const LEAST_HEIGHT: f64 = 1e-9;
/// 1 − cosθ of the angle θ between normals up to which they count as one.
const SAME_NORMAL: f64 = 1e-12;
/// Distance of a lamp that is near, over the radii of both balls.
const NEAR: f64 = 1.5;

/// All lamps.
#[derive(Clone, Debug)]
pub struct LampTree {
    lamps: Vec<Lamp>,
    /// The first is the root; children follow their parent.
    nodes: Vec<Node>,
    /// Power of all lamps up to each, in the order of the tree, W.
    cumulated: Vec<f64>,
    /// Place in the order of the tree of every patch that is a lamp.
    place_of: Vec<Option<u32>>,
}

#[derive(Clone, Debug)]
struct Lamp {
    patch: usize,
    surface: SurfaceDensity,
    outline: Patch,
}

#[derive(Clone, Debug)]
struct Node {
    centre: Vec3,
    radius: f64,
    power: f64,
    /// The normal that all its lamps have, and the height over the origin, along it, of the lowest:
    /// what is not higher is lit by none.
    turned: Option<(Vec3, f64)>,
    first: usize,
    count: usize,
    /// The second child; the first one follows its parent. None for a single lamp.
    second: Option<usize>,
}

/// What lamps may light.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    patch: Patch,
    centre: Vec3,
    radius: f64,
}

impl Receiver {
    /// All of a patch.
    #[must_use]
    pub fn of(patch: &Patch) -> Self {
        let centre = patch.centroid();
        let radius = patch.corners().iter().map(|x| x.distance(centre)).fold(0.0, f64::max);
        Self { patch: *patch, centre, radius }
    }

    /// The middle of it, m.
    pub(super) fn centre(&self) -> Vec3 {
        self.centre
    }

    /// The direction in which it faces.
    pub(super) fn normal(&self) -> Vec3 {
        self.patch.normal()
    }
}

/// The parts of the tree that each of many receivers tells apart, and how likely they are.
#[derive(Clone, Debug, Default)]
pub struct Cuts {
    /// Where the parts of every receiver begin, and where those of the last end.
    starts: Vec<usize>,
    parts: Vec<Part>,
    /// Probability of each part and those before it; in a list of its own, since all of a receiver
    /// are read to find one.
    ends: Vec<f32>,
    /// Sum of the bounds of each receiver's parts, W/m² but for a factor that all have.
    totals: Vec<f64>,
    /// Receivers that are so near a lamp that what its points bring varies without bound.
    near: Vec<bool>,
}

/// A node of the tree as a receiver sees it.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// The same as `bound` were all of its lamps where the nearest may be.
    most: f64,
    /// A bound on what it brings, W/m² but for factors that all have, that takes its lamps as far away
    /// as its centre; 0 where they are behind the receiver or turned away from it.
    bound: f64,
    node: usize,
}

/// What is at hand while a cut is made.
#[derive(Default)]
struct Lists {
    parts: Vec<Seen>,
    opened: Vec<Seen>,
    /// What the parts that are to be opened may bring.
    large: Vec<f64>,
}

/// The parts for one receiver.
#[derive(Clone, Copy, Debug)]
pub struct Cut<'a> {
    parts: &'a [Part],
    ends: &'a [f32],
}

/// A part of a cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) node: u32,
    /// Probability.
    pub(super) share: f32,
}

impl Cuts {
    /// The parts for a receiver.
    #[must_use]
    pub fn of(&self, receiver: usize) -> Cut<'_> {
        let range = self.starts[receiver]..self.starts[receiver + 1];
        Cut { parts: &self.parts[range.clone()], ends: &self.ends[range] }
    }

    /// Whether a receiver is so near a lamp that what points of it bring varies without bound.
    #[must_use]
    pub fn is_near(&self, receiver: usize) -> bool {
        self.near[receiver]
    }

    /// Sum of the bounds of a receiver's parts, W/m² but for a factor that all have.
    #[must_use]
    pub fn total(&self, receiver: usize) -> f64 {
        self.totals[receiver]
    }

    /// The parts of a receiver, and the sums of their probabilities.
    pub(super) fn of_mut(&mut self, receiver: usize) -> (&mut [Part], &mut [f32]) {
        let range = self.starts[receiver]..self.starts[receiver + 1];
        (&mut self.parts[range.clone()], &mut self.ends[range])
    }
}

/// Adds up the probabilities of the parts of a receiver.
pub(super) fn set_ends(parts: &[Part], ends: &mut [f32]) {
    let mut sum = 0.0;
    for (end, part) in ends.iter_mut().zip(parts) {
        sum += part.share;
        *end = sum;
    }
}

impl LampTree {
    /// The tree of patches that emit so much each (W).
    #[must_use]
    pub fn new(patches: &[Patch], power: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..patches.len()).filter(|&patch| power[patch] > 0.0).collect();
        let mut nodes = Vec::new();
        if !order.is_empty() {
            let count = order.len();
            build(&mut order, (0, count), patches, power, &mut nodes);
        }
        let mut place_of = vec![None; patches.len()];
        for (place, &patch) in order.iter().enumerate() {
            place_of[patch] = Some(place as u32);
        }
        let lamp = |&patch: &usize| Lamp {
            patch,
            surface: SurfaceDensity::new(&patches[patch]),
            outline: patches[patch],
        };
        let mut sum = 0.0;
        let cumulated = order.iter().map(|&patch| {
            sum += power[patch];
            sum
        });
        let cumulated = cumulated.collect();
        Self { lamps: order.iter().map(lamp).collect(), nodes, cumulated, place_of }
    }

    /// The parts that may light each of some receivers.
    #[must_use]
    pub fn cuts(&self, receivers: &[Receiver]) -> Cuts {
        let found: Vec<(Vec<Part>, f64, bool)> = receivers
            .par_iter()
            .map_init(Lists::default, |lists, receiver| self.cut(receiver, lists))
            .collect();
        let mut cuts = Cuts { starts: vec![0], ..Cuts::default() };
        for (parts, total, near) in found {
            let begin = cuts.ends.len();
            cuts.ends.resize(begin + parts.len(), 0.0);
            set_ends(&parts, &mut cuts.ends[begin..]);
            cuts.parts.extend(parts);
            cuts.starts.push(cuts.parts.len());
            cuts.totals.push(total);
            cuts.near.push(near);
        }
        cuts
    }

    /// The parts for a receiver, the sum of their bounds, and whether a lamp is near; what the lists
    /// held is lost.
    fn cut(&self, receiver: &Receiver, lists: &mut Lists) -> (Vec<Part>, f64, bool) {
        let Lists { parts, opened, large } = lists;
        let part = |node: usize| Some(self.seen(node, receiver)).filter(|part| part.bound > 0.0);
        parts.clear();
        parts.extend((!self.nodes.is_empty()).then(|| part(0)).flatten());
        let mut total: f64 = parts.iter().map(|part| part.bound).sum();
        loop {
            // All that may bring much by what is known of the sum are opened at once, in place, so
            // that parts stay in the order of the tree.
            let second = |part: &Seen| self.nodes[part.node].second;
            large.clear();
            large.extend(
                parts
                    .iter()
                    .filter(|part| part.most > LEAST_OPENED * total && second(part).is_some())
                    .map(|part| part.most),
            );
            large.sort_unstable_by(|a, b| b.total_cmp(a));
            large.truncate(MOST_PARTS.saturating_sub(parts.len()));
            let (Some(&least), mut left) = (large.last(), large.len()) else { break };
            opened.clear();
            for &whole in parts.iter() {
                match second(&whole).filter(|_| whole.most >= least && left > 0) {
                    Some(second) => {
                        opened.extend([part(whole.node + 1), part(second)].into_iter().flatten());
                        left -= 1;
                    }
                    None => opened.push(whole),
                }
            }
            std::mem::swap(parts, opened);
            total = parts.iter().map(|part| part.bound).sum();
        }
        let part =
            |&Seen { node, bound, .. }: &Seen| Part { node: node as u32, share: (bound / total) as f32 };
        (parts.iter().map(part).collect(), total, self.is_near(receiver))
    }

    /// Whether any lamp that may light a receiver lies within a few radii.
    fn is_near(&self, receiver: &Receiver) -> bool {
        let mut left: Vec<usize> = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(node) = left.pop() {
            let Node { centre, radius, second, .. } = self.nodes[node];
            // A lamp of the node is no larger than it, and no farther away than its centre and more.
            let off = if second.is_some() { radius } else { 0.0 };
            let reach = off + NEAR * (radius + receiver.radius);
            if centre.distance_squared(receiver.centre) < reach * reach
                && self.seen(node, receiver).bound > 0.0
            {
                match second {
                    Some(second) => left.extend([node + 1, second]),
                    None => return true,
                }
            }
        }
        false
    }

    fn seen(&self, node: usize, receiver: &Receiver) -> Seen {
        let Node { centre, radius, power, turned, first, count, .. } = &self.nodes[node];
        let nothing = Seen { most: 0.0, bound: 0.0, node };
        let between = *centre - receiver.centre;
        let (square, reach) = (between.length_squared(), radius + receiver.radius);
        let normal = receiver.patch.normal();
        // Heights of the centre of each over the other, along its normal. Where a ball reaches below
        // the plane, corners tell whether all of it lies there.
        let (height, lamp_height) = (normal.dot(between), turned.map(|(turned, _)| -turned.dot(between)));
        if height.min(lamp_height.unwrap_or(height)) + reach <= LEAST_HEIGHT * reach {
            return nothing;
        }
        let is_above = |outline: &Patch, normal: Vec3, plane: f64| {
            outline.corners().iter().any(|&x| normal.dot(x) - plane > LEAST_HEIGHT * reach)
        };
        let is_behind = turned.zip(lamp_height).is_some_and(|((turned, lowest), height)| {
            height < reach && !is_above(&receiver.patch, turned, lowest)
        });
        let is_lamp_behind = *count == 1
            && height < reach
            && !is_above(&self.lamps[*first].outline, normal, normal.dot(receiver.centre));
        if is_behind || is_lamp_behind {
            return nothing;
        }
        let distance = square.sqrt();
        let cosine = |height: f64| ((height + reach) / distance.max(height + reach)).max(f64::MIN_POSITIVE);
        let bound = power * cosine(height) * lamp_height.map_or(1.0, cosine) / square.max(reach * reach);
        // The nearest lamp of a node that reaches about the receiver brings far more.
        let ratio = distance.max(reach) / (distance - reach).max(NEAREST * reach);
        Seen { most: bound * ratio * ratio, bound, node }
    }

    /// A point of a lamp from three numbers in [0, 1), its patch, and its density (1/m²); none where
    /// no lamp lights the receiver.
    #[must_use]
    pub fn sample(&self, cut: Cut, choice: f64, numbers: [f64; 2]) -> Option<(usize, Vec3, f64)> {
        let (last, &whole) = cut.ends.iter().enumerate().next_back()?;
        let choice = choice * f64::from(whole);
        // All ends are compared, several at once, which takes less time than the wrong turns of a
        // search.
        let chosen = choice as f32;
        let below = cut.ends.iter().map(|&end| u32::from(end <= chosen)).sum::<u32>();
        let at = (below as usize).min(last);
        let (node, share) = self.part(cut.parts[at]);
        let begin = f64::from(cut.ends[at]) - share;
        let rest = ((choice - begin) / share).clamp(0.0, 1.0);
        let before = node.first.checked_sub(1).map_or(0.0, |last| self.cumulated[last]);
        let range = &self.cumulated[node.first..node.first + node.count];
        let place = range.partition_point(|&end| end - before <= rest * node.power).min(node.count - 1);
        let lamp = &self.lamps[node.first + place];
        let density = self.density((node, share), node.first + place) / f64::from(whole);
        Some((lamp.patch, lamp.surface.sample(numbers), density))
    }

    /// The place of a lamp in the order of the tree; none of other patches.
    pub(crate) fn place(&self, patch: usize) -> Option<u32> {
        self.place_of[patch]
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Number of lamps.
    pub(super) fn lamps(&self) -> usize {
        self.lamps.len()
    }

    /// The places of the lamps of a node: the first, and the one after the last.
    pub(super) fn places(&self, node: u32) -> (u32, u32) {
        let Node { first, count, .. } = self.nodes[node as usize];
        (first as u32, (first + count) as u32)
    }

    /// The patches that may light the receiver of a cut.
    pub fn patches<'a>(&'a self, cut: Cut<'a>) -> impl Iterator<Item = usize> + 'a {
        let of_part = move |part: &'a Part| {
            let node = &self.nodes[part.node as usize];
            self.lamps[node.first..node.first + node.count].iter().map(|lamp| lamp.patch)
        };
        cut.parts.iter().flat_map(of_part)
    }

    /// The density with which a cut finds points of a patch, 1/m².
    #[must_use]
    pub fn pdf(&self, cut: Cut, patch: usize) -> f64 {
        let Some(place) = self.place_of[patch].map(|place| place as usize) else { return 0.0 };
        let holds = |part: &&Part| {
            let node = &self.nodes[part.node as usize];
            (node.first..node.first + node.count).contains(&place)
        };
        let (Some(&part), Some(&whole)) = (cut.parts.iter().find(holds), cut.ends.last()) else { return 0.0 };
        self.density(self.part(part), place) / f64::from(whole)
    }

    fn part(&self, part: Part) -> (&Node, f64) {
        (&self.nodes[part.node as usize], f64::from(part.share))
    }

    /// Density of points of the lamp at this place, as a part with this share has them, 1/m².
    fn density(&self, (node, share): (&Node, f64), place: usize) -> f64 {
        let before = place.checked_sub(1).map_or(0.0, |last| self.cumulated[last]);
        share * (self.cumulated[place] - before) / (node.power * self.lamps[place].outline.area())
    }
}

/// Builds the tree of a part of the order, halved where its centres lie farthest apart.
fn build(
    order: &mut [usize],
    (first, count): (usize, usize),
    patches: &[Patch],
    power: &[f64],
    nodes: &mut Vec<Node>,
) {
    let members = &mut order[first..first + count];
    let corners = || members.iter().flat_map(|&patch| patches[patch].corners().iter().copied());
    let (low, high) =
        corners().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let centre = 0.5 * (low + high);
    let radius = corners().map(|x| x.distance(centre)).fold(0.0, f64::max);
    let sum = members.iter().map(|&patch| power[patch]).sum();
    let own = nodes.len();
    let normal = patches[members[0]].normal();
    let alike = members.iter().all(|&patch| patches[patch].normal().dot(normal) > 1.0 - SAME_NORMAL);
    let lowest = corners().map(|x| normal.dot(x)).fold(f64::INFINITY, f64::min);
    let turned = alike.then_some((normal, lowest));
    nodes.push(Node { centre, radius, power: sum, turned, first, count, second: None });
    if count == 1 {
        return;
    }
    let axis = (high - low).to_array();
    let axis = (0..3).max_by(|&a, &b| axis[a].total_cmp(&axis[b])).unwrap_or(0);
    let place = |&patch: &usize| patches[patch].centroid()[axis];
    let half = count / 2;
    members.select_nth_unstable_by(half, |a, b| place(a).total_cmp(&place(b)).then(a.cmp(b)));
    build(order, (first, half), patches, power, nodes);
    nodes[own].second = Some(nodes.len());
    build(order, (first + half, count - half), patches, power, nodes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{Key, PointSet, Samples};

    fn square(corner: Vec3, side: f64, up: bool) -> Patch {
        let at = |i: f64, j: f64| corner + Vec3::new(side * i, side * j, 0.0);
        let corners = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let patch = Patch::quad(corners).unwrap().unwrap();
        if up { patch } else { patch.flipped() }
    }

    /// A field of lamps over a floor, some of them turned away.
    fn lamps() -> (Vec<Patch>, Vec<f64>) {
        let patch = |k: usize| {
            let place = Vec3::new((k % 20) as f64, (k / 20) as f64, 2.0 + 0.1 * (k % 3) as f64);
            square(place, 0.5, k.is_multiple_of(7))
        };
        let patches: Vec<Patch> = (0..300).map(patch).collect();
        let power =
            (0..300_u32).map(|k| if k.is_multiple_of(11) { 0.0 } else { 1.0 + f64::from(k % 5) }).collect();
        (patches, power)
    }

    #[test]
    fn densities_of_a_cut_integrate_to_one_and_leave_no_lamp_out() {
        let (patches, power) = lamps();
        let tree = LampTree::new(&patches, &power);
        let receivers = [square(Vec3::ZERO, 1.0, true), square(Vec3::new(10.0, 8.0, 1.9), 0.2, true)];
        let cuts = tree.cuts(&receivers.map(|patch| Receiver::of(&patch)));
        for receiver in 0..2 {
            let cut = cuts.of(receiver);
            assert!(cut.parts.len() <= MOST_PARTS);
            let mass = |k: usize| tree.pdf(cut, k) * patches[k].area();
            assert!(((0..300).map(mass).sum::<f64>() - 1.0).abs() < 1e-6);
            for (k, patch) in patches.iter().enumerate() {
                let lights = power[k] > 0.0 && patch.normal().z < 0.0;
                assert!(mass(k) > 0.0 || !lights, "{k}");
            }
        }
        assert!(!cuts.is_near(0) && cuts.is_near(1));
        // Nothing lights what looks away from all lamps.
        let away = tree.cuts(&[Receiver::of(&square(Vec3::new(0.0, 0.0, -30.0), 1.0, false))]);
        assert!(tree.sample(away.of(0), 0.3, [0.5; 2]).is_none());
    }

    #[test]
    fn samples_follow_the_density() {
        let (patches, power) = lamps();
        let tree = LampTree::new(&patches, &power);
        let cuts = tree.cuts(&[Receiver::of(&square(Vec3::ZERO, 1.0, true))]);
        let cut = cuts.of(0);
        let n = 40_000;
        let mut samples = Samples::new(PointSet::Independent, Key { seed: 3, batch: 0, stream: 0 }, n);
        let mut counts = vec![0.0; patches.len()];
        for s in 0..n {
            let mut draw = samples.draw(s);
            let (patch, _, density) = tree.sample(cut, draw.single(), draw.pair()).unwrap();
            assert!((density / tree.pdf(cut, patch) - 1.0).abs() < 1e-9);
            counts[patch] += 1.0;
        }
        for (k, count) in counts.iter().enumerate() {
            let expected = f64::from(n) * tree.pdf(cut, k) * patches[k].area();
            assert!((count - expected).abs() <= 5.0 * expected.sqrt() + 1.0, "{k}: {count} {expected}");
        }
    }
}
