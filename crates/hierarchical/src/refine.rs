//! Refinement: pairs of nodes that are too coarse become pairs of their children, until every pair
//! is fine enough for the oracle.
//!
//! Pairs wait on a stack, from which blocks of them are taken. Each pair of a block is judged by
//! itself, in parallel; then the nodes to be split are split in the order of the pairs, and the
//! pairs of children go on the stack. So the links do not depend on the number of threads, and few
//! pairs wait at any time. What a pair sees wholly its parts see wholly, and what sees nothing is
//! gone.
//!
//! **Memory.** Before a block is taken over, what tree, links and waiting pairs will need is
//! compared with what they may take, every waiting pair counted as a link. Where it is more,
//! nothing is refined any further: what waits is linked as it is, but for pairs that cannot be a
//! link.

use crate::operator::MOST_LINKS;
use crate::oracle::{Candidate, Light, Oracle, Verdict};
use crate::transport::{Chance, Meeting, Side, Sight, View, Viewer, apart, encounter, exchanges, spread};
use crate::tree::{Node, Tree};
use fredholm_linop::Watch;

use crate::{HierarchyError, Link};
use fredholm_mesh::Patch;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Pairs that one thread takes at a time.
const CHUNK: usize = 256;
/// Pairs that are judged before the tree grows.
const PAIRS_OF_A_BLOCK: usize = 1 << 15;

/// Input elements from which on clusters that face all ways are linked as wholes. Where there are
/// fewer, the links of their parts are few enough, and more exact.
const MANY_INPUT_ELEMENTS: usize = 4096;

/// A pair of nodes to be judged.
#[derive(Clone, Copy, Debug)]
struct Pair {
    nodes: [u32; 2],
    /// Whether nothing can be between.
    open: bool,
    /// Whether it is known to be too coarse, by its first node.
    coarse: bool,
}

/// What becomes of a pair.
enum Fate {
    Gone,
    Link(Link),
    /// The first is replaced by its children.
    Split(Pair),
}

/// Limits of a refinement.
pub(crate) struct Limits<'a> {
    /// Relative error that one link may leave.
    pub threshold: f64,
    /// Whether links have gradients.
    pub linear: bool,
    /// Elements are not made smaller than this, m².
    pub least_area: f64,
    /// Relative tolerance of exchanges.
    pub tolerance: f64,
    /// Bytes that tree and links may take.
    pub bytes: u64,
    /// Bands of the light.
    pub bands: usize,
    /// Whether to go on.
    pub watch: &'a dyn Watch,
}

/// The links that the refinement left.
pub(crate) struct Refined {
    pub links: Vec<Link>,
    /// Whether anything was too coarse.
    pub changed: bool,
    /// Whether memory ended it.
    pub limited: bool,
}

/// Bytes of a tree and its links with all that a solution of some bands does with them.
pub(crate) fn bytes(nodes: usize, links: usize, bands: usize) -> u64 {
    let node = size_of::<Node>() + NODE_WORK + BAND_WORK * bands;
    (nodes as u64 * node as u64).saturating_add((links as u64).saturating_mul(Link::BYTES))
}

/// Bytes of a node in the operator, in the preparation of exchanges and in what is known of the
/// light.
const NODE_WORK: usize = 320;
/// Bytes of a node for each band: means, moments, power and gradients of a product, and the vectors
/// of a solver.
const BAND_WORK: usize = 176;
/// Share of the memory from which on nothing is refined any further: the rest is for pairs that
/// cannot be links.
const MOST_MEMORY_TO_REFINE: f64 = 0.85;

