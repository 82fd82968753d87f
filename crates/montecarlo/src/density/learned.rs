//! Lamps in proportion to what looks at them have found.
//!
//! A bound on what a lamp brings knows nothing of what stands between. Looks do: each of them is an
//! estimate y = M κ V/p_L of what all lamps bring to its receiver, less where a ray may find the
//! lamp too. Of all ways to choose between the parts of a cut, the one with probabilities in
//! proportion to P √⟨y²⟩ has the least variance, where P are those by which looks were chosen and
//! the mean is over looks at a part; where rays count too, it is near that. Receivers near each
//! other that face the same way have much in common: so the mean is that of x = y/Σ bound over a
//! small group of them, and over a large one where few looks are known (after P. Vévoda, I.
//! Kondapaneni, J. Křivánek, *Bayesian online regression for adaptive direct illumination
//! sampling*, ACM Trans. Graph. 37(4), 2018, doi:10.1145/3197517.3201340). A share of [`BY_BOUND`]
//! stays with the bounds, since no lamp that may light a receiver may be left out.

use super::lamp_tree::set_ends;
use super::{Cuts, LampTree, Receiver};

/// Share of the probability that stays with the bounds.
const BY_BOUND: f32 = 0.35;
/// Looks of a large group and of a small one, at most.
const LOOKS_OF_A_LARGE_GROUP: usize = 4096;
const LOOKS_OF_A_SMALL_GROUP: usize = 64;
/// Looks of the large group that count beside those of the small one at the same part, and of the
/// whole group beside those at one part.
const PRIOR_LOOKS: f32 = 2.0;

/// A look at a lamp.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// From which receiver.
    pub(crate) receiver: u32,
    /// At which lamp, by its place in the order of the tree.
    pub(crate) place: u32,
    /// The estimate of what all lamps bring, over the sum of the receiver's bounds.
    pub(crate) found: f32,
}

/// Receivers near each other that face the same way.
struct Groups {
    /// The small group of every receiver, and the large group of every small one.
    small_of: Vec<u32>,
    large_of: Vec<u32>,
}

/// What the looks of groups have found.
struct Found {
    /// Where the lamps of every group begin, and where those of the last end.
    starts: Vec<usize>,
    /// Lamps that were looked at, in the order of the tree.
    seen: Vec<Seen>,
}

/// Looks at a lamp.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    place: u32,
    looks: f32,
    /// Σ x².
    squares: f32,
}

impl Found {
    /// From looks, in the order of the tree, that belong to these groups.
    fn new(looks: &[Seen], group_of: &[u32], groups: usize) -> Self {
        let mut found = Self { starts: vec![0], seen: Vec::new() };
        let (starts, order) = sorted(group_of, groups);
        let place = |look: u32| looks[look as usize].place;
        for range in starts.windows(2) {
            let own = order[range[0]..range[1]].chunk_by(|&a, &b| place(a) == place(b));
            found.seen.extend(own.map(|same| Seen {
                place: place(same[0]),
                looks: same.len() as f32,
                squares: same.iter().map(|&look| looks[look as usize].squares).sum(),
            }));
            found.starts.push(found.seen.len());
        }
        found
    }

    fn of(&self, group: u32) -> &[Seen] {
        &self.seen[self.starts[group as usize]..self.starts[group as usize + 1]]
    }
}

/// The numbers of things in the order of their kinds, in that which they have within each, and where
/// those of each kind begin and those of the last end.
fn sorted(kinds: &[u32], count: usize) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; count + 1];
    for &kind in kinds {
        starts[kind as usize + 1] += 1;
    }
    for kind in 0..count {
        starts[kind + 1] += starts[kind];
    }
    let (mut next, mut order) = (starts.clone(), vec![0; kinds.len()]);
    for (thing, &kind) in (0..).zip(kinds) {
        order[next[kind as usize]] = thing;
        next[kind as usize] += 1;
    }
    (starts, order)
}

/// The mean of x² over looks at these places, and [`PRIOR_LOOKS`] that have found `prior`.
fn mean(seen: &[Seen], (begin, end): (u32, u32), prior: f32) -> f32 {
    let first = seen.partition_point(|seen| seen.place < begin);
    let own = seen[first..].iter().take_while(|seen| seen.place < end);
    let (looks, squares) = own.fold((0.0, 0.0), |(n, sum), seen| (n + seen.looks, sum + seen.squares));
    (squares + PRIOR_LOOKS * prior) / (looks + PRIOR_LOOKS)
}