/// Refines links, or the pair of the whole scene with itself where there are none yet.
pub(crate) fn refine(
    tree: &mut Tree,
    links: Option<Vec<Link>>,
    light: &mut Light,
    sight: Sight,
    limits: &Limits,
) -> Result<Refined, HierarchyError> {
    let (mut kept, mut fresh) = (Vec::new(), Vec::new());
    let mut waiting = match links {
        None => vec![Pair { nodes: [0, 0], open: false, coarse: true }],
        Some(links) => {
            kept = links;
            sift(tree, &mut kept, light, limits)
        }
    };
    let changed = !waiting.is_empty();
    let mut limited = false;
    while !waiting.is_empty() {
        let block = waiting.split_off(waiting.len().saturating_sub(PAIRS_OF_A_BLOCK));
        let threshold = if limited { f64::INFINITY } else { limits.threshold };
        let oracle = Oracle { tree, light, threshold, linear: limits.linear, least_area: limits.least_area };
        let fates = judge(&oracle, sight, &block, limits.watch)?;
        let [nodes, pairs] = outcome(tree, &fates);
        let links = kept.len() + fresh.len() + waiting.len() + pairs;
        let needed = bytes(nodes, links, limits.bands);
        if !limited && needed as f64 > MOST_MEMORY_TO_REFINE * limits.bytes as f64 {
            limited = true;
            // Once more, and nothing is too coarse now but what cannot be a link.
            waiting.extend(block);
            for pair in &mut waiting {
                pair.coarse = false;
            }
            continue;
        }
        if needed > limits.bytes || links > MOST_LINKS {
            return Err(HierarchyError::Memory { needed, limit: limits.bytes });
        }
        advance(tree, light, fates, &mut fresh, &mut waiting)?;
    }
    fresh.par_sort_unstable_by_key(|link: &Link| (link.a, link.b));
    exchanges(tree, &mut fresh, limits.tolerance);
    fresh.retain(|link| link.open > 0.0);
    kept.reserve_exact(fresh.len());
    kept.append(&mut fresh);
    kept.par_sort_unstable_by_key(|link| (link.a, link.b));
    Ok(Refined { links: kept, changed, limited })
}

/// Nodes of the tree, and links and pairs in the place of a block, when it has become what was
/// found.
fn outcome(tree: &Tree, fates: &[Fate]) -> [usize; 2] {
    let mut pairs = 0;
    let mut split: Vec<u32> = Vec::new();
    for fate in fates {
        match fate {
            Fate::Gone => {}
            Fate::Link(_) => pairs += 1,
            Fate::Split(pair) => {
                pairs += 4;
                split.push(pair.nodes[0]);
            }
        }
    }
    split.retain(|&node| tree.nodes()[node as usize].is_leaf());
    split.sort_unstable();
    split.dedup();
    [tree.nodes().len() + 4 * split.len(), pairs]
}

/// Takes the links that are too coarse out and returns them as pairs to be split.
fn sift(tree: &Tree, links: &mut Vec<Link>, light: &Light, limits: &Limits) -> Vec<Pair> {
    let oracle = Oracle {
        tree,
        light,
        threshold: limits.threshold,
        linear: limits.linear,
        least_area: limits.least_area,
    };
    let verdicts: Vec<Verdict> = links.par_iter().map(|link| oracle.judge(&candidate(link))).collect();
    let (mut coarse, mut verdicts) = (Vec::new(), verdicts.into_iter());
    links.retain(|link| {
        let pair = Pair { nodes: [link.a, link.b], open: !link.partly, coarse: true };
        match verdicts.next() {
            Some(Verdict::SplitA) => coarse.push(pair),
            Some(Verdict::SplitB) => coarse.push(swapped(pair)),
            _ => return true,
        }
        false
    });
    coarse
}

fn candidate(link: &Link) -> Candidate {
    Candidate {
        nodes: [link.a, link.b],
        open: link.open,
        sides: [0, 1].map(|k| [link.deviation[k], link.rest[k]].map(f64::from)),
        doubt: f64::from(link.doubt),
    }
}

fn judge(
    oracle: &Oracle,
    sight: Sight,
    block: &[Pair],
    watch: &dyn Watch,
) -> Result<Vec<Fate>, HierarchyError> {
    let judged = block.par_chunks(CHUNK).map_init(
        || Viewer::new(sight),
        |viewer, pairs| match watch.go_on() {
            ControlFlow::Continue(()) => Ok(pairs.iter().map(|pair| fate(oracle, viewer, *pair)).collect()),
            ControlFlow::Break(()) => Err(HierarchyError::Interrupted),
        },
    );
    let judged: Vec<Vec<Fate>> = judged.collect::<Result<_, _>>()?;
    Ok(judged.into_iter().flatten().collect())
}

fn fate(oracle: &Oracle, viewer: &mut Viewer, pair: Pair) -> Fate {
    if pair.coarse {
        return Fate::Split(pair);
    }
    let [a, b] = pair.nodes.map(|index| &oracle.tree.nodes()[index as usize]);
    if pair.nodes[0] == pair.nodes[1] {
        return match a.patch() {
            Some(_) => Fate::Gone,
            None if a.faces_one_way() => bent(oracle, viewer, pair),
            None => Fate::Split(pair),
        };
    }
    if a.cone().turned_away(b.cone()) {
        return Fate::Gone;
    }
    match (a.patch(), b.patch()) {
        (Some(p), Some(q)) => flat(oracle, viewer, pair, [p, q]),
        (Some(p), None) if b.cone().apart_from(p) => Fate::Gone,
        (None, Some(q)) if a.cone().apart_from(q) => Fate::Gone,
        _ if a.faces_one_way() && b.faces_one_way() => bent(oracle, viewer, pair),
        _ if oracle.tree.roots().len() > MANY_INPUT_ELEMENTS && apart(a, b) => {
            scattered(oracle, viewer, pair)
        }
        _ if b.faces_one_way() => Fate::Split(pair),
        _ if a.faces_one_way() || a.cone().radius < b.cone().radius => Fate::Split(swapped(pair)),
        _ => Fate::Split(pair),
    }
}

/// The fate of two nodes of which at least one is bent, or of a bent one with itself.
fn bent(oracle: &Oracle, viewer: &mut Viewer, pair: Pair) -> Fate {
    let Meeting { open, share, sides, doubt } = encounter(oracle.tree, pair.nodes, viewer);
    let deviations = sides.map(|side| [side.deviation, side.rest]);
    let candidate = Candidate { nodes: pair.nodes, open, sides: deviations, doubt };
    match oracle.judge(&candidate) {
        Verdict::SplitA => Fate::Split(pair),
        Verdict::SplitB => Fate::Split(swapped(pair)),
        Verdict::Keep => Fate::Link(Link { open, ..link(pair, sides, [share, doubt], oracle.linear) }),
    }
}

/// The fate of two nodes of which at least one faces all ways.
fn scattered(oracle: &Oracle, viewer: &mut Viewer, pair: Pair) -> Fate {
    let [a, b] = pair.nodes;
    let chance = Chance::of(oracle.tree, pair.nodes);
    let coarse = |verdict| match verdict {
        Verdict::SplitA => Some(Fate::Split(pair)),
        Verdict::SplitB => Some(Fate::Split(swapped(pair))),
        Verdict::Keep => None,
    };
    // Rays only where the pair is not too coarse anyway.
    let (open, deviations) = (chance.open, chance.deviations);
    let candidate = |doubt| Candidate { nodes: [a, b], open, sides: deviations.map(|d| [d; 2]), doubt };
    if let Some(split) = coarse(oracle.judge(&candidate(0.0))) {
        return split;
    }
    let [share, doubt] = chance.seen(viewer);
    if let Some(split) = coarse(oracle.judge(&candidate(doubt))) {
        return split;
    }
    let sides = deviations.map(|deviation| Side::default().at_least(deviation));
    Fate::Link(Link { open, ..link(pair, sides, [share, doubt], false) })
}

fn swapped(pair: Pair) -> Pair {
    let [a, b] = pair.nodes;
    Pair { nodes: [b, a], ..pair }
}