impl Cuts {
    /// Chooses lamps by what looks have found, which these cuts have chosen.
    pub(crate) fn learn(&mut self, tree: &LampTree, receivers: &[Receiver], looks: &[Look]) {
        let groups = Groups::new(receivers, looks);
        let [small, large] = groups.found(tree, looks);
        let (members, order) = sorted(&groups.small_of, groups.large_of.len());
        // What is known of a node, for the group that was the last to ask.
        let mut known = vec![(u32::MAX, 0.0); tree.len()];
        for (group, range) in (0..).zip(members.windows(2)) {
            let (near, far) = (small.of(group), large.of(groups.large_of[group as usize]));
            let whole = mean(far, (0, u32::MAX), 0.0);
            // A group to which no look found any light may yet have some.
            for &receiver in order[range[0]..range[1]].iter().filter(|_| whole > 0.0) {
                self.reweigh(receiver as usize, |part| {
                    let (by, root) = &mut known[part as usize];
                    if *by != group {
                        let places = tree.places(part);
                        (*by, *root) = (group, mean(near, places, mean(far, places, whole)).sqrt());
                    }
                    *root
                });
            }
        }
    }

    /// Multiplies the probabilities of the parts of a receiver by what is known of their nodes.
    fn reweigh(&mut self, receiver: usize, mut factor: impl FnMut(u32) -> f32) {
        let (parts, ends) = self.of_mut(receiver);
        let (mut before, mut after) = (0.0, 0.0);
        for (part, end) in parts.iter().zip(&mut *ends) {
            *end = part.share * factor(part.node);
            before += part.share;
            after += *end;
        }
        for (part, weight) in parts.iter_mut().zip(&*ends).filter(|_| after.is_normal()) {
            part.share = BY_BOUND * part.share / before + (1.0 - BY_BOUND) * weight / after;
        }
        set_ends(parts, ends);
    }
}

impl Groups {
    /// Those whose normals have the same largest component, halved where their centres lie farthest
    /// apart until few looks are left to each.
    fn new(receivers: &[Receiver], looks: &[Look]) -> Self {
        let mut count = vec![0_usize; receivers.len()];
        for look in looks {
            count[look.receiver as usize] += 1;
        }
        let side = |receiver: usize| {
            let normal = receivers[receiver].normal().to_array();
            let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
            2 * axis + usize::from(normal[axis] < 0.0)
        };
        let mut sides = vec![Vec::new(); 6];
        (0..receivers.len()).for_each(|receiver| sides[side(receiver)].push(receiver));
        let mut groups = Self { small_of: vec![0; receivers.len()], large_of: Vec::new() };
        let mut large_groups = 0;
        // Of each, whether it belongs to a large group already.
        let mut left: Vec<(&mut [usize], bool)> =
            sides.iter_mut().map(|members| (members.as_mut_slice(), false)).collect();
        while let Some((members, mut is_within)) = left.pop() {
            let sum: usize = members.iter().map(|&receiver| count[receiver]).sum();
            let fits = |size: usize| sum <= size || members.len() < 2;
            if !is_within && fits(LOOKS_OF_A_LARGE_GROUP) {
                large_groups += 1;
                is_within = true;
            }
            if fits(LOOKS_OF_A_SMALL_GROUP) {
                let small = groups.large_of.len() as u32;
                for &receiver in &*members {
                    groups.small_of[receiver] = small;
                }
                groups.large_of.push(large_groups - 1);
                continue;
            }
            let place = |&receiver: &usize, axis: usize| receivers[receiver].centre()[axis];
            let width = |axis: usize| {
                let places = || members.iter().map(|receiver| place(receiver, axis));
                places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
            };
            let axis = (0..3).max_by(|&a, &b| width(a).total_cmp(&width(b))).unwrap_or(0);
            let half = members.len() / 2;
            let by_place = |a: &usize, b: &usize| place(a, axis).total_cmp(&place(b, axis)).then(a.cmp(b));
            members.select_nth_unstable_by(half, by_place);
            let (first, second) = members.split_at_mut(half);
            left.extend([(first, is_within), (second, is_within)]);
        }
        groups
    }

    /// What looks have found from the small groups, and from the large ones.
    fn found(&self, tree: &LampTree, looks: &[Look]) -> [Found; 2] {
        // In the order of the tree, and where two are at one lamp, in that in which they were made.
        let places: Vec<u32> = looks.iter().map(|look| look.place).collect();
        let (_, order) = sorted(&places, tree.lamps());
        let look = |&look: &u32| {
            let Look { place, found, .. } = looks[look as usize];
            Seen { place, looks: 1.0, squares: found * found }
        };
        let seen: Vec<Seen> = order.iter().map(look).collect();
        let small_of = |&look: &u32| self.small_of[looks[look as usize].receiver as usize];
        let small_of: Vec<u32> = order.iter().map(small_of).collect();
        let large_of: Vec<u32> = small_of.iter().map(|&small| self.large_of[small as usize]).collect();
        let large_groups = self.large_of.last().map_or(0, |&last| last as usize + 1);
        [(&small_of, self.large_of.len()), (&large_of, large_groups)]
            .map(|(group_of, groups)| Found::new(&seen, group_of, groups))
    }
}