/// The fate of two flat nodes.
fn flat(oracle: &Oracle, viewer: &mut Viewer, pair: Pair, [p, q]: [&Patch; 2]) -> Fate {
    if behind(p, q) || behind(q, p) {
        return Fate::Gone;
    }
    let view = if pair.open { View::Open } else { viewer.view(p, q) };
    let seen = spread(p, q, &mut viewer.front);
    let (share, sides, doubt, open) = match view {
        View::Nothing => return Fate::Gone,
        View::Open => (1.0, seen.sides, 0.0, true),
        View::Part { share, sides, doubt } => {
            // Where nothing stands in the way of the points, the open pair still varies.
            let varied = |k: usize| Side {
                deviation: sides[k].deviation.max(share * seen.sides[k].deviation),
                rest: sides[k].rest.max(share * seen.sides[k].rest),
                ..sides[k]
            };
            (share, [varied(0), varied(1)], doubt, false)
        }
    };
    let candidate = Candidate {
        nodes: pair.nodes,
        open: seen.exchange,
        sides: sides.map(|side| [side.deviation, side.rest]),
        doubt,
    };
    let pair = Pair { open, ..pair };
    match oracle.judge(&candidate) {
        Verdict::SplitA => Fate::Split(pair),
        Verdict::SplitB => Fate::Split(swapped(pair)),
        Verdict::Keep => Fate::Link(link(pair, sides, [share, doubt], oracle.linear)),
    }
}

fn link(pair: Pair, sides: [Side; 2], [share, doubt]: [f64; 2], linear: bool) -> Link {
    let [a, b] = pair.nodes;
    let [p, q] = if a < b { sides } else { [sides[1], sides[0]] };
    let gradient = |side: Side| if linear { side.gradient.as_vec3() } else { glam::Vec3::ZERO };
    Link {
        a: a.min(b),
        b: a.max(b),
        open: 0.0,
        share: share as f32,
        doubt: doubt as f32,
        deviation: [p.deviation as f32, q.deviation as f32],
        rest: [p.rest as f32, q.rest as f32],
        gradient: [gradient(p), gradient(q)],
        partly: !pair.open,
    }
}

/// Whether no point of `p` is in front of `q`.
fn behind(p: &Patch, q: &Patch) -> bool {
    let flat = 1e-12 * (p.centroid().distance(q.centroid()) + p.diameter() + q.diameter());
    p.corners().iter().all(|x| (*x - q.corner(0)).dot(q.normal()) <= flat)
}

/// Takes over what became of a block: links, split nodes, and the pairs of their children.
fn advance(
    tree: &mut Tree,
    light: &mut Light,
    fates: Vec<Fate>,
    links: &mut Vec<Link>,
    waiting: &mut Vec<Pair>,
) -> Result<(), HierarchyError> {
    for fate in fates {
        match fate {
            Fate::Gone => {}
            Fate::Link(link) => {
                if links.len() == links.capacity() {
                    // A quarter more at a time: doubling would take memory that nothing needs.
                    links.reserve_exact(links.len() / 4 + PAIRS_OF_A_BLOCK);
                }
                links.push(link);
            }
            Fate::Split(pair) => children(tree, light, pair, waiting)?,
        }
    }
    Ok(())
}

/// Appends the pairs that take the place of a pair whose first node is split.
fn children(
    tree: &mut Tree,
    light: &mut Light,
    pair: Pair,
    waiting: &mut Vec<Pair>,
) -> Result<(), HierarchyError> {
    let Pair { nodes: [a, b], open, .. } = pair;
    tree.split(a)?;
    light.inherit(tree, a);
    let children = tree.nodes()[a as usize].children();
    if a == b {
        for (k, &child) in children.iter().enumerate() {
            waiting.extend(children[k..].iter().map(|&other| Pair {
                nodes: [child, other],
                open,
                coarse: false,
            }));
        }
    } else {
        waiting.extend(children.iter().map(|&child| Pair { nodes: [child, b], open, coarse: false }));
    }
    Ok(())
}
